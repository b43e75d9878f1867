#include "apps/rank_guard.h"

#include "apps/command_line.h"

#include <mpi.h>

#include <chrono>
#include <thread>

namespace apps
{
  namespace
  {
    constexpr std::chrono::seconds patience(3);

    /** True if all ranks come here within the patience. */
    bool is_everyone_here(MPI_Comm communicator)
    {
      MPI_Request request;
      MPI_Ibarrier(communicator, &request);
      const auto start = std::chrono::steady_clock::now();
      int is_done = 0;
      while (is_done == 0 && std::chrono::steady_clock::now() - start < patience)
        {
          MPI_Test(&request, &is_done, MPI_STATUS_IGNORE);
          std::this_thread::sleep_for(std::chrono::milliseconds(5));
        }
      return is_done != 0;
    }
  } // namespace

  int run_guarded_on_ranks(const std::string &program, const std::function<int()> &body)
  {
    MPI_Comm own; // its messages cannot be taken for those that other ranks wait for
    MPI_Comm_dup(MPI_COMM_WORLD, &own);
    int rank = 0;
    MPI_Comm_rank(own, &rank);
    bool has_thrown = true;
    const auto watched = [&]() {
      const int status = body();
      has_thrown = false;
      return status;
    };
    const int status = run_guarded(program, rank == 0, watched);
    if (has_thrown && !is_everyone_here(own))
      MPI_Abort(MPI_COMM_WORLD, status);
    MPI_Comm_free(&own);
    return status;
  }
} // namespace apps

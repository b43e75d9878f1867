#include <deal.II/base/mpi.h>

#include <gtest/gtest.h>

#include <cstdio>

namespace
{
  // A test fails on all ranks when it fails on one; ranks above 0 print their failures to stderr.
  class RankListener : public ::testing::EmptyTestEventListener
  {
    void OnTestPartResult(const ::testing::TestPartResult &result) override
    {
      const unsigned int rank = dealii::Utilities::MPI::this_mpi_process(MPI_COMM_WORLD);
      if (result.failed() && rank != 0)
        std::fprintf(stderr, "[rank %u] %s:%d: %s\n", rank, result.file_name(), result.line_number(), result.message());
    }

    void OnTestEnd(const ::testing::TestInfo &info) override
    {
      const int failed_here  = info.result()->Failed() ? 1 : 0;
      const int failed_there = dealii::Utilities::MPI::max(failed_here, MPI_COMM_WORLD);
      if (failed_there > failed_here)
        ADD_FAILURE() << "failed on another rank";
    }
  };
} // namespace

int main(int argc, char **argv)
{
  ::testing::InitGoogleTest(&argc, argv);
  const dealii::Utilities::MPI::MPI_InitFinalize mpi(argc, argv, 1);
  auto &listeners = ::testing::UnitTest::GetInstance()->listeners();
  if (dealii::Utilities::MPI::this_mpi_process(MPI_COMM_WORLD) != 0)
    delete listeners.Release(listeners.default_result_printer());
  listeners.Append(new RankListener);
  return dealii::Utilities::MPI::max(RUN_ALL_TESTS(), MPI_COMM_WORLD);
}

#include "coupling/rev_pool.h"

#include "dem/stopwatch.h"

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <stdexcept>
#include <string>
#include <thread>

namespace coupling
{
  namespace
  {
    std::span<double> get_row(std::vector<double> &rows, const std::size_t n_columns, const std::size_t i)
    {
      return std::span<double>(rows).subspan(i * n_columns, n_columns);
    }
  } // namespace

  std::vector<double> gather_rows(const std::vector<double> &rows, MPI_Comm communicator)
  {
    const unsigned int n_ranks = dealii::Utilities::MPI::n_mpi_processes(communicator);
    const int n_here = static_cast<int>(rows.size());
    std::vector<int> counts(n_ranks), offsets(n_ranks, 0);
    MPI_Allgather(&n_here, 1, MPI_INT, counts.data(), 1, MPI_INT, communicator);
    for (unsigned int r = 1; r < n_ranks; ++r)
      offsets[r] = offsets[r - 1] + counts[r - 1];
    std::vector<double> all(static_cast<std::size_t>(offsets.back() + counts.back()));
    MPI_Allgatherv(rows.data(), n_here, MPI_DOUBLE, all.data(), counts.data(), offsets.data(), MPI_DOUBLE,
                   communicator);
    return all;
  }

  RevPool::RevPool(MPI_Comm communicator, const bool is_replicated, const unsigned int n_threads)
      : communicator_(communicator), is_replicated_(is_replicated), n_threads_(std::max(1u, n_threads)),
        n_ranks_(dealii::Utilities::MPI::n_mpi_processes(communicator)),
        rank_(dealii::Utilities::MPI::this_mpi_process(communicator))
  {}

  void RevPool::set_points(const std::vector<PointId> &introduced)
  {
    const std::vector<double> mine(introduced.begin(), introduced.end());
    const std::vector<double> all = is_replicated_ ? mine : gather_rows(mine, communicator_);
    points_.assign(all.begin(), all.end());
    std::sort(points_.begin(), points_.end());
    if (std::adjacent_find(points_.begin(), points_.end()) != points_.end())
      throw std::logic_error("a Gauss point was introduced twice");
    index_.clear();
    local_points_.clear();
    for (std::size_t i = 0; i < points_.size(); ++i)
      {
        index_[points_[i]] = i;
        if (i % n_ranks_ == rank_)
          local_points_.push_back(points_[i]);
      }
  }

  RevPool::Questions RevPool::gather(const Questions &questions, std::vector<PointId> &ids) const
  {
    const std::vector<double> mine(questions.ids.begin(), questions.ids.end());
    const std::vector<double> all = gather_rows(mine, communicator_);
    ids.assign(all.begin(), all.end());
    return {ids, gather_rows(questions.rows, communicator_), questions.n_columns};
  }

  std::vector<double> RevPool::ask(const Questions &questions, const std::size_t n_columns,
                                   const Responder &respond) const
  {
    const dem::Stopwatch watch(total_s_);
    if (is_replicated_)
      return answer_all(questions, n_columns, respond);
    std::vector<PointId> ids;
    const std::vector<double> answers = answer_all(gather(questions, ids), n_columns, respond);
    std::vector<double> mine;
    for (const PointId id : questions.ids)
      {
        const std::size_t place = std::find(ids.begin(), ids.end(), id) - ids.begin();
        mine.insert(mine.end(), answers.begin() + place * n_columns, answers.begin() + (place + 1) * n_columns);
      }
    return mine;
  }

  std::vector<double> RevPool::answer_all(const Questions &questions, const std::size_t n_columns,
                                          const Responder &respond) const
  {
    std::vector<std::size_t> here;
    for (std::size_t i = 0; i < questions.ids.size(); ++i)
      if (get_owner(questions.ids[i]) == rank_)
        here.push_back(i);
    std::vector<double> local(here.size() * n_columns);
    agree([&]() {
      run_threads(here.size(), [&](const std::size_t k) {
        const std::span<const double> rows(questions.rows);
        respond(questions.ids[here[k]], rows.subspan(here[k] * questions.n_columns, questions.n_columns),
                get_row(local, n_columns, k));
      });
    });

    // The ranks' answers one after another, each in the order of the questions: deal them back.
    const std::vector<double> gathered = gather_rows(local, communicator_);
    std::vector<double> answers(questions.ids.size() * n_columns);
    auto next = gathered.begin();
    for (unsigned int rank = 0; rank < n_ranks_; ++rank)
      for (std::size_t i = 0; i < questions.ids.size(); ++i)
        if (get_owner(questions.ids[i]) == rank)
          {
            std::copy_n(next, n_columns, get_row(answers, n_columns, i).begin());
            next += n_columns;
          }
    return answers;
  }

  std::vector<double> RevPool::collect(const std::size_t n_columns,
                                       const std::function<void(PointId, std::span<double>)> &respond) const
  {
    const dem::Stopwatch watch(total_s_);
    return answer_all(
        {points_, {}, 0}, n_columns,
        [&](const PointId id, std::span<const double>, std::span<double> answer) { respond(id, answer); });
  }

  void RevPool::for_each_local(const std::function<void(PointId)> &work) const
  {
    const dem::Stopwatch watch(total_s_);
    agree([&]() { run_threads(local_points_.size(), [&](const std::size_t k) { work(local_points_[k]); }); });
  }

  void RevPool::run_threads(const std::size_t n, const std::function<void(std::size_t)> &work) const
  {
    const dem::Stopwatch watch(working_s_);
    std::atomic<std::size_t> next = 0;
    std::mutex mutex;
    std::exception_ptr failure;
    const auto run = [&]() {
      for (std::size_t i = next++; i < n; i = next++)
        try
          {
            work(i);
          }
        catch (...)
          {
            const std::lock_guard lock(mutex);
            failure = std::current_exception();
          }
    };
    {
      std::vector<std::jthread> threads;
      for (unsigned int t = 1; t < std::min<std::size_t>(n_threads_, n); ++t)
        threads.emplace_back(run);
      run();
    }
    if (failure)
      std::rethrow_exception(failure);
  }

  void RevPool::agree(const std::function<void()> &work) const
  {
    std::string message;
    bool has_failed = false;
    try
      {
        work();
      }
    catch (const std::exception &error)
      {
        message = error.what();
        has_failed = true;
      }
    const unsigned int first = dealii::Utilities::MPI::min(has_failed ? rank_ : n_ranks_, communicator_);
    if (first == n_ranks_)
      return;
    message = dealii::Utilities::MPI::broadcast(communicator_, message, first);
    throw std::runtime_error(message);
  }
} // namespace coupling

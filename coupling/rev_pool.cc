#include "coupling/rev_pool.h"

#include "dem/stopwatch.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

namespace coupling
{
  namespace
  {
    constexpr double unknown = std::numeric_limits<double>::quiet_NaN();

    /** A REV that has never been asked such a thing: worth being taken over. */
    constexpr double cost_of_the_unknown = 1.; // [s]

    /** Numbers that a rank sends in front of its answers: those of its PhaseReport. */
    constexpr std::size_t n_report_columns = 4;

    /** Numbers in front of each answer: its question and its cost. */
    constexpr std::size_t n_head_columns = 2;

    /** Parts of all ranks, one after the other. */
    struct Gathered
    {
      std::vector<double> values;
      std::vector<int> offsets; ///< one a rank, and the end
    };

    Gathered gather_parts(const std::vector<double> &part, MPI_Comm communicator)
    {
      const unsigned int n_ranks = dealii::Utilities::MPI::n_mpi_processes(communicator);
      const int n_here = static_cast<int>(part.size());
      std::vector<int> counts(n_ranks);
      Gathered gathered;
      gathered.offsets.assign(n_ranks + 1, 0);
      MPI_Allgather(&n_here, 1, MPI_INT, counts.data(), 1, MPI_INT, communicator);
      for (unsigned int r = 0; r < n_ranks; ++r)
        gathered.offsets[r + 1] = gathered.offsets[r] + counts[r];
      gathered.values.resize(static_cast<std::size_t>(gathered.offsets.back()));
      MPI_Allgatherv(part.data(), n_here, MPI_DOUBLE, gathered.values.data(), counts.data(), gathered.offsets.data(),
                     MPI_DOUBLE, communicator);
      return gathered;
    }

    /** Runs something; says what it was that failed. */
    template <typename Work>
    auto name_failures(const std::string &what, const Work &work)
    {
      try
        {
          return work();
        }
      catch (const std::exception &error)
        {
          throw std::runtime_error(fmt::format("{}: {}", what, std::string(error.what())));
        }
    }

    void smooth(double &expected, const double measured)
    {
      expected = std::isnan(expected) ? measured : 0.5 * (expected + measured);
    }
  } // namespace

  std::vector<double> gather_rows(const std::vector<double> &rows, MPI_Comm communicator)
  {
    return gather_parts(rows, communicator).values;
  }

  RevPool::RevPool(MPI_Comm communicator, const bool is_replicated, const unsigned int n_threads,
                   const BalanceRule &rule)
      : communicator_(communicator), is_replicated_(is_replicated), n_threads_(std::max(1u, n_threads)),
        n_ranks_(dealii::Utilities::MPI::n_mpi_processes(communicator)),
        rank_(dealii::Utilities::MPI::this_mpi_process(communicator)), rule_(rule)
  {
    tally_.n_workers = n_threads_;
    tally_.work_s.assign(n_ranks_, 0.);
    tally_.idle_s.assign(n_ranks_, 0.);
  }

  void RevPool::set_travel(const Travel &travel)
  {
    travel_.pack = [rank = rank_, pack = travel.pack](const PointId id) {
      return name_failures(fmt::format("the REV of point {} cannot leave rank {}", id, rank),
                           [&]() { return pack(id); });
    };
    travel_.unpack = [rank = rank_, unpack = travel.unpack](const PointId id, const std::vector<std::byte> &bytes) {
      name_failures(fmt::format("the REV of point {} has not arrived whole on rank {}", id, rank),
                    [&]() { unpack(id, bytes); });
    };
  }

  void RevPool::set_points(const std::vector<PointId> &introduced)
  {
    const std::vector<double> mine(introduced.begin(), introduced.end());
    const std::vector<double> all = is_replicated_ ? mine : gather_rows(mine, communicator_);
    points_.assign(all.begin(), all.end());
    std::sort(points_.begin(), points_.end());
    if (std::adjacent_find(points_.begin(), points_.end()) != points_.end())
      throw std::logic_error("a Gauss point was introduced twice");
    index_.clear();
    owners_.clear();
    for (std::size_t i = 0; i < points_.size(); ++i)
      {
        index_[points_[i]] = i;
        owners_.push_back(static_cast<unsigned int>(i % n_ranks_));
      }
    for (std::vector<double> &costs : costs_)
      costs.assign(points_.size(), unknown);
    expected_step_costs_.assign(points_.size(), unknown);
    step_costs_.assign(points_.size(), 0.);
    last_step_costs_ = step_costs_;
    list_local_points();
  }

  void RevPool::list_local_points()
  {
    local_points_.clear();
    for (std::size_t i = 0; i < points_.size(); ++i)
      if (owners_[i] == rank_)
        local_points_.push_back(points_[i]);
  }

  RevPool::Questions RevPool::gather(const Questions &questions, std::vector<PointId> &ids) const
  {
    const std::vector<double> mine(questions.ids.begin(), questions.ids.end());
    const std::vector<double> all = gather_rows(mine, communicator_);
    ids.assign(all.begin(), all.end());
    return {ids, gather_rows(questions.rows, communicator_), questions.n_columns, questions.kind};
  }

  std::vector<double> RevPool::ask(const Questions &questions, const std::size_t n_columns, const Responder &respond)
  {
    const dem::Stopwatch watch(total_s_);
    if (is_replicated_)
      {
        Phase phase = answer_all(questions, n_columns, respond);
        record(questions, phase);
        return std::move(phase.answers);
      }
    std::vector<PointId> ids;
    const Questions all = gather(questions, ids);
    const Phase phase = answer_all(all, n_columns, respond);
    record(all, phase);
    std::map<PointId, std::size_t> places;
    for (std::size_t i = 0; i < ids.size(); ++i)
      places[ids[i]] = i;
    std::vector<double> mine;
    for (const PointId id : questions.ids)
      {
        const auto row = phase.answers.begin() + static_cast<std::ptrdiff_t>(places.at(id) * n_columns);
        mine.insert(mine.end(), row, row + static_cast<std::ptrdiff_t>(n_columns));
      }
    return mine;
  }

  std::vector<double> RevPool::ask_all(const WorkKind kind, const std::size_t n_columns,
                                       const std::function<void(PointId, std::span<double>)> &respond)
  {
    const dem::Stopwatch watch(total_s_);
    const Questions questions{points_, {}, 0, kind};
    Phase phase =
        answer_all(questions, n_columns,
                   [&](const PointId id, std::span<const double>, std::span<double> answer) { respond(id, answer); });
    record(questions, phase);
    return std::move(phase.answers);
  }

  std::vector<double> RevPool::collect(const std::size_t n_columns,
                                       const std::function<void(PointId, std::span<double>)> &respond) const
  {
    const dem::Stopwatch watch(total_s_);
    return answer_all({points_, {}, 0, WorkKind::bookkeeping}, n_columns,
                      [&](const PointId id, std::span<const double>, std::span<double> answer) { respond(id, answer); })
        .answers;
  }

  // Each answer is a row: number of the question, cost, numbers of the answer.
  RevPool::Phase RevPool::answer_all(const Questions &questions, const std::size_t n_columns,
                                     const Responder &respond) const
  {
    std::vector<double> rows;
    std::mutex mutex;
    const auto work = [&](const WaitingRev &rev) {
      const double start = clock_();
      std::vector<double> row(n_head_columns + n_columns, unknown);
      respond(rev.id,
              std::span<const double>(questions.rows).subspan(rev.question * questions.n_columns, questions.n_columns),
              std::span<double>(row).subspan(n_head_columns));
      row[0] = static_cast<double>(rev.question);
      row[1] = clock_() - start;
      const std::lock_guard lock(mutex);
      rows.insert(rows.end(), row.begin(), row.end());
    };
    PhaseReport report;
    agree([&]() {
      report = run_phase(questions, work);
      working_s_ += report.wall_s;
      if (report.failure)
        std::rethrow_exception(report.failure);
    });
    return assemble(questions, n_columns, rows, report);
  }

  PhaseReport RevPool::run_phase(const Questions &questions, const WorkSharing::Work &work) const
  {
    const std::vector<double> expected = compute_expected_costs(questions);
    std::vector<WaitingRev> waiting;
    std::vector<double> loads(n_ranks_, 0.);
    for (const std::size_t i : sort_by_cost(expected))
      {
        const unsigned int owner = get_owner(questions.ids[i]);
        loads[owner] += expected[i];
        if (owner == rank_)
          waiting.push_back({questions.ids[i], i, expected[i]});
      }
    if (!can_share(questions, expected))
      return run_workers(waiting, n_threads_, clock_, work);
    std::vector<unsigned int> victims;
    for (const std::size_t victim : sort_by_cost(loads))
      if (victim != rank_)
        victims.push_back(static_cast<unsigned int>(victim));
    return WorkSharing(communicator_, n_threads_, rule_.smallest_cost, travel_, clock_)
        .run(waiting, victims, questions.ids, work);
  }

  std::vector<double> RevPool::compute_expected_costs(const Questions &questions) const
  {
    const std::vector<double> &known = costs_[static_cast<std::size_t>(questions.kind)];
    std::vector<double> expected;
    for (const PointId id : questions.ids)
      {
        const double cost = known[get_index(id)];
        expected.push_back(std::isnan(cost) ? cost_of_the_unknown : cost);
      }
    return expected;
  }

  bool RevPool::can_share(const Questions &questions, std::span<const double> expected) const
  {
    return rule_.is_active && n_ranks_ > 1 && travel_.pack && questions.kind != WorkKind::bookkeeping &&
           std::any_of(expected.begin(), expected.end(),
                       [&](const double cost) { return cost >= rule_.smallest_cost; });
  }

  RevPool::Phase RevPool::assemble(const Questions &questions, const std::size_t n_columns,
                                   const std::vector<double> &rows, const PhaseReport &report) const
  {
    std::vector<double> part = {report.work_s, report.longest_s, static_cast<double>(report.n_taken),
                                static_cast<double>(report.bytes_taken)};
    part.insert(part.end(), rows.begin(), rows.end());
    const Gathered gathered = gather_parts(part, communicator_);
    const std::size_t n = questions.ids.size(), length = n_head_columns + n_columns;
    Phase phase{std::vector<double>(n * n_columns), std::vector<double>(n), std::vector<unsigned int>(n), {}};
    for (unsigned int rank = 0; rank < n_ranks_; ++rank)
      {
        const double *at = gathered.values.data() + gathered.offsets[rank];
        const double *const end = gathered.values.data() + gathered.offsets[rank + 1];
        phase.reports.push_back(
            {at[0], at[1], 0., static_cast<std::size_t>(at[2]), static_cast<std::size_t>(at[3]), nullptr});
        for (at += n_report_columns; at < end; at += length)
          {
            const auto question = static_cast<std::size_t>(at[0]);
            phase.costs[question] = at[1];
            phase.ranks[question] = rank;
            std::copy_n(at + n_head_columns, n_columns, phase.answers.begin() + question * n_columns);
          }
      }
    return phase;
  }

  // Who lives where now, and what it cost.
  void RevPool::record(const Questions &questions, const Phase &phase)
  {
    if (questions.kind == WorkKind::bookkeeping)
      return;
    std::vector<double> &known = costs_[static_cast<std::size_t>(questions.kind)];
    for (std::size_t i = 0; i < questions.ids.size(); ++i)
      {
        const std::size_t place = get_index(questions.ids[i]);
        owners_[place] = phase.ranks[i];
        smooth(known[place], phase.costs[i]);
        step_costs_[place] += phase.costs[i];
      }
    list_local_points();

    double longest = 0.;
    for (const PhaseReport &report : phase.reports)
      longest = std::max(longest, report.longest_s);
    for (unsigned int rank = 0; rank < n_ranks_; ++rank)
      {
        const PhaseReport &report = phase.reports[rank];
        tally_.work_s[rank] += report.work_s;
        tally_.idle_s[rank] += n_threads_ * longest - report.work_s;
        tally_.n_taken += report.n_taken;
        tally_.bytes_migrated += report.bytes_taken;
      }
    tally_.longest_s += longest;
    ++tally_.n_phases;
  }

  void RevPool::close_step()
  {
    const dem::Stopwatch watch(total_s_);
    for (std::size_t i = 0; i < points_.size(); ++i)
      smooth(expected_step_costs_[i], step_costs_[i]);
    last_step_costs_ = step_costs_;
    std::fill(step_costs_.begin(), step_costs_.end(), 0.);
    if (!rule_.is_active || n_ranks_ == 1 || !travel_.pack)
      return;
    const auto moves = plan_migration(owners_, expected_step_costs_, n_ranks_, rule_.tolerance);
    agree([&]() { tally_.bytes_migrated += migrate(moves, points_, travel_, communicator_); });
    tally_.n_migrated += moves.size();
    for (const Move &move : moves)
      owners_[move.rev] = move.to;
    list_local_points();
  }

  void RevPool::for_each_local(const std::function<void(PointId)> &work) const
  {
    const dem::Stopwatch watch(total_s_);
    std::vector<WaitingRev> waiting;
    for (const PointId id : local_points_)
      waiting.push_back({id, 0, 0.});
    agree([&]() {
      const PhaseReport report = run_workers(waiting, n_threads_, clock_, [&](const WaitingRev &rev) { work(rev.id); });
      working_s_ += report.wall_s;
      if (report.failure)
        std::rethrow_exception(report.failure);
    });
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

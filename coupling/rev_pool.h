#pragma once

#include "coupling/migration.h"
#include "coupling/work_sharing.h"
#include "coupling/work_tally.h"

#include <array>
#include <functional>
#include <map>
#include <span>
#include <vector>

namespace coupling
{
  /** What kind of work a question is: costs are expected by kind. */
  enum class WorkKind : std::size_t
  {
    bookkeeping, ///< cheap: REVs stay where they are, and nothing is measured
    prepare,     ///< before the first step
    evaluate,
    age,
    split,
    count
  };

  /**
   * Which REV lives on which rank, and the way of questions to it and of answers back.
   *
   * REVs are dealt out to the ranks like cards, in the order of their numbers, whatever rank the mesh gave their points
   * to. From there they go where work is missing: within a question to all of them idle ranks take waiting REVs over
   * (work_sharing.h), and between steps they migrate until the costs of the steps before balance (balance.h). Questions
   * and answers are rows of plain numbers. Nothing that comes out depends on the number of ranks or threads, nor on
   * what lives where: answers are assembled in the order of the questions, sums over points in the order of their
   * numbers.
   *
   * All members that communicate are collective. What is thrown on one rank is thrown on all.
   */
  class RevPool
  {
  public:
    /**
     * @param communicator    the ranks that share the REVs
     * @param is_replicated   true: every rank holds the whole mesh and asks the same; false: each rank asks for its
     * part
     * @param n_threads       of each rank, >= 1; one REV is worked on by one thread
     */
    RevPool(MPI_Comm communicator, bool is_replicated, unsigned int n_threads, const BalanceRule &rule = {});

    /** How REVs travel; without it they stay. What it throws is told with the REV and the rank where it happened. */
    void set_travel(const Travel &travel);

    /** Costs are processor time unless another clock is given, one that a test foresees. */
    void set_clock(const CostClock &clock) { clock_ = clock; }

    /** Deals out the points of all ranks. @param introduced  those of this rank's part of the mesh, in any order */
    void set_points(const std::vector<PointId> &introduced);

    /** All points, ascending. */
    const std::vector<PointId> &get_points() const { return points_; }

    /** Those whose REVs live here, ascending. */
    const std::vector<PointId> &get_local_points() const { return local_points_; }

    /** Place of a point among all. */
    std::size_t get_index(PointId id) const { return index_.at(id); }
    unsigned int get_owner(PointId id) const { return owners_[get_index(id)]; }

    unsigned int get_rank() const { return rank_; }
    unsigned int get_n_ranks() const { return n_ranks_; }
    MPI_Comm get_communicator() const { return communicator_; }

    /** Some points, each once, and a row of numbers for each. */
    struct Questions
    {
      std::span<const PointId> ids;
      std::vector<double> rows; ///< ids.size() rows of n_columns
      std::size_t n_columns = 0;
      WorkKind kind = WorkKind::bookkeeping;
    };

    /** Fills the answer to one question; runs where the REV lives, for several points at a time. */
    using Responder = std::function<void(PointId, std::span<const double> question, std::span<double> answer)>;

    /** Answers to this rank's questions, one row of n_columns each, in their order. REVs may change their ranks. */
    std::vector<double> ask(const Questions &questions, std::size_t n_columns, const Responder &respond);

    /** One row of n_columns for every point, in the order of get_points(), known to all ranks. REVs may change their
     * ranks. */
    std::vector<double> ask_all(WorkKind kind, std::size_t n_columns,
                                const std::function<void(PointId, std::span<double>)> &respond);

    /** The same as bookkeeping. */
    std::vector<double> collect(std::size_t n_columns,
                                const std::function<void(PointId, std::span<double>)> &respond) const;

    /** Runs the work once for each REV that lives here. */
    void for_each_local(const std::function<void(PointId)> &work) const;

    /** Runs something on every rank; if it throws on one, all throw the first such rank's message. */
    void agree(const std::function<void()> &work) const;

    /** A step is over: its costs are kept, and REVs migrate where they help. */
    void close_step();

    /** Processor time of each point in the last step that was closed, in the order of get_points() [s]. */
    const std::vector<double> &get_step_costs() const { return last_step_costs_; }

    const WorkTally &get_tally() const { return tally_; }

    /** Wall time that this rank has spent on REVs, and in all calls with waiting for others [s]. */
    double get_working_time() const { return working_s_; }
    double get_total_time() const { return total_s_; }

  private:
    /** What came out of a phase, known to all ranks. */
    struct Phase
    {
      std::vector<double> answers;      ///< in the order of the questions
      std::vector<double> costs;        ///< of each [s]
      std::vector<unsigned int> ranks;  ///< where each was found
      std::vector<PhaseReport> reports; ///< of each rank
    };

    Phase answer_all(const Questions &questions, std::size_t n_columns, const Responder &respond) const;
    PhaseReport run_phase(const Questions &questions, const WorkSharing::Work &work) const;
    Phase assemble(const Questions &questions, std::size_t n_columns, const std::vector<double> &rows,
                   const PhaseReport &report) const;
    void record(const Questions &questions, const Phase &phase);
    std::vector<double> compute_expected_costs(const Questions &questions) const;
    bool can_share(const Questions &questions, std::span<const double> expected) const;
    Questions gather(const Questions &questions, std::vector<PointId> &ids) const;
    void list_local_points();

    MPI_Comm communicator_;
    bool is_replicated_;
    unsigned int n_threads_, n_ranks_, rank_;
    BalanceRule rule_;
    Travel travel_;
    CostClock clock_ = measure_thread_seconds;
    std::vector<PointId> points_, local_points_;
    std::map<PointId, std::size_t> index_;
    std::vector<unsigned int> owners_;

    // Measurements, the same on all ranks: they say where REVs live, and no result depends on them.
    std::array<std::vector<double>, static_cast<std::size_t>(WorkKind::count)> costs_; ///< of an answer, NaN: unknown
    std::vector<double> step_costs_, last_step_costs_, expected_step_costs_;
    WorkTally tally_;
    mutable double working_s_ = 0., total_s_ = 0.;
  };

  /** Rows of several ranks put together in the order of the ranks. Collective. */
  std::vector<double> gather_rows(const std::vector<double> &rows, MPI_Comm communicator);
} // namespace coupling

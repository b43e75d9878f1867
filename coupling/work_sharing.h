#pragma once

#include "coupling/cpu_clock.h"
#include "coupling/migration.h"

#include <condition_variable>
#include <deque>
#include <exception>
#include <functional>
#include <mutex>
#include <span>
#include <vector>

namespace coupling
{
  /** A question that waits for its REV. */
  struct WaitingRev
  {
    PointId id = 0;
    std::size_t question = 0; ///< its number, the same on all ranks
    double expected_s = 0.;   ///< cost of its answer [s]
  };

  /** What a rank did in a phase. */
  struct PhaseReport
  {
    double work_s = 0.;    ///< processor time of all workers [s]
    double longest_s = 0.; ///< of the busiest of them [s]
    double wall_s = 0.;    ///< wall time of the same worker's answers [s]
    std::size_t n_taken = 0, bytes_taken = 0;
    std::exception_ptr failure; ///< what a REV threw; the others have been worked through
  };

  /**
   * One phase of work: the waiting REVs of this rank, the costliest first, and those that it takes from busier ranks
   * once it has none left.
   *
   * Workers are threads that never talk to other ranks. The calling thread is the clerk, who does nothing else: it
   * gives waiting REVs to ranks that ask, and asks the others, the one with the most expected work first, while a
   * worker here is idle. A rank that has once refused is not asked again, since its queue only gets shorter. The phase
   * is over when all ranks are idle and have been refused by all others. A REV that was taken over stays.
   */
  class WorkSharing
  {
  public:
    using Work = std::function<void(const WaitingRev &)>;

    /** @param n_workers  threads of this rank, >= 1 @param smallest_cost  of a REV that is given away [s] */
    WorkSharing(MPI_Comm communicator, unsigned int n_workers, double smallest_cost, const Travel &travel,
                const CostClock &clock);

    /**
     * Collective.
     *
     * @param waiting  this rank's REVs, in the order in which they shall be worked on
     * @param victims  other ranks in the order in which they shall be asked
     * @param question_ids  the point of every question, the same on all ranks
     */
    PhaseReport run(const std::vector<WaitingRev> &waiting, const std::vector<unsigned int> &victims,
                    std::span<const PointId> question_ids, const Work &work);

  private:
    void work_through(const Work &work);
    void keep_failure();
    bool answer_requests();
    bool receive_reply(std::span<const PointId> question_ids);
    void ask_for_work();
    bool is_idle();
    void serve(std::span<const PointId> question_ids);

    MPI_Comm communicator_;
    unsigned int n_workers_;
    double smallest_cost_;
    const Travel &travel_;
    const CostClock &clock_;

    std::mutex mutex_; // of all that follows
    std::condition_variable for_workers_, for_clerk_;
    std::deque<WaitingRev> waiting_, taken_;
    unsigned int n_idle_ = 0;
    bool is_over_ = false;
    PhaseReport report_;

    std::deque<unsigned int> victims_; // the clerk's own
    bool is_asking_ = false;
  };

  /**
   * The same without other ranks: the REVs that wait here, by so many threads, of which the calling one is the first.
   */
  PhaseReport run_workers(const std::vector<WaitingRev> &waiting, unsigned int n_workers, const CostClock &clock,
                          const WorkSharing::Work &work);
} // namespace coupling

#pragma once

#include <cstdint>
#include <vector>

namespace coupling
{
  /**
   * Where the processor time of the REVs went, known to all ranks. A measurement: no result depends on it.
   *
   * Work is done in phases: questions that all ranks wait for together. `longest_s` adds up what the busiest worker of
   * any rank had to do in each of them, and is what the work would take if nothing but REVs cost time.
   */
  struct WorkTally
  {
    std::vector<double> work_s;       ///< of each rank, all its workers together [s]
    std::vector<double> idle_s;       ///< of each rank: what its workers had less to do than the busiest of all [s]
    double longest_s = 0.;            ///< of the busiest worker, summed over the phases [s]
    unsigned int n_workers = 1;       ///< of a rank
    std::uint64_t n_phases = 0;       ///< in which REVs worked
    std::uint64_t n_taken = 0;        ///< REVs that an idle rank took over in mid-phase
    std::uint64_t n_migrated = 0;     ///< REVs that changed their rank between steps
    std::uint64_t bytes_migrated = 0; ///< sent for both [B]

    double compute_work() const
    {
      double sum = 0.;
      for (const double work : work_s)
        sum += work;
      return sum;
    }

    /** Work divided by the workers of all ranks and what the busiest had to do [-]; 1 if there was none. */
    double compute_efficiency() const
    {
      const double room = static_cast<double>(work_s.size()) * n_workers * longest_s;
      return room > 0. ? compute_work() / room : 1.;
    }
  };

  /** What was added between two moments. @pre `earlier` is an earlier state of the same tally, or empty */
  inline WorkTally compute_difference(WorkTally later, const WorkTally &earlier)
  {
    for (std::size_t rank = 0; rank < earlier.work_s.size(); ++rank)
      {
        later.work_s[rank] -= earlier.work_s[rank];
        later.idle_s[rank] -= earlier.idle_s[rank];
      }
    later.longest_s -= earlier.longest_s;
    later.n_phases -= earlier.n_phases;
    later.n_taken -= earlier.n_taken;
    later.n_migrated -= earlier.n_migrated;
    later.bytes_migrated -= earlier.bytes_migrated;
    return later;
  }

  /** Sum of the tallies of separate times. */
  inline WorkTally add(WorkTally sum, const WorkTally &more)
  {
    sum.work_s.resize(more.work_s.size());
    sum.idle_s.resize(more.idle_s.size());
    for (std::size_t rank = 0; rank < more.work_s.size(); ++rank)
      {
        sum.work_s[rank] += more.work_s[rank];
        sum.idle_s[rank] += more.idle_s[rank];
      }
    sum.n_workers = more.n_workers;
    sum.longest_s += more.longest_s;
    sum.n_phases += more.n_phases;
    sum.n_taken += more.n_taken;
    sum.n_migrated += more.n_migrated;
    sum.bytes_migrated += more.bytes_migrated;
    return sum;
  }
} // namespace coupling

#pragma once

#include "dem/rev.h"

#include <string>

namespace coupling
{
  /** How the specimen's time goes through the fractures of its REVs. */
  enum class AgeingMode
  {
    events,  ///< a macro step ends at the earliest batch of fractures of any REV
    schedule ///< macro steps as the schedule says; each REV goes through its own batches at held strain meanwhile
  };

  struct AgeingRule
  {
    AgeingMode mode = AgeingMode::events;
    unsigned int round_cap = 1000; ///< batches and avalanche rounds of one REV within one step; beyond it: failed
  };

  /** What a REV went through while it was aged or split. */
  struct AgeingReport
  {
    dem::RestReport rest;     ///< of the last relaxation
    std::size_t n_broken = 0; ///< grains
    bool is_capped = false;   ///< still breaking after round_cap batches

    bool has_failed() const { return is_capped || rest.status != dem::RestStatus::at_rest; }
  };

  /**
   * One clock for the grains and for the specimen (docs/theory.md, section 8). A macro step is
   *
   *     dt = the schedule's, or the earliest batch of any REV     compute_time_to_next_event()
   *     every REV ages by dt, at held strain                      age()
   *     repeat  Newton on the nodal forces, fracture frozen
   *             every REV splits what is overstressed, relaxes    split_overstressed()
   *     until   nothing was overstressed
   *     commit, or take all back and make the load or the batch smaller (is_excessive, can_cut_batch)
   *
   * Everything here is about one REV; RevMaterial does it to all of them.
   */
  double compute_time_to_next_event(const dem::Rev &rev, const AgeingRule &rule, unsigned int n_cuts);

  /** True if a batch cut once more than n_cuts times is a smaller one. */
  bool can_cut_batch(const dem::Rev &rev, const AgeingRule &rule, unsigned int n_cuts);

  /** Moves the baseline on by dt [s] and brings it to rest at held strain if grains broke. Trial = baseline. */
  AgeingReport age(dem::Rev &rev, double dt, const AgeingRule &rule);

  /** True if more grains of the baseline are overstressed than one batch may hold. */
  bool is_excessive(const dem::Rev &rev);

  /** Splits one batch of overstressed grains of the baseline and relaxes at held strain. Trial = baseline. */
  AgeingReport split_overstressed(dem::Rev &rev);

  /**
   * The jump that is meant by dt: if a fracture lies above dt by no more than the rounding of the clock, the time of
   * that fracture. A macro clock at 1e6 s cannot count 1e-11 s, and would wait for such a grain for ever.
   *
   * @param now  [s] since the start
   */
  double snap_to_fracture(const dem::Grains &grains, double dt, double now);
} // namespace coupling

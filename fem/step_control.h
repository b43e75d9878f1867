#pragma once

#include <string>

namespace fem
{
  /** What a step has brought about. */
  struct StepEffects
  {
    double fractures = 0.;     ///< events of a point while time passed, mean over the points that know events [-]
    double strain = 0.;        ///< largest over the ground's points: norm of the logarithmic strain increment [-]
    double stress_change = 0.; ///< largest over the ground's points, over its own stress or their mean stress,
                               ///< whichever is more [-]
  };

  /** How the lengths of scheduled creep steps follow what steps bring about (docs/theory.md, Eqs. 8.4 and 8.5). */
  struct StepControl
  {
    bool is_active = false;
    StepEffects target = {0.25, 1e-3, 0.1}; ///< that a step should come to at most, all > 0
    double hard_limit = 2.;                 ///< multiple of a target beyond which a step is repeated, > 1
    double smallest_share = 1. / 16.;       ///< of a scheduled step, in (0, 1]: no shorter step is asked for
    double largest_growth = 2.;             ///< of the share from one step to the next, > 1
  };

  /** Largest effect over its target [-]. */
  double rate(const StepEffects &effects, const StepControl &control);

  /** True for a step that must be repeated with half its share. @param share  of a scheduled step that it had */
  bool is_overshoot(const StepEffects &effects, double share, const StepControl &control);

  /** Share of a scheduled step that the next one should have, after one with these effects. */
  double compute_next_share(const StepEffects &effects, double share, const StepControl &control);

  /** Throws std::invalid_argument naming parameter, value and range.
   *  @param smallest_step_share  down to which other failures cut a step: the control's must not lie below */
  void check_control(const StepControl &control, double smallest_step_share);
} // namespace fem

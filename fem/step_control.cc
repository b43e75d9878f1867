#include "fem/step_control.h"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

namespace fem
{
  namespace
  {
    void require(const bool is_allowed, const std::string &name, const double value, const std::string &range)
    {
      if (!is_allowed)
        throw std::invalid_argument(fmt::format("step control: {} = {:g} must be {}", name, value, range));
    }
  } // namespace

  double rate(const StepEffects &effects, const StepControl &control)
  {
    const StepEffects &target = control.target;
    return std::max({effects.fractures / target.fractures, effects.strain / target.strain,
                     effects.stress_change / target.stress_change});
  }

  bool is_overshoot(const StepEffects &effects, const double share, const StepControl &control)
  {
    return control.is_active && rate(effects, control) > control.hard_limit && 0.5 * share >= control.smallest_share;
  }

  double compute_next_share(const StepEffects &effects, const double share, const StepControl &control)
  {
    const double rating = rate(effects, control);
    const double growth =
        rating * control.largest_growth > 1. ? 1. / rating : control.largest_growth; // a quiet step says no more
    return std::clamp(share * growth, control.smallest_share, 1.);
  }

  void check_control(const StepControl &control, const double smallest_step_share)
  {
    if (!control.is_active)
      return;
    require(control.target.fractures > 0., "fractures a point", control.target.fractures, "> 0");
    require(control.target.strain > 0., "strain", control.target.strain, "> 0");
    require(control.target.stress_change > 0., "stress change", control.target.stress_change, "> 0");
    require(control.hard_limit > 1., "hard limit", control.hard_limit, "> 1");
    require(control.largest_growth > 1., "largest growth", control.largest_growth, "> 1");
    require(control.smallest_share >= smallest_step_share && control.smallest_share <= 1., "smallest share",
            control.smallest_share,
            fmt::format("at least the smallest step share {:g} and at most 1", smallest_step_share));
  }
} // namespace fem

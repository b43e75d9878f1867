#pragma once

#include "dem/breakage.h"
#include "dem/equilibrium.h"

#include <limits>

namespace dem
{
  /** How time passes for cracks in a dynamic computation. The default is the computation's own time, without end. */
  struct CrackClock
  {
    double scale = 1.; ///< of their time over the computation's, [-] or [s] a cycle
    double interval = std::numeric_limits<double>::infinity(); ///< after which it stands still [s]
    bool waits_for_rest =
        true; ///< the run ends at rest, but not before the interval; false: with the interval, as it is
  };

  /** What a dynamic computation in which time passes needs beside a RestRule. */
  struct CrackingRule
  {
    FractureRule fracture;
    RevIdentity identity;
    CrackClock clock = {};
  };

  /**
   * The time-to-fracture paper's dynamic computation: time counts, every crack grows by v dt and both criteria are
   * tested in every cycle; grains split as they go, and the run is at rest when the rule says so. With a scaled clock
   * cracks grow by v scale dt (docs/theory.md Eq. 6.5).
   *
   * @pre true masses, or a clock with a finite interval
   * @post state.time has moved on by report.duration [s]; counters count what broke by cause
   */
  RestReport run_dynamic_computation(RevState &state, const RestRule &rule, const CrackingRule &cracking,
                                     const CellControl &control);
} // namespace dem

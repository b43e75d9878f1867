#pragma once

#include "dem/breakage.h"
#include "dem/equilibrium.h"

namespace dem
{
  /** What a dynamic computation in real time needs beside a RestRule. */
  struct CrackingRule
  {
    FractureRule fracture;
    RevIdentity identity;
  };

  /**
   * The time-to-fracture paper's dynamic computation: true masses, time counts, every crack grows by v dt and both
   * criteria are tested in every cycle; grains split as they go, and the run is at rest when the rule says so.
   *
   * @pre rule.dynamics.motion.has_true_masses
   * @post state.time has moved on by report.duration [s]; counters count what broke by cause
   */
  RestReport run_dynamic_computation(RevState &state, const RestRule &rule, const CrackingRule &cracking,
                                     const CellControl &control);
} // namespace dem

#pragma once

#include "dem/laboratory.h"

namespace dem
{
  /** How far an attempt at a step had come when its last dynamic computation ended. */
  struct AttemptEnd
  {
    RestReport rest;             ///< of that computation
    double strain = 0.;          ///< largest component of the logarithmic strain since the last committed state [-]
    double strain_of_stage = 0.; ///< the same since the stage began [-]
    double largest_target = 0.;  ///< largest stress that is controlled [Pa]
    std::array<bool, 6> is_stress_controlled{}; ///< xx, yy, zz, xy, yz, xz
  };

  /**
   * What such an end means for the stage (docs/theory.md, section 6.3): `finished` if nothing is wrong with it, else
   * why the programme ends should no smaller step be left.
   */
  LaboratoryOutcome judge_attempt(const LaboratoryStage &stage, const LaboratoryRule &rule, const AttemptEnd &end);

  /** A triaxial creep that has ruptured though every batch came to rest: no smaller batch would tell more. */
  bool has_crept_too_far(const LaboratoryStage &stage, const LaboratoryRule &rule, const AttemptEnd &end);

  const char *describe(LaboratoryOutcome outcome);
  const char *describe(RuptureCriterion criterion);

  /** What a user can do about an outcome, a clause; empty where there is nothing to do. */
  const char *suggest_remedy(LaboratoryOutcome outcome);
} // namespace dem

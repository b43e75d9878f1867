#include "dem/attempt_judgement.h"

#include "dem/stage_path.h"

namespace dem
{
  namespace
  {
    /** A REV that cannot bear its load errs to one side; a servo that is too quick errs to both. */
    bool has_swung(const AttemptEnd &end, const double share)
    {
      const double bound = share * end.largest_target;
      for (int m = 0; m < 6; ++m)
        if (end.rest.largest_deviation[m] > bound && end.rest.smallest_deviation[m] < -bound)
          return true;
      return false;
    }
  } // namespace

  bool has_crept_too_far(const LaboratoryStage &stage, const LaboratoryRule &rule, const AttemptEnd &end)
  {
    return stage.kind == StageKind::creep && stage.held == HeldStress::all_normal &&
           end.rest.status == RestStatus::at_rest && end.strain <= rule.flow_strain &&
           end.strain_of_stage > rule.rupture_strain;
  }

  LaboratoryOutcome judge_attempt(const LaboratoryStage &stage, const LaboratoryRule &rule, const AttemptEnd &end)
  {
    const bool is_at_rest = end.rest.status == RestStatus::at_rest;
    if (!is_at_rest && has_swung(end, rule.unstable_swing))
      return LaboratoryOutcome::servo_unstable;
    if ((stage.kind == StageKind::creep && end.strain > rule.flow_strain) || has_crept_too_far(stage, rule, end))
      return LaboratoryOutcome::ruptured;
    if (is_to_stress(stage) &&
        (end.strain_of_stage > rule.largest_strain || (!is_at_rest && end.strain > rule.flow_strain)))
      return LaboratoryOutcome::not_reached;
    if (is_at_rest)
      return LaboratoryOutcome::finished;
    return end.rest.status == RestStatus::cell_too_narrow ? LaboratoryOutcome::collapsed
                                                          : LaboratoryOutcome::no_equilibrium;
  }

  const char *describe(const LaboratoryOutcome outcome)
  {
    switch (outcome)
      {
      case LaboratoryOutcome::finished:
        return "finished";
      case LaboratoryOutcome::no_equilibrium:
        return "no equilibrium at the smallest step";
      case LaboratoryOutcome::ruptured:
        return "ruptured";
      case LaboratoryOutcome::not_reached:
        return "the stress asked for is not reached: the REV strains without bearing it";
      case LaboratoryOutcome::collapsed:
        return "collapsed: the cell is narrower than two largest diameters plus skin";
      case LaboratoryOutcome::servo_unstable:
        return "the servo is unstable: a controlled stress swings about its target";
      case LaboratoryOutcome::stopped:
        return "stopped";
      }
    return "unknown";
  }

  const char *describe(const RuptureCriterion criterion)
  {
    switch (criterion)
      {
      case RuptureCriterion::none:
        return "none";
      case RuptureCriterion::endless_avalanche:
        return "an avalanche of fractures did not end";
      case RuptureCriterion::no_rest:
        return "strained on under held stress without coming to rest";
      case RuptureCriterion::large_strain:
        return "strained further under held stress than creep does before coming to rest";
      case RuptureCriterion::large_creep:
        return "crept further than a specimen that has not failed";
      }
    return "unknown";
  }

  const char *suggest_remedy(const LaboratoryOutcome outcome)
  {
    switch (outcome)
      {
      case LaboratoryOutcome::finished:
      case LaboratoryOutcome::stopped:
        return "";
      case LaboratoryOutcome::no_equilibrium:
        return "try more Increments, or a larger Equilibrium/Cycle cap";
      case LaboratoryOutcome::ruptured:
        return "try more Increments, or a larger Laboratory/Round cap";
      case LaboratoryOutcome::not_reached:
        return "ask for less stress, or strain the REV instead";
      case LaboratoryOutcome::collapsed:
        return "start from more grains (Packing/Grains), or strain and load less";
      case LaboratoryOutcome::servo_unstable:
        return "lower Equilibrium/Servo gain";
      }
    return "";
  }
} // namespace dem

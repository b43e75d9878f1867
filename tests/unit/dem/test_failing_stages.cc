// Stages that cannot be finished: a creep that ruptures, a stress that is not reached, a servo that is too quick.

#include "dem/attempt_judgement.h"
#include "dem/laboratory.h"
#include "dem/stage_path.h"

#include "tests/support/rev_cases.h"
#include "tests/support/stage_cases.h"

#include <gtest/gtest.h>

#include <string>

namespace
{
  using namespace dem;
  using namespace dem::cases;

  constexpr double pressure = 2e6; // [Pa]

  ProgrammeRun run(Rev &rev, const std::vector<LaboratoryStage> &stages, const LaboratoryPosition &position = {})
  {
    ProgrammeRun result;
    result.position = position;
    go_on(rev, stages, result);
    return result;
  }

  /** Wide enough to flow before it is too narrow for its grains. */
  const RevState &get_wide_packing()
  {
    static const Packing packing = [] {
      PackingRule rule = make_packing_rule();
      rule.n_grains = 250;
      rule.seed = 1;
      return generate_packing(rule, GrainMaterial{}, DynamicsRule{});
    }();
    return packing.state;
  }

  TEST(FailingStages, ACreepNearTheStrengthRupturesAndIsNamedWithItsTime)
  {
    // Law: held at 0.99 q_max of its own, a REV ruptures once cracks have weakened it enough: the programme ends with
    // time and criterion, the last state at rest kept; gone on with, it ruptures again the same way. By then cracks
    // break what twice the contact stress would break in the first second, (1e18)^(1/60) = 2.0: no packing bears that.
    Rev rev = make_rev(RevModel{}, get_wide_packing());
    LaboratoryStage search = make_stage(StageKind::strength_search), share = make_stage(StageKind::triaxial),
                    creep = make_stage(StageKind::creep);
    search.axial_strain = 0.12;
    search.n_increments = 30;
    share.strength_share = 0.99;
    share.n_increments = 12;
    creep.held = HeldStress::all_normal;
    creep.duration = 1e18;
    creep.points_per_decade = 1;
    LaboratoryStage isotropic = make_isotropic(pressure);
    isotropic.n_increments = 8;
    const std::vector<LaboratoryStage> stages = {isotropic, search, share, creep};
    const ProgrammeRun first = run(rev, stages);
    ASSERT_EQ(first.outcome, LaboratoryOutcome::ruptured) << describe(first.outcome);
    ASSERT_EQ(first.position.stage, 3u);
    EXPECT_NE(first.position.criterion, RuptureCriterion::none);
    const Observation &last = first.observations.back();
    EXPECT_EQ(last.kind, ObservationKind::rupture);
    EXPECT_EQ(last.time, first.position.rupture_time);
    EXPECT_GT(first.position.rupture_time, 0.);
    EXPECT_LT(first.position.rupture_time, 1e18);
    EXPECT_TRUE(are_equal_bits(rev.get_baseline(), rev.get_committed()));
    EXPECT_LT(rev.get_committed().unbalanced_ratio, 1e-4);

    const ProgrammeRun again = run(rev, stages, first.position);
    EXPECT_EQ(again.outcome, LaboratoryOutcome::ruptured);
    EXPECT_EQ(again.position.rupture_time, first.position.rupture_time);
    EXPECT_EQ(again.position.criterion, first.position.criterion);
    EXPECT_EQ(again.observations.back().strain, last.strain);
  }

  TEST(FailingStages, AStressAboveTheStrengthIsNotReached)
  {
    // Law: asked for a q far above what it bears, a REV that breaks no grain flows, and the stage says so.
    RevModel model;
    model.fracture.is_active = false;
    Rev rev = make_rev(model, get_wide_packing());
    LaboratoryStage stage = make_stage(StageKind::triaxial);
    stage.deviatoric_stress = 20. * pressure;
    const ProgrammeRun result = run(rev, {make_isotropic(pressure), stage});
    EXPECT_EQ(result.outcome, LaboratoryOutcome::not_reached) << describe(result.outcome);
    EXPECT_TRUE(are_equal_bits(rev.get_baseline(), rev.get_committed()));
    EXPECT_LT(rev.get_committed().unbalanced_ratio, 1e-4);
  }

  TEST(FailingStages, ACellTooNarrowForItsGrainsIsACollapse)
  {
    // Law: strained until two largest diameters no longer fit, the sample has collapsed.
    RevModel model;
    model.fracture.is_active = false;
    Rev rev = make_rev(model, get_packing().state);
    LaboratoryStage stage = make_stage(StageKind::strain_path);
    stage.strain(2, 2) = 1.; // to 37 % of its height: from four diameters to less than two
    stage.strain(0, 0) = stage.strain(1, 1) = -0.45;
    const ProgrammeRun result = run(rev, {stage});
    EXPECT_EQ(result.outcome, LaboratoryOutcome::collapsed) << describe(result.outcome);
  }

  TEST(FailingStages, AServoThatIsTooQuickIsNamed)
  {
    // Law: with a gain fifty times the default the stress swings about its target and the cycles run out: the servo is
    // unstable, not the sand.
    RevModel model;
    model.fracture.is_active = false;
    model.equilibrium.servo_gain = 3.;
    model.equilibrium.strain_per_cycle = 1e-3; // so that the bound on strain does not tame it
    model.equilibrium.cycle_cap = 3000;
    Rev rev = make_rev(model, get_packing().state);
    const ProgrammeRun result = run(rev, {make_isotropic(pressure)});
    EXPECT_EQ(result.outcome, LaboratoryOutcome::servo_unstable) << describe(result.outcome);
  }

  TEST(FailingStages, EndsAreJudgedByWhatTheyAre)
  {
    // Law: section 6.3's table, one row each.
    const LaboratoryRule rule;
    LaboratoryStage creep = make_stage(StageKind::creep), path = make_stage(StageKind::strain_path);
    AttemptEnd end;
    end.largest_target = 10e6;
    const auto judge = [&](const LaboratoryStage &stage) { return judge_attempt(stage, rule, end); };
    EXPECT_EQ(judge(creep), LaboratoryOutcome::finished);
    end.strain = end.strain_of_stage = 0.051; // above the flow strain of 0.05
    EXPECT_EQ(judge(creep), LaboratoryOutcome::ruptured);
    EXPECT_EQ(judge(make_isotropic(pressure)), LaboratoryOutcome::finished); // a load may strain as it comes to rest
    EXPECT_EQ(judge(path), LaboratoryOutcome::finished);
    end.rest.status = RestStatus::cap_reached;
    EXPECT_EQ(judge(creep), LaboratoryOutcome::ruptured);
    EXPECT_EQ(judge(make_isotropic(pressure)), LaboratoryOutcome::not_reached);
    EXPECT_EQ(judge(path), LaboratoryOutcome::no_equilibrium);
    end.rest.largest_deviation[2] = 1.1e6; // to one side
    EXPECT_EQ(judge(creep), LaboratoryOutcome::ruptured);
    end.rest.smallest_deviation[2] = -1.1e6; // and the other
    EXPECT_EQ(judge(creep), LaboratoryOutcome::servo_unstable);
    end.rest = RestReport{};
    end.rest.status = RestStatus::cell_too_narrow;
    EXPECT_EQ(judge(path), LaboratoryOutcome::collapsed);
    end.strain = 1e-3;
    EXPECT_EQ(judge(creep), LaboratoryOutcome::collapsed);
    end.rest.status = RestStatus::not_finite;
    EXPECT_EQ(judge(creep), LaboratoryOutcome::no_equilibrium);
    end.rest.status = RestStatus::at_rest;
    end.strain_of_stage = 0.51; // above the largest strain of 0.5
    EXPECT_EQ(judge(make_isotropic(pressure)), LaboratoryOutcome::not_reached);
    EXPECT_EQ(judge(creep), LaboratoryOutcome::finished); // in an oedometer creep may go far, bit by bit
    creep.held = HeldStress::all_normal;
    EXPECT_EQ(judge(creep), LaboratoryOutcome::ruptured); // a triaxial specimen has failed at 0.15
    EXPECT_TRUE(has_crept_too_far(creep, rule, end));
    end.strain_of_stage = 0.149;
    EXPECT_EQ(judge(creep), LaboratoryOutcome::finished);
    end.strain = end.strain_of_stage = 0.2; // in one computation: a smaller batch may show more
    EXPECT_EQ(judge(creep), LaboratoryOutcome::ruptured);
    EXPECT_FALSE(has_crept_too_far(creep, rule, end));
  }

  TEST(FailingStages, ATriaxialCreepThatGoesFarBitByBitHasRuptured)
  {
    // Law: the creep ends with the first equilibrium beyond the rupture strain, which is told as it is, at rest; what
    // is kept lies below it.
    LaboratoryStage share = make_stage(StageKind::triaxial), creep = make_stage(StageKind::creep);
    share.deviatoric_stress = 3e6;
    creep.held = HeldStress::all_normal;
    creep.duration = 1e18;
    creep.points_per_decade = 1;
    Rev rev = make_rev(RevModel{}, get_wide_packing());
    ProgrammeRun result;
    LaboratoryRule rule;
    rule.rupture_strain = 5e-4;
    go_on(rev, {make_isotropic(pressure), share, creep}, result, 0, rule);
    ASSERT_EQ(result.outcome, LaboratoryOutcome::ruptured) << describe(result.outcome);
    EXPECT_EQ(result.position.criterion, RuptureCriterion::large_creep);
    const Observation &last = result.observations.back();
    EXPECT_EQ(last.kind, ObservationKind::rupture);
    EXPECT_LT(last.unbalanced_ratio, 1e-4);
    const auto crept = [&](const Matrix &strain) {
      return (strain - result.position.strain_at_start).cwiseAbs().maxCoeff();
    };
    EXPECT_GT(crept(last.strain), rule.rupture_strain);
    EXPECT_LE(crept(compute_logarithmic_strain(rev.get_committed().cell.deformation)), rule.rupture_strain);
  }
} // namespace

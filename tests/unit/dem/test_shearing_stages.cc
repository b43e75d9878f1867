// Stages that shear a REV: to a strain, to a deviatoric stress, at constant mean stress, to failure and beyond.

#include "dem/attempt_judgement.h"
#include "dem/laboratory.h"
#include "dem/stage_path.h"

#include "tests/support/rev_cases.h"
#include "tests/support/stage_cases.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace
{
  using namespace dem;
  using namespace dem::cases;

  constexpr double pressure = 2e6;         // [Pa]
  constexpr double servo_tolerance = 2e-3; // EquilibriumRule's default

  LaboratoryStage make_search()
  {
    LaboratoryStage stage = make_stage(StageKind::strength_search);
    stage.axial_strain = 0.3;
    stage.n_increments = 60;
    return stage;
  }

  LaboratoryStage make_share(const double share, const double strength = 0.)
  {
    LaboratoryStage stage = make_stage(StageKind::triaxial);
    stage.strength_share = share;
    stage.strength = strength;
    return stage;
  }

  Rev make_small_rev(const RevModel &model = RevModel{})
  {
    return make_rev(model, get_packing().state);
  }

  double get_mean(const Matrix &stress)
  {
    return -stress.trace() / 3.;
  }

  /** The REV at 2 MPa and its q_max by a search, found once per program. */
  const ProgrammeRun &get_search()
  {
    static const ProgrammeRun search = [] {
      ProgrammeRun run;
      Rev rev = make_small_rev();
      go_on(rev, {make_isotropic(pressure), make_search()}, run);
      return run;
    }();
    return search;
  }

  TEST(ShearingStages, OedometricLoadReachesItsStrain)
  {
    // Law: axial logarithmic strain to its value within rounding, no lateral strain at all.
    Rev rev = make_small_rev();
    LaboratoryStage stage = make_stage(StageKind::oedometric);
    stage.axial_strain = 0.01;
    ProgrammeRun run;
    go_on(rev, {stage}, run);
    ASSERT_EQ(run.outcome, LaboratoryOutcome::finished);
    const Matrix strain = compute_logarithmic_strain(rev.get_committed().cell.deformation);
    EXPECT_NEAR(strain(2, 2), -0.01, 1e-13);
    EXPECT_EQ(strain(0, 0), 0.);
    EXPECT_EQ(strain(0, 2), 0.);
  }

  TEST(ShearingStages, TriaxialCompressionReachesItsDeviatoricStress)
  {
    // Law: q goes to its value in equal steps while the lateral stresses stay, all within the servo's 0.2 % of the
    // largest target (q of two such stresses: twice that).
    Rev rev = make_small_rev();
    LaboratoryStage stage = make_stage(StageKind::triaxial);
    stage.deviatoric_stress = 1.5e6;
    ProgrammeRun run;
    go_on(rev, {make_isotropic(pressure), stage}, run);
    ASSERT_EQ(run.outcome, LaboratoryOutcome::finished);
    const double tolerance = servo_tolerance * (pressure + 1.5e6);
    std::size_t n = 0;
    for (const Observation &observation : run.observations)
      if (observation.stage == 1)
        {
          EXPECT_NEAR(observation.stress(0, 0), -pressure, tolerance);
          EXPECT_NEAR(observation.stress(1, 1), -pressure, tolerance);
          EXPECT_NEAR(compute_deviator(observation.stress), 1.5e6 * double(++n) / 6., 2. * tolerance);
        }
    EXPECT_EQ(n, 6u);
  }

  TEST(ShearingStages, ConstantPIsHeldOnTheWayToAStrain)
  {
    // Law: at each equilibrium p is what it was within the servo's 0.2 %, the lateral stresses equal one another within
    // twice that, the axial strain ends at its value within rounding; q grows, so that lateral stress falls.
    Rev rev = make_small_rev();
    LaboratoryStage stage = make_stage(StageKind::constant_p);
    stage.axial_strain = 0.02;
    ProgrammeRun run;
    go_on(rev, {make_isotropic(pressure), stage}, run);
    ASSERT_EQ(run.outcome, LaboratoryOutcome::finished);
    const double start = -compute_logarithmic_strain(rev.get_committed().cell.deformation)(2, 2);
    EXPECT_NEAR(start, 0.02, 1e-13);
    for (const Observation &observation : run.observations)
      if (observation.stage == 1)
        {
          EXPECT_NEAR(get_mean(observation.stress) / pressure, 1., servo_tolerance);
          EXPECT_NEAR(observation.stress(0, 0) / observation.stress(1, 1), 1., 2. * servo_tolerance);
        }
    EXPECT_GT(compute_deviator(rev.get_committed().stress), 0.3 * pressure);
    EXPECT_GT(rev.get_committed().stress(0, 0), -0.9 * pressure);
  }

  TEST(ShearingStages, ConstantPIsHeldOnTheWayToADeviatoricStress)
  {
    // Law: p and q both reach their values within the servo's 0.2 % of the largest target, which is p + 2 q / 3.
    Rev rev = make_small_rev();
    LaboratoryStage stage = make_stage(StageKind::constant_p);
    stage.deviatoric_stress = 1e6;
    ProgrammeRun run;
    go_on(rev, {make_isotropic(pressure), stage}, run);
    ASSERT_EQ(run.outcome, LaboratoryOutcome::finished);
    const double tolerance = servo_tolerance * (pressure + 2. / 3. * 1e6);
    for (const Observation &observation : run.observations)
      if (observation.stage == 1)
        {
          EXPECT_NEAR(get_mean(observation.stress), pressure, tolerance);
        }
    EXPECT_NEAR(compute_deviator(rev.get_committed().stress), 1e6, 2. * tolerance);
  }

  TEST(ShearingStages, ASearchFindsTheLargestDeviatoricStressAndEndsBelowIt)
  {
    // Law: q_max is the largest q of a committed equilibrium, its strain that equilibrium's; the search ends at the
    // first one that lies 25 % lower, or at its largest strain.
    const ProgrammeRun &run = get_search();
    ASSERT_EQ(run.outcome, LaboratoryOutcome::finished);
    const Observation &last = run.observations.back();
    ASSERT_EQ(last.stage, 1u);
    double largest = 0., strain = 0.;
    for (const Observation &observation : run.observations)
      if (observation.stage == 1 && compute_deviator(observation.stress) > largest)
        {
          largest = compute_deviator(observation.stress);
          strain = observation.strain(2, 2);
        }
    EXPECT_GE(largest, run.position.strength); // equilibria inside an avalanche are observed too
    EXPECT_GT(run.position.strength, pressure);
    EXPECT_LE(strain, -1e-3);
    const bool is_at_limit = std::abs(last.strain(2, 2) + 0.3) < 1e-12;
    EXPECT_TRUE(is_at_limit || compute_deviator(last.stress) <= 0.75 * run.position.strength);
  }

  TEST(ShearingStages, ASearchPutsTheRevBackToItsBits)
  {
    // Law: after the search the REV has the bits it had before, and a stage to a share of the q_max found does what one
    // to a share of that number does without any search.
    Rev searched = make_small_rev(), plain = make_small_rev();
    ProgrammeRun first, second;
    go_on(searched, {make_isotropic(pressure), make_search()}, first);
    go_on(plain, {make_isotropic(pressure)}, second);
    EXPECT_FALSE(first.position.before_search.has_value());
    EXPECT_TRUE(are_equal_bits(searched.get_committed(), plain.get_committed()));

    const double strength = first.position.strength;
    go_on(searched, {make_isotropic(pressure), make_search(), make_share(0.5)}, first);
    go_on(plain, {make_isotropic(pressure), make_share(0.5, strength)}, second);
    ASSERT_EQ(first.outcome, LaboratoryOutcome::finished);
    EXPECT_TRUE(are_equal_bits(searched.get_committed(), plain.get_committed()));
    // Two stresses, each within the servo's tolerance of the largest target.
    const double tolerance = 2. * servo_tolerance * (pressure + 0.5 * strength);
    EXPECT_NEAR(compute_deviator(plain.get_committed().stress), 0.5 * strength, tolerance);
  }

  TEST(ShearingStages, ASearchMayLeaveTheRevWhereItEnds)
  {
    // Law: without going back the next stage begins at the end of the search.
    Rev rev = make_small_rev();
    LaboratoryStage search = make_search();
    search.goes_back = false;
    search.axial_strain = 0.02;
    search.n_increments = 4;
    ProgrammeRun run;
    go_on(rev, {make_isotropic(pressure), search}, run);
    ASSERT_EQ(run.outcome, LaboratoryOutcome::finished);
    EXPECT_NEAR(compute_logarithmic_strain(rev.get_committed().cell.deformation)(2, 2), -0.02, 1e-13);
  }

  TEST(ShearingStages, ResumedAfterAnyStepTheyRepeatEveryBit)
  {
    // Law: position and committed state are all that the future depends on, in the middle of a search, of its return
    // and of each shearing stage.
    LaboratoryStage search = make_search(), strained = make_stage(StageKind::constant_p), to_q = strained;
    search.axial_strain = 0.03;
    search.n_increments = 6;
    strained.axial_strain = 0.01;
    strained.n_increments = 3;
    to_q.deviatoric_stress = 1.2e6;
    to_q.n_increments = 2;
    LaboratoryStage oedometric = make_stage(StageKind::oedometric);
    oedometric.axial_strain = 0.03;
    oedometric.n_increments = 2;
    LaboratoryStage share = make_share(0.4);
    share.n_increments = 2;
    const std::vector<LaboratoryStage> stages = {make_isotropic(pressure), search, share, strained, to_q, oedometric};
    Rev whole_rev = make_small_rev();
    ProgrammeRun whole;
    go_on(whole_rev, stages, whole);
    ASSERT_EQ(whole.outcome, LaboratoryOutcome::finished);
    for (std::size_t n = 2; n < 21; n += 2)
      {
        ProgrammeRun part;
        Rev first = make_small_rev();
        go_on(first, stages, part, n);
        ASSERT_EQ(part.outcome, LaboratoryOutcome::stopped) << n;
        Rev second(RevModel{}, deserialise(serialise(first.get_committed())));
        go_on(second, stages, part);
        EXPECT_TRUE(are_equal_bits(second.get_committed(), whole_rev.get_committed())) << "stopped after step " << n;
        EXPECT_EQ(part.observations.size(), whole.observations.size());
        EXPECT_EQ(part.position.strength, whole.position.strength);
      }
  }
} // namespace

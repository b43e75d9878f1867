// The isotropic stage that is driven by volume.

#include "dem/stage_path.h"

#include "tests/support/rev_cases.h"
#include "tests/support/stage_cases.h"

#include <gtest/gtest.h>

#include <cmath>

namespace
{
  using namespace dem;
  using namespace dem::cases;

  constexpr double servo_tolerance = 2e-3; // EquilibriumRule's default
  constexpr double volumetric_strain = 0.012;

  LaboratoryStage make_volumetric(const double strain = volumetric_strain)
  {
    LaboratoryStage stage = make_stage(StageKind::isotropic);
    stage.volumetric_strain = strain;
    return stage;
  }

  double get_volume_change(const Observation &observation)
  {
    return -observation.strain.trace();
  }

  TEST(VolumetricStage, ReachesItsVolumeAtEqualStresses)
  {
    // Law: the volume goes to its value in equal steps of logarithmic strain, within rounding, while the three normal
    // stresses stay within the servo's 0.2 % of their mean; the shape is free: a packing of 80 grains is not isotropic.
    Rev rev = make_rev(RevModel{}, get_packing().state);
    ProgrammeRun run;
    go_on(rev, {make_volumetric()}, run);
    ASSERT_EQ(run.outcome, LaboratoryOutcome::finished);
    ASSERT_EQ(run.observations.size(), 6u);
    for (int i = 0; i < 6; ++i)
      {
        const Observation &observation = run.observations[i];
        EXPECT_NEAR(get_volume_change(observation), volumetric_strain * (i + 1) / 6., 1e-12);
        const double mean = observation.stress.trace() / 3.;
        for (int k = 0; k < 3; ++k)
          EXPECT_NEAR(observation.stress(k, k) / mean, 1., 1.01 * servo_tolerance); // the symmetric part's rounding
      }
    const Matrix strain = run.observations.back().strain;
    EXPECT_GT(std::abs(strain(0, 0) - strain(2, 2)), 1e-5); // far above rounding
    EXPECT_LT(run.observations.back().stress.trace() / 3., -1e6);
  }

  TEST(VolumetricStage, FollowsTheCurveOfTheStageDrivenByStress)
  {
    // Law: the same compression curve, whichever of its two coordinates is driven. Nothing breaks. Tolerance: stresses
    // are within 0.2 % of their targets, and as small steps in volume as in stress leave paths through sliding contacts
    // that differ by less than a hundredth.
    RevModel model;
    model.fracture.is_active = false;
    Rev by_volume = make_rev(model, get_packing().state), by_stress = make_rev(model, get_packing().state);
    LaboratoryStage stage = make_volumetric();
    stage.n_increments = 24;
    ProgrammeRun first, second;
    go_on(by_volume, {stage}, first);
    ASSERT_EQ(first.outcome, LaboratoryOutcome::finished);
    LaboratoryStage other = make_isotropic(-first.observations.back().stress.trace() / 3.);
    other.n_increments = 24;
    go_on(by_stress, {other}, second);
    ASSERT_EQ(second.outcome, LaboratoryOutcome::finished);
    EXPECT_NEAR(get_volume_change(second.observations.back()) / volumetric_strain, 1., 0.01);
  }

  TEST(VolumetricStage, UnloadsAndHandsOnItsMeanStress)
  {
    // Law: back to a larger volume the pressure falls; a creep that follows holds the mean stress in all three
    // directions, each within the servo's 0.2 %.
    Rev rev = make_rev(RevModel{}, get_packing().state);
    LaboratoryStage creep = make_stage(StageKind::creep);
    creep.held = HeldStress::all_normal;
    creep.duration = 10.;
    ProgrammeRun run;
    go_on(rev, {make_volumetric(), make_volumetric(0.75 * volumetric_strain), creep}, run);
    ASSERT_EQ(run.outcome, LaboratoryOutcome::finished);
    const double loaded = run.observations[5].stress.trace() / 3., unloaded = run.observations[11].stress.trace() / 3.;
    EXPECT_LT(loaded, 1.2 * unloaded); // both negative
    for (int k = 0; k < 3; ++k)
      EXPECT_NEAR(rev.get_committed().stress(k, k) / unloaded, 1., 1.01 * servo_tolerance);
  }

  TEST(VolumetricStage, MovesWallsAsWell)
  {
    // Law: the same between rigid walls, where the stresses that are equal are those on the walls.
    Rev rev = make_rev(RevModel{}, get_walled_packing().state);
    ProgrammeRun run;
    go_on(rev, {make_volumetric(0.008)}, run);
    ASSERT_EQ(run.outcome, LaboratoryOutcome::finished);
    const Observation &last = run.observations.back();
    EXPECT_NEAR(get_volume_change(last), 0.008, 1e-12);
    for (int k = 0; k < 3; ++k)
      EXPECT_NEAR(last.wall_stress[k] / last.wall_stress.mean(), 1., 1.01 * servo_tolerance);
  }

  TEST(VolumetricStage, GrainsBreakAtHeldVolume)
  {
    // Law: an avalanche within an increment changes no volume, and the equilibria after it keep stresses equal.
    RevModel model;
    model.fracture.strength.reference_strength = 1.2e9;
    Rev rev = make_rev(model, get_packing().state);
    ProgrammeRun run;
    LaboratoryRule rule;
    rule.smallest_share = 1.; // increments stay whole, so that avalanches are long
    go_on(rev, {make_volumetric(0.02)}, run, 0, rule);
    ASSERT_EQ(run.outcome, LaboratoryOutcome::finished);
    EXPECT_GT(run.observations.back().counters.broken_instant, 3u);
    ASSERT_GT(run.observations.size(), 6u);
    for (const Observation &observation : run.observations)
      {
        const double steps = get_volume_change(observation) / 0.02 * 6.;
        EXPECT_NEAR(steps, std::round(steps), 1e-9);
      }
  }
} // namespace

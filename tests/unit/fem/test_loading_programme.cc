#include "fem/rigid_motions.h"
#include "tests/support/fem_cases.h"

#include <gtest/gtest.h>

using namespace fem;
using namespace fem::cases;

namespace
{
} // namespace

namespace
{
  /** Takes a programme to its end in steps that end its increments. @return the time after each [s] */
  std::vector<double> run_through(const std::vector<Stage> &stages, Progress &progress)
  {
    std::vector<double> times;
    while (progress.stage < stages.size())
      {
        const Stage &stage = stages[progress.stage];
        update_progress(stage, {}, {0., compute_next_milestone(stage, progress.increment_start), true}, progress);
        times.push_back(progress.time);
      }
    return times;
  }
} // namespace

TEST(LoadingProgramme, CreepMilestonesAreThoseOfAllSeriesInOrder)
{
  // Law: outputs at first 10^(k/n), scheduled steps likewise, the end last; each is followed by the next larger one.
  Stage stage = get_creep_stage(50., 1.);
  stage.steps_per_decade = 2.;
  std::vector<double> milestones;
  for (double position = 0.; position < stage.duration; milestones.push_back(position))
    position = compute_next_milestone(stage, position);
  ASSERT_EQ(milestones.size(), 5u);
  const double expected[] = {1., std::sqrt(10.), 10., std::sqrt(1000.), 50.};
  for (unsigned int i = 0; i < 5; ++i)
    EXPECT_DOUBLE_EQ(milestones[i], expected[i]);
  EXPECT_TRUE(is_output_position(stage, milestones[0]));
  EXPECT_FALSE(is_output_position(stage, milestones[1]));
  EXPECT_TRUE(is_output_position(stage, milestones[2]));
  EXPECT_TRUE(is_output_position(stage, milestones[4]));
}

TEST(LoadingProgramme, ManyDecadesGiveNeitherRepeatedNorMissingOutputs)
{
  // Law: n outputs a decade are n outputs a decade, also where 10^(k/n) is not a number of the machine.
  const Stage stage = get_creep_stage(1e9, 7.);
  unsigned int n_milestones = 0;
  for (double position = 0.; position < stage.duration; ++n_milestones)
    {
      position = compute_next_milestone(stage, position);
      EXPECT_TRUE(is_output_position(stage, position));
    }
  EXPECT_EQ(n_milestones, 9u * 7u + 1u);
}

TEST(LoadingProgramme, GeometricSpacingHasEqualRatios)
{
  // Law: value(share) = start (end/start)^share.
  Stage stage = get_load_stage(8e6, 3);
  stage.spacing = Spacing::geometric;
  EXPECT_DOUBLE_EQ(interpolate(stage, 1e6, 8e6, 1. / 3.), 2e6);
  EXPECT_EQ(interpolate(stage, 1e6, 8e6, 1.), 8e6);
  EXPECT_EQ(interpolate(stage, 0., 0., 0.5), 0.); // a held zero stays zero
}

TEST(LoadingProgramme, AProlongedCreepGoesOnAsIfItHadBeenMeantToBeLong)
{
  // Law: creep to 1e3 s and then prolonged has the steps of creep to 1e5 s in one go, wherever it stands in a
  // programme.
  Stage warming = get_load_stage(1e6, 3);
  warming.duration = 0.1; // no binary fraction: the sums of times round
  const std::vector<Stage> whole = {get_load_stage(1e6, 2), warming, get_creep_stage(1e5, 3.), get_creep_stage(7., 1.)};
  std::vector<Stage> first(whole.begin(), whole.begin() + 3);
  first[2].duration = 1e3;
  Progress progress, undisturbed;
  std::vector<double> times = run_through(first, progress);
  EXPECT_EQ(prolong_creep(first, progress).stage, 3u); // no more time: it stays where it is
  progress = prolong_creep(whole, progress);
  EXPECT_EQ(progress.stage, 2u);
  const std::vector<double> later = run_through(whole, progress);
  times.insert(times.end(), later.begin(), later.end());
  EXPECT_EQ(times, run_through(whole, undisturbed));
}

TEST(LoadingProgramme, WhatHasEndedOtherwiseIsNotProlonged)
{
  // Law: a load that is over keeps its rate, and a creep that another stage has followed keeps its end.
  Stage slow = get_load_stage(1e6, 2);
  slow.duration = 10.;
  std::vector<Stage> stages = {slow, get_creep_stage(100., 1.)};
  Progress after_load = {.time = 10., .stage = 1, .stage_start = 10., .step = 2};
  Progress in_creep = {.time = 20., .stage = 1, .stage_start = 10., .position = 10., .step = 3};
  stages[0].duration = 20.;
  EXPECT_EQ(get_error([&] { prolong_creep(stages, after_load); }),
            "stage 'load' has ended at 10 s: only a creep that has just ended can be given more time; add a stage "
            "instead");
  EXPECT_EQ(prolong_creep(stages, in_creep).position, 10.);
}

TEST(LoadingProgramme, BadStagesAreNamed)
{
  // Law: an impossible stage is refused with its name, the parameter, the value and the range.
  const auto conditions = get_oedometer_conditions();
  Stage geometric = get_load_stage(1e6);
  geometric.spacing = Spacing::geometric; // from zero
  EXPECT_NE(get_error([&] { resolve_targets(conditions, {geometric}); }).find("geometric"), std::string::npos);
  Stage creep = get_creep_stage(0., 1.);
  EXPECT_EQ(get_error([&] { resolve_targets(conditions, {creep}); }),
            "stage 'creep': duration = 0 must be > 0 s in a creep stage");
  Stage unknown = get_load_stage(1e6);
  unknown.targets[0].boundary = "lid";
  EXPECT_EQ(
      get_error([&] { resolve_targets(conditions, {unknown}); }),
      "stage 'load': no condition 'lid pressure' for this target; known: axis displacement x, outer displacement x, "
      "bottom displacement z, top pressure");
}

TEST(BoundaryConditions, WrongNamesAreToldWithTheKnownOnes)
{
  // Law: an unknown boundary or component is refused with what there is.
  ScriptedMaterial material;
  const auto build = [&](const BoundaryCondition &condition) {
    return get_error(
        [&] { QuasiStaticProblem<2>(create_oedometer_mesh(1, 1, MPI_COMM_SELF), {condition}, {}, material); });
  };
  EXPECT_EQ(build({"lid", ConditionKind::pressure, ""}),
            "boundary condition: no boundary 'lid'; known: axis, bottom, outer, top");
  EXPECT_EQ(build({"top", ConditionKind::displacement, "y"}),
            "boundary condition on 'top': no component 'y'; known: x, z");
}

TEST(BoundaryConditions, RigidMotionsMustBePrescribedAway)
{
  // Law: a body has 1 rigid motion in axisymmetry, 3 in a plane, 6 in space; each must meet a prescribed component.
  using dealii::Point;
  const auto count = [](Geometry geometry, const std::vector<PrescribedComponent> &components) {
    return count_free_rigid_motions(geometry, components, MPI_COMM_SELF);
  };
  EXPECT_EQ(count(Geometry::axisymmetric, {{Point<3>(1., 0., 0.), 0}}), 1u);
  EXPECT_EQ(count(Geometry::axisymmetric, {{Point<3>(1., 0., 0.), 2}}), 0u);
  EXPECT_EQ(count(Geometry::plane_strain, {}), 3u);
  EXPECT_EQ(count(Geometry::plane_strain, {{Point<3>(0., 0., 0.), 0}, {Point<3>(1., 0., 0.), 2}}), 1u);
  EXPECT_EQ(
      count(Geometry::plane_strain, {{Point<3>(0., 0., 0.), 0}, {Point<3>(1., 0., 0.), 2}, {Point<3>(2., 0., 0.), 2}}),
      0u);
  // A clamped point in space leaves three rotations.
  EXPECT_EQ(count(Geometry::three_dimensional,
                  {{Point<3>(1., 2., 3.), 0}, {Point<3>(1., 2., 3.), 1}, {Point<3>(1., 2., 3.), 2}}),
            3u);
  ScriptedMaterial material;
  EXPECT_EQ(get_error([&] {
              QuasiStaticProblem<2>(create_oedometer_mesh(1, 1, MPI_COMM_SELF), {{"top", ConditionKind::pressure, ""}},
                                    get_exact_parameters(Geometry::plane_strain, Kinematics::small), material);
            }),
            "boundary conditions: 3 rigid motions of the body left free: prescribe more displacement components");
}

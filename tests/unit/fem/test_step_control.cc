// Law: controlled creep steps bring about what they may, between a smallest share of the schedule's steps and the
// schedule.

#include "tests/support/fem_cases.h"

#include <gtest/gtest.h>

#include <cmath>

using namespace fem;
using namespace fem::cases;

namespace
{
  StepControl make_control()
  {
    StepControl control;
    control.is_active = true;
    control.target = {1., 1e-3, 0.1};
    control.smallest_share = 1. / 8.;
    return control;
  }

  /** Breaks grains at a constant rate while time passes: one point alone knows events. */
  class CrumblingMaterial : public ScriptedMaterial
  {
  public:
    static constexpr double events_a_second = 1.;

    Status begin_step(double dt) override
    {
      n_events_ = static_cast<std::uint64_t>(std::llround(events_a_second * dt));
      return ScriptedMaterial::begin_step(dt);
    }

    EventCount count_events() const override { return {n_events_, 1}; }

  private:
    std::uint64_t n_events_ = 0;
  };

  /** The oedometer of one cell with it. */
  struct CrumblingOedometer
  {
    CrumblingMaterial material;
    QuasiStaticProblem<2> problem{create_oedometer_mesh(1, 1, MPI_COMM_SELF), get_oedometer_conditions(),
                                  get_exact_parameters(Geometry::axisymmetric, Kinematics::small), material};
  };
} // namespace

TEST(StepControl, TheLargestEffectOverItsTargetCounts)
{
  const StepControl control = make_control();
  EXPECT_DOUBLE_EQ(rate({0.5, 2e-4, 0.03}, control), 0.5);
  EXPECT_DOUBLE_EQ(rate({0.1, 5e-4, 0.03}, control), 0.5);
  EXPECT_DOUBLE_EQ(rate({0.1, 2e-4, 0.05}, control), 0.5);
}

TEST(StepControl, ShareGoesToTheTargetWithinItsLimits)
{
  const StepControl control = make_control();
  EXPECT_DOUBLE_EQ(compute_next_share({1., 0., 0.}, 0.5, control), 0.5);        // just what it may
  EXPECT_DOUBLE_EQ(compute_next_share({0.8, 0., 0.}, 0.5, control), 0.5 / 0.8); // a little more
  EXPECT_DOUBLE_EQ(compute_next_share({0., 0., 0.}, 0.25, control), 0.5);       // at most twice as long
  EXPECT_DOUBLE_EQ(compute_next_share({0., 0., 0.}, 0.75, control), 1.);        // never beyond the schedule
  EXPECT_DOUBLE_EQ(compute_next_share({0., 4e-3, 0.}, 1., control), 0.25);
  EXPECT_DOUBLE_EQ(compute_next_share({0., 0., 9.}, 1., control), 1. / 8.); // never below the smallest share
}

TEST(StepControl, AnOvershootIsRepeatedUnlessItIsAlreadyShort)
{
  const StepControl control = make_control();
  EXPECT_FALSE(is_overshoot({2., 0., 0.}, 1., control));
  EXPECT_TRUE(is_overshoot({2.01, 0., 0.}, 1., control));
  EXPECT_TRUE(is_overshoot({2.01, 0., 0.}, 0.25, control));
  EXPECT_FALSE(is_overshoot({2.01, 0., 0.}, 0.24, control)); // half of it lies below the smallest share
  EXPECT_FALSE(is_overshoot({2.01, 0., 0.}, 1., StepControl{}));
}

TEST(StepControl, ImpossibleValuesAreNamed)
{
  StepControl control = make_control();
  control.smallest_share = 1e-3;
  EXPECT_NE(get_error([&]() { check_control(control, 1. / 64.); }).find("smallest share = 0.001"), std::string::npos);
  control = make_control();
  control.target.strain = 0.;
  EXPECT_NE(get_error([&]() { check_control(control, 1. / 64.); }).find("strain = 0"), std::string::npos);
  control.is_active = false;
  EXPECT_EQ(get_error([&]() { check_control(control, 1. / 64.); }), "");
}

TEST(StepControl, StepsBreakAsManyGrainsAsTheyMay)
{
  // At one event a second and one step of 100 s, a target of 10 ends in steps of 10 s: the first step is halved until
  // it breaks at most 20, and is followed by steps at the target; the last is the rest.
  CrumblingOedometer oedometer;
  SteppingParameters parameters;
  parameters.control = make_control();
  parameters.control.target.fractures = 10.;
  parameters.control.smallest_share = 1. / 64.;
  Stage creep = get_creep_stage(100., 0.);
  creep.first_output = 100.;
  std::vector<StepReport> commits;
  std::vector<CutReport> cuts;
  LoadStepping<2> stepping(oedometer.problem, {creep}, parameters,
                           {[&](const StepReport &report) { commits.push_back(report); },
                            [&](const CutReport &report) { cuts.push_back(report); }});
  EXPECT_EQ(stepping.run().status, StepStatus::ok);
  ASSERT_EQ(cuts.size(), 3u); // 100, 50, 25 s break 100, 50, 25
  for (const CutReport &cut : cuts)
    EXPECT_EQ(cut.status, StepStatus::overshoot);
  ASSERT_GT(commits.size(), 3u);
  EXPECT_DOUBLE_EQ(commits[0].length, 12.5);
  EXPECT_EQ(commits[0].bound, StepBound::share);
  EXPECT_EQ(commits[0].effects.fractures, 13.);
  for (std::size_t i = 1; i < commits.size(); ++i)
    EXPECT_LE(commits[i].effects.fractures, 20.);
  EXPECT_NEAR(commits[1].length, 12.5 * 10. / 13., 1e-9);
  EXPECT_EQ(commits.back().time, 100.);
  EXPECT_EQ(commits.back().bound, StepBound::milestone);
}

TEST(StepControl, WithoutItTheScheduleStands)
{
  CrumblingOedometer oedometer;
  std::vector<StepReport> commits;
  Stage creep = get_creep_stage(100., 0.);
  creep.first_output = 100.;
  LoadStepping<2> stepping(oedometer.problem, {creep}, {},
                           {[&](const StepReport &report) { commits.push_back(report); }, {}});
  EXPECT_EQ(stepping.run().status, StepStatus::ok);
  ASSERT_EQ(commits.size(), 1u);
  EXPECT_EQ(commits[0].effects.fractures, 100.); // told all the same
}

TEST(StepControl, EffectsAreStrainAndStressChangeOfTheStep)
{
  // An elastic oedometer of modulus M under p strains by p/M (small strains); its stress is new altogether: the mean of
  // before is zero, and no share of that is told. A second load of a tenth changes it by a tenth.
  Oedometer oedometer;
  std::vector<StepReport> commits;
  LoadStepping<2> stepping(oedometer.problem, {get_load_stage(1e6), get_load_stage(1.1e6)}, {},
                           {[&](const StepReport &report) { commits.push_back(report); }, {}});
  EXPECT_EQ(stepping.run().status, StepStatus::ok);
  ASSERT_EQ(commits.size(), 2u);
  EXPECT_NEAR(commits[0].effects.strain, 1e6 / oedometer_modulus, 1e-9); // Newton's tolerance of 1e-10
  EXPECT_EQ(commits[0].effects.stress_change, 0.);
  EXPECT_NEAR(commits[1].effects.strain, 0.1e6 / oedometer_modulus, 1e-9);
  EXPECT_NEAR(commits[1].effects.stress_change, 0.1, 1e-9);
}

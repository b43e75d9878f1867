#include "tests/support/fem_cases.h"

#include <gtest/gtest.h>

using namespace fem;
using namespace fem::cases;

namespace
{
  struct Record
  {
    std::vector<StepReport> commits;
    std::vector<CutReport> cuts;

    StepObserver get_observer()
    {
      return {[this](const StepReport &report) { commits.push_back(report); },
              [this](const CutReport &report) { cuts.push_back(report); }};
    }
  };
} // namespace

TEST(LoadStepping, GoesThroughItsStages)
{
  // Law: n increments and the outputs of a creep stage are one committed step each, the last one at the target.
  Oedometer oedometer;
  Record record;
  LoadStepping<2> stepping(oedometer.problem, {get_load_stage(1e6, 4), get_creep_stage(100., 2.)}, {},
                           record.get_observer());
  EXPECT_EQ(stepping.run().status, StepStatus::ok);
  ASSERT_EQ(record.commits.size(), 4u + 5u); // 1, 10^0.5, 10, 10^1.5, 100 s
  EXPECT_DOUBLE_EQ(record.commits[0].boundaries.back().force[2], -0.25e6 * dealii::numbers::PI);
  EXPECT_DOUBLE_EQ(record.commits[3].boundaries.back().force[2], -1e6 * dealii::numbers::PI);
  EXPECT_EQ(record.commits[3].time, 0.);
  EXPECT_TRUE(record.commits[3].is_stage_end);
  EXPECT_DOUBLE_EQ(record.commits[5].time, std::sqrt(10.));
  EXPECT_EQ(record.commits[8].time, 100.);
  EXPECT_TRUE(record.commits[8].is_stage_end);
  EXPECT_EQ(oedometer.material.n_commits, 9u);
  EXPECT_EQ(record.commits[8].evaluations, 0u); // nothing creeps here: nothing is asked
}

TEST(LoadStepping, NeverJumpsPastAnEventOrAnOutput)
{
  // Law: a step ends at the next event or milestone, whichever comes first.
  Oedometer oedometer;
  oedometer.material.time_to_event = 4.;
  Record record;
  LoadStepping<2> stepping(oedometer.problem, {get_creep_stage(10., 1.)}, {}, record.get_observer());
  EXPECT_EQ(stepping.run().status, StepStatus::ok);
  ASSERT_EQ(record.commits.size(), 4u);
  const double times[] = {1., 5., 9., 10.};
  for (unsigned int i = 0; i < 4; ++i)
    EXPECT_DOUBLE_EQ(record.commits[i].time, times[i]);
  EXPECT_TRUE(record.commits[0].is_output);
  EXPECT_FALSE(record.commits[1].is_output);
  EXPECT_TRUE(record.commits[3].is_output);
}

TEST(LoadStepping, AnAvalancheIsASequenceOfEquilibria)
{
  // Law: while settling breaks grains the load stands and the next equilibrium is sought; all of it is one step.
  Oedometer oedometer;
  unsigned int n_settled = 0;
  oedometer.material.on_settle = [&](bool) { return Settlement{n_settled++ < 3 ? 5u : 0u, false, Status::ok}; };
  Record record;
  LoadStepping<2> stepping(oedometer.problem, {get_load_stage(1e6)}, {}, record.get_observer());
  EXPECT_EQ(stepping.run().status, StepStatus::ok);
  ASSERT_EQ(record.commits.size(), 1u);
  EXPECT_EQ(record.commits[0].n_broken, 15u);
  EXPECT_EQ(record.commits[0].avalanche_rounds, 3u);
  EXPECT_EQ(record.commits[0].evaluations, 1u);
}

TEST(LoadStepping, ExcessHalvesTheLoadFirst)
{
  // Law: more overstressed grains than a batch roll the step back and halve the load, down to the smallest share.
  Oedometer oedometer;
  oedometer.material.on_settle = [&](bool accept) {
    const bool is_large = oedometer.material.n_reverts < 2; // the third try is small enough
    return Settlement{0, is_large && !accept, Status::ok};
  };
  Record record;
  LoadStepping<2> stepping(oedometer.problem, {get_load_stage(1e6)}, {}, record.get_observer());
  EXPECT_EQ(stepping.run().status, StepStatus::ok);
  EXPECT_EQ(record.cuts.size(), 2u);
  EXPECT_EQ(record.cuts[0].status, StepStatus::excessive);
  EXPECT_DOUBLE_EQ(record.commits[0].boundaries.back().force[2], -0.25e6 * dealii::numbers::PI);
  // 1/4, 1/4, then grown back to 1/2.
  EXPECT_EQ(record.commits.size(), 3u);
  EXPECT_NEAR(oedometer.compute_strain(), 1e6 / oedometer_modulus, 1e-12);
}

TEST(LoadStepping, ExcessInCreepMakesTheBatchSmallerAndIsAcceptedAtTheSmallest)
{
  // Law: in creep it is the batch that shrinks; a batch that cannot shrink is split all the same.
  Oedometer oedometer;
  oedometer.material.time_to_event = 8.;
  oedometer.material.max_event_cuts = 2;
  bool is_quiet = false; // after the batch has been split
  unsigned int n_accepted = 0;
  oedometer.material.on_settle = [&](bool accept) {
    if (is_quiet)
      return Settlement();
    n_accepted += accept;
    is_quiet = accept;
    return Settlement{accept ? 7u : 0u, true, Status::ok};
  };
  Record record;
  LoadStepping<2> stepping(oedometer.problem, {get_creep_stage(100., 0.)}, {}, record.get_observer());
  EXPECT_EQ(stepping.advance(), StepStatus::ok);
  EXPECT_EQ(record.cuts.size(), 2u);
  EXPECT_EQ(n_accepted, 1u);
  EXPECT_EQ(record.commits[0].n_broken, 7u);
  EXPECT_DOUBLE_EQ(record.commits[0].time, 8. / 4.);
}

TEST(LoadStepping, ARevertRestoresTheCommittedStateToTheLastBit)
{
  // Law: what was rolled back leaves no trace.
  Oedometer oedometer, reference;
  unsigned int n = 0;
  oedometer.material.on_settle = [&](bool) { return Settlement{0, false, ++n == 2 ? Status::failed : Status::ok}; };
  LoadStepping<2> stepping(oedometer.problem, {get_load_stage(1e6, 2)}, {});
  LoadStepping<2> other(reference.problem, {get_load_stage(1e6, 2)}, {});
  EXPECT_EQ(stepping.advance(), StepStatus::ok);
  EXPECT_EQ(other.advance(), StepStatus::ok);
  oedometer.problem.equilibrate({0., 0., 0., 0.7e6}, true);
  oedometer.problem.revert();
  oedometer.material.revert();
  EXPECT_EQ(oedometer.problem.get_state().displacement, reference.problem.get_state().displacement);
  EXPECT_EQ(oedometer.problem.get_state().secants, reference.problem.get_state().secants);
  EXPECT_EQ(oedometer.compute_strain(), reference.compute_strain());
}

TEST(LoadStepping, GivesUpBelowTheSmallestStepWithTheLastCommittedStateIntact)
{
  // Law: a failure is a named end, not a crash, and history keeps what was committed.
  Oedometer oedometer;
  oedometer.material.on_settle = [&](bool) {
    return Settlement{0, false, oedometer.material.n_commits == 1 ? Status::failed : Status::ok};
  };
  Record record;
  LoadStepping<2> stepping(oedometer.problem, {get_load_stage(1e6, 2)}, {}, record.get_observer());
  const RunResult result = stepping.run();
  EXPECT_EQ(result.status, StepStatus::failed);
  EXPECT_NE(result.message.find("stage 'load'"), std::string::npos) << result.message;
  EXPECT_EQ(record.cuts.size(), 7u); // 1, 1/2, ... 1/64
  EXPECT_TRUE(record.cuts.back().is_final);
  EXPECT_NEAR(oedometer.compute_strain(), 0.5e6 / oedometer_modulus, 1e-14);
}

TEST(LoadStepping, AnAvalancheThatDoesNotEndIsARupture)
{
  // Law: rupture is an avalanche beyond the cap on rounds.
  Oedometer oedometer;
  oedometer.material.on_settle = [&](bool) { return Settlement{1, false, Status::ok}; };
  SteppingParameters parameters;
  parameters.max_avalanche_rounds = 6;
  LoadStepping<2> stepping(oedometer.problem, {get_load_stage(1e6)}, parameters);
  EXPECT_EQ(stepping.run().status, StepStatus::rupture);
  EXPECT_EQ(oedometer.material.n_commits, 0u);
  EXPECT_EQ(oedometer.compute_strain(), 0.);
}

TEST(LoadStepping, EventsWithoutTimeBetweenThemEndTheRun)
{
  // Law: a clock that stands still is noticed.
  Oedometer oedometer;
  oedometer.material.time_to_event = 0.;
  SteppingParameters parameters;
  parameters.max_idle_steps = 10;
  LoadStepping<2> stepping(oedometer.problem, {get_creep_stage(100., 1.)}, parameters);
  EXPECT_EQ(stepping.run().status, StepStatus::no_progress);
}

#include "dem/laboratory.h"

#include "tests/support/rev_cases.h"
#include "tests/support/stage_cases.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>

namespace
{
  using namespace dem;
  using namespace dem::cases;

  RevModel make_model(const CreepKind kind)
  {
    RevModel model;
    model.creep.kind = kind;
    model.creep.time_scale = 100.;
    model.creep.step_share = 0.02; // fewer equilibria
    model.creep.burgers = {{3e11, 5e6, 1e9}, {3e11, 5e6, 1e9}};
    if (model.creep.has_contact_creep())
      model.fracture.is_active = false; // what strains the REV are contacts alone
    return model;
  }

  LaboratoryStage make_load()
  {
    LaboratoryStage stage = make_stage(StageKind::oedometric);
    stage.stress = 15e6;
    return stage;
  }

  LaboratoryStage make_held(const StageKind kind, const double duration)
  {
    LaboratoryStage stage = make_stage(kind);
    stage.duration = duration;
    stage.points_per_decade = 1;
    return stage;
  }

  const std::vector<CreepKind> alternatives = {CreepKind::scaled_time, CreepKind::rate_process, CreepKind::burgers};

  /** The packing in an oedometer at the stress of creep, made once for each law. */
  const Rev &get_loaded(const CreepKind kind)
  {
    static std::map<CreepKind, Rev> loaded;
    const auto found = loaded.find(kind);
    if (found != loaded.end())
      return found->second;
    Rev rev = make_rev(make_model(kind), get_packing().state);
    ProgrammeRun run;
    go_on(rev, {make_load()}, run);
    EXPECT_EQ(run.outcome, LaboratoryOutcome::finished);
    return loaded.emplace(kind, rev).first->second;
  }

  /** Creep or relaxation after the load. */
  ProgrammeRun hold(Rev &rev, const StageKind kind, const double duration, const std::size_t n_steps = 0)
  {
    ProgrammeRun run;
    run.position.stage = 1;
    go_on(rev, {make_load(), make_held(kind, duration)}, run, n_steps);
    return run;
  }

  TEST(CreepStages, EveryLawCreepsToTheEndOfItsStageAtRest)
  {
    // Law: stresses are held within the servo's 0.2 %, the axial strain grows, time ends at the duration to the last
    // bit after the load's 0 s, and the REV is at rest.
    for (const CreepKind kind : alternatives)
      {
        Rev rev = get_loaded(kind);
        const double before = compute_logarithmic_strain(rev.get_committed().cell.deformation)(2, 2);
        const ProgrammeRun run = hold(rev, StageKind::creep, 3e5);
        ASSERT_EQ(run.outcome, LaboratoryOutcome::finished);
        const RevState &state = rev.get_committed();
        EXPECT_NEAR(state.time, 3e5, 1e-9); // a sum of jumps; scaled time: of outputs
        EXPECT_EQ(run.position.time_in_stage, 3e5);
        EXPECT_NEAR(state.stress(2, 2), -15e6, 2e-3 * 15e6);
        EXPECT_LT(state.unbalanced_ratio, 1e-4);
        EXPECT_LT(compute_logarithmic_strain(state.cell.deformation)(2, 2), before - 1e-4);
        EXPECT_GT(run.observations.size(), 5u);
      }
  }

  TEST(CreepStages, AtHeldStrainStressRelaxes)
  {
    // Law: contacts that creep bear less at held strain; no component of strain moves.
    for (const CreepKind kind : {CreepKind::rate_process, CreepKind::burgers})
      {
        Rev rev = get_loaded(kind);
        const RevState before = rev.get_committed();
        const ProgrammeRun run = hold(rev, StageKind::relaxation, 3e5);
        ASSERT_EQ(run.outcome, LaboratoryOutcome::finished);
        EXPECT_EQ(rev.get_committed().cell.deformation, before.cell.deformation);
        EXPECT_GT(rev.get_committed().stress(2, 2), 0.99 * before.stress(2, 2));
        EXPECT_GT(rev.get_committed().stress(2, 2), before.stress(2, 2) + 1e-3 * 15e6);
        EXPECT_EQ(run.observations.back().kind, ObservationKind::relaxed);
      }
  }

  TEST(CreepStages, StoppedAndGoneOnWithLeavesTheSameBits)
  {
    // Law: a committed state and the position are all that the future depends on, what has crept included. Bits.
    for (const CreepKind kind : alternatives)
      {
        Rev whole = get_loaded(kind), half = whole;
        hold(whole, StageKind::creep, 1e4);
        ProgrammeRun run = hold(half, StageKind::creep, 1e4, 2);
        ASSERT_EQ(run.outcome, LaboratoryOutcome::stopped);
        Rev resumed(half.get_model(), deserialise(serialise(half.get_committed())));
        go_on(resumed, {make_load(), make_held(StageKind::creep, 1e4)}, run);
        EXPECT_TRUE(are_equal_bits(whole.get_committed(), resumed.get_committed()));
      }
  }

  TEST(CreepStages, ThreadsChangeNothing)
  {
    // Law: forces are summed in the order of pairs and creep goes contact by contact. Bits. (80 grains are one block:
    // that blocks are summed alike is the team's test.)
    for (const CreepKind kind : alternatives)
      {
        Rev alone = get_loaded(kind);
        RevModel model = alone.get_model();
        model.dynamics.n_threads = 2;
        Rev shared(model, alone.get_committed());
        hold(alone, StageKind::creep, 1e3);
        hold(shared, StageKind::creep, 1e3);
        EXPECT_TRUE(are_equal_bits(alone.get_committed(), shared.get_committed()));
      }
  }

  TEST(CreepStages, CracksGrowBesideTheCreepOfContacts)
  {
    // Law: a jump ends with the next batch or with the longest step of creep, whichever is first; grains break.
    for (const CreepKind kind : {CreepKind::rate_process, CreepKind::burgers})
      {
        RevModel model = make_model(kind);
        model.fracture.is_active = true;
        Rev rev(model, get_loaded_state());
        EXPECT_LE(rev.compute_longest_jump(), rev.compute_time_to_next_batch());
        RevModel cracks_alone = model;
        cracks_alone.creep.kind = CreepKind::delayed_fracture;
        EXPECT_EQ(Rev(cracks_alone, get_loaded_state()).compute_longest_jump(), rev.compute_time_to_next_batch());
        EXPECT_EQ(rev.age(rev.compute_time_to_next_batch()), 1u);
      }
  }

  /** Three grains in a column whose middle one's crack is to grow through. */
  RevState make_cracked()
  {
    RevState state = make_column(1e-2 * radius);
    for (int i = 0; i < 3; ++i)
      {
        state.grains.strength[i] = i == 1 ? 100e9 : 1e15;
        state.grains.crack_half_length[i] = 0.2 * radius;
      }
    return state;
  }

  /** True masses: dt = share sqrt(2 m / sum kn) of the middle grain [s]. */
  double compute_time_step(const RevState &column)
  {
    const double kn = list_contacts(column, make_contact_law(GrainMaterial{}))[0].normal_stiffness;
    return MotionRule{}.time_step_share * std::sqrt(2. * column.grains.velocity[1].w / (2. * kn));
  }

  TEST(ScaledTime, AGrainBreaksWhenItsScaledTimeHasCome)
  {
    // Law: cracks grow by v scale dt in each cycle: under held force a grain breaks (r - a)/v of scaled time after the
    // beginning, with masses of either kind. Tolerance: one cycle's time, in which the crack passes its end.
    for (const bool has_true_masses : {false, true})
      {
        RevModel model;
        model.dynamics.motion.has_true_masses = has_true_masses;
        model.fracture.crack.exponent = 2.;
        RevState state = make_cracked();
        Rev probe(model, state);
        probe.relax();
        state.set_contacts(probe.get_baseline().contacts);
        const Grains &grains = probe.get_baseline().grains;
        const double lifetime = 0.8 * radius / grains.crack_velocity[1];
        const double step = has_true_masses ? compute_time_step(state) : 1.; // [s] or one cycle
        const CrackClock clock{lifetime / (500.5 * step), 1.5 * lifetime, true};
        Rev rev(model, state);
        const RestReport report = rev.control(CellControl{}, clock);
        ASSERT_EQ(report.status, RestStatus::at_rest);
        const RevState &end = rev.get_trial();
        EXPECT_EQ(end.counters.broken_delayed, 1u);
        ASSERT_EQ(end.fractures.size(), 1u);
        EXPECT_NEAR(end.fractures[0].time / lifetime, 1., 1. / 500.);
        EXPECT_EQ(end.time, 1.5 * lifetime);
      }
  }

  TEST(ScaledTime, TheClockStandsStillAtItsEnd)
  {
    // Law: no crack grows beyond the interval: after it, a is a0 + v dt for a grain under held force, however long it
    // takes to come to rest; an interval that does not wait ends with its last cycle. Tolerance: rounding of 700
    // additions.
    RevModel model;
    model.fracture.crack.exponent = 2.;
    for (const bool waits : {false, true})
      {
        Rev rev(model, make_cracked());
        Rev probe = rev;
        probe.relax();
        const double velocity = probe.get_baseline().grains.crack_velocity[1];
        const double interval = 0.1 * radius / velocity;
        const RestReport report = rev.control(CellControl{}, {interval / 699.5, interval, waits});
        EXPECT_EQ(rev.get_trial().time, interval);
        EXPECT_NEAR(rev.get_trial().grains.crack_half_length[1] / radius, 0.3, 1e-12);
        EXPECT_EQ(report.n_cycles, 700u);
      }
  }
} // namespace

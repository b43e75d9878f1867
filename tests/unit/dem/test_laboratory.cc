#include "dem/laboratory.h"

#include "tests/support/rev_cases.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace
{
  using namespace dem;
  using namespace dem::cases;

  /** A sand weak enough to break a few of its grains in short tests. */
  RevModel make_weak_model()
  {
    RevModel model;
    model.fracture.strength.reference_strength = 1.8e9;
    return model;
  }

  LaboratoryStage make_stage(const StageKind kind, const double stress = 0.)
  {
    LaboratoryStage stage;
    stage.name = "test";
    stage.kind = kind;
    stage.stress = stress;
    stage.n_increments = 4;
    return stage;
  }

  LaboratoryStage make_held(const StageKind kind, const double duration)
  {
    LaboratoryStage stage = make_stage(kind);
    stage.duration = duration;
    stage.points_per_decade = 2;
    return stage;
  }

  struct ProgrammeRun
  {
    LaboratoryOutcome outcome;
    std::vector<Observation> observations;
    std::vector<LaboratoryPosition> positions; // after each committed step
    std::vector<std::pair<std::size_t, bool>> edges;
    LaboratoryPosition last;
    double fraction = 0.;
  };

  /** Runs a programme from a position; stops after n committed steps. */
  ProgrammeRun run(Rev &rev, const std::vector<LaboratoryStage> &stages, const LaboratoryRule &rule = {},
                   const LaboratoryPosition &position = {}, const std::size_t n_steps = 1000000)
  {
    ProgrammeRun result;
    result.last = position;
    LaboratoryObserver observer;
    observer.observe = [&](const Observation &observation) { result.observations.push_back(observation); };
    observer.committed = [&](const LaboratoryPosition &now, const double fraction) {
      EXPECT_GE(fraction, result.fraction);
      result.fraction = fraction;
      result.positions.push_back(now);
      return result.positions.size() >= n_steps;
    };
    observer.stage_edge = [&](const std::size_t stage, const bool is_end) { result.edges.emplace_back(stage, is_end); };
    result.outcome = run_programme(rev, stages, rule, observer, result.last);
    return result;
  }

  Rev make_small_rev(const RevModel &model = RevModel{})
  {
    return make_rev(model, get_packing().state);
  }

  Matrix get_strain(const Rev &rev)
  {
    return compute_logarithmic_strain(rev.get_committed().cell.deformation);
  }

  TEST(Laboratory, IsotropicLoadReachesItsPressure)
  {
    // Law: three equal normal stresses, within the servo's 0.2 %, in as many committed equilibria as increments, by
    // equal factors. Nothing broken at 1 MPa.
    Rev rev = make_small_rev();
    const ProgrammeRun result = run(rev, {make_stage(StageKind::isotropic, 1e6)});
    ASSERT_EQ(result.outcome, LaboratoryOutcome::finished);
    ASSERT_EQ(result.observations.size(), 4u);
    for (int k = 0; k < 3; ++k)
      EXPECT_NEAR(rev.get_committed().stress(k, k), -1e6, 2e-3 * 1e6);
    const double factor = std::pow(10., 1. / 4.); // from 100 kPa
    for (int i = 0; i < 4; ++i)
      EXPECT_NEAR(result.observations[i].stress(0, 0) / (-100e3 * std::pow(factor, i + 1)), 1., 4e-3);
    EXPECT_EQ(result.edges, (std::vector<std::pair<std::size_t, bool>>{{0, false}, {0, true}}));
    EXPECT_EQ(result.fraction, 1.);
  }

  TEST(Laboratory, OedometricLoadKeepsItsWidth)
  {
    // Law: axial stress to its value, no lateral strain: exactly none; lateral stress follows below the axial one.
    Rev rev = make_small_rev();
    LaboratoryStage stage = make_stage(StageKind::oedometric, 1.5e6);
    stage.is_geometric = false;
    const ProgrammeRun result = run(rev, {stage});
    ASSERT_EQ(result.outcome, LaboratoryOutcome::finished);
    EXPECT_NEAR(rev.get_committed().stress(2, 2), -1.5e6, 2e-3 * 1.5e6);
    EXPECT_NEAR(result.observations[1].stress(2, 2), -0.8e6, 4e-3 * 0.8e6); // half way from 100 kPa, equal steps
    EXPECT_EQ(get_strain(rev)(0, 0), 0.);
    EXPECT_EQ(get_strain(rev)(0, 1), 0.);
    EXPECT_LT(get_strain(rev)(2, 2), -1e-3);
    EXPECT_LT(std::abs(rev.get_committed().stress(0, 0)), 0.9 * 1.5e6);
  }

  TEST(Laboratory, TriaxialCompressionReachesItsStrainAtHeldLateralStress)
  {
    // Law: axial strain to its value (rounding), lateral stresses at what they were, within the servo's 0.2 %.
    Rev rev = make_small_rev();
    LaboratoryStage stage = make_stage(StageKind::triaxial);
    stage.axial_strain = 0.01;
    const ProgrammeRun result = run(rev, {make_stage(StageKind::isotropic, 1e6), stage});
    ASSERT_EQ(result.outcome, LaboratoryOutcome::finished);
    EXPECT_NEAR(get_strain(rev)(2, 2), -0.01, 1e-13);
    for (const Observation &observation : result.observations)
      if (observation.stage == 1)
        {
          EXPECT_NEAR(observation.stress(0, 0), -1e6, 4.1e-3 * 1e6); // of a start that was within 0.2 % itself
          EXPECT_NEAR(observation.stress(1, 1), -1e6, 4.1e-3 * 1e6);
        }
    EXPECT_LT(rev.get_committed().stress(2, 2), -1.5e6);
  }

  TEST(Laboratory, AStrainPathEndsAtItsSixStrains)
  {
    // Law: the logarithmic strain of the whole programme reaches the values. Tolerance: rounding of exponentials and
    // some hundred products, once the small strains of the path are taken as coaxial in each increment: 1e-12.
    Rev rev = make_small_rev();
    LaboratoryStage first = make_stage(StageKind::strain_path), second = first;
    first.strain = Vector(0.002, 0.001, 0.003).asDiagonal();
    second.strain = Vector(-0.001, 0.002, 0.005).asDiagonal();
    ASSERT_EQ(run(rev, {first}).outcome, LaboratoryOutcome::finished);
    EXPECT_LT((get_strain(rev) + first.strain).norm(), 1e-12);
    ASSERT_EQ(run(rev, {second}).outcome, LaboratoryOutcome::finished);
    EXPECT_LT((get_strain(rev) + second.strain).norm(), 1e-12);

    Rev sheared = make_small_rev();
    LaboratoryStage shear = make_stage(StageKind::strain_path);
    shear.strain << 0.001, 0.002, 0., 0.002, 0.001, -0.001, 0., -0.001, 0.003;
    ASSERT_EQ(run(sheared, {shear}).outcome, LaboratoryOutcome::finished);
    EXPECT_LT((get_strain(sheared) + shear.strain).norm(), 1e-12); // proportional: coaxial throughout
  }

  TEST(Laboratory, CreepHoldsItsStressAndIsWrittenAtCertainTimes)
  {
    // Law: axial stress within 0.2 % of its value at each equilibrium; outputs at first 10^(k/points) and at the end,
    // to rounding; strain grows, time runs to the duration.
    Rev rev = make_small_rev(make_weak_model());
    const ProgrammeRun result = run(rev, {make_stage(StageKind::oedometric, 8e6), make_held(StageKind::creep, 1e4)});
    ASSERT_EQ(result.outcome, LaboratoryOutcome::finished);
    std::vector<double> times, wanted;
    std::size_t n_equilibria = 0;
    double held = 0.;
    for (const Observation &observation : result.observations)
      {
        if (observation.kind == ObservationKind::load)
          held = observation.stress(2, 2);
        if (observation.kind == ObservationKind::ageing)
          times.push_back(observation.time);
        if (observation.kind != ObservationKind::dynamic)
          continue;
        ++n_equilibria;
        EXPECT_NEAR(observation.stress(2, 2), held, 2.001e-3 * std::abs(held));
        EXPECT_EQ(observation.strain(0, 0), 0.);
      }
    for (int k = 0; k <= 8; ++k)
      EXPECT_TRUE(std::any_of(times.begin(), times.end(), [&](const double time) {
        return std::abs(time / std::pow(10., 0.5 * k) - 1.) < 1e-11;
      })) << k;
    EXPECT_TRUE(std::is_sorted(times.begin(), times.end()));
    EXPECT_EQ(result.last.stage, 2u);
    EXPECT_EQ(result.positions.back().time_in_stage, 1e4);
    EXPECT_NEAR(rev.get_committed().time, 1e4, 1e-8);
    EXPECT_GE(n_equilibria, 9u);
    EXPECT_GT(rev.get_committed().counters.broken_delayed, 0u);
  }

  TEST(Laboratory, DynamicComputationsOfAStepAreHandedOut)
  {
    // Law: of a creep whose load stood for no time, every broken grain disturbed one of them, jumps add up to the time
    // and strain changes to the strain (rounding), and the controlled stress alone has deviations that include the
    // servo's: a grain that breaks carries load, so that stress drops (rises in tension-positive sign).
    Rev rev = make_small_rev(make_weak_model());
    const ProgrammeRun loaded = run(rev, {make_stage(StageKind::oedometric, 8e6)});
    ASSERT_EQ(loaded.outcome, LaboratoryOutcome::finished);
    const Matrix strain_before = get_strain(rev);
    const Counters before = rev.get_committed().counters;
    std::vector<DynamicRecord> records;
    LaboratoryObserver observer;
    observer.disturbed = [&](const DynamicRecord &record) { records.push_back(record); };
    LaboratoryPosition position = loaded.last;
    const std::vector<LaboratoryStage> stages = {make_stage(StageKind::oedometric, 8e6),
                                                 make_held(StageKind::creep, 1e4)};
    ASSERT_EQ(run_programme(rev, stages, {}, observer, position), LaboratoryOutcome::finished);
    std::size_t n_instant = 0, n_delayed = 0, n_cycles = 0;
    double time = 0.;
    Matrix strain = Matrix::Zero();
    for (const DynamicRecord &record : records)
      {
        EXPECT_EQ(record.stage, 1u);
        EXPECT_NEAR(record.time, time, 1e-8);
        EXPECT_EQ(record.cause == BreakageCause::instant, record.jump == 0.);
        EXPECT_EQ(record.is_stress_controlled, (std::array<bool, 6>{false, false, true, false, false, false}));
        EXPECT_GE(record.largest_deviation[2], 0.);
        EXPECT_LE(record.smallest_deviation[2], 0.);
        EXPECT_TRUE(record.n_broken == 0 || record.largest_deviation[2] > 0.);
        (record.cause == BreakageCause::instant ? n_instant : n_delayed) += record.n_broken;
        n_cycles += record.n_cycles;
        time += record.jump;
        strain += record.strain_change;
      }
    const Counters after = rev.get_committed().counters;
    EXPECT_EQ(n_delayed, after.broken_delayed - before.broken_delayed);
    EXPECT_EQ(n_instant, after.broken_instant - before.broken_instant);
    EXPECT_EQ(n_cycles, after.cycles - before.cycles);
    EXPECT_GT(n_delayed, 0u);
    EXPECT_NEAR(time, 1e4, 1e-8);
    EXPECT_LT((strain - (get_strain(rev) - strain_before)).norm(), 1e-14);
  }

  TEST(Laboratory, RelaxationHoldsItsStrain)
  {
    // Law: not a bit of the cell moves while grains break and stress falls.
    Rev rev = make_small_rev(make_weak_model());
    ASSERT_EQ(run(rev, {make_stage(StageKind::oedometric, 8e6)}).outcome, LaboratoryOutcome::finished);
    const RevState before = rev.get_committed();
    const ProgrammeRun result = run(rev, {make_held(StageKind::relaxation, 1e6)});
    ASSERT_EQ(result.outcome, LaboratoryOutcome::finished);
    EXPECT_EQ(rev.get_committed().cell.deformation, before.cell.deformation);
    EXPECT_GT(rev.get_committed().counters.broken_delayed, 0u);
    EXPECT_GT(rev.get_committed().stress(2, 2), before.stress(2, 2));
    EXPECT_EQ(result.observations.back().kind, ObservationKind::relaxed);
    EXPECT_EQ(result.positions.back().time_in_stage, 1e6);
  }

  TEST(Laboratory, ALoadThatLastsAgesMeanwhile)
  {
    // Law: time goes on in proportion to the load, ends exactly with it, and breaks grains that the same load without
    // time leaves whole.
    Rev slow = make_small_rev(make_weak_model()), fast = make_small_rev(make_weak_model());
    LaboratoryStage stage = make_stage(StageKind::oedometric, 12e6);
    ASSERT_EQ(run(fast, {stage}).outcome, LaboratoryOutcome::finished);
    stage.duration = 1e7;
    const ProgrammeRun result = run(slow, {stage});
    ASSERT_EQ(result.outcome, LaboratoryOutcome::finished);
    EXPECT_EQ(result.positions.back().time_in_stage, 1e7);
    EXPECT_EQ(result.positions.back().share, 1.);
    EXPECT_NEAR(slow.get_committed().time, 1e7, 1e-5);
    for (const LaboratoryPosition &position : result.positions)
      EXPECT_NEAR(position.time_in_stage, position.share * 1e7, 1e-5); // rounding of some hundred sums
    EXPECT_GT(slow.get_committed().counters.broken_delayed, 0u);
    EXPECT_EQ(fast.get_committed().counters.broken_delayed, 0u);
    EXPECT_NEAR(slow.get_committed().stress(2, 2), -12e6, 2e-3 * 12e6);
  }

  TEST(Laboratory, GivesUpWithAReasonAndALastGoodState)
  {
    // Law: an avalanche that does not end within its rounds is a rupture; an increment that finds no rest even at its
    // smallest share is no equilibrium; the REV then stands at its last committed step.
    RevModel model = make_weak_model();
    model.fracture.strength.reference_strength = 0.4e9;
    model.fracture.batch_limit = 1000;
    Rev crumbling = make_small_rev(model);
    LaboratoryRule rule;
    rule.round_cap = 2;
    const ProgrammeRun ruptured = run(crumbling, {make_stage(StageKind::oedometric, 20e6)}, rule);
    EXPECT_EQ(ruptured.outcome, LaboratoryOutcome::ruptured);
    EXPECT_TRUE(are_equal_bits(crumbling.get_baseline(), crumbling.get_committed()));

    model = make_weak_model();
    model.equilibrium.cycle_cap = 3;
    Rev restless = make_small_rev(model);
    const RevState before = restless.get_committed();
    const ProgrammeRun lost = run(restless, {make_stage(StageKind::isotropic, 1e6)});
    EXPECT_EQ(lost.outcome, LaboratoryOutcome::no_equilibrium);
    EXPECT_TRUE(lost.observations.empty());
    EXPECT_TRUE(are_equal_bits(restless.get_committed(), before));
    EXPECT_TRUE(are_equal_bits(restless.get_baseline(), before));
    EXPECT_LE(lost.last.share_step, 0.25 / 64.); // of a quarter, halved to its smallest
  }
} // namespace

// A laboratory programme as a whole: what is refused before it starts, and what a resumed one repeats.

#include "dem/programme_check.h"

#include "tests/support/rev_cases.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

namespace
{
  using namespace dem;
  using namespace dem::cases;

  /** Grains weak enough to break at small stresses. */
  RevModel make_weak_model()
  {
    RevModel model;
    model.fracture.strength.reference_strength = 1.8e9;
    return model;
  }

  std::vector<LaboratoryStage> make_programme()
  {
    std::vector<LaboratoryStage> stages(3);
    for (LaboratoryStage &stage : stages)
      {
        stage.name = "test";
        stage.n_increments = 3;
        stage.duration = 1e3;
        stage.points_per_decade = 1;
      }
    stages[0].kind = StageKind::oedometric;
    stages[0].stress = 5e6;
    stages[1].kind = StageKind::creep;
    stages[2].kind = StageKind::relaxation;
    return stages;
  }

  /**
   * A packing that surely bears the programme. Whether a weak and small one ruptures in its creep is chance: of 60
   * packings of 80 grains 7 to 9 do under 9 MPa, and of one packing whose places differ by a last bit one copy in 20 to
   * 60; a sum in another order, or other instructions, decides. Of 60 packings like this one none did, on machines with
   * and without AVX-512, and in each of them cracks broke grains.
   */
  const RevState &get_strong_packing()
  {
    static const RevState packing = [] {
      PackingRule rule = make_packing_rule();
      rule.n_grains = 2 * n_grains;
      return generate_packing(rule, GrainMaterial{}, DynamicsRule{}).state;
    }();
    return packing;
  }

  /** All bits of an observation that a table could show. */
  std::vector<double> list_values(const Observation &observation)
  {
    std::vector<double> values = {observation.time,
                                  double(observation.stage),
                                  double(observation.kind),
                                  double(observation.counters.cycles),
                                  double(observation.counters.broken_instant),
                                  double(observation.counters.broken_delayed),
                                  observation.void_ratio,
                                  observation.void_ratio_with_fines,
                                  observation.coordination,
                                  observation.unbalanced_ratio,
                                  double(observation.n_grains)};
    values.insert(values.end(), observation.strain.data(), observation.strain.data() + 9);
    values.insert(values.end(), observation.stress.data(), observation.stress.data() + 9);
    return values;
  }

  struct Record
  {
    LaboratoryOutcome outcome;
    std::vector<std::vector<double>> rows;
    std::vector<std::pair<std::size_t, bool>> edges;
    std::size_t n_steps = 0;
  };

  /** Goes on with a programme for n committed steps and adds to the record. */
  void go_on(Rev &rev, LaboratoryPosition &position, const std::size_t n_steps, Record &record)
  {
    LaboratoryObserver observer;
    observer.observe = [&](const Observation &observation) { record.rows.push_back(list_values(observation)); };
    std::size_t n = 0;
    observer.committed = [&](const LaboratoryPosition &, double) {
      ++record.n_steps;
      return ++n == n_steps;
    };
    observer.stage_edge = [&](const std::size_t stage, const bool is_end) { record.edges.emplace_back(stage, is_end); };
    record.outcome = run_programme(rev, make_programme(), LaboratoryRule{}, observer, position);
  }

  const Record &get_uninterrupted()
  {
    static const Record record = [] {
      Record whole;
      LaboratoryPosition position;
      Rev rev = make_rev(make_weak_model(), get_strong_packing());
      go_on(rev, position, 0, whole);
      return whole;
    }();
    return record;
  }

  TEST(Programme, ResumedAfterAnyStepItRepeatsEveryBit)
  {
    // Law: position and committed state are all that a run's future depends on: stopped after any step and gone on with
    // in a new REV, it writes the same rows and passes the same edges of stages, once each.
    const Record &whole = get_uninterrupted();
    ASSERT_EQ(whole.outcome, LaboratoryOutcome::finished);
    ASSERT_GT(whole.rows.back()[5], 0.); // grains broke by cracks
    ASSERT_EQ(whole.edges.size(), 6u);
    for (std::size_t n = 1; n < whole.n_steps; n += 1 + whole.n_steps / 12)
      {
        Record record;
        LaboratoryPosition position;
        Rev first = make_rev(make_weak_model(), get_strong_packing());
        go_on(first, position, n, record);
        ASSERT_EQ(record.outcome, LaboratoryOutcome::stopped);
        const auto bytes = serialise(first.get_committed());
        Rev second(make_weak_model(), deserialise(bytes));
        go_on(second, position, 0, record);
        EXPECT_EQ(record.outcome, LaboratoryOutcome::finished);
        EXPECT_EQ(record.rows, whole.rows) << "stopped after step " << n;
        EXPECT_EQ(record.edges, whole.edges) << "stopped after step " << n;
      }
  }

  TEST(Programme, ResumedAtTheEndOfAStageItGoesOnWithTheNext)
  {
    // Law: the step that ends a stage is a step like any other.
    const Record &whole = get_uninterrupted();
    Record record;
    LaboratoryPosition position;
    Rev first = make_rev(make_weak_model(), get_strong_packing());
    while (position.share < 1.)
      go_on(first, position, 1, record);
    ASSERT_EQ(position.stage, 0u);
    Rev second(make_weak_model(), first.get_committed());
    go_on(second, position, 0, record);
    EXPECT_EQ(record.rows, whole.rows);
    EXPECT_EQ(record.edges, whole.edges);
  }

  struct Complaint
  {
    std::string message, quantity;
  };

  Complaint complain(const std::vector<LaboratoryStage> &stages)
  {
    try
      {
        check_programme(stages);
      }
    catch (const StageContradiction &contradiction)
      {
        return {contradiction.what(), contradiction.quantity};
      }
    catch (const std::invalid_argument &error)
      {
        return {error.what(), ""};
      }
    return {};
  }

  TEST(Programme, WhatContradictsItselfIsRefusedByStage)
  {
    // Law: one message that names the stage, its quantity and what is wrong with it; a sound programme passes.
    EXPECT_EQ(complain(make_programme()).message, "");
    EXPECT_NE(complain({}).message.find("no stage"), std::string::npos);
    const auto expect = [&](const std::size_t stage, const std::string &quantity, const std::string &what,
                            const auto &spoil) {
      auto stages = make_programme();
      spoil(stages[stage]);
      const Complaint complaint = complain(stages);
      EXPECT_EQ(complaint.message.rfind("stage " + std::to_string(stage + 1) + " (test): ", 0), 0u)
          << complaint.message;
      EXPECT_NE(complaint.message.find(what), std::string::npos) << complaint.message;
      EXPECT_EQ(complaint.quantity, quantity) << complaint.message;
    };
    expect(1, "Duration", "duration", [](LaboratoryStage &stage) { stage.duration = 0.; });
    expect(2, "Duration", "duration", [](LaboratoryStage &stage) { stage.duration = std::nan(""); });
    expect(1, "First output", "first output", [](LaboratoryStage &stage) { stage.first_output = 2e3; });
    expect(1, "First output", "first output", [](LaboratoryStage &stage) { stage.first_output = 0.; });
    expect(1, "Stress", "no target", [](LaboratoryStage &stage) { stage.stress = 1e6; });
    expect(0, "Stress", "above 0 Pa", [](LaboratoryStage &stage) { stage.stress = -1e6; });
    expect(0, "Kind", "one of: Stress, Axial strain", [](LaboratoryStage &stage) { stage.stress = 0.; });
    expect(0, "Volumetric strain", "no target", [](LaboratoryStage &stage) { stage.volumetric_strain = 0.01; });
    expect(0, "Volumetric strain", "one target",
           [](LaboratoryStage &stage) { stage.kind = StageKind::isotropic, stage.volumetric_strain = 0.01; });
    expect(0, "Axial strain", "one target", [](LaboratoryStage &stage) { stage.axial_strain = 0.01; });
    expect(0, "Kind", "loading stage before",
           [](LaboratoryStage &stage) { stage.kind = StageKind::creep, stage.stress = 0.; });
    const auto turn_into = [](LaboratoryStage &stage, const StageKind kind) {
      stage.kind = kind;
      stage.stress = 0.;
    };
    expect(0, "Kind", "Deviatoric stress, Share of q_max",
           [&](LaboratoryStage &stage) { turn_into(stage, StageKind::triaxial); });
    expect(2, "Share of q_max", "searches for it",
           [&](LaboratoryStage &stage) { turn_into(stage, StageKind::triaxial), stage.strength_share = 0.5; });
    expect(2, "q_max", "Share of q_max alone", [&](LaboratoryStage &stage) {
      turn_into(stage, StageKind::triaxial), stage.axial_strain = 0.1, stage.strength = 1e6;
    });
    expect(2, "Axial strain", "compresses",
           [&](LaboratoryStage &stage) { turn_into(stage, StageKind::strength_search), stage.axial_strain = -0.1; });
    expect(2, "Drop below q_max", "between 0 and 1", [&](LaboratoryStage &stage) {
      turn_into(stage, StageKind::strength_search), stage.axial_strain = 0.1, stage.strength_drop = 1.;
    });
    expect(0, "Kind", "brings p about",
           [&](LaboratoryStage &stage) { turn_into(stage, StageKind::constant_p), stage.axial_strain = 0.1; });
  }

  TEST(Programme, AConstantMeanStressBearsThreeTimesItselfAsDeviator)
  {
    // Law: at constant p the lateral stress p - q/3 must not be tension, nor the axial p + 2q/3.
    auto stages = make_programme();
    stages[0].kind = StageKind::isotropic;
    stages[0].stress = 9e6;
    stages[1] = stages[0];
    stages[1].kind = StageKind::constant_p;
    stages[1].stress = 0.;
    for (const double deviator : {26.9e6, -13.4e6, 27.1e6, -13.6e6})
      {
        stages[1].deviatoric_stress = deviator;
        EXPECT_EQ(complain(stages).quantity, deviator < 27e6 && deviator > -13.5e6 ? "" : "Deviatoric stress");
      }
  }

  TEST(Programme, ObservationsAreThoseOfTheState)
  {
    // Law: symmetric stress, strain, void ratios, counters of the committed state, tension-positive.
    const RevState &state = get_loaded_state();
    const Observation observation = observe(state, RevModel{});
    EXPECT_EQ(observation.stress, Matrix(0.5 * (state.stress + state.stress.transpose())));
    EXPECT_LT(observation.stress(2, 2), -9e6);
    EXPECT_EQ(observation.strain, compute_logarithmic_strain(state.cell.deformation));
    EXPECT_EQ(observation.void_ratio, compute_void_ratio(state));
    EXPECT_EQ(observation.n_grains, n_grains);
    EXPECT_DOUBLE_EQ(observation.coordination, 2. * double(state.contacts.size()) / n_grains);
  }
} // namespace

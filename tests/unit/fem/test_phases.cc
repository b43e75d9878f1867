#include "fem/checkpoint.h"
#include "tests/support/pile_cases.h"
#include "tests/support/scratch_folder.h"

#include <gtest/gtest.h>

namespace fem::cases::phases // names of its own: several tests are one translation unit
{

  // A pile that enters the ground after its hole has been widened: what is absent, what is let go, what begins to be
  // held.
  namespace
  {
    constexpr double weight = 16e3, surcharge = 50e3, ratio = 0.5; // of the ground
    constexpr ElasticParameters concrete = {30e9, 0.2, Kinematics::finite}, sand = {50e6, 0.25, Kinematics::finite};

    ProblemParameters get_parameters(bool is_pile_absent)
    {
      ProblemParameters parameters = get_exact_parameters(Geometry::axisymmetric, Kinematics::finite);
      parameters.newton.tolerance = 1e-8;
      parameters.unit_weight = weight;
      parameters.pile_regions = {pile_region};
      parameters.is_pile_absent = is_pile_absent;
      return parameters;
    }

    std::vector<BoundaryCondition> get_conditions()
    {
      auto conditions = get_ground_conditions();
      conditions.push_back({"surface", ConditionKind::pressure, "", surcharge});
      conditions.push_back(make_displacement("shaft", "x", true));
      conditions.push_back(make_displacement("base", "z", true));
      conditions.push_back(make_displacement("head", "z", false));
      return conditions;
    }

    dealii::SymmetricTensor<2, 3> get_stress(const dealii::Point<3> &place)
    {
      dealii::SymmetricTensor<2, 3> stress;
      stress[2][2] = -surcharge + weight * place[2];
      stress[0][0] = stress[1][1] = ratio * stress[2][2];
      return stress;
    }

    Stage make_stage(const std::string &name, std::vector<Target> targets, unsigned int n_increments)
    {
      Stage stage;
      stage.name = name;
      stage.targets = std::move(targets);
      stage.n_increments = n_increments;
      return stage;
    }

    constexpr double widening = 0.01;

    /** Widen the hole, place the pile, push its head. */
    std::vector<Stage> get_stages()
    {
      Stage widen = make_stage("widen", {{"shaft", ConditionKind::displacement, "x", widening}}, 2);
      Stage place = make_stage("place", {}, 4);
      place.places_pile = true;
      place.releases = {{"shaft", ConditionKind::displacement, "x"}, {"base", ConditionKind::displacement, "z"}};
      Stage push = make_stage("push", {{"head", ConditionKind::displacement, "z", -0.001}}, 2);
      push.holds = {{"head", ConditionKind::displacement, "z"}};
      return {widen, place, push};
    }

    struct PileRun
    {
      PileRun()
          : material(make_elastic_pile(concrete, sand)),
            problem(read_pile_mesh("pile_coarse.msh"), get_conditions(), get_parameters(true), *material, get_stress),
            stepping(problem, get_stages(), {}, {[this](const StepReport &report) { reports.push_back(report); }, {}})
      {}

      void advance(unsigned int n_steps)
      {
        for (unsigned int i = 0; i < n_steps; ++i)
          ASSERT_EQ(stepping.advance(), StepStatus::ok);
      }

      std::vector<StepReport> reports;
      std::unique_ptr<CompositeMaterial> material;
      QuasiStaticProblem<2> problem;
      LoadStepping<2> stepping;
    };

    double get_force(const StepReport &report, const std::string &name, unsigned int axis)
    {
      for (const BoundaryResponse &response : report.boundaries)
        if (response.name == name)
          return response.force[axis];
      throw std::logic_error(name);
    }
  } // namespace

  TEST(Phases, AnAbsentPilePullsAtNothing)
  {
    // Law: the ground around a held hole answers the same whatever the absent pile is made of.
    std::vector<double> forces;
    for (const double modulus : {30e9, 3e6})
      {
        const auto material = make_elastic_pile({modulus, 0.2, Kinematics::finite}, sand);
        QuasiStaticProblem<2> problem(read_pile_mesh("pile_coarse.msh"), get_conditions(), get_parameters(true),
                                      *material, get_stress);
        LoadStepping<2> stepping(problem, {get_stages().front()}, {});
        ASSERT_EQ(stepping.run().status, StepStatus::ok);
        forces.push_back(find_response(problem, "shaft").force[0]);
      }
    EXPECT_GT(forces[0], 1e5);
    EXPECT_NEAR(forces[0], forces[1], 1e-6 * forces[0]); // Newton's tolerance of 1e-8 times the number of nodes
  }

  TEST(Phases, TheUntouchedGroundIsInEquilibrium)
  {
    // Law: geostatic stress carries weight and surcharge: linear in z, it is integrated exactly; what holds the hole
    // carries 2 pi r times the integral of K0 (q - gamma z) over its wall, and pi r^2 (q + gamma L) on its floor.
    PileRun run;
    EXPECT_LT(run.problem.compute_unbalanced_share(), 1e-12);
    const BoundaryResponse shaft = find_response(run.problem, "shaft"), base = find_response(run.problem, "base");
    const double wall = 2. * dealii::numbers::PI * 0.125 * ratio * (surcharge * 5. + weight * 12.5);
    const double floor = dealii::numbers::PI * 0.125 * 0.125 * (surcharge + weight * 5.);
    EXPECT_NEAR(shaft.force[0] + base.force[0], wall, 1e-9 * wall);
    EXPECT_NEAR(shaft.force[2] + base.force[2], -floor, 1e-9 * floor);
    EXPECT_NEAR(shaft.force[0], wall, 1e-9 * wall); // below the tip nothing counts as shaft
  }

  TEST(Phases, PlacingThePileLeavesEquilibrium)
  {
    // Law: at the moment of the change nothing is out of balance and the pile is free of stress; what the hole's wall
    // carried then goes to the pile, whose own stiffness lets the hole hardly close.
    PileRun run;
    run.advance(2);
    const double held = get_force(run.reports[1], "shaft", 0);
    run.advance(4);
    for (unsigned int i = 2; i < 6; ++i)
      {
        EXPECT_LT(run.reports[i].residual, 1e-8 * run.reports[i].reaction_norm);
        EXPECT_LE(run.reports[i].evaluations, 4u); // no jump to recover from
      }
    // The pile is a thousand times as stiff as sand: its wall keeps the pressure to a few thousandths.
    EXPECT_NEAR(get_force(run.reports[5], "shaft", 0), held, 0.01 * held);
    const PointState inside = run.problem.compute_nearest_point_state(dealii::Point<3>(0.06, 0., -2.));
    const PointState beside = run.problem.compute_nearest_point_state(dealii::Point<3>(0.14, 0., -2.));
    EXPECT_LT(inside.stress[0][0], 0.5 * beside.stress[0][0]); // both pressed
  }

  TEST(Phases, TheCarriedForcesAreThoseOfTheWall)
  {
    // Law: with all carried forces left on, the problem stays where it is.
    PileRun run;
    run.advance(2);
    const auto before = run.problem.get_state().displacement;
    const auto phases = resolve_phases(run.problem.get_conditions(), get_stages(), run.problem.get_phase());
    ASSERT_EQ(run.problem.begin_phase(phases[1]), Status::ok);
    const NewtonResult result = run.problem.equilibrate(run.problem.get_values(), true);
    EXPECT_EQ(result.status, EquilibriumStatus::converged);
    run.problem.move_baseline();
    run.material->settle(true);
    run.problem.commit();
    const auto after = run.problem.get_state().displacement;
    for (std::size_t i = 0; i < before.size(); ++i)
      EXPECT_NEAR(after[i], before[i], 1e-7 * widening); // what Newton's tolerance of 1e-8 leaves of either equilibrium
  }

  TEST(Phases, AHeldHeadIsPushedFromWhereItIs)
  {
    // Law: a displacement that begins to be held counts from its present value, node by node.
    PileRun run;
    run.advance(6);
    const double before = find_response(run.problem, "head").displacement[2];
    run.advance(2);
    EXPECT_NEAR(find_response(run.problem, "head").displacement[2], before - 0.001, 1e-15);
    // Equilibrium of the pile: what the head takes, shaft and base pass on; its weight is in both.
    const double pile_weight = weight * dealii::numbers::PI * 0.125 * 0.125 * 5.;
    const double head = get_force(run.reports[7], "head", 2);
    EXPECT_LT(head, -1e4);
    EXPECT_NEAR(get_force(run.reports[7], "shaft", 2) + get_force(run.reports[7], "base", 2), head - pile_weight,
                1e-6 * std::abs(head));
  }

  TEST(Phases, ACheckpointAtAnyStepResumesToTheSameBits)
  {
    // Law: phases, carried forces and offsets are state: resumed at the end of a stage or inside one, it is one run.
    const ScratchFolder folder;
    const std::string file = folder.get_file("phases.h5");
    PileRun whole;
    whole.advance(8);
    for (const unsigned int n_steps : {1u, 2u, 4u, 6u, 7u})
      {
        PileRun first, second;
        first.advance(n_steps);
        write_checkpoint(file, first.problem, first.stepping.get_progress());
        second.stepping.set_progress(read_checkpoint(file, second.problem));
        second.advance(8 - n_steps);
        EXPECT_EQ(second.problem.get_state().displacement, whole.problem.get_state().displacement) << n_steps;
        EXPECT_EQ(second.problem.get_state().stress, whole.problem.get_state().stress) << n_steps;
      }
  }

  TEST(Phases, AContradictionIsNamed)
  {
    // Law: what cannot be is refused before anything is computed, with the stage's name.
    const auto conditions = get_conditions();
    Phase before;
    for (const BoundaryCondition &condition : conditions)
      before.is_held.push_back(condition.is_held);
    const auto get_refusal = [&](const std::function<void(Stage &)> &change) {
      Stage stage = make_stage("this one", {}, 1);
      change(stage);
      return get_error([&]() { resolve_phases(conditions, {stage}, before); });
    };
    EXPECT_EQ(get_refusal([](Stage &) {}), "");
    EXPECT_NE(get_refusal([](Stage &stage) { stage.places_pile = true; }).find("this one"), std::string::npos);
    EXPECT_NE(get_refusal([](Stage &stage) {
                stage.releases = {{"head", ConditionKind::displacement, "z"}};
              }).find("not held"),
              std::string::npos);
    EXPECT_NE(get_refusal([](Stage &stage) {
                stage.holds = {{"shaft", ConditionKind::displacement, "x"}};
              }).find("already"),
              std::string::npos);
    EXPECT_NE(get_refusal([](Stage &stage) {
                stage.holds = {{"head", ConditionKind::displacement, "z"}};
                stage.duration = 1.;
              }).find("without duration"),
              std::string::npos);
  }
} // namespace fem::cases::phases

#include "dem/dynamic_computation.h"

#include "dem/splitting.h"
#include "tests/support/rev_cases.h"

#include <gtest/gtest.h>

#include <cmath>

namespace
{
  using namespace dem;
  using namespace dem::cases;

  constexpr double overlap = 1e-2 * radius;

  /** Cracks that grow with the square of the stress, fast enough for the time of a DEM. */
  RevModel make_model()
  {
    RevModel model;
    model.dynamics.motion.has_true_masses = true;
    model.equilibrium.fixed_cycles = 4000;
    model.fracture.crack.exponent = 2.;
    return model;
  }

  /** Three equal grains under held strain, exactly at rest; the middle one's crack is to grow through. */
  RevState make_cracked(const double strength_of_the_others = 1e15)
  {
    RevState state = make_column(overlap);
    for (int i = 0; i < 3; ++i)
      {
        state.grains.strength[i] = i == 1 ? 100e9 : strength_of_the_others;
        state.grains.crack_half_length[i] = 0.2 * radius;
      }
    return state;
  }

  RestReport run(const RevModel &model, RevState &state)
  {
    return run_dynamic_computation(state, make_rest_rule(model), {model.fracture, model.identity}, CellControl{});
  }

  /** sigma of the column's contacts by the reference law [Pa]. */
  double compute_column_stress()
  {
    const double force = compute_normal_response(make_contact_law(GrainMaterial{}), overlap, 0.5 * radius).force;
    return compute_contact_stress(force, 0.5 * radius, overlap);
  }

  /** One time step of the column [s]. */
  double compute_time_step()
  {
    RevModel model = make_model();
    model.equilibrium.fixed_cycles = 1;
    model.fracture.is_active = false;
    RevState state = make_cracked();
    return run(model, state).duration;
  }

  TEST(DynamicComputation, TimeIsTheSumOfItsSteps)
  {
    // Law: n cycles are n time steps, dt = share sqrt(2 m / sum kn); none for no cycle. Tolerance: the overlap's
    // rounding in kn, and the sum's.
    const double kn = compute_normal_response(make_contact_law(GrainMaterial{}), overlap, 0.5 * radius).stiffness;
    const double dt = 0.5 * std::sqrt(2. * make_cracked().grains.velocity[0].w / (2. * kn));
    for (const std::size_t n : {1, 7, 300})
      {
        RevModel model = make_model();
        model.equilibrium.fixed_cycles = n;
        model.fracture.is_active = false;
        RevState state = make_cracked();
        state.time = 1e-3;
        const RestReport report = run(model, state);
        EXPECT_EQ(report.n_cycles, n);
        EXPECT_NEAR(report.duration / (static_cast<double>(n) * dt), 1., 1e-10);
        EXPECT_NEAR(state.time, 1e-3 + report.duration, 1e-18);
      }
  }

  TEST(DynamicComputation, AGrainUnderHeldForceBreaksWhenItsCrackIsThrough)
  {
    // Law: after (r - a0)/v of DEM time, v = v0 (sigma/sigma_lim)^n. Just before, it is whole. Tolerance: one time
    // step.
    RevModel model = make_model();
    const double dt = compute_time_step();
    const double ratio = compute_column_stress() / 100e9;
    const double target = 2000.5 * dt; // of the fracture [s]
    model.fracture.crack.reference_velocity = 0.8 * radius / target / (ratio * ratio);

    model.equilibrium.fixed_cycles = 1999;
    RevState early = make_cracked();
    run(model, early);
    EXPECT_EQ(early.grains.size(), 3u);
    EXPECT_NEAR(early.grains.crack_half_length[1], radius - 1.5 / 2000.5 * 0.8 * radius, 1e-7 * radius);

    model.equilibrium.fixed_cycles = 2002;
    RevState late = make_cracked();
    run(model, late);
    EXPECT_EQ(late.grains.size(), 2u + n_siblings);
    EXPECT_EQ(late.counters.broken_delayed, 1u);
    EXPECT_EQ(late.counters.broken_instant, 0u);
    EXPECT_EQ(late.grains.parent.back(), 1u);
  }

  TEST(DynamicComputation, AnOverstressedGrainBreaksAtOnce)
  {
    // Law: F > F_lim splits in the first cycle and is counted by its cause; grains below the comminution limit and
    // inactive fracture never do.
    RevModel model = make_model();
    model.equilibrium.fixed_cycles = 1;
    model.fracture.crack.reference_velocity = 1e-300;
    RevState state = make_cracked();
    state.grains.strength[1] = 0.99 * compute_column_stress();
    const RevState overstressed = state;
    run(model, state);
    EXPECT_EQ(state.counters.broken_instant, 1u);
    EXPECT_EQ(state.counters.broken_delayed, 0u);
    EXPECT_EQ(state.grains.size(), 2u + n_siblings);

    state = overstressed;
    model.fracture.comminution_diameter = 2.01 * radius;
    run(model, state);
    EXPECT_EQ(state.grains.size(), 3u);
    state = overstressed;
    model.fracture.comminution_diameter = 0.;
    model.fracture.is_active = false;
    run(model, state);
    EXPECT_EQ(state.grains.size(), 3u);
    EXPECT_EQ(state.grains.crack_half_length[1], 0.2 * radius);
  }

  TEST(DynamicComputation, ContactsThatStayFollowEachStepOnce)
  {
    // Law: replacing grains in mid-cycle computes forces twice; the shear of contacts that stay must not grow twice.
    RevState state = get_loaded_state();
    update_true_masses(state.grains, 2650.);
    RevModel model;
    model.dynamics.motion.has_true_masses = true;
    const ContactLaw law = make_contact_law(model.material);
    Dynamics dynamics(state, law, model.dynamics);
    Matrix increment = Matrix::Zero();
    increment(0, 1) = increment(1, 0) = 1e-5;
    dynamics.compute_forces();
    dynamics.move();
    dynamics.strain(increment);
    dynamics.compute_forces();
    const auto before = collect_memories(dynamics.get_network());
    state.set_contacts(before);
    dynamics.rebuild();
    dynamics.compute_forces();
    const auto after = collect_memories(dynamics.get_network());
    ASSERT_EQ(after.size(), before.size());
    for (std::size_t i = 0; i < before.size(); ++i) // turning into the same plane again: rounding
      EXPECT_LE((after[i].shear_force - before[i].shear_force).norm(), 1e-13 * before[i].shear_force.norm());
  }

  TEST(DynamicComputation, ARevInRealTimeKeepsItsClock)
  {
    // Law: with true masses a question is a dynamic computation: time passes in the trial, and the same question gives
    // the same bits.
    RevModel model;
    model.dynamics.motion.has_true_masses = true;
    Rev rev(model, get_loaded_state());
    const RestReport report = rev.control(make_oedometer(10.5e6));
    ASSERT_EQ(report.status, RestStatus::at_rest) << describe(report.status);
    EXPECT_GT(report.duration, 0.);
    EXPECT_EQ(rev.get_trial().time, report.duration);
    EXPECT_EQ(rev.get_baseline().time, 0.);
    EXPECT_NEAR(rev.get_trial().stress(2, 2), -10.5e6, 2e-3 * 10.5e6);
    const RevState first = rev.get_trial();
    rev.control(make_oedometer(10.5e6));
    EXPECT_TRUE(are_equal_bits(rev.get_trial(), first));
  }
} // namespace

#include "dem/dynamics.h"

#include "tests/support/rev_cases.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace
{
  using namespace dem;
  using namespace dem::cases;

  Forces make_forces(const std::size_t n, const Row &force)
  {
    Forces forces;
    forces.on_grains.resize(n, true);
    for (std::size_t i = 0; i < n; ++i)
      forces.on_grains.force(i) = forces.on_grains.torque(i) = force;
    return forces;
  }

  /** All grains by one step. */
  double advance(RevState &state, const Forces &forces, const Kinetics &kinetics, const MotionRule &rule)
  {
    const std::size_t n = state.grains.size();
    ForceTable table;
    table.resize(n, rule.is_rotation_free);
    for (std::size_t i = 0; i < n; ++i)
      {
        table.force(i) = forces.on_grains.force(i);
        if (rule.is_rotation_free)
          table.torque(i) = forces.on_grains.torque(i);
      }
    return advance_grains(state.grains, 0, n, {state.cell, table.get_rows(), kinetics, rule});
  }

  TEST(Motion, DampingTakesFromWhatDrivesAndAddsToWhatBrakes)
  {
    // Law: F (1 - alpha sign(F v)) in each component; nothing at rest. Tolerance: rounding.
    RevState state = make_state({Vector::Zero()}, 1.);
    const MotionRule rule;
    const Kinetics kinetics{2., 2., 1.};
    state.grains.velocity[0] = {2., -2., 0., 1.};
    advance(state, make_forces(1, {1., 1., 1., 0.}), kinetics, rule);
    EXPECT_EQ(state.grains.velocity[0].w, 1.);
    EXPECT_NEAR(state.grains.velocity[0].x, 2. + 0.5 * 0.3, 1e-15);
    EXPECT_NEAR(state.grains.velocity[0].y, -2. + 0.5 * 1.7, 1e-15);
    EXPECT_NEAR(state.grains.velocity[0].z, 0. + 0.5 * 1., 1e-15);
  }

  TEST(Motion, AGrainMovesByItsVelocityInALeaningCell)
  {
    // Law: x += v dt in space, whatever the cell's edges; the largest way is returned. Blocked grains do not spin, free
    // ones do. Tolerance: rounding.
    RevState state = make_state({Vector::Zero()}, 1.);
    state.cell.edges << 2., 0.5, 0., 0., 1.5, 0.3, 0., 0., 1.;
    const Vector before = state.cell.edges * to_vector(state.grains.place[0]);
    MotionRule rule;
    const Kinetics kinetics{1., 0.5, 0.25};
    const Forces forces = make_forces(1, {1., -2., 3., 0.});
    const double way = advance(state, forces, kinetics, rule);
    const Vector step = state.cell.edges * to_vector(state.grains.place[0]) - before;
    EXPECT_LT((step - 0.0625 * Vector(1., -2., 3.)).norm(), 1e-15);
    EXPECT_NEAR(way, 0.0625 * std::sqrt(14.), 1e-15);
    EXPECT_EQ(to_vector(state.grains.spin[0]), Vector::Zero());
    rule.is_rotation_free = true;
    advance(state, forces, kinetics, rule);
    EXPECT_LT((to_vector(state.grains.spin[0]) - 0.5 * Vector(1., -2., 3.)).norm(), 1e-15);
  }

  TEST(Motion, TrueTimeStepIsTheShareOfTheCriticalOne)
  {
    // Law: dt = share min sqrt(2 m / sum kn), the moments of inertia included when grains turn; m = 4/3 pi rho r^3,
    // I = 2/5 m r^2. Tolerance: rounding.
    RevState state = make_state({Vector::Zero(), Vector::Zero()}, 1.);
    state.grains.place[1].w = 0.5 * radius;
    update_true_masses(state.grains, 2650.);
    const double mass = 4. / 3. * std::numbers::pi * 2650. * std::pow(radius, 3);
    EXPECT_NEAR(state.grains.velocity[0].w, mass, 1e-14 * mass);
    EXPECT_NEAR(state.grains.spin[0].w, 0.4 * mass * radius * radius, 1e-14 * mass * radius * radius);

    MotionRule rule;
    rule.has_true_masses = true;
    rule.time_step_share = 0.3;
    Forces forces = make_forces(2, {0., 0., 0., 1e6});
    forces.on_grains.torque(0).w = 1e3 * radius * radius * 1e6;
    Kinetics kinetics;
    update_kinetics(kinetics, rule, state.grains, forces, {});
    const double expected = 0.3 * std::sqrt(2. * mass / 8. / 1e6);
    EXPECT_NEAR(kinetics.time_step, expected, 1e-14 * expected);

    rule.is_rotation_free = true;
    forces.on_grains.torque(1).w = 0.;
    update_kinetics(kinetics, rule, state.grains, forces, {});
    const double turning = 0.3 * std::sqrt(2. * 0.4 * mass / 1e9);
    ASSERT_LT(turning, expected);
    EXPECT_NEAR(kinetics.time_step, turning, 1e-14 * turning);
  }

  TEST(Motion, TrueMassesAreThoseBesideTheVelocities)
  {
    // Law: dv = F dt / m, dw = T dt / I, with m and I beside velocity and spin, which stay. Tolerance: rounding.
    RevState state = make_state({Vector::Zero()}, 1.);
    state.grains.velocity[0] = {0., 0., 0., 4.};
    state.grains.spin[0] = {0., 0., 0., 0.5};
    MotionRule rule;
    rule.has_true_masses = rule.is_rotation_free = true;
    advance(state, make_forces(1, {1., -2., 3., 7.}), {100., 100., 0.25}, rule);
    EXPECT_LT((to_vector(state.grains.velocity[0]) - 0.0625 * Vector(1., -2., 3.)).norm(), 1e-16);
    EXPECT_LT((to_vector(state.grains.spin[0]) - 0.5 * Vector(1., -2., 3.)).norm(), 1e-15);
    EXPECT_EQ(state.grains.velocity[0].w, 4.);
    EXPECT_EQ(state.grains.spin[0].w, 0.5);
  }

  TEST(Motion, ScaledMassesFollowTheStiffness)
  {
    // Law: m = sum of kn (dt = 1 cycle), at least a fifth of the mean over the grains; likewise moments of inertia; no
    // contact at all gives a mass of 1. Tolerance: rounding.
    RevState state = make_state({Vector::Zero(), Vector::Zero()}, 1.);
    Forces forces = make_forces(2, {1., 0., 0., 3e6});
    forces.on_grains.force(1).w = forces.on_grains.torque(1).w = 0.;
    ContactSums sums;
    sums.stiffness = sums.turning_stiffness = 3e6;
    MotionRule rule;
    rule.is_rotation_free = true;
    Kinetics kinetics;
    update_kinetics(kinetics, rule, state.grains, forces, sums);
    EXPECT_EQ(kinetics.time_step, 1.);
    advance(state, forces, kinetics, rule);
    for (const auto *velocity : {&state.grains.velocity, &state.grains.spin})
      {
        EXPECT_DOUBLE_EQ((*velocity)[0].x, 1. / 3e6);
        EXPECT_DOUBLE_EQ((*velocity)[1].x, 1. / (0.2 * 1.5e6));
      }
    update_kinetics(kinetics, rule, state.grains, forces, {});
    EXPECT_EQ(kinetics.smallest_mass, 1.);
    EXPECT_EQ(kinetics.smallest_inertia, 1.);
  }

  struct Oscillation
  {
    double largest_drift; // of the energy over its part that moves, between the first and the last periods
    int n_periods;
  };

  /** Energy of a column of three grains whose middle one swings, undamped, no friction, true masses [J]. */
  Oscillation swing(const double time_step_share, const int n_cycles)
  {
    RevState state = make_column(1e-2 * radius);
    GrainMaterial material;
    material.friction = 0.;
    const ContactLaw law = make_contact_law(material);
    DynamicsRule rule;
    rule.motion.has_true_masses = true;
    rule.motion.local_damping = 0.;
    rule.motion.time_step_share = time_step_share;
    Dynamics dynamics(state, law, rule);
    const double at_rest = 3. * compute_stored_energy(law, 1e-2 * radius, 0.5 * radius);
    state.grains.place[1].z += 3e-3 * radius / state.cell.edges(2, 2);
    dynamics.compute_forces(); // the one and only choice of the time step

    double first = 0., largest = 0.;
    int n_turns = 0;
    for (int cycle = 0; cycle < n_cycles; ++cycle)
      {
        const std::vector<Row> before(state.grains.velocity.begin(), state.grains.velocity.end());
        double stored = 0.;
        for (const auto &[a, b] : {std::pair{0, 1}, {1, 2}, {2, 0}})
          {
            const double distance = compute_branch(state.cell, state.grains.place[a], state.grains.place[b]).norm();
            stored += compute_stored_energy(law, 2. * radius - distance, 0.5 * radius);
          }
        dynamics.move();
        dynamics.strain(Matrix::Zero());
        double kinetic = 0.; // at the time of the places: between two half steps
        for (int i = 0; i < 3; ++i)
          kinetic += 0.5 * before[i].w * std::pow(0.5 * (before[i].z + state.grains.velocity[i].z), 2);
        n_turns += before[1].z * state.grains.velocity[1].z < 0. ? 1 : 0;
        const double energy = kinetic + stored - at_rest;
        if (cycle == 1)
          first = energy;
        if (cycle > 0)
          largest = std::max(largest, std::abs(energy / first - 1.));
        dynamics.compute_forces();
      }
    return {largest, n_turns / 2};
  }

  TEST(Motion, UndampedGrainsKeepTheirEnergy)
  {
    // Law: leapfrog is symplectic: kinetic and stored energy together stay within a band as narrow as the square of the
    // time step, over many periods. Bound: (omega dt)^2 / 4 of the energy that moves, with omega dt <= 2 share.
    const Oscillation coarse = swing(0.1, 8000), fine = swing(0.05, 16000);
    EXPECT_GT(coarse.n_periods, 100);
    EXPECT_LT(coarse.largest_drift, 0.01);
    EXPECT_NEAR(fine.largest_drift / coarse.largest_drift, 0.25, 0.05);
    EXPECT_LT(swing(0.05, 160000).largest_drift, 1.1 * fine.largest_drift); // ten times as long: no drift
  }
} // namespace

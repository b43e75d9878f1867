// The shear force of the hot loop: growth, cap, loss, what moves it and what only turns it.

#include "dem/contact_forces.h"

#include "tests/support/rev_cases.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include <cmath>
#include <numbers>

namespace
{
  using namespace dem;
  using namespace dem::cases;

  constexpr double overlap = 2e-2 * radius;

  /** Two grains in contact whose motion is prescribed step by step. */
  struct PairTest
  {
    ContactLaw law = make_contact_law(GrainMaterial{});
    RevState state;
    ContactNetwork network;
    Forces forces;
    Motion motion;

    explicit PairTest(const Vector &direction = Vector::UnitX())
        : state(make_pair(overlap, direction)), network(build_contact_network(state, radius))
    {}

    void compute() { compute_contact_forces(state, law, motion, network, forces); }
    Vector shear() const { return network.get_shear(0); }
    NormalResponse normal() const { return compute_normal_response(law, overlap, 0.5 * radius); }
    void set_velocity(const std::size_t i, const Vector &v)
    {
      state.grains.velocity[i] = {v.x(), v.y(), v.z(), state.grains.velocity[i].w};
    }
    void set_spins(const Vector &w)
    {
      for (Row &spin : state.grains.spin)
        spin = {w.x(), w.y(), w.z(), spin.w};
    }
  };

  /** Shear force that starts a test [N], well below friction. */
  Vector make_shear(const PairTest &test, const Vector &direction)
  {
    return 0.3 * test.law.friction * test.normal().force * direction;
  }

  TEST(ShearForce, WhatLiesAlongTheNormalNeverGrows)
  {
    // Law: a shear force is turned into the contact plane with its size kept. One along the normal, as rounding leaves
    // it in a contact that bears no shear, has nowhere to be turned to: whatever becomes of it is not larger than it
    // was. Sizes from rounding to that of friction; directions at random, so that the part in the plane is of either
    // sign.
    for (int i = 0; i < 200; ++i)
      for (const double size : {1e-29, 1e-17, 1e-6, 1e-2})
        {
          const Vector normal = Vector(std::cos(1. + i), std::sin(2. + 3. * i), std::cos(0.7 * i)).normalized();
          PairTest test(normal);
          test.network.set_shear(0, size * normal, PairStatus::sticks);
          test.compute();
          EXPECT_LE(test.shear().norm(), size);
        }
  }

  TEST(ShearForce, GrowsByTangentialStiffnessTimesDisplacement)
  {
    // Law: t on a = kt (v_b - v_a) dt in the contact plane, kt = 2(1 - nu)/(2 - nu) kn; the part along n does not
    // count. Tolerance: the overlap's rounding, 1e-14 relative of the radius, in kn.
    PairTest test;
    test.motion.time_step = 0.5;
    test.set_velocity(1, Vector(3e-9, 2e-9, -1e-9));
    test.set_velocity(0, Vector(-1e-9, 1e-9, 0.));
    test.compute();
    const double kt = 2. * (1. - 0.19) / (2. - 0.19) * test.normal().stiffness;
    const Vector expected = kt * 0.5 * Vector(0., 1e-9, -1e-9);
    EXPECT_LT((test.shear() - expected).norm(), 1e-11 * expected.norm());
    EXPECT_EQ(test.network.status[0], PairStatus::sticks);
    const Vector force = to_vector(test.forces.on_grains.force(0));
    EXPECT_LT((force - (expected - test.normal().force * Vector::UnitX())).norm(), 1e-11 * force.norm());
  }

  TEST(ShearForce, IsCappedByFrictionAndKeepsItsDirection)
  {
    // Law: |t| <= mu N; a contact at the cap slides, one that turns back sticks. Tolerance: rounding, 1e-11 of N.
    PairTest test;
    test.set_velocity(1, Vector(0., 3e-3 * radius, -4e-3 * radius));
    for (int k = 0; k < 5; ++k)
      test.compute();
    const double cap = 0.275 * test.normal().force;
    EXPECT_LT((test.shear() - cap * Vector(0., 0.6, -0.8)).norm(), 1e-11 * cap);
    EXPECT_EQ(test.network.status[0], PairStatus::slides);
    test.set_velocity(1, -1e-6 * radius * Vector(0., 0.6, -0.8));
    test.compute();
    EXPECT_LT(test.shear().norm(), cap * (1. - 1e-6));
    EXPECT_EQ(test.network.status[0], PairStatus::sticks);
  }

  TEST(ShearForce, IsLostWhenTheContactOpens)
  {
    // Law: a contact that opens forgets; closed again it begins at zero.
    PairTest test;
    test.network.set_shear(0, make_shear(test, Vector::UnitY()), PairStatus::sticks);
    const Row place = test.state.grains.place[1];
    test.state.grains.place[1].x += 0.01;
    test.compute();
    EXPECT_EQ(test.network.status[0], PairStatus::is_apart);
    test.state.grains.place[1] = place;
    test.compute();
    EXPECT_EQ(test.shear(), Vector::Zero());
    EXPECT_EQ(test.network.status[0], PairStatus::sticks);
  }

  /** Shear after small steps of a simple shear dx = gamma y, by the cell or by the grains' own velocities. */
  Vector strain_pair(const bool by_the_cell)
  {
    PairTest test(Vector(0., 0.6, 0.8));
    constexpr int n = 10;
    Matrix increment = Matrix::Zero();
    increment(0, 1) = 2e-6;
    increment(2, 2) = -1e-6;
    for (int k = 0; k < n; ++k)
      {
        if (by_the_cell)
          {
            test.state.cell.deform(Matrix::Identity() + increment);
            test.motion.strain_increment = increment;
          }
        else
          for (std::size_t i = 0; i < 2; ++i)
            {
              const double edge = test.state.cell.edges(0, 0);
              const Vector place = edge * to_vector(test.state.grains.place[i]);
              const Vector step = increment * (place - Vector::Constant(0.5 * edge));
              test.set_velocity(i, step);
              const Vector next = (place + step) / edge;
              test.state.grains.place[i] = {next.x(), next.y(), next.z(), radius};
            }
        test.compute();
      }
    return test.shear();
  }

  TEST(ShearForce, FeelsTheCellsStrainAsItFeelsVelocities)
  {
    // Law: the relative displacement at a contact is (v_b - v_a) dt + L dt (x_b - x_a): a contact that the cell shears
    // and one whose grains move likewise end with the same shear force. Tolerance: the increment acts on the branch at
    // the end of the step in one and at its beginning in the other, 1e-6 relative.
    const Vector by_cell = strain_pair(true), by_velocity = strain_pair(false);
    ASSERT_GT(by_velocity.norm(), 1e-4);
    EXPECT_LT((by_cell - by_velocity).norm(), 1e-5 * by_velocity.norm());
  }

  constexpr double degree = std::numbers::pi / 180.;

  /** Force of a shear displacement as long as the branch, over the shear force that a test starts with [-]. */
  double compute_branch_force()
  {
    const PairTest test;
    const NormalResponse normal = test.normal();
    return test.law.shear_ratio * normal.stiffness * (2. * radius - overlap) / (0.3 * test.law.friction * normal.force);
  }

  struct Turned
  {
    double error; // of the shear force against R t0, over |t0|
  };

  /** Turns two touching, stuck grains rigidly with their spins and looks at their shear force. */
  Turned turn_pair(const double angle, const Vector &axis, const int n_steps)
  {
    const Vector branch = Vector::UnitX();
    PairTest test(branch);
    test.motion.is_rotation_free = true;
    test.network.set_shear(0, make_shear(test, Vector::UnitY()), PairStatus::sticks);
    const Vector before = test.shear();
    const Vector middle = Vector::Constant(0.5 * test.state.cell.edges(0, 0));
    test.set_spins(angle / n_steps * axis);
    for (int k = 1; k <= n_steps; ++k)
      {
        const Vector half = Eigen::AngleAxisd(angle * k / n_steps, axis) * ((radius - 0.5 * overlap) * branch);
        for (int i = 0; i < 2; ++i)
          {
            const Vector place = (middle + (i == 0 ? -1. : 1.) * half) / test.state.cell.edges(0, 0);
            const Vector step =
                test.state.cell.edges * (place - to_vector(test.state.grains.place[i])); // exact chord of the turn
            test.set_velocity(i, step);
            test.state.grains.place[i] = {place.x(), place.y(), place.z(), radius};
          }
        test.compute();
      }
    const Vector expected = Eigen::AngleAxisd(angle, axis) * before;
    return {(test.shear() - expected).norm() / before.norm()};
  }

  TEST(ShearForce, TurnsWithAPairThatTurnsInAPlaneThroughItsBranch)
  {
    // Law: objectivity. Turned by R up to 60 degrees about an axis across the branch, t becomes R t and keeps its size.
    // A step of angle h moves the contact by the chord, sin h branches along the new contact plane, and its spins by h:
    // an error of (h - sin h) branches a step, as a force over t. Tolerance: rounding, 1e-16 of h against
    // h^3/6 with h no less than 2e-4 rad, and room.
    for (const double angle : {10. * degree, 60. * degree})
      for (const int n_steps : {500, 1000})
        {
          const double step = angle / n_steps;
          const double foretold = n_steps * (step - std::sin(step)) * compute_branch_force();
          EXPECT_NEAR(turn_pair(angle, Vector::UnitZ(), n_steps).error, foretold, 1e-6 * foretold);
        }
  }

  TEST(ShearForce, TurnsWithAPairThatTurnsAboutAnyAxis)
  {
    // Law: objectivity, about the branch itself and askew. Spins are taken with the normal at the end of the step, so a
    // step errs by its square and the whole in proportion to the step, half as much with half the step. Bound: angle
    // step / 2 branches, as a force over t; about the branch alone only |t| errs, by angle step / 2.
    for (const Vector &axis : {Vector(1., 0., 0.), Vector(1., -2., 0.5).normalized()})
      for (const double angle : {10. * degree, 60. * degree})
        {
          const double along = axis.x(), across = std::sqrt(1. - along * along);
          const Turned coarse = turn_pair(angle, axis, 4000), fine = turn_pair(angle, axis, 8000);
          const double bound = 0.5 * angle * angle / 4000. * (along * along + along * across * compute_branch_force());
          EXPECT_LT(coarse.error, 1.01 * bound);
          EXPECT_NEAR(fine.error / coarse.error, 0.5, 0.01);
        }
  }

  TEST(ShearForce, RollingWithoutSlipMovesNoShear)
  {
    // Law: grains that roll on each other like gears have no relative velocity at their contact. Tolerance: rounding of
    // products that cancel.
    PairTest test;
    test.motion.is_rotation_free = true;
    test.state.grains.spin[0].z = 1e-3;
    test.state.grains.spin[1].z = -1e-3;
    test.compute();
    EXPECT_LT(test.shear().norm(), 1e-12 * test.normal().stiffness * 1e-3 * radius);
  }

  TEST(ShearForce, TorquesBalanceTheForces)
  {
    // Law: a contact makes no moment about any point: both torques and the couple of the forces cancel. Lever arms are
    // R - d/2, also of unequal grains. Tolerance: rounding.
    PairTest test(Vector(1., 2., -2.) / 3.);
    test.motion.is_rotation_free = true;
    test.state.grains.place[1].w = 1.2 * radius;
    test.state.grains.spin[0] = {1e-4, 2e-4, -1e-4, 1.};
    test.set_velocity(1, Vector(1e-4, 3e-4, 2e-4) * radius);
    test.compute();
    ASSERT_GT(test.shear().norm(), 0.);
    const Vector branch = compute_branch(test.state.cell, test.state.grains.place[0], test.state.grains.place[1]);
    const Vector moment = to_vector(test.forces.on_grains.torque(0)) + to_vector(test.forces.on_grains.torque(1)) +
                          branch.cross(to_vector(test.forces.on_grains.force(1)));
    EXPECT_LT(moment.norm(), 1e-13 * branch.norm() * test.shear().norm());
    const double arm = radius - 0.5 * (2.2 * radius - branch.norm());
    EXPECT_NEAR(to_vector(test.forces.on_grains.torque(0)).norm(), arm * test.shear().norm(),
                1e-12 * arm * test.shear().norm());
  }
} // namespace

// Single precision: the same law as in double within what floats can hold, and a state that loses nothing.

#include "dem/single_dynamics.h"
#include "dem/single_power.h"
#include "tests/support/rev_cases.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace
{
  using namespace dem;
  using namespace dem::cases;

  constexpr double unit = 0x1p-24; // what rounding to float takes at most, relative

  Vector draw_direction(std::mt19937_64 &random)
  {
    std::normal_distribution<double> normal;
    return Vector(normal(random), normal(random), normal(random)).normalized();
  }

  /** Pairs far from each other, each overlapping as told, at whole counts. */
  RevState make_pairs(const std::vector<double> &overlaps, std::mt19937_64 &random)
  {
    std::uniform_real_distribution<double> size(0.4, 1.);
    std::vector<Vector> places;
    std::vector<double> radii;
    for (std::size_t k = 0; k < overlaps.size(); ++k)
      {
        const Vector middle = 8. * radius * Vector(0.5 + k % 7, 0.5 + k / 7 % 7, 0.5 + k / 49 % 7);
        const double a = size(random) * radius, b = size(random) * radius;
        const Vector direction = draw_direction(random);
        places.push_back(middle - a * direction);
        places.push_back(middle + (b - overlaps[k]) * direction);
        radii.insert(radii.end(), {a, b});
      }
    RevState state = make_state(places, 8. * radius * 7.);
    for (std::size_t i = 0; i < radii.size(); ++i)
      state.grains.place[i].w = radii[i];
    round_places(state.grains);
    return state;
  }

  TEST(SinglePower, AgreesWithTheLibrary)
  {
    // Law: x^y over the overlaps (in units of a stage's length) and exponents that contact laws use. Tolerance: the two
    // polynomials and the last steps of 2^z round to a few units each.
    std::mt19937_64 random(1);
    std::uniform_real_distribution<float> decade(-12.f, 3.f), exponent(1.f, 3.f);
    for (int i = 0; i < 300000; ++i)
      {
        const float x = std::pow(10.f, decade(random)), y = exponent(random);
        const Singles power = compute_power(Singles(x), Singles(y));
        const double expected = std::pow(static_cast<double>(x), static_cast<double>(y));
        ASSERT_NEAR(power.v[i % n_singles] / expected, 1., 8. * unit) << x << "^" << y;
      }
    EXPECT_EQ(compute_power(Singles(1.f), Singles(2.7f)).v[0], 1.f);
  }

  /** N and kn of each pair by the single precision loop against the reference law at the same overlap. */
  void expect_reference(const ContactLaw &law, const std::vector<double> &overlaps, const bool is_rotation_free)
  {
    std::mt19937_64 random(4);
    const RevState state = make_pairs(overlaps, random);
    ContactNetwork network = build_contact_network(state, 0.1 * radius);
    SingleDynamics single;
    Team alone(1);
    single.load(state, network, alone);
    Motion motion;
    motion.is_rotation_free = is_rotation_free;
    Forces forces;
    const ContactSums sums = single.compute_forces({state, law, motion}, network, forces, alone);
    single.write_forces(forces);
    ASSERT_EQ(sums.n_touching, overlaps.size());
    for (std::size_t k = 0; k < overlaps.size(); ++k)
      {
        const Row &a = state.grains.place[2 * k], &b = state.grains.place[2 * k + 1];
        const Vector branch = compute_branch(state.cell, a, b);
        const double overlap = a.w + b.w - branch.norm();
        const NormalResponse expected = compute_normal_response(law, overlap, compute_effective_radius(a.w, b.w));
        // Some twenty roundings of force and stiffness, and an overlap rounded by half a unit, times the exponent; next
        // to the end of a stage the overlap less d1 or d1 + d2 is rounded as the overlap is.
        const double depth = overlap > law.dT2   ? overlap - law.d1 - law.d2
                             : overlap > law.dT1 ? overlap - law.d1
                                                 : overlap;
        const double tolerance = (20. + 6. * overlap / depth) * unit;
        EXPECT_NEAR(to_vector(forces.on_grains.force(2 * k)).norm() / expected.force, 1., tolerance) << overlap;
        EXPECT_NEAR(forces.on_grains.force(2 * k).w / expected.stiffness, 1., tolerance) << overlap;
        EXPECT_LT(to_vector(forces.on_grains.force(2 * k)).dot(branch), 0.); // pushed apart
        EXPECT_EQ(forces.on_grains.force(2 * k + 1).x, -forces.on_grains.force(2 * k).x);
      }
  }

  TEST(SinglePrecision, FastLawIsTheReferenceLaw)
  {
    // Law: N and kn of Hertz and of all stages of the three-stage contact, for 300 pairs of unequal grains.
    for (const double n1 : {0., 0.05, 0.82, 2.})
      {
        GrainMaterial material;
        material.n1 = n1;
        if (n1 == 0.)
          material.roughness = 0.;
        const ContactLaw law = make_contact_law(material);
        std::mt19937_64 random(1);
        std::uniform_real_distribution<double> share(0.1, 2.);
        const double first = n1 == 0. ? 1e-3 * radius : law.dT1, second = n1 == 0. ? 1e-2 * radius : law.dT2;
        std::vector<double> overlaps;
        while (overlaps.size() < 300)
          overlaps.push_back(share(random) * (overlaps.size() % 2 == 0 ? first : second));
        for (const bool is_rotation_free : {false, true})
          expect_reference(law, overlaps, is_rotation_free);
      }
  }

  Dynamics make_dynamics(RevState &state, const ContactLaw &law, const Precision precision, const std::size_t n_threads,
                         const bool is_rotation_free)
  {
    DynamicsRule rule;
    rule.precision = precision;
    rule.n_threads = n_threads;
    rule.motion.has_true_masses = true;
    rule.motion.local_damping = 0.;
    rule.motion.is_rotation_free = is_rotation_free;
    return Dynamics(state, law, rule);
  }

  TEST(SinglePrecision, OverlapsFollowGrainsAndCell)
  {
    // Law: the overlap is that when the network was built plus its change: after grains and cell have moved by half the
    // skin, forces are those of a network built then. Tolerance: the change is rounded a few times, relative to the
    // overlap, and carries the exponent 1.5; one edge's count over the overlap comes on top for the second rounding.
    const GrainMaterial smooth{.roughness = 0.};
    const ContactLaw law = make_contact_law(smooth);
    std::mt19937_64 random(7);
    RevState state = make_pairs(std::vector<double>(200, 5e-3 * radius), random);
    ContactNetwork network = build_contact_network(state, 0.2 * radius);
    SingleDynamics single;
    Team alone(1);
    single.load(state, network, alone);
    std::uniform_real_distribution<double> speed(-1., 1.);
    for (Row &velocity : state.grains.velocity)
      velocity = {speed(random), speed(random), speed(random), velocity.w};
    single.load(state, network, alone);
    const Kinetics kinetics{.time_step = 1e-3 * radius};
    MotionRule rule;
    rule.has_true_masses = true;
    const std::vector<TwinRow> no_forces(state.grains.size());
    for (const GrainBlock &block : network.blocks)
      single.move(block, {state.cell, no_forces.data(), kinetics, rule});
    state.cell.deform(Matrix::Identity() + 1e-3 * Matrix::Random());
    single.write_grains(network, state.grains);

    Forces forces, expected;
    const ForceTask task{state, law, Motion{}};
    single.compute_forces(task, network, forces, alone);
    single.write_forces(forces);
    ContactNetwork fresh = build_contact_network(state, 0.1 * radius);
    compute_contact_forces(task, fresh, expected, alone);
    for (std::size_t i = 0; i < forces.on_grains.size(); ++i)
      {
        const double scale = to_vector(expected.on_grains.force(i)).norm();
        EXPECT_LT((to_vector(forces.on_grains.force(i)) - to_vector(expected.on_grains.force(i))).norm(),
                  40. * unit * scale)
            << i;
      }
  }

  Matrix make_compression()
  {
    Matrix increment = Matrix::Zero();
    increment(2, 2) = -1e-5;
    return increment;
  }

  /** Edges do not stay along the axes. */
  Matrix make_shear()
  {
    Matrix increment = make_compression();
    increment(0, 2) = 1e-4;
    return increment;
  }

  /** Some cycles of a packing of several blocks. */
  RevState strain(const RevState &start, const Precision precision, const std::size_t n_threads,
                  const bool is_rotation_free, const Matrix &increment)
  {
    RevState state = start;
    update_true_masses(state.grains, 2650.);
    const ContactLaw law = make_contact_law(GrainMaterial{});
    Dynamics dynamics = make_dynamics(state, law, precision, n_threads, is_rotation_free);
    for (int cycle = 0; cycle < 60; ++cycle)
      {
        cycle % 10 == 0 ? dynamics.compute_forces() : dynamics.compute_forces_and_move(true);
        if (cycle % 10 == 0)
          dynamics.move();
        dynamics.strain(increment);
      }
    dynamics.compute_forces();
    dynamics.store();
    return state;
  }

  /** The loaded packing beside itself: more than two blocks. */
  RevState make_large_state()
  {
    const RevState &small = get_loaded_state();
    const int n = 3;
    RevState large;
    large.cell.edges = n * small.cell.edges;
    large.resize_grains(n * n * n * small.grains.size());
    for (std::size_t i = 0; i < large.grains.size(); ++i)
      {
        const std::size_t from = i % small.grains.size(), copy = i / small.grains.size();
        large.grains.assign(i, small.grains, from);
        large.grains.id[i] = i;
        const Vector shift(copy % n, copy / n % n, copy / n / n);
        const Vector place = (to_vector(small.grains.place[from]) + shift) / n;
        large.grains.place[i] = {place.x(), place.y(), place.z(), small.grains.place[from].w};
      }
    return large;
  }

  TEST(SinglePrecision, DoesNotDependOnTheNumberOfThreads)
  {
    // Law: results do not depend on the number of threads, bit by bit; grains free to turn and blocked.
    const RevState start = make_large_state();
    ASSERT_GT(start.grains.size(), undivided_grains);
    for (const bool is_rotation_free : {false, true})
      {
        const RevState alone = strain(start, Precision::single, 1, is_rotation_free, make_compression());
        const RevState two = strain(start, Precision::single, 2, is_rotation_free, make_compression());
        EXPECT_TRUE(are_equal_bits(two, alone));
      }
  }

  TEST(SinglePrecision, StressIsThatOfDouble)
  {
    // Law: stress after straining is that of double precision to 1e-4, the bound that single precision is offered with;
    // along the axes of the cell, and in a cell that does not keep its edges along them.
    const RevState start = make_large_state();
    for (const Matrix &increment : {make_compression(), make_shear()})
      {
        const Matrix expected = strain(start, Precision::full, 1, true, increment).stress;
        const Matrix stress = strain(start, Precision::single, 1, true, increment).stress;
        EXPECT_LT((stress - expected).norm(), 1e-4 * expected.norm());
        EXPECT_GT((stress - expected).norm(), 0.); // another computation
      }
  }

  TEST(SinglePrecision, ARestoredStateRepeatsEveryBit)
  {
    // Law: a state stored and read again answers as the one that was never stored; so does a question asked twice.
    RevModel model;
    model.dynamics.precision = Precision::single;
    Rev rev(model, get_loaded_state());
    ASSERT_EQ(rev.control(make_oedometer(10.5e6)).status, RestStatus::at_rest);
    EXPECT_NEAR(rev.get_trial().stress(2, 2), -10.5e6, 2e-3 * 10.5e6);
    rev.accept();
    Rev restored(model, deserialise(serialise(rev.get_baseline())));
    rev.control(make_oedometer(11e6));
    const RevState first = rev.get_trial();
    rev.control(make_oedometer(11e6));
    EXPECT_TRUE(are_equal_bits(rev.get_trial(), first));
    restored.control(make_oedometer(11e6));
    EXPECT_TRUE(are_equal_bits(restored.get_trial(), first));
  }

  TEST(SinglePrecision, KeepsPlacesToTheLastCount)
  {
    // Law: rounding places moves them by half a count at most, and then nothing but motion moves them.
    RevState state = get_loaded_state();
    const RevState before = state;
    round_places(state.grains);
    const RevState rounded = state;
    for (std::size_t i = 0; i < state.grains.size(); ++i)
      EXPECT_LE((to_vector(state.grains.place[i]) - to_vector(before.grains.place[i])).cwiseAbs().maxCoeff(), 0x1p-33);
    round_places(state.grains);
    EXPECT_TRUE(are_equal_bits(state, rounded));
    ContactNetwork network = build_contact_network(state, 0.1 * radius);
    SingleDynamics single;
    Team alone(1);
    single.load(state, network, alone);
    single.write_grains(network, state.grains);
    EXPECT_TRUE(are_equal_bits(state, rounded));
  }

  /** Kinetic plus stored energy [J]; velocities half a step behind the places, as the leapfrog has them. */
  double compute_energy(const RevState &state, const ContactLaw &law)
  {
    double energy = 0.;
    for (const Row &velocity : state.grains.velocity)
      energy += 0.5 * velocity.w * to_vector(velocity).squaredNorm();
    for (const Contact &contact : list_contacts(state, law))
      energy += compute_stored_energy(law, contact.overlap, contact.effective_radius);
    return energy;
  }

  TEST(SinglePrecision, KeepsEnergyAsDoubleDoes)
  {
    // Law: without friction and damping, energy is kept; what single precision loses of it in 200 cycles stays below
    // 1e-5, a tenth of what the time step costs (docs/performance.md, Single precision).
    const ContactLaw law = make_contact_law(GrainMaterial{.friction = 0.});
    const auto run = [&law](const Precision precision) {
      RevState state = make_large_state();
      update_true_masses(state.grains, 2650.);
      Dynamics dynamics = make_dynamics(state, law, precision, 1, false);
      dynamics.compute_forces();
      dynamics.move();
      for (int cycle = 0; cycle < 200; ++cycle)
        {
          dynamics.strain(Matrix::Zero());
          dynamics.compute_forces_and_move(true);
        }
      dynamics.strain(Matrix::Zero());
      dynamics.compute_forces();
      dynamics.store();
      return compute_energy(state, law);
    };
    const double expected = run(Precision::full);
    EXPECT_NEAR(run(Precision::single) / expected, 1., 1e-5);
  }

  TEST(SinglePrecision, WhatIsNoNumberIsNoticed)
  {
    // Law: whole counts are always numbers, so velocities must tell that a grain is nowhere.
    RevState state = get_loaded_state();
    update_true_masses(state.grains, 2650.);
    state.grains.velocity[3].x = std::numeric_limits<double>::quiet_NaN();
    const ContactLaw law = make_contact_law(GrainMaterial{});
    Dynamics dynamics = make_dynamics(state, law, Precision::single, 1, false);
    dynamics.compute_forces();
    EXPECT_FALSE(dynamics.is_finite());
  }

  TEST(SinglePrecision, WallsAreRefused)
  {
    // Law: what is not computed is refused, not computed otherwise.
    RevState state = get_walled_packing().state;
    const ContactLaw law = make_contact_law(GrainMaterial{});
    DynamicsRule rule;
    rule.precision = Precision::single;
    EXPECT_THROW(Dynamics(state, law, rule), std::invalid_argument);
  }
} // namespace

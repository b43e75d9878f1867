// Motion in single precision: the step of double precision within what floats can hold.

#include "dem/single_motion.h"
#include "tests/support/rev_cases.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace
{
  using namespace dem;
  using namespace dem::cases;

  constexpr double unit = 0x1p-24; // what rounding to float takes at most, relative
  constexpr double count = 0x1p-32;

  /** Grains that move and turn under forces, some of which are zero; numbers that floats can hold. */
  struct Moving
  {
    RevState state;
    ForceTable forces;
    std::vector<TwinRow> rows;

    Moving(const std::size_t n, const bool is_upright)
        : state(make_state(std::vector<Vector>(n, Vector::Constant(radius)), 40. * radius)), rows(n)
    {
      forces.resize(n, true);
      std::mt19937_64 random(11);
      std::uniform_real_distribution<double> share(-1., 1.);
      const auto draw = [&](const double scale) {
        const double x = scale * share(random);
        return std::abs(x) < 0.1 * scale ? 0. : static_cast<double>(static_cast<float>(x));
      };
      for (std::size_t i = 0; i < n; ++i)
        {
          state.grains.place[i].w = static_cast<float>(radius * (1. + 0.5 * share(random)));
          state.grains.velocity[i] = {draw(1e-6), draw(1e-6), draw(1e-6), 0.};
          state.grains.spin[i] = {draw(1e-2), draw(1e-2), draw(1e-2), 0.};
          forces.force(i) = {draw(1.), draw(1.), draw(1.), std::abs(draw(1e6)) + 1e4};
          forces.torque(i) = {draw(1e-4), draw(1e-4), draw(1e-4), std::abs(draw(1e-2)) + 1e-4};
          rows[i] = {to_single(forces.force(i)), to_single(forces.torque(i))};
        }
      update_true_masses(state.grains, 2650.);
      if (!is_upright)
        state.cell.deform(Matrix::Identity() + 0.1 * Matrix::Random());
      round_places(state.grains);
    }

    static SingleRow to_single(const Row &row)
    {
      return {static_cast<float>(row.x), static_cast<float>(row.y), static_cast<float>(row.z),
              static_cast<float>(row.w)};
    }
  };

  /** Largest difference of two rows' vectors over the largest number of the first. */
  double compare(const Row &expected, const SingleRow &found)
  {
    const Vector e(expected.x, expected.y, expected.z), f(found.x, found.y, found.z);
    return (e - f).cwiseAbs().maxCoeff() / e.cwiseAbs().maxCoeff();
  }

  void expect_step_of_double(Moving moving, const Kinetics &kinetics, const MotionRule &rule)
  {
    const std::size_t n = moving.state.grains.size();
    const RevState before = moving.state;
    SingleGrains single;
    single.load(moving.state.grains);
    const double reach = advance_singles(single, 0, n, {moving.state.cell, moving.rows.data(), kinetics, rule});
    const double expected =
        advance_grains(moving.state.grains, 0, n, {moving.state.cell, moving.forces.get_rows(), kinetics, rule});
    // Some ten roundings: the mass, its inverse (two), the time step, damping (two), their products, the sum.
    EXPECT_NEAR(reach, expected, 10. * unit * expected);
    for (std::size_t i = 0; i < n; ++i)
      {
        EXPECT_LT(compare(moving.state.grains.velocity[i], single.motion[i].linear), 10. * unit) << i;
        EXPECT_LT(compare(moving.state.grains.spin[i], single.motion[i].angular), 10. * unit) << i;
        const Vector step = to_vector(moving.state.grains.place[i]) - to_vector(before.grains.place[i]);
        const Vector counts(single.counts[i].x, single.counts[i].y, single.counts[i].z);
        ASSERT_GT(step.norm(), 1e4 * count); // in a skewed cell three products add up: three roundings more
        EXPECT_LT((counts - step / count).cwiseAbs().maxCoeff(), 0.5 + 13. * unit * step.norm() / count) << i;
        EXPECT_EQ(single.counts[i].mass, static_cast<float>(before.grains.velocity[i].w));
        EXPECT_EQ(single.motion[i].linear.w, static_cast<float>(before.grains.place[i].w));
        EXPECT_EQ(single.motion[i].angular.w, static_cast<float>(before.grains.spin[i].w));
      }
  }

  TEST(SingleMotion, IsTheStepOfDouble)
  {
    // Law: velocities, spins and places after a step are those of double precision; true and scaled masses, damped,
    // in cells along the axes and not, with grains left over from groups of four.
    const MotionRule damped{.is_rotation_free = true, .local_damping = 0.7};
    for (const bool is_upright : {true, false})
      for (const std::size_t n : {1, 4, 11})
        {
          MotionRule rule = damped;
          expect_step_of_double(Moving(n, is_upright), {.smallest_mass = 4e5, .smallest_inertia = 5e-3}, rule);
          rule.has_true_masses = true;
          expect_step_of_double(Moving(n, is_upright), {.time_step = 1e-6}, rule);
        }
  }
} // namespace

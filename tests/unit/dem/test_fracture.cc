#include "dem/fracture.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

namespace
{
  using namespace dem;

  RandomStream make_stream(std::uint64_t grain, Purpose purpose)
  {
    return RandomStream({.seed = 1, .rev = 0, .grain = grain, .purpose = purpose});
  }

  TEST(Strength, ScatterIsThatOfTheTruncatedNormal)
  {
    // Law: f = 1 + var X, |X| <= 2.5: mean 1, standard deviation 0.38 sqrt(1 - 2 k phi(k)/(2 Phi(k) - 1)) = 0.3627.
    // Tolerance: 3 standard errors of 1e5 grains, each with a stream of its own.
    constexpr int n = 100000;
    const StrengthLaw law;
    double sum = 0., squares = 0., fourths = 0.;
    for (int grain = 0; grain < n; ++grain)
      {
        RandomStream stream = make_stream(grain, Purpose::strength);
        const double factor = draw_strength_factor(law, stream);
        ASSERT_GE(factor, 1. - 0.38 * 2.5 - 1e-15);
        ASSERT_LE(factor, 1. + 0.38 * 2.5 + 1e-15);
        sum += factor;
        squares += std::pow(factor - 1., 2);
        fourths += std::pow(factor - 1., 4);
      }
    const double deviation = std::sqrt(squares / n);
    const double error_of_deviation = std::sqrt((fourths / n - std::pow(deviation, 4)) / n) / (2. * deviation);
    RecordProperty("mean", std::to_string(sum / n));
    RecordProperty("standard_deviation", std::to_string(deviation));
    EXPECT_NEAR(sum / n, 1., 3. * deviation / std::sqrt(n));
    EXPECT_NEAR(deviation, 0.36275, 3. * error_of_deviation);
  }

  TEST(Strength, MeanFallsWithDiameterAtSlopeMinusThreeOverM)
  {
    // Law: log mean sigma_lim against log d is a line of slope -3/m. Tolerance: 3 standard errors of a least-squares
    // slope over 10 diameters of 1e4 grains.
    constexpr int n_sizes = 10, n_each = 10000;
    const StrengthLaw law;
    std::vector<double> x, y;
    for (int size = 0; size < n_sizes; ++size)
      {
        const double diameter = 0.1e-3 * std::pow(30., size / (n_sizes - 1.));
        double sum = 0.;
        for (int i = 0; i < n_each; ++i)
          {
            RandomStream stream = make_stream(size * n_each + i, Purpose::strength);
            sum += compute_strength(law, diameter, draw_strength_factor(law, stream));
          }
        x.push_back(std::log(diameter));
        y.push_back(std::log(sum / n_each));
      }
    double mean_x = 0., xx = 0., xy = 0.;
    for (const double value : x)
      mean_x += value / n_sizes;
    for (int i = 0; i < n_sizes; ++i)
      {
        xx += (x[i] - mean_x) * (x[i] - mean_x);
        xy += (x[i] - mean_x) * y[i];
      }
    RecordProperty("slope", std::to_string(xy / xx));
    EXPECT_NEAR(xy / xx, -3. / 12., 3. * 0.36275 / std::sqrt(n_each) / std::sqrt(xx));
  }

  TEST(Strength, ReferenceGrainHasTheReferenceStrength)
  {
    // Law: sigma_lim(d0) = sigma_lim0 f; a grain of d0/16 is 16^(3/12) = 2 times as strong. Tolerance: rounding.
    const StrengthLaw law;
    EXPECT_DOUBLE_EQ(compute_strength(law, 2e-3, 1.), 3.75e9);
    EXPECT_DOUBLE_EQ(compute_strength(law, 2e-3 / 16., 0.5), 3.75e9);
  }

  TEST(Strength, LimitForceIsReachedWhereContactStressEqualsStrength)
  {
    // Law: N > F_lim = sigma_lim pi r' d is contact stress > sigma_lim; 0 for tangent grains. Tolerance: rounding.
    const double radius = 0.05e-3, overlap = 2e-6, strength = 6e9;
    const double limit_force = strength * std::numbers::pi * radius * overlap;
    EXPECT_DOUBLE_EQ(compute_contact_stress(limit_force, radius, overlap), strength);
    EXPECT_EQ(compute_contact_stress(0., radius, 0.), 0.);
  }

  TEST(CrackGrowth, VelocityIsAPowerOfStress)
  {
    // Law: log v against log(sigma/sigma_lim) is a line of slope n through v0 at 1. Tolerance: pow errs by n times the
    // rounding of its argument, 60 * 1e-16, and a slope over 0.01 in the logarithm magnifies it a hundredfold.
    for (const double exponent : {20., 60.})
      {
        CharlesLaw law;
        law.exponent = exponent;
        EXPECT_DOUBLE_EQ(compute_crack_velocity(law, 5e9, 5e9), 0.1);
        EXPECT_EQ(compute_crack_velocity(law, 0., 5e9), 0.);
        for (const double ratio : {0.3, 0.6, 0.9})
          {
            const double v = compute_crack_velocity(law, ratio * 5e9, 5e9);
            const double faster = compute_crack_velocity(law, 1.01 * ratio * 5e9, 5e9);
            EXPECT_NEAR(std::log(faster / v) / std::log(1.01), exponent, 1e-10);
          }
      }
  }

  TEST(CrackGrowth, TimeToFractureIsWhatTheCrackHasLeftToGo)
  {
    // Law: growth by v over the time (r - a)/v ends at r, over a ladder of stresses; slope -n in log-log. Tolerance:
    // rounding of a division and a product; the slope as above.
    const CharlesLaw law;
    const double r = 0.1e-3, a = 0.03e-3, strength = 6e9;
    double last_time = 0.;
    for (int step = 0; step < 5; ++step)
      {
        const double v = compute_crack_velocity(law, strength * 0.5 * std::pow(1.1, step), strength);
        const double time = compute_time_to_fracture(r, a, v);
        EXPECT_NEAR(a + v * time, r, 1e-15 * r);
        if (step > 0)
          {
            EXPECT_NEAR(std::log(time / last_time) / std::log(1.1), -60., 1e-10);
          }
        last_time = time;
      }
  }

  TEST(CrackGrowth, TimeToFractureIsNeverNegativeAndNeverNaN)
  {
    // Law: 0 when the crack is through already, infinity when it stands still.
    const double infinity = std::numeric_limits<double>::infinity();
    EXPECT_EQ(compute_time_to_fracture(1., 1., 0.5), 0.);
    EXPECT_EQ(compute_time_to_fracture(1., 1.5, 0.5), 0.);
    EXPECT_EQ(compute_time_to_fracture(1., 1.5, 0.), 0.);
    EXPECT_EQ(compute_time_to_fracture(1., 0.5, 0.), infinity);
    EXPECT_EQ(compute_time_to_fracture(1., 0.5, infinity), 0.);
  }

  TEST(CrackGrowth, InitialCracksAreUniformBetweenTheirBounds)
  {
    // Law: a0 uniform in [0.001 d, 0.5 d]: mean 0.2505 d, variance (0.499 d)^2/12. Tolerance: 3 standard errors.
    constexpr int n = 100000;
    const CharlesLaw law;
    const double d = 0.21e-3, variance = std::pow(0.499, 2) / 12.;
    double sum = 0., squares = 0.;
    for (int grain = 0; grain < n; ++grain)
      {
        RandomStream stream = make_stream(grain, Purpose::crack);
        const double share = draw_initial_crack(law, d, stream) / d;
        ASSERT_GE(share, 0.001);
        ASSERT_LE(share, 0.5);
        sum += share;
        squares += std::pow(share - 0.2505, 2);
      }
    EXPECT_NEAR(sum / n, 0.2505, 3. * std::sqrt(variance / n));
    EXPECT_NEAR(squares / n, variance, 3. * variance * std::sqrt(0.8 / n));
  }
} // namespace

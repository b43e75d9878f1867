#include "dem/grading.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>

namespace
{
  using namespace dem;

  double compute_mean_volume(const std::vector<double> &diameters)
  {
    double volume = 0.;
    for (const double diameter : diameters)
      volume += std::numbers::pi / 6. * std::pow(diameter, 3);
    return volume / static_cast<double>(diameters.size());
  }

  /** Solid volume over number of grains by the midpoint rule on dN = 6/pi dM/d^3: another way than the source's. */
  double integrate_mean_volume(const Grading &grading)
  {
    constexpr int n = 20000;
    double number = 0.;
    for (std::size_t i = 1; i < grading.size(); ++i)
      for (int j = 0; j < n; ++j)
        {
          const double width = grading[i].diameter - grading[i - 1].diameter;
          const double diameter = grading[i - 1].diameter + width * (j + 0.5) / n;
          number += 6. / std::numbers::pi * (grading[i].passing - grading[i - 1].passing) / n / std::pow(diameter, 3);
        }
    return 1. / number;
  }

  StreamKey make_key(std::uint64_t seed)
  {
    return {.seed = seed, .rev = 0, .grain = 0, .purpose = Purpose::diameter};
  }

  TEST(Grading, Ne34HonoursWhatThePaperGives)
  {
    // Law: d50 = 0.21 mm, d_max = 0.27 mm, D10 near 0.15 mm, and 11,497 grains in a 4 mm cube at e = 0.65. The
    // reconstruction is held to 1 % of that count and to 2 % in D10 ("about").
    const Grading grading = make_ne34_grading();
    EXPECT_NO_THROW(check_grading(grading));
    EXPECT_EQ(grading.back().diameter, 0.27e-3);
    const std::vector<double> diameters = sample_diameters(grading, 11600, make_key(1));
    const double count = std::pow(4e-3, 3) / 1.65 / compute_mean_volume(diameters);
    RecordProperty("count", std::to_string(count));
    EXPECT_NEAR(count, 11497., 0.01 * 11497.);
    const GrainMass mass{.diameters = diameters};
    EXPECT_NEAR(compute_diameter_at(mass, 0.5), 0.21e-3, 0.001e-3);
    EXPECT_NEAR(compute_diameter_at(mass, 0.1), 0.152e-3, 0.02 * 0.152e-3);
  }

  TEST(Grading, MeanSolidVolumeOfASampleIsUnbiased)
  {
    // Law: the expected mean volume of n grains is that of the number distribution for every n. Tolerance: 3 standard
    // errors of 2000 samples; the quadrature errs by 1e-9.
    const Grading grading = make_ne34_grading();
    const double expected = integrate_mean_volume(grading);
    for (const std::size_t n : {1u, 7u, 50u})
      {
        constexpr int n_samples = 2000;
        double sum = 0., squares = 0.;
        for (int seed = 0; seed < n_samples; ++seed)
          {
            const double ratio = compute_mean_volume(sample_diameters(grading, n, make_key(seed))) / expected;
            sum += ratio - 1.;
            squares += (ratio - 1.) * (ratio - 1.);
          }
        EXPECT_NEAR(sum / n_samples, 0., 3. * std::sqrt(squares) / n_samples) << n << " grains";
      }
  }

  TEST(Grading, StratifiedSampleKeepsToTheCurve)
  {
    // Law: with grain i in the i-th of n shares, the volume up to any share is wrong by one grain at most, of 3.08 mean
    // volumes (0.27 mm), and so is the total: 6.2/n in the passing.
    constexpr std::size_t n = 1000;
    const Grading grading = make_ne34_grading();
    const std::vector<double> diameters = sample_diameters(grading, n, make_key(4));
    std::vector<double> at;
    for (const GradingPoint &point : grading)
      at.push_back(point.diameter);
    const std::vector<double> passing = compute_passing({.diameters = diameters}, at);
    for (std::size_t i = 0; i < at.size(); ++i)
      EXPECT_NEAR(passing[i], grading[i].passing, 6.2 / n);
  }

  TEST(Grading, SampleIsDecreasingWithinBoundsAndAFunctionOfItsKey)
  {
    // Law: diameters decrease, stay within the grading, and the same key gives the same bits.
    const Grading grading = make_ne34_grading();
    const std::vector<double> diameters = sample_diameters(grading, 500, make_key(7));
    EXPECT_TRUE(std::is_sorted(diameters.rbegin(), diameters.rend()));
    EXPECT_LE(diameters.front(), 0.27e-3);
    EXPECT_GE(diameters.back(), 0.10e-3);
    EXPECT_EQ(diameters, sample_diameters(grading, 500, make_key(7)));
    EXPECT_NE(diameters, sample_diameters(grading, 500, make_key(8)));
  }

  TEST(Grading, GapHoldsNoGrains)
  {
    // Law: no mass between two diameters, no grains there; half the mass in grains of 8 times the volume is 1 grain
    // in 9. Tolerance: pieces 1e-6 wide, and one grain of 900 at the border.
    const Grading grading = {{0.5e-3, 0.}, {1e-3, 0.}, {1.000001e-3, 0.5}, {2e-3, 0.5}, {2.000002e-3, 1.}, {3e-3, 1.}};
    const std::vector<double> diameters = sample_diameters(grading, 900, make_key(1));
    int n_large = 0;
    for (const double diameter : diameters)
      {
        const bool is_large = diameter >= 2e-3 && diameter <= 2.000002e-3;
        EXPECT_TRUE(is_large || (diameter >= 1e-3 && diameter <= 1.000001e-3)) << diameter;
        n_large += is_large;
      }
    EXPECT_NEAR(n_large, 100, 1);
  }

  TEST(Grading, FaultyPointIsNamed)
  {
    // Law: the message names the first point that is out of order.
    const auto get_message = [](const Grading &grading) -> std::string {
      try
        {
          check_grading(grading);
        }
      catch (const std::invalid_argument &error)
        {
          return error.what();
        }
      return "";
    };
    const auto names = [&](const Grading &grading, const std::string &point) {
      return get_message(grading).find("point " + point) != std::string::npos;
    };
    EXPECT_TRUE(names({{0., 0.}, {1e-3, 1.}}, "1"));
    EXPECT_TRUE(names({{1e-3, 0.1}, {2e-3, 1.}}, "1"));
    EXPECT_TRUE(names({{1e-3, 0.}, {1e-3, 1.}}, "2"));
    EXPECT_TRUE(names({{1e-3, 0.}, {2e-3, 0.6}, {3e-3, 0.5}, {4e-3, 1.}}, "3"));
    EXPECT_TRUE(names({{1e-3, 0.}, {2e-3, 0.9}}, "2"));
    EXPECT_TRUE(names({{1e-3, 0.}, {2e-3, NAN}, {3e-3, 1.}}, "2"));
    EXPECT_THROW(check_grading({{1e-3, 0.}}), std::invalid_argument);
    EXPECT_EQ(get_message({{1e-3, 0.}, {2e-3, 1.}}), "");
  }

  TEST(Grading, PassingCountsGrainsAndFines)
  {
    // Law: grains of 1, 2 and 3 mm hold 1, 8 and 27 of 36 parts; as much again in fines is log-uniform over the decade
    // below d_c. Tolerance: rounding.
    const std::vector<double> diameters = {2e-3, 3e-3, 1e-3};
    const std::vector<double> at = {0.5e-3, 2e-3, 2.5e-3, 3e-3};
    const std::vector<double> without = compute_passing({.diameters = diameters}, at);
    const std::vector<double> expected = {0., 9. / 36., 9. / 36., 1.};
    for (std::size_t i = 0; i < at.size(); ++i)
      EXPECT_NEAR(without[i], expected[i], 1e-14);

    const GrainMass with{diameters, 6. * std::numbers::pi * 1e-9, 0.5e-3};
    const std::vector<double> at_fines = {0.05e-3, 0.5e-3 / std::sqrt(10.), 0.5e-3, 2e-3};
    const std::vector<double> passing = compute_passing(with, at_fines);
    const std::vector<double> expected_with = {0., 0.25, 0.5, 45. / 72.};
    for (std::size_t i = 0; i < at_fines.size(); ++i)
      EXPECT_NEAR(passing[i], expected_with[i], 1e-14);
    EXPECT_NEAR(compute_diameter_at(with, 0.25), 0.5e-3 / std::sqrt(10.), 1e-14);
    EXPECT_EQ(compute_diameter_at(with, 0.6), 2e-3);
    EXPECT_EQ(compute_diameter_at({.diameters = diameters}, 0.2), 2e-3);
  }

  TEST(Grading, DiameterAtAShareInvertsThePassing)
  {
    // Law: D_s is where the passing curve first reaches s, also where fines are as large as grains. The curve is asked
    // 1e-9 below and above D_s: rounding of volumes is 1e-15.
    const std::vector<double> diameters = sample_diameters(make_ne34_grading(), 40, make_key(3));
    for (const double fines_per_grains : {0., 0.3, 3.})
      {
        const double solids = 40. * compute_mean_volume(diameters);
        const GrainMass mass{diameters, fines_per_grains * solids, 0.25e-3};
        for (const double share : {0.01, 0.1, 0.37, 0.5, 0.8, 0.99})
          {
            const double diameter = compute_diameter_at(mass, share);
            const std::vector<double> at = {diameter * (1. - 1e-9), diameter * (1. + 1e-9)};
            const std::vector<double> passing = compute_passing(mass, at);
            EXPECT_LT(passing[0], share);
            EXPECT_GT(passing[1], share - 1e-12);
          }
      }
    EXPECT_TRUE(std::isnan(compute_diameter_at({}, 0.5)));
  }
} // namespace

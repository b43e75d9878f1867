#include "dem/breakage_measures.h"

#include "tests/support/rev_cases.h"

#include <gtest/gtest.h>

#include <cmath>

namespace
{
  using namespace dem;

  std::vector<double> repeat(const double diameter, const std::size_t n)
  {
    return std::vector<double>(n, diameter);
  }

  constexpr double rounding = 1e-13; // some hundred sums and logarithms of order one

  TEST(BreakageMeasures, TheUnbrokenIsZero)
  {
    // Law: the initial grading has not broken, bit by bit, whatever it is.
    const std::vector<double> diameters = {0.1e-3, 0.12e-3, 0.2e-3, 0.27e-3, 0.05e-3};
    const GrainMass mass{.diameters = diameters};
    EXPECT_EQ(compute_hardin_breakage(mass, mass, {}), 0.);
    EXPECT_EQ(compute_einav_breakage(mass, mass, {}), 0.);
  }

  TEST(BreakageMeasures, TwoSizesByHand)
  {
    // Law: by hand. Two grains of 0.74 mm have the potential log10(0.74/0.074) = 1. One becomes eight of half its
    // diameter, which weigh as much: half of the mass loses log10(2). Einav with d_m = 0.0074 mm and alpha = 2 (passing
    // linear in d): ln(d_M/d_m) = ln 100, and its mean over the ultimate grading is (100 ln 100)/99 - 1.
    const std::vector<double> before = repeat(0.74e-3, 2);
    std::vector<double> after = repeat(0.37e-3, 8);
    after.push_back(0.74e-3);
    const BreakageScale scale{.silt_diameter = 0.074e-3, .fractal_dimension = 2., .smallest_diameter = 0.0074e-3};
    const GrainMass initial{.diameters = before}, now{.diameters = after};
    EXPECT_NEAR(compute_hardin_breakage(initial, now, scale), 0.5 * std::log10(2.), rounding);
    const double way = std::log(100.) - (100. * std::log(100.) / 99. - 1.);
    EXPECT_NEAR(compute_einav_breakage(initial, now, scale), 0.5 * std::log(2.) / way, rounding);
  }

  TEST(BreakageMeasures, OnlyMassCoarserThanSiltHasPotential)
  {
    // Law (Hardin): all mass finer than 0.074 mm is 1, however fine; initial sand with a silty half keeps the potential
    // of the sand alone: eight grains of half the size of one weigh as much as it.
    const std::vector<double> sand = {0.148e-3}, silt = repeat(0.037e-3, 64);
    EXPECT_EQ(compute_hardin_breakage({.diameters = sand}, {.diameters = silt}, {}), 1.);
    std::vector<double> both = repeat(0.074e-3, 8);
    both.push_back(0.148e-3);
    const GrainMass initial{.diameters = both};
    EXPECT_NEAR(compute_mean_logarithm(initial, 0.074e-3), 0.5 * std::log(2.), rounding);
    EXPECT_TRUE(std::isnan(compute_hardin_breakage({.diameters = silt}, {.diameters = silt}, {}))); // nothing to lose
  }

  /** Mean of ln(d/d_m) over the ultimate grading: n equal shares of the mass, each at its middle. */
  double compute_mean_logarithm_by_quadrature(const BreakageScale &scale, const double largest, const int n)
  {
    const double p = 3. - scale.fractal_dimension;
    const double low = std::pow(scale.smallest_diameter, p), high = std::pow(largest, p);
    double sum = 0.;
    for (int i = 0; i < n; ++i)
      sum += std::log(std::pow(low + (high - low) * (i + 0.5) / n, 1. / p) / scale.smallest_diameter);
    return sum / n;
  }

  TEST(BreakageMeasures, TheUltimateGradingIsOne)
  {
    // Law (Einav): grains whose mass has the mean logarithm of the ultimate grading are at 1. Two sizes are mixed so
    // that they do, d_M and d_m, with the mean by the midpoint rule: another way than the source's closed form. Its
    // error with 1e6 shares is below 1e-9 here.
    const double largest = 0.2e-3;
    const BreakageScale scale{.silt_diameter = 0.074e-3, .fractal_dimension = 2.6, .smallest_diameter = 0.02e-3};
    const double mean = compute_mean_logarithm_by_quadrature(scale, largest, 1000000);
    const double coarse_share = mean / std::log(largest / scale.smallest_diameter);
    const std::vector<double> grain = {largest};
    const double volume = compute_grain_volume(largest);
    // The fine part as fines of a decade that lies below d_m: they count as d_m.
    const GrainMass ultimate{
        .diameters = grain, .fines = volume * (1. / coarse_share - 1.), .largest_fine = scale.smallest_diameter};
    EXPECT_NEAR(compute_einav_breakage({.diameters = grain}, ultimate, scale), 1., 1e-8);
  }

  TEST(BreakageMeasures, FinesAreADecade)
  {
    // Law: log-uniform over [d/10, d]: the mean of max(0, ln(x/limit)) against the midpoint rule, for a limit below the
    // decade, within it and above it; the kink costs the rule 1e-5 of a decade at most.
    const double largest = 0.1e-3;
    for (const double limit : {0.005e-3, 0.03e-3, 0.2e-3})
      {
        constexpr int n = 100000;
        double sum = 0.;
        for (int i = 0; i < n; ++i)
          sum += std::max(0., std::log(largest * std::pow(10., -(i + 0.5) / n) / limit));
        EXPECT_NEAR(compute_mean_logarithm({.diameters = {}, .fines = 1., .largest_fine = largest}, limit), sum / n,
                    1e-5 * std::log(10.))
            << limit;
      }
    // By hand: a limit at the decade's middle, sqrt(10) below its top, leaves (ln sqrt 10)^2 / (2 ln 10) = ln(10)/8.
    EXPECT_NEAR(
        compute_mean_logarithm({.diameters = {}, .fines = 1., .largest_fine = largest}, largest / std::sqrt(10.)),
        std::log(10.) / 8., rounding);
  }

  TEST(BreakageMeasures, OneSplitGrainOfAState)
  {
    // Law: fourteen siblings keep 0.523861 of the volume (closed form of the split grain); what is lost are fines; with
    // them no mass is missing, so that d90 of two equal grains of which one split is the whole one's diameter.
    RevState state = cases::make_pair(1e-6, Vector::UnitZ());
    FractureRule rule;
    rule.comminution_diameter = 0.05e-3;
    draw_strengths(state.grains, rule, {});
    const std::vector<double> before = list_diameters(state.grains);
    const BreakageMeasures unbroken = measure_breakage(state, before, rule, {});
    EXPECT_EQ(unbroken.fines_share, 0.);
    EXPECT_EQ(unbroken.with_fines.hardin, 0.);
    EXPECT_EQ(unbroken.whole.n, 2u);

    const double kept = state.grains.strength[1] / compute_strength(rule.strength, 2. * cases::radius, 1.);
    split_grains(state, {0}, {}, rule, {});
    const BreakageMeasures split = measure_breakage(state, before, rule, {});
    EXPECT_NEAR(split.fines_share, 0.5 * (1. - 0.523861), 1e-6); // the constant has six digits
    EXPECT_EQ(split.with_fines.d90, 2. * cases::radius);
    EXPECT_LE(split.with_fines.d10, rule.comminution_diameter);                             // 24 % of the mass is fines
    EXPECT_NEAR(split.without_fines.d10, 2. * (std::sqrt(2.) - 1.) * cases::radius, 1e-15); // 6 % are small siblings
    EXPECT_GT(split.without_fines.hardin, 0.);
    EXPECT_GT(split.with_fines.hardin, split.without_fines.hardin);
    EXPECT_GT(split.with_fines.einav, split.without_fines.einav);
    // The same from what is kept of the initial grading alone.
    const auto kept_alone = measure_grading_with_fines(state, measure_initial_grading(before, {}), rule, {});
    EXPECT_EQ(kept_alone.einav, split.with_fines.einav);
    EXPECT_EQ(kept_alone.hardin, split.with_fines.hardin);
    EXPECT_EQ(kept_alone.d50, split.with_fines.d50);
    EXPECT_TRUE(std::isnan(measure_grading_with_fines(state, {}, rule, {}).einav)); // nothing is known of before
    // Siblings are not of the packing: the whole one is left.
    EXPECT_EQ(split.whole.n, 1u);
    EXPECT_NEAR(split.whole.mean, kept, rounding);
    EXPECT_EQ(split.whole.standard_deviation, 0.);
  }

  TEST(BreakageMeasures, StrengthsAreThoseDrawn)
  {
    // Law: f of grains of any size has the mean 1 and the standard deviation 0.3627 (theory, Eq. 16), and is at least
    // 1 - 0.38 * 2.5 = 0.05. Three standard errors: 0.36/sqrt(n), and 0.36/sqrt(2n) of the deviation (a truncated
    // normal's tails are lighter than a normal's). Grains below the limit are left out.
    constexpr std::size_t n = 20000;
    RevState state;
    state.resize_grains(n);
    Grains &grains = state.grains;
    for (std::size_t i = 0; i < n; ++i)
      {
        grains.id[i] = i;
        grains.place[i].w = i < 100 ? 0.04e-3 : 0.06e-3 + 0.04e-3 * (i % 7);
        grains.generation[i] = 0;
      }
    const FractureRule rule;
    draw_strengths(grains, rule, {});
    const StrengthStatistics drawn = compute_strength_statistics(grains, rule);
    EXPECT_EQ(drawn.n, n - 100);
    EXPECT_NEAR(drawn.mean, 1., 3. * 0.3627 / std::sqrt(n));
    EXPECT_NEAR(drawn.standard_deviation, 0.3627, 3. * 0.3627 / std::sqrt(2. * n));
    EXPECT_GE(drawn.smallest, 0.05);
    EXPECT_LT(drawn.smallest, 0.06); // nine draws are expected between 0.05 and 0.06
    EXPECT_EQ(compute_strength_statistics(Grains(), rule).n, 0u);
  }
} // namespace

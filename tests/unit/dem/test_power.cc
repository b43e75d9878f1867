#include "dem/power.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace
{
  using dem::compute_power;

  // Tolerance: the exponent y log2 x is rounded a few times, and its absolute error times ln 2 is the relative error of
  // the power; the two polynomials add a few units of the last place.
  double compute_tolerance(const double x, const double y)
  {
    return 3e-16 * std::abs(y * std::log2(x)) + 1e-15;
  }

  TEST(Power, AgreesWithTheLibrary)
  {
    // Law: x^y, over the overlaps (in units of a stage's length) and exponents that contact laws use.
    std::mt19937_64 random(1);
    std::uniform_real_distribution<double> decade(-12., 3.), exponent(1., 3.);
    for (int i = 0; i < 300000; ++i)
      {
        const double x = std::pow(10., decade(random)), y = exponent(random);
        ASSERT_NEAR(compute_power(x, y) / std::pow(x, y), 1., compute_tolerance(x, y)) << x << "^" << y;
      }
  }

  TEST(Power, HasNoSeamWhereTheMantissaIsSplit)
  {
    // Law: x^y on both sides of 2^k sqrt(1/2), 2^k and 2^k sqrt(2), where the splitting of x and the rounding of the
    // exponent change their branch.
    for (int k = -39; k < 10; ++k)
      for (const double factor : {std::sqrt(0.5), 1., std::sqrt(2.)})
        for (const double nudge : {-3e-16, 0., 3e-16})
          for (const double y : {1., 1.5, 1.83472, 2.58980, 3.})
            {
              const double x = std::ldexp(factor * (1. + nudge), k);
              ASSERT_NEAR(compute_power(x, y) / std::pow(x, y), 1., compute_tolerance(x, y)) << x << "^" << y;
            }
  }

  TEST(Power, ReachesTheEndsOfItsRange)
  {
    // Law: x^y while |y log2 x| < 1000, the stated precondition. Tolerance: as above, at the ends some 3e-13.
    for (const double x : {1e-100, 1e-60, 1e60, 1e100})
      for (const double y : {1., 2., 3.})
        EXPECT_NEAR(compute_power(x, y) / std::pow(x, y), 1., compute_tolerance(x, y)) << x << "^" << y;
    EXPECT_EQ(compute_power(1., 2.7), 1.);
  }
} // namespace

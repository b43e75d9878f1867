#pragma once

#include <bit>
#include <cstdint>

namespace dem
{
  /**
   * x^y for positive normal x, without branches or calls, so that a loop over contacts is vectorised. Relative error
   * below 1e-14 |y log2 x| + 1e-14 (tests/unit/dem/test_power.cc holds it against std::pow).
   *
   * @pre x > 0, normal, finite; |y log2 x| < 1000
   */
  inline double compute_power(const double x, const double y)
  {
    // x = m 2^e with m in [sqrt(1/2), sqrt(2)); the exponent becomes a double through the bits of 2^52, which every
    // instruction set can do in vectors.
    constexpr std::int64_t sqrt_half = 0x3fe6a09e667f3bcd;
    const std::int64_t bits = std::bit_cast<std::int64_t>(x);
    const std::int64_t shifted = bits - sqrt_half;
    const std::int64_t biased = (shifted >> 52) + 2048; // positive, as the trick below needs
    const double e = std::bit_cast<double>(biased | 0x4330000000000000) - (4503599627370496. + 2048.);
    const double m = std::bit_cast<double>((shifted & 0x000fffffffffffff) + sqrt_half);

    // log m = 2 artanh(t), |t| < 0.1716: the series' first neglected term is below 1e-17.
    const double t = (m - 1.) / (m + 1.);
    const double s = t * t;
    double p = 1. / 21.;
    p = p * s + 1. / 19.;
    p = p * s + 1. / 17.;
    p = p * s + 1. / 15.;
    p = p * s + 1. / 13.;
    p = p * s + 1. / 11.;
    p = p * s + 1. / 9.;
    p = p * s + 1. / 7.;
    p = p * s + 1. / 5.;
    p = p * s + 1. / 3.;
    p = p * s + 1.;
    constexpr double two_over_ln2 = 2.8853900817779268147;
    const double exponent = y * (e + two_over_ln2 * (t * p));

    // 2^exponent = 2^k e^z, |z| <= ln(2)/2; k by adding and taking away 1.5 2^52.
    constexpr double rounder = 6755399441055744.;
    const double shifted_exponent = exponent + rounder;
    const double k = shifted_exponent - rounder;
    const double z = (exponent - k) * 0.69314718055994530942;
    double q = 1. / 6227020800.;
    q = q * z + 1. / 479001600.;
    q = q * z + 1. / 39916800.;
    q = q * z + 1. / 3628800.;
    q = q * z + 1. / 362880.;
    q = q * z + 1. / 40320.;
    q = q * z + 1. / 5040.;
    q = q * z + 1. / 720.;
    q = q * z + 1. / 120.;
    q = q * z + 1. / 24.;
    q = q * z + 1. / 6.;
    q = q * z + 0.5;
    q = q * z + 1.;
    q = q * z + 1.;
    const std::int64_t k_bits = std::bit_cast<std::int64_t>(shifted_exponent) << 52;
    return std::bit_cast<double>(std::bit_cast<std::int64_t>(q) + k_bits);
  }
} // namespace dem

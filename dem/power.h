#pragma once

#include "dem/lanes.h"

#include <bit>
#include <cstdint>

namespace dem
{
  inline std::int64_t get_bits(const double x)
  {
    return std::bit_cast<std::int64_t>(x);
  }

  inline double get_numbers(const std::int64_t bits)
  {
    return std::bit_cast<double>(bits);
  }

  /**
   * x^y for positive normal x, without branches or calls, for one number or for many lanes. Relative error
   * below 1e-14 |y log2 x| + 1e-14 (tests/unit/dem/test_power.cc holds it against std::pow).
   *
   * @pre x > 0, normal, finite; |y log2 x| < 1000
   */
  template <typename Real, typename Bits>
  [[gnu::always_inline]] inline Real compute_power_of_bits(const Real x, const Real y)
  {
    // x = m 2^e with m in [sqrt(1/2), sqrt(2)); the exponent becomes a double through the bits of 2^52, which every
    // instruction set can do in vectors.
    constexpr std::int64_t sqrt_half = 0x3fe6a09e667f3bcd;
    const Bits bits = get_bits(x);
    const Bits shifted = bits - Bits(sqrt_half);
    const Bits biased = (shifted >> 52) + Bits(2048); // positive, as the trick below needs
    const Real e = get_numbers(biased | Bits(0x4330000000000000)) - (4503599627370496. + 2048.);
    const Real m = get_numbers((shifted & Bits(0x000fffffffffffff)) + Bits(sqrt_half));

    // log m = 2 artanh(t), |t| < 0.1716: the series' first neglected term is below 1e-17.
    const Real t = (m - 1.) / (m + 1.);
    const Real s = t * t;
    Real p = s * (1. / 21.) + 1. / 19.;
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
    const Real exponent = y * (e + two_over_ln2 * (t * p));

    // 2^exponent = 2^k e^z, |z| <= ln(2)/2; k by adding and taking away 1.5 2^52.
    constexpr double rounder = 6755399441055744.;
    const Real shifted_exponent = exponent + rounder;
    const Real k = shifted_exponent - rounder;
    const Real z = (exponent - k) * 0.69314718055994530942;
    Real q = z * (1. / 6227020800.) + 1. / 479001600.;
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
    const Bits k_bits = get_bits(shifted_exponent) << 52;
    return get_numbers(get_bits(q) + k_bits);
  }

  [[gnu::always_inline]] inline double compute_power(const double x, const double y)
  {
    return compute_power_of_bits<double, std::int64_t>(x, y);
  }

  [[gnu::always_inline]] inline Lanes compute_power(const Lanes x, const Lanes y)
  {
    return compute_power_of_bits<Lanes, LaneBits>(x, y);
  }
} // namespace dem

#pragma once

#include "dem/single_lanes.h"

namespace dem
{
  /**
   * x^y for positive normal x in single precision, without branches or calls. Relative error below 4e-7 wherever the
   * result is normal (tests/unit/dem/test_single_law.cc holds it against std::pow).
   *
   * @pre x > 0, normal, finite; 0 <= y < 8; |y log2 x| < 120
   */
  [[gnu::always_inline]] inline Singles compute_power(const Singles x, const Singles y)
  {
    // x = m 2^e with m in [sqrt(1/2), sqrt(2)).
    constexpr std::int32_t sqrt_half = 0x3f3504f3;
    const SinglesBits shifted = get_bits(x) - SinglesBits(sqrt_half);
    const Singles e = convert(shifted >> 23);
    const Singles m = get_numbers((shifted & SinglesBits(0x007fffff)) + SinglesBits(sqrt_half));

    // log m = 2 artanh(t), |t| < 0.1716: the series' first neglected term is below 3e-9.
    const Singles t = (m - 1.f) / (m + 1.f);
    const Singles s = t * t;
    Singles p = s * (1.f / 9.f) + 1.f / 7.f;
    p = p * s + 1.f / 5.f;
    p = p * s + 1.f / 3.f;
    p = p * s + 1.f;
    constexpr float two_over_ln2 = 2.885390081777926815f;

    // y = a multiple of 2^-10 and a rest: e times the first is exact, and what remains to be rounded is small.
    constexpr float tenth_digit = 12288.f; // 1.5 2^13: its last digit is worth 2^-10
    const Singles coarse = (y + tenth_digit) - tenth_digit;
    const Singles whole = coarse * e;
    const Singles rest = (y - coarse) * e + y * (two_over_ln2 * (t * p));

    // 2^exponent = 2^k e^z, |z| <= ln(2)/2; k by adding and taking away 1.5 2^23.
    constexpr float rounder = 12582912.f;
    const Singles k = ((whole + rest) + rounder) - rounder;
    const Singles z = ((whole - k) + rest) * 0.693147180559945309f;
    Singles q = z * (1.f / 5040.f) + 1.f / 720.f;
    q = q * z + 1.f / 120.f;
    q = q * z + 1.f / 24.f;
    q = q * z + 1.f / 6.f;
    q = q * z + 0.5f;
    q = q * z + 1.f;
    q = q * z + 1.f;
    return get_numbers(get_bits(q) + (convert(k) << 23));
  }
} // namespace dem

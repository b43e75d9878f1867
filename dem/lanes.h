#pragma once

#include "dem/vector.h"

#include <cmath>
#include <cstdint>
#ifdef __AVX512VL__ // what has it has all that is used here
#include <immintrin.h>
#endif

/**
 * Sixteen contacts side by side, in two of gcc's vectors of eight: one register each with AVX-512, several with less.
 * Each operation is done to both halves in turn, so that one half computes while the other waits for what it computed
 * before: alone, chains of square roots would set the pace.
 *
 * Grains lie in memory as rows of four numbers. Eight rows are read with eight aligned loads and turned into four
 * vectors of eight inside the registers, which is faster than gathering single numbers (dem/lane_rows.h).
 */
namespace dem
{
  inline constexpr int n_lanes = 16;
  inline constexpr int n_half = 8; ///< lanes of one vector

  using Half = double __attribute__((vector_size(64)));
  using HalfBits = std::int64_t __attribute__((vector_size(64)));
#ifdef __AVX512VL__
  using HalfMask = __mmask8; ///< a bit a lane
#else
  using HalfMask = HalfBits; ///< all bits of a lane set, or none
#endif

  /** Numbers, lane by lane. */
  struct Lanes
  {
    Half low, high;

    Lanes() = default;
    [[gnu::always_inline]] Lanes(const Half l, const Half h) : low(l), high(h) {}
    [[gnu::always_inline]] Lanes(const double x) : low{x, x, x, x, x, x, x, x}, high(low) {} ///< the same in all lanes
  };

  /** The bits of numbers, lane by lane. */
  struct LaneBits
  {
    HalfBits low, high;

    LaneBits() = default;
    [[gnu::always_inline]] LaneBits(const HalfBits l, const HalfBits h) : low(l), high(h) {}
    [[gnu::always_inline]] LaneBits(const std::int64_t x) : low{x, x, x, x, x, x, x, x}, high(low) {}
  };

  /** Yes or no, lane by lane. */
  struct LaneMask
  {
    HalfMask low, high;
  };

  [[gnu::always_inline]] inline Lanes operator+(const Lanes a, const Lanes b)
  {
    return {a.low + b.low, a.high + b.high};
  }

  [[gnu::always_inline]] inline Lanes operator-(const Lanes a, const Lanes b)
  {
    return {a.low - b.low, a.high - b.high};
  }

  [[gnu::always_inline]] inline Lanes operator*(const Lanes a, const Lanes b)
  {
    return {a.low * b.low, a.high * b.high};
  }

  [[gnu::always_inline]] inline Lanes operator/(const Lanes a, const Lanes b)
  {
    return {a.low / b.low, a.high / b.high};
  }

  [[gnu::always_inline]] inline Lanes operator-(const Lanes a)
  {
    return {-a.low, -a.high};
  }

  [[gnu::always_inline]] inline Lanes &operator+=(Lanes &a, const Lanes b)
  {
    return a = a + b;
  }

  [[gnu::always_inline]] inline LaneBits operator+(const LaneBits a, const LaneBits b)
  {
    return {a.low + b.low, a.high + b.high};
  }

  [[gnu::always_inline]] inline LaneBits operator-(const LaneBits a, const LaneBits b)
  {
    return {a.low - b.low, a.high - b.high};
  }

  [[gnu::always_inline]] inline LaneBits operator&(const LaneBits a, const LaneBits b)
  {
    return {a.low & b.low, a.high & b.high};
  }

  [[gnu::always_inline]] inline LaneBits operator|(const LaneBits a, const LaneBits b)
  {
    return {a.low | b.low, a.high | b.high};
  }

  [[gnu::always_inline]] inline LaneBits operator<<(const LaneBits a, const int n)
  {
    return {a.low << n, a.high << n};
  }

  [[gnu::always_inline]] inline LaneBits operator>>(const LaneBits a, const int n)
  {
    return {a.low >> n, a.high >> n};
  }

  [[gnu::always_inline]] inline LaneMask operator&(const LaneMask a, const LaneMask b)
  {
    return {static_cast<HalfMask>(a.low & b.low), static_cast<HalfMask>(a.high & b.high)};
  }

  [[gnu::always_inline]] inline LaneBits get_bits(const Lanes a)
  {
    return {reinterpret_cast<HalfBits>(a.low), reinterpret_cast<HalfBits>(a.high)};
  }

  [[gnu::always_inline]] inline Lanes get_numbers(const LaneBits a)
  {
    return {reinterpret_cast<Half>(a.low), reinterpret_cast<Half>(a.high)};
  }

#ifdef __AVX512VL__
  [[gnu::always_inline]] inline HalfMask is_less(const Half a, const Half b)
  {
    return _mm512_cmp_pd_mask(reinterpret_cast<__m512d>(a), reinterpret_cast<__m512d>(b), _CMP_LT_OQ);
  }

  [[gnu::always_inline]] inline Half select(const HalfMask mask, const Half yes, const Half no)
  {
    return reinterpret_cast<Half>(
        _mm512_mask_blend_pd(mask, reinterpret_cast<__m512d>(no), reinterpret_cast<__m512d>(yes)));
  }

  [[gnu::always_inline]] inline Half compute_larger(const Half a, const Half b)
  {
    return reinterpret_cast<Half>(_mm512_max_pd(reinterpret_cast<__m512d>(a), reinterpret_cast<__m512d>(b)));
  }

  [[gnu::always_inline]] inline Half estimate_inverse_root(const Half a)
  {
    return reinterpret_cast<Half>(_mm512_rsqrt14_pd(reinterpret_cast<__m512d>(a)));
  }

  /** What is left of a number once the nearest whole one is taken away. */
  [[gnu::always_inline]] inline Half compute_remainder(const Half a)
  {
    return reinterpret_cast<Half>(_mm512_reduce_pd(reinterpret_cast<__m512d>(a), 0));
  }

  [[gnu::always_inline]] inline int count(const LaneMask mask)
  {
    return __builtin_popcount(mask.low | mask.high << n_half);
  }
#else
  [[gnu::always_inline]] inline HalfMask is_less(const Half a, const Half b)
  {
    return a < b;
  }

  [[gnu::always_inline]] inline Half select(const HalfMask mask, const Half yes, const Half no)
  {
    return mask ? yes : no;
  }

  [[gnu::always_inline]] inline Half compute_larger(const Half a, const Half b)
  {
    return a > b ? a : b;
  }

  [[gnu::always_inline]] inline Half compute_remainder(const Half a)
  {
    constexpr double rounder = 6755399441055744.; // 1.5 2^52: its last digit is worth 1
    return a - ((a + rounder) - rounder);
  }

  [[gnu::always_inline]] inline int count(const LaneMask mask)
  {
    const HalfBits both = -(mask.low + mask.high);
    int n = 0;
    for (int i = 0; i < n_half; ++i)
      n += static_cast<int>(both[i]);
    return n;
  }
#endif

  [[gnu::always_inline]] inline LaneMask operator<(const Lanes a, const Lanes b)
  {
    return {is_less(a.low, b.low), is_less(a.high, b.high)};
  }

  [[gnu::always_inline]] inline bool is_any(const LaneMask mask)
  {
    return count(mask) != 0;
  }

  [[gnu::always_inline]] inline Lanes select(const LaneMask mask, const Lanes yes, const Lanes no)
  {
    return {select(mask.low, yes.low, no.low), select(mask.high, yes.high, no.high)};
  }

  [[gnu::always_inline]] inline Lanes keep(const LaneMask mask, const Lanes value)
  {
    return select(mask, value, Lanes(0.));
  }

  [[gnu::always_inline]] inline Lanes compute_larger(const Lanes a, const Lanes b)
  {
    return {compute_larger(a.low, b.low), compute_larger(a.high, b.high)};
  }

  /** value - rint(value), |value| < 2^51. */
  [[gnu::always_inline]] inline Lanes compute_remainder(const Lanes value)
  {
    return {compute_remainder(value.low), compute_remainder(value.high)};
  }

  /** 1/sqrt(value) to some roundings. @pre value > 0, normal */
  [[gnu::always_inline]] inline Lanes compute_inverse_root(const Lanes value)
  {
#ifdef __AVX512VL__
    const Lanes root{estimate_inverse_root(value.low), estimate_inverse_root(value.high)};
    // value root^2 = 1 - e with |e| < 2^-13: (1 - e)^-1/2 to the third power of e, the fourth is below 2^-53.
    const Lanes e = 1. - (value * root) * root;
    const Lanes series = (5. / 16. * e + 3. / 8.) * e + 0.5;
    return root + (root * e) * series;
#else
    Lanes root;
    for (int i = 0; i < n_half; ++i)
      {
        root.low[i] = 1. / std::sqrt(value.low[i]);
        root.high[i] = 1. / std::sqrt(value.high[i]);
      }
    return root;
#endif
  }

  /** sqrt(value). @pre value >= 0 */
  [[gnu::always_inline]] inline Lanes compute_root(const Lanes value)
  {
#ifdef __AVX512VL__
    const auto root = [](const Half v) { return reinterpret_cast<Half>(_mm512_sqrt_pd(reinterpret_cast<__m512d>(v))); };
    return {root(value.low), root(value.high)};
#else
    Lanes root;
    for (int i = 0; i < n_half; ++i)
      {
        root.low[i] = std::sqrt(value.low[i]);
        root.high[i] = std::sqrt(value.high[i]);
      }
    return root;
#endif
  }

  [[gnu::always_inline]] inline double sum_lanes(const Lanes value)
  {
    const Half sum = value.low + value.high;
    return ((sum[0] + sum[4]) + (sum[2] + sum[6])) + ((sum[1] + sum[5]) + (sum[3] + sum[7]));
  }

  using UnalignedHalf = double __attribute__((vector_size(64), aligned(8), may_alias));

  [[gnu::always_inline]] inline Lanes load_lanes(const double *from)
  {
    return {*reinterpret_cast<const UnalignedHalf *>(from), *reinterpret_cast<const UnalignedHalf *>(from + n_half)};
  }

  [[gnu::always_inline]] inline void store_lanes(double *to, const Lanes value)
  {
    *reinterpret_cast<UnalignedHalf *>(to) = value.low;
    *reinterpret_cast<UnalignedHalf *>(to + n_half) = value.high;
  }

  /** A byte a lane: 0 where `is_any_sort` says no, else 1, or 2 where `is_second` says yes. */
  template <typename Byte>
  [[gnu::always_inline]] inline void store_sorts(Byte *const to, const LaneMask is_any_sort, const LaneMask is_second)
  {
    static_assert(sizeof(Byte) == 1);
#ifdef __AVX512VL__
    const auto join = [](const LaneMask mask) { return static_cast<__mmask16>(mask.low | mask.high << n_half); };
    const __m128i sorts = _mm_mask_blend_epi8(join(is_second), _mm_set1_epi8(1), _mm_set1_epi8(2));
    const __m128i bytes = _mm_maskz_mov_epi8(join(is_any_sort), sorts);
    __builtin_memcpy(to, &bytes, sizeof bytes);
#else
    using Bytes = std::int8_t __attribute__((vector_size(n_half)));
    const Bytes low = __builtin_convertvector(is_any_sort.low & (1 - is_second.low), Bytes); // masks are -1 or 0
    const Bytes high = __builtin_convertvector(is_any_sort.high & (1 - is_second.high), Bytes);
    __builtin_memcpy(to, &low, sizeof low);
    __builtin_memcpy(to + n_half, &high, sizeof high);
#endif
  }
} // namespace dem

#pragma once

#include <cmath>
#include <cstdint>
#ifdef __AVX__ // __AVX512VL__, asked for below, comes with it
#include <immintrin.h>
#endif

/** Contacts side by side in single precision: what lanes.h is for double. */
namespace dem
{
  inline constexpr int n_singles = 16; ///< floats of one vector

  using Single = float __attribute__((vector_size(64)));
  using SingleBits = std::int32_t __attribute__((vector_size(64)));
#ifdef __AVX512VL__
  using SingleMask = __mmask16; ///< a bit a lane
#else
  using SingleMask = SingleBits; ///< all bits of a lane set, or none
#endif

  /** The bits of sixteen numbers, or sixteen whole ones. */
  struct SinglesBits
  {
    SingleBits v;

    SinglesBits() = default;
    [[gnu::always_inline]] SinglesBits(const SingleBits x) : v(x) {}
    [[gnu::always_inline]] SinglesBits(const std::int32_t x) : v{x, x, x, x, x, x, x, x, x, x, x, x, x, x, x, x} {}

    [[gnu::always_inline]] friend SinglesBits operator+(const SinglesBits a, const SinglesBits b) { return a.v + b.v; }
    [[gnu::always_inline]] friend SinglesBits operator-(const SinglesBits a, const SinglesBits b) { return a.v - b.v; }
    [[gnu::always_inline]] friend SinglesBits operator&(const SinglesBits a, const SinglesBits b) { return a.v & b.v; }
    [[gnu::always_inline]] friend SinglesBits operator<<(const SinglesBits a, const int n) { return a.v << n; }
    [[gnu::always_inline]] friend SinglesBits operator>>(const SinglesBits a, const int n) { return a.v >> n; }
  };

  /** Yes or no, lane by lane. */
  struct SinglesMask
  {
    SingleMask v;
  };

  /** Sixteen numbers. */
  struct Singles
  {
    using Mask = SinglesMask;
    using Bits = SinglesBits;
    static constexpr int n_lanes = n_singles;

    Single v;

    Singles() = default;
    [[gnu::always_inline]] Singles(const Single x) : v(x) {}
    [[gnu::always_inline]] Singles(const float x) : v{x, x, x, x, x, x, x, x, x, x, x, x, x, x, x, x} {} ///< all lanes

    [[gnu::always_inline]] friend Singles operator+(const Singles a, const Singles b) { return a.v + b.v; }
    [[gnu::always_inline]] friend Singles operator-(const Singles a, const Singles b) { return a.v - b.v; }
    [[gnu::always_inline]] friend Singles operator*(const Singles a, const Singles b) { return a.v * b.v; }
    [[gnu::always_inline]] friend Singles operator/(const Singles a, const Singles b) { return a.v / b.v; }
    [[gnu::always_inline]] friend Singles operator-(const Singles a) { return -a.v; }
    [[gnu::always_inline]] friend Singles &operator+=(Singles &a, const Singles b) { return a = a + b; }

    [[gnu::always_inline]] friend SinglesMask operator<(const Singles a, const Singles b)
    {
#ifdef __AVX512VL__
      return {_mm512_cmp_ps_mask(reinterpret_cast<__m512>(a.v), reinterpret_cast<__m512>(b.v), _CMP_LT_OQ)};
#else
      return {a.v < b.v};
#endif
    }
  };

  [[gnu::always_inline]] inline SinglesBits get_bits(const Singles a)
  {
    return reinterpret_cast<SingleBits>(a.v);
  }

  [[gnu::always_inline]] inline Singles get_numbers(const SinglesBits a)
  {
    return reinterpret_cast<Single>(a.v);
  }

  /** Whole numbers as floats. */
  [[gnu::always_inline]] inline Singles convert(const SinglesBits a)
  {
    return __builtin_convertvector(a.v, Single);
  }

  /** Floats without a fraction as whole numbers. */
  [[gnu::always_inline]] inline SinglesBits convert(const Singles a)
  {
    return __builtin_convertvector(a.v, SingleBits);
  }

  [[gnu::always_inline]] inline Singles select(const SinglesMask mask, const Singles yes, const Singles no)
  {
#ifdef __AVX512VL__
    return reinterpret_cast<Single>(
        _mm512_mask_blend_ps(mask.v, reinterpret_cast<__m512>(no.v), reinterpret_cast<__m512>(yes.v)));
#else
    return mask.v ? yes.v : no.v;
#endif
  }

  [[gnu::always_inline]] inline Singles compute_larger(const Singles a, const Singles b)
  {
#ifdef __AVX512VL__
    return reinterpret_cast<Single>(_mm512_max_ps(reinterpret_cast<__m512>(a.v), reinterpret_cast<__m512>(b.v)));
#else
    return a.v > b.v ? a.v : b.v;
#endif
  }

  [[gnu::always_inline]] inline int count(const SinglesMask mask)
  {
#ifdef __AVX512VL__
    return __builtin_popcount(mask.v);
#else
    int n = 0;
    for (int i = 0; i < n_singles; ++i)
      n -= mask.v[i];
    return n;
#endif
  }

  /** 1/sqrt(value) to some roundings; of one it is one. @pre value > 0, normal */
  [[gnu::always_inline]] inline Singles compute_inverse_root(const Singles value)
  {
#ifdef __AVX512VL__
    const Singles root = reinterpret_cast<Single>(_mm512_rsqrt14_ps(reinterpret_cast<__m512>(value.v)));
    // value root^2 = 1 - e with |e| < 2^-13: the square of e is below 2^-26, and three eighths of it below rounding.
    const Singles e = 1.f - (value * root) * root;
    return root + (0.5f * root) * e;
#else
    Singles root;
    for (int i = 0; i < n_singles; ++i)
      root.v[i] = 1.f / std::sqrt(value.v[i]);
    return root;
#endif
  }

  /** sqrt(value). @pre value >= 0 */
  [[gnu::always_inline]] inline Singles compute_root(const Singles value)
  {
#ifdef __AVX512VL__
    return reinterpret_cast<Single>(_mm512_sqrt_ps(reinterpret_cast<__m512>(value.v)));
#else
    Singles root;
    for (int i = 0; i < n_singles; ++i)
      root.v[i] = std::sqrt(value.v[i]);
    return root;
#endif
  }

  /** 1/value to 2^-14 or better: for what matters little. @pre value normal */
  [[gnu::always_inline]] inline Singles estimate_inverse(const Singles value)
  {
#ifdef __AVX512VL__
    return reinterpret_cast<Single>(_mm512_rcp14_ps(reinterpret_cast<__m512>(value.v)));
#else
    return 1.f / value;
#endif
  }

  /** 1/value to some roundings. @pre value normal */
  [[gnu::always_inline]] inline Singles compute_inverse(const Singles value)
  {
#ifdef __AVX512VL__
    const Singles estimate = estimate_inverse(value);
    return estimate + estimate * (1.f - value * estimate);
#else
    return 1.f / value;
#endif
  }

  /** The nearest whole numbers. */
  [[gnu::always_inline]] inline SingleBits round_singles(const Single value)
  {
#ifdef __AVX512VL__
    return reinterpret_cast<SingleBits>(_mm512_cvtps_epi32(reinterpret_cast<__m512>(value)));
#else
    SingleBits rounded;
    for (int i = 0; i < n_singles; ++i)
      rounded[i] = static_cast<std::int32_t>(std::lrint(value[i]));
    return rounded;
#endif
  }

  [[gnu::always_inline]] inline double sum_lanes(const Singles value)
  {
    double sum = 0.;
    for (int i = 0; i < n_singles; ++i)
      sum += static_cast<double>(value.v[i]);
    return sum;
  }

  /** @pre aligned to 64 bytes */
  [[gnu::always_inline]] inline Singles load_singles(const float *from)
  {
    using Aliased = float __attribute__((vector_size(64), may_alias));
    return Single(*reinterpret_cast<const Aliased *>(from));
  }

  /** @pre aligned to 64 bytes */
  [[gnu::always_inline]] inline void store_singles(float *to, const Singles value)
  {
    using Aliased = float __attribute__((vector_size(64), may_alias));
    *reinterpret_cast<Aliased *>(to) = value.v;
  }

  /** The same as doubles. */
  [[gnu::always_inline]] inline void store_doubles(double *const to, const Singles value)
  {
    for (int i = 0; i < n_singles; ++i)
      to[i] = static_cast<double>(value.v[i]);
  }

  /** A byte a lane: 0 where `is_any_sort` says no, else 1, or 2 where `is_second` says yes. */
  template <typename Byte>
  [[gnu::always_inline]] inline void store_sorts(Byte *const to, const SinglesMask is_any_sort,
                                                 const SinglesMask is_second)
  {
    static_assert(sizeof(Byte) == 1);
#ifdef __AVX512VL__
    const __m128i sorts = _mm_mask_blend_epi8(is_second.v, _mm_set1_epi8(1), _mm_set1_epi8(2));
    const __m128i bytes = _mm_maskz_mov_epi8(is_any_sort.v, sorts);
#else
    using Bytes = std::int8_t __attribute__((vector_size(n_singles)));
    const Bytes bytes = __builtin_convertvector(is_any_sort.v & (1 - is_second.v), Bytes); // masks are -1 or 0
#endif
    __builtin_memcpy(to, &bytes, sizeof bytes);
  }
} // namespace dem

#pragma once

#include "dem/vector.h"

#include <cmath>
#include <cstdint>
#ifdef __AVX512F__
#include <immintrin.h>
#endif

/**
 * Eight contacts side by side, in gcc's vector types: one register each with AVX-512, several with less.
 *
 * Grains lie in memory as rows of four numbers. Eight rows are read with eight aligned loads and turned into four
 * vectors of eight inside the registers, which is faster than gathering single numbers.
 */
namespace dem
{
  inline constexpr int n_lanes = 8;

  using Lanes = double __attribute__((vector_size(64)));
  using LaneMask = std::int64_t __attribute__((vector_size(64))); ///< all bits of a lane set, or none
  using RowLanes = double __attribute__((vector_size(32), may_alias));
  using RowMask = std::int64_t __attribute__((vector_size(32), may_alias));

  /** The four numbers of eight rows, number by number. */
  struct RowsOfLanes
  {
    Lanes x, y, z, w;
  };

  [[gnu::always_inline]] inline Lanes make_lanes(const double value)
  {
    return Lanes{} + value;
  }

  [[gnu::always_inline]] inline Lanes select(const LaneMask mask, const Lanes yes, const Lanes no)
  {
    return mask ? yes : no;
  }

  [[gnu::always_inline]] inline Lanes keep(const LaneMask mask, const Lanes value)
  {
    return reinterpret_cast<Lanes>(reinterpret_cast<LaneMask>(value) & mask);
  }

  /** Nearest whole number, |value| < 2^51. */
  [[gnu::always_inline]] inline Lanes round_lanes(const Lanes value)
  {
    constexpr double rounder = 6755399441055744.; // 1.5 2^52: its last digit is worth 1
    return (value + rounder) - rounder;
  }

  /** 1/sqrt(value) to some roundings. @pre value > 0, normal */
  [[gnu::always_inline]] inline Lanes compute_inverse_root(const Lanes value)
  {
#ifdef __AVX512F__
    Lanes root = reinterpret_cast<Lanes>(_mm512_rsqrt14_pd(reinterpret_cast<__m512d>(value)));
    const Lanes half = 0.5 * value;
    root = root * (1.5 - half * root * root); // 14 bits, 28
    const Lanes rest = 0.5 - half * root * root;
    return root + root * rest; // 56: the rest is small, so that its rounding does not count
#else
    Lanes root;
    for (int i = 0; i < n_lanes; ++i)
      root[i] = 1. / std::sqrt(value[i]);
    return root;
#endif
  }

  [[gnu::always_inline]] inline Lanes compute_larger(const Lanes a, const Lanes b)
  {
    return a > b ? a : b;
  }

  [[gnu::always_inline]] inline bool is_any(const LaneMask mask)
  {
#ifdef __AVX512DQ__
    return _mm512_movepi64_mask(reinterpret_cast<__m512i>(mask)) != 0;
#else
    std::int64_t all = 0;
    for (int i = 0; i < n_lanes; ++i)
      all |= mask[i];
    return all != 0;
#endif
  }

  [[gnu::always_inline]] inline double sum_lanes(const Lanes value)
  {
    return ((value[0] + value[4]) + (value[2] + value[6])) + ((value[1] + value[5]) + (value[3] + value[7]));
  }

  [[gnu::always_inline]] inline RowLanes load_row(const Row &row)
  {
    return *reinterpret_cast<const RowLanes *>(&row);
  }

  [[gnu::always_inline]] inline void store_row(Row &row, const RowLanes value)
  {
    *reinterpret_cast<RowLanes *>(&row) = value;
  }

  [[gnu::always_inline]] inline void add_row(Row &row, const RowLanes value)
  {
    store_row(row, load_row(row) + value);
  }

  [[gnu::always_inline]] inline Lanes join(const RowLanes low, const RowLanes high)
  {
#ifdef __AVX512F__
    return reinterpret_cast<Lanes>(
        _mm512_insertf64x4(_mm512_castpd256_pd512(reinterpret_cast<__m256d>(low)), reinterpret_cast<__m256d>(high), 1));
#else
    return __builtin_shufflevector(low, high, 0, 1, 2, 3, 4, 5, 6, 7);
#endif
  }

  /** Eight rows, number by number. */
  [[gnu::always_inline]] inline RowsOfLanes transpose(const Lanes r04, const Lanes r15, const Lanes r26,
                                                      const Lanes r37)
  {
    const Lanes xz01 = __builtin_shufflevector(r04, r15, 0, 8, 2, 10, 4, 12, 6, 14);
    const Lanes yw01 = __builtin_shufflevector(r04, r15, 1, 9, 3, 11, 5, 13, 7, 15);
    const Lanes xz23 = __builtin_shufflevector(r26, r37, 0, 8, 2, 10, 4, 12, 6, 14);
    const Lanes yw23 = __builtin_shufflevector(r26, r37, 1, 9, 3, 11, 5, 13, 7, 15);
    return {__builtin_shufflevector(xz01, xz23, 0, 1, 8, 9, 4, 5, 12, 13),
            __builtin_shufflevector(yw01, yw23, 0, 1, 8, 9, 4, 5, 12, 13),
            __builtin_shufflevector(xz01, xz23, 2, 3, 10, 11, 6, 7, 14, 15),
            __builtin_shufflevector(yw01, yw23, 2, 3, 10, 11, 6, 7, 14, 15)};
  }

  /** Rows at[0] to at[7] of an array. */
  [[gnu::always_inline]] inline RowsOfLanes load_rows(const Row *rows, const std::uint32_t *at)
  {
    const auto load = [&](const int i) { return join(load_row(rows[at[i]]), load_row(rows[at[i + 4]])); };
    return transpose(load(0), load(1), load(2), load(3));
  }

  /** Rows b[0] to b[7] less rows a[0] to a[7]. */
  [[gnu::always_inline]] inline RowsOfLanes load_differences(const Row *rows, const std::uint32_t *a,
                                                             const std::uint32_t *b)
  {
    const auto load = [&](const int i) {
      return join(load_row(rows[b[i]]), load_row(rows[b[i + 4]])) -
             join(load_row(rows[a[i]]), load_row(rows[a[i + 4]]));
    };
    return transpose(load(0), load(1), load(2), load(3));
  }

  /** Calls take(i, row) for the eight rows in their order: what load_rows does, backwards. */
  template <typename Taker>
  [[gnu::always_inline]] inline void give_rows(const RowsOfLanes &v, const Taker &take)
  {
    const Lanes xy0 = __builtin_shufflevector(v.x, v.y, 0, 8, 2, 10, 4, 12, 6, 14);
    const Lanes xy1 = __builtin_shufflevector(v.x, v.y, 1, 9, 3, 11, 5, 13, 7, 15);
    const Lanes zw0 = __builtin_shufflevector(v.z, v.w, 0, 8, 2, 10, 4, 12, 6, 14);
    const Lanes zw1 = __builtin_shufflevector(v.z, v.w, 1, 9, 3, 11, 5, 13, 7, 15);
    const Lanes r04 = __builtin_shufflevector(xy0, zw0, 0, 1, 8, 9, 4, 5, 12, 13);
    const Lanes r26 = __builtin_shufflevector(xy0, zw0, 2, 3, 10, 11, 6, 7, 14, 15);
    const Lanes r15 = __builtin_shufflevector(xy1, zw1, 0, 1, 8, 9, 4, 5, 12, 13);
    const Lanes r37 = __builtin_shufflevector(xy1, zw1, 2, 3, 10, 11, 6, 7, 14, 15);
    take(0, __builtin_shufflevector(r04, r04, 0, 1, 2, 3));
    take(1, __builtin_shufflevector(r15, r15, 0, 1, 2, 3));
    take(2, __builtin_shufflevector(r26, r26, 0, 1, 2, 3));
    take(3, __builtin_shufflevector(r37, r37, 0, 1, 2, 3));
    take(4, __builtin_shufflevector(r04, r04, 4, 5, 6, 7));
    take(5, __builtin_shufflevector(r15, r15, 4, 5, 6, 7));
    take(6, __builtin_shufflevector(r26, r26, 4, 5, 6, 7));
    take(7, __builtin_shufflevector(r37, r37, 4, 5, 6, 7));
  }

  [[gnu::always_inline]] inline Lanes load_lanes(const double *from)
  {
    Lanes value;
    __builtin_memcpy(&value, from, sizeof value);
    return value;
  }

  [[gnu::always_inline]] inline void store_lanes(double *to, const Lanes value)
  {
    __builtin_memcpy(to, &value, sizeof value);
  }
} // namespace dem

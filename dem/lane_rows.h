#pragma once

#include "dem/force_rows.h"
#include "dem/lanes.h"

/** Rows of four numbers to lanes and back. */
namespace dem
{
  using RowLanes = double __attribute__((vector_size(32), may_alias));
  using RowMask = std::int64_t __attribute__((vector_size(32), may_alias));
  using ActionLanes = double __attribute__((vector_size(64), may_alias));

  /** The four numbers of sixteen rows, number by number. */
  struct RowsOfLanes
  {
    Lanes x, y, z, w;
  };

  /** The same of eight. */
  struct RowsOfHalf
  {
    Half x, y, z, w;
  };

  [[gnu::always_inline]] inline RowLanes load_row(const Row &row)
  {
    return *reinterpret_cast<const RowLanes *>(&row);
  }

  [[gnu::always_inline]] inline void store_row(Row &row, const RowLanes value)
  {
    *reinterpret_cast<RowLanes *>(&row) = value;
  }

  [[gnu::always_inline]] inline ActionLanes load_row(const Action &action)
  {
    return *reinterpret_cast<const ActionLanes *>(&action);
  }

  [[gnu::always_inline]] inline void store_row(Action &action, const ActionLanes value)
  {
    *reinterpret_cast<ActionLanes *>(&action) = value;
  }

  [[gnu::always_inline]] inline void add_row(Row &row, const RowLanes value)
  {
    store_row(row, load_row(row) + value);
  }

  /** Where a row lies [bytes behind the first]: no multiplication in the loop. */
  using RowOffset = std::uint32_t;

  [[gnu::always_inline]] inline const Row &get_row(const Row *const rows, const RowOffset offset)
  {
    return *reinterpret_cast<const Row *>(reinterpret_cast<const char *>(rows) + offset);
  }

  [[gnu::always_inline]] inline Row &get_row(Row *const rows, const RowOffset offset)
  {
    return *reinterpret_cast<Row *>(reinterpret_cast<char *>(rows) + offset);
  }

  /** Of the grain whose row lies there. */
  [[gnu::always_inline]] inline Action &get_row(Action *const actions, const RowOffset offset)
  {
    return *reinterpret_cast<Action *>(reinterpret_cast<char *>(actions) + std::size_t(2) * offset);
  }

  /** Four numbers, and the same one four times behind them. */
  [[gnu::always_inline]] inline ActionLanes join(const RowLanes low, const double &high)
  {
#ifdef __AVX512VL__
    return reinterpret_cast<ActionLanes>(
        _mm512_mask_broadcastsd_pd(_mm512_castpd256_pd512(reinterpret_cast<__m256d>(low)), 0xf0, _mm_load_sd(&high)));
#else
    return ActionLanes{low[0], low[1], low[2], low[3], high, high, high, high};
#endif
  }

  [[gnu::always_inline]] inline Half join(const RowLanes low, const RowLanes high)
  {
#ifdef __AVX512VL__
    return reinterpret_cast<Half>(
        _mm512_insertf64x4(_mm512_castpd256_pd512(reinterpret_cast<__m256d>(low)), reinterpret_cast<__m256d>(high), 1));
#else
    return __builtin_shufflevector(low, high, 0, 1, 2, 3, 4, 5, 6, 7);
#endif
  }

  /** Eight rows, number by number; r04 holds rows 0 and 4, and so on. */
  [[gnu::always_inline]] inline RowsOfHalf transpose(const Half r04, const Half r15, const Half r26, const Half r37)
  {
    const Half xz01 = __builtin_shufflevector(r04, r15, 0, 8, 2, 10, 4, 12, 6, 14);
    const Half yw01 = __builtin_shufflevector(r04, r15, 1, 9, 3, 11, 5, 13, 7, 15);
    const Half xz23 = __builtin_shufflevector(r26, r37, 0, 8, 2, 10, 4, 12, 6, 14);
    const Half yw23 = __builtin_shufflevector(r26, r37, 1, 9, 3, 11, 5, 13, 7, 15);
    return {__builtin_shufflevector(xz01, xz23, 0, 1, 8, 9, 4, 5, 12, 13),
            __builtin_shufflevector(yw01, yw23, 0, 1, 8, 9, 4, 5, 12, 13),
            __builtin_shufflevector(xz01, xz23, 2, 3, 10, 11, 6, 7, 14, 15),
            __builtin_shufflevector(yw01, yw23, 2, 3, 10, 11, 6, 7, 14, 15)};
  }

  [[gnu::always_inline]] inline RowsOfLanes join(const RowsOfHalf &low, const RowsOfHalf &high)
  {
    return {{low.x, high.x}, {low.y, high.y}, {low.z, high.z}, {low.w, high.w}};
  }

  /** Rows i and i + 4 of the eight whose offsets are given. */
  [[gnu::always_inline]] inline Half load_two(const Row *const rows, const RowOffset *const at, const int i)
  {
    return join(load_row(get_row(rows, at[i])), load_row(get_row(rows, at[i + 4])));
  }

  [[gnu::always_inline]] inline RowsOfHalf load_half_of_differences(const Row *const rows, const RowOffset *const a,
                                                                    const RowOffset *const b)
  {
    const auto load = [&](const int i) { return load_two(rows, b, i) - load_two(rows, a, i); };
    return transpose(load(0), load(1), load(2), load(3));
  }

  /** Rows at b less rows at a, of sixteen pairs. */
  [[gnu::always_inline]] inline RowsOfLanes load_differences(const Row *const rows, const RowOffset *const a,
                                                             const RowOffset *const b)
  {
    return join(load_half_of_differences(rows, a, b), load_half_of_differences(rows, a + n_half, b + n_half));
  }

  struct SumsAndDifferences
  {
    RowsOfLanes sum, difference;
  };

  /** Rows at b plus and less rows at a, of sixteen pairs. */
  [[gnu::always_inline]] inline SumsAndDifferences
  load_sums_and_differences(const Row *const rows, const RowOffset *const a, const RowOffset *const b)
  {
    RowsOfHalf sum[2], difference[2];
    for (int half = 0; half < 2; ++half)
      {
        Half s[4], d[4];
        for (int i = 0; i < 4; ++i)
          {
            const Half of_a = load_two(rows, a + half * n_half, i), of_b = load_two(rows, b + half * n_half, i);
            s[i] = of_b + of_a;
            d[i] = of_b - of_a;
          }
        sum[half] = transpose(s[0], s[1], s[2], s[3]);
        difference[half] = transpose(d[0], d[1], d[2], d[3]);
      }
    return {join(sum[0], sum[1]), join(difference[0], difference[1])};
  }

  /** Eight rows; r04 holds rows 0 and 4, and so on. */
  struct RowsByTwo
  {
    Half r04, r15, r26, r37;
  };

  /** transpose, backwards. */
  [[gnu::always_inline]] inline RowsByTwo collect_rows(const RowsOfHalf &v)
  {
    const Half xy0 = __builtin_shufflevector(v.x, v.y, 0, 8, 2, 10, 4, 12, 6, 14);
    const Half xy1 = __builtin_shufflevector(v.x, v.y, 1, 9, 3, 11, 5, 13, 7, 15);
    const Half zw0 = __builtin_shufflevector(v.z, v.w, 0, 8, 2, 10, 4, 12, 6, 14);
    const Half zw1 = __builtin_shufflevector(v.z, v.w, 1, 9, 3, 11, 5, 13, 7, 15);
    return {__builtin_shufflevector(xy0, zw0, 0, 1, 8, 9, 4, 5, 12, 13),
            __builtin_shufflevector(xy1, zw1, 0, 1, 8, 9, 4, 5, 12, 13),
            __builtin_shufflevector(xy0, zw0, 2, 3, 10, 11, 6, 7, 14, 15),
            __builtin_shufflevector(xy1, zw1, 2, 3, 10, 11, 6, 7, 14, 15)};
  }

  /** Calls take(i, row) for eight rows in their order, as numbers `first` to `first + 7`. */
  template <typename Taker>
  [[gnu::always_inline]] inline void give_half(const RowsOfHalf &v, const int first, const Taker &take)
  {
    const auto [r04, r15, r26, r37] = collect_rows(v);
    take(first + 0, __builtin_shufflevector(r04, r04, 0, 1, 2, 3));
    take(first + 1, __builtin_shufflevector(r15, r15, 0, 1, 2, 3));
    take(first + 2, __builtin_shufflevector(r26, r26, 0, 1, 2, 3));
    take(first + 3, __builtin_shufflevector(r37, r37, 0, 1, 2, 3));
    take(first + 4, __builtin_shufflevector(r04, r04, 4, 5, 6, 7));
    take(first + 5, __builtin_shufflevector(r15, r15, 4, 5, 6, 7));
    take(first + 6, __builtin_shufflevector(r26, r26, 4, 5, 6, 7));
    take(first + 7, __builtin_shufflevector(r37, r37, 4, 5, 6, 7));
  }

  /** The same with actions: rows of forces and of torques side by side. */
  template <typename Taker>
  [[gnu::always_inline]] inline void give_half(const RowsOfHalf &force, const RowsOfHalf &torque, const int first,
                                               const Taker &take)
  {
    const RowsByTwo f = collect_rows(force), t = collect_rows(torque);
    constexpr auto low = [](const Half p, const Half q) {
      return ActionLanes(__builtin_shufflevector(p, q, 0, 1, 2, 3, 8, 9, 10, 11));
    };
    constexpr auto high = [](const Half p, const Half q) {
      return ActionLanes(__builtin_shufflevector(p, q, 4, 5, 6, 7, 12, 13, 14, 15));
    };
    take(first + 0, low(f.r04, t.r04));
    take(first + 1, low(f.r15, t.r15));
    take(first + 2, low(f.r26, t.r26));
    take(first + 3, low(f.r37, t.r37));
    take(first + 4, high(f.r04, t.r04));
    take(first + 5, high(f.r15, t.r15));
    take(first + 6, high(f.r26, t.r26));
    take(first + 7, high(f.r37, t.r37));
  }

  /** Calls take(i, row) for the sixteen rows in their order. */
  template <typename Taker>
  [[gnu::always_inline]] inline void give_rows(const RowsOfLanes &v, const Taker &take)
  {
    give_half({v.x.low, v.y.low, v.z.low, v.w.low}, 0, take);
    give_half({v.x.high, v.y.high, v.z.high, v.w.high}, n_half, take);
  }

  /** Calls take(i, action) for the sixteen in their order. */
  template <typename Taker>
  [[gnu::always_inline]] inline void give_actions(const RowsOfLanes &f, const RowsOfLanes &t, const Taker &take)
  {
    give_half({f.x.low, f.y.low, f.z.low, f.w.low}, {t.x.low, t.y.low, t.z.low, t.w.low}, 0, take);
    give_half({f.x.high, f.y.high, f.z.high, f.w.high}, {t.x.high, t.y.high, t.z.high, t.w.high}, n_half, take);
  }
} // namespace dem

#pragma once

#include "dem/single_law.h"

/** Rows of grains in single precision, to lanes and back. */
namespace dem
{
  /** How far a grain has moved since the network was built [2^-32 of an edge], and its mass [kg]. */
  struct alignas(16) CountRow
  {
    std::int32_t x = 0, y = 0, z = 0;
    float mass = 0.f;
  };

  struct alignas(16) SingleRow
  {
    float x = 0.f, y = 0.f, z = 0.f, w = 0.f;
  };

  /** Velocity and spin, or force and torque: both in one load, one addition, one store. */
  struct alignas(32) TwinRow
  {
    SingleRow linear, angular;
  };

  using Counts = std::int32_t __attribute__((vector_size(16), may_alias));
  using Quad = float __attribute__((vector_size(16), may_alias));
  using Octet = float __attribute__((vector_size(32), may_alias));

  [[gnu::always_inline]] inline Counts load_row(const CountRow &row)
  {
    return *reinterpret_cast<const Counts *>(&row);
  }

  [[gnu::always_inline]] inline Quad load_row(const SingleRow &row)
  {
    return *reinterpret_cast<const Quad *>(&row);
  }

  [[gnu::always_inline]] inline Octet load_row(const TwinRow &row)
  {
    return *reinterpret_cast<const Octet *>(&row);
  }

  [[gnu::always_inline]] inline void store_row(CountRow &row, const Counts value)
  {
    *reinterpret_cast<Counts *>(&row) = value;
  }

  [[gnu::always_inline]] inline void store_row(SingleRow &row, const Quad value)
  {
    *reinterpret_cast<Quad *>(&row) = value;
  }

  [[gnu::always_inline]] inline void store_row(TwinRow &row, const Octet value)
  {
    *reinterpret_cast<Octet *>(&row) = value;
  }

  /** Where the counts of a grain lie [bytes behind the first]; its twin rows lie twice as far. */
  using SingleOffset = std::uint32_t;

  /** The same place, of which the compiler does not know what it has read there: reading again costs less than keeping
   * dozens of offsets where there is no register left for them. */
  template <typename T>
  [[gnu::always_inline]] inline T *forget(T *place)
  {
    asm("" : "+r"(place));
    return place;
  }

  template <typename R>
  [[gnu::always_inline]] inline R &get_row(R *const rows, const SingleOffset offset)
  {
    using Byte = std::conditional_t<std::is_const_v<R>, const char, char>;
    return *reinterpret_cast<R *>(reinterpret_cast<Byte *>(rows) +
                                  std::size_t(offset) * (sizeof(R) / sizeof(CountRow)));
  }

  [[gnu::always_inline]] inline Single join(const Octet low, const Octet high)
  {
#ifdef __AVX512VL__
    return reinterpret_cast<Single>(
        _mm512_insertf32x8(_mm512_castps256_ps512(reinterpret_cast<__m256>(low)), reinterpret_cast<__m256>(high), 1));
#else
    return __builtin_shufflevector(low, high, 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
#endif
  }

  [[gnu::always_inline]] inline Octet join(const Quad low, const Quad high)
  {
#ifdef __AVX__
    return reinterpret_cast<Octet>(
        _mm256_insertf128_ps(_mm256_castps128_ps256(reinterpret_cast<__m128>(low)), reinterpret_cast<__m128>(high), 1));
#else
    return __builtin_shufflevector(low, high, 0, 1, 2, 3, 4, 5, 6, 7);
#endif
  }

  /** Four numbers, then the same one four times. */
  [[gnu::always_inline]] inline Octet join(const Quad low, const float &high)
  {
#ifdef __AVX__
    return reinterpret_cast<Octet>(
        _mm256_blend_ps(_mm256_castps128_ps256(reinterpret_cast<__m128>(low)), _mm256_broadcast_ss(&high), 0xf0));
#else
    return join(low, Quad{high, high, high, high});
#endif
  }

  /** Four vectors of four quads each. */
  struct FourSingles
  {
    Single a, b, c, d;
  };

  /** Quad by quad, four rows of four become four columns; its own inverse. */
  [[gnu::always_inline]] inline FourSingles transpose_quads(const FourSingles &r)
  {
    constexpr auto low = [](const Single p, const Single q) {
      return __builtin_shufflevector(p, q, 0, 16, 1, 17, 4, 20, 5, 21, 8, 24, 9, 25, 12, 28, 13, 29);
    };
    constexpr auto high = [](const Single p, const Single q) {
      return __builtin_shufflevector(p, q, 2, 18, 3, 19, 6, 22, 7, 23, 10, 26, 11, 27, 14, 30, 15, 31);
    };
    const Single xy01 = low(r.a, r.b), xy23 = low(r.c, r.d), zw01 = high(r.a, r.b), zw23 = high(r.c, r.d);
    constexpr auto first = [](const Single p, const Single q) {
      return __builtin_shufflevector(p, q, 0, 1, 16, 17, 4, 5, 20, 21, 8, 9, 24, 25, 12, 13, 28, 29);
    };
    constexpr auto second = [](const Single p, const Single q) {
      return __builtin_shufflevector(p, q, 2, 3, 18, 19, 6, 7, 22, 23, 10, 11, 26, 27, 14, 15, 30, 31);
    };
    return {first(xy01, xy23), second(xy01, xy23), first(zw01, zw23), second(zw01, zw23)};
  }

  /** The four numbers of a row, lane by lane. */
  template <typename L>
  struct RowLanesOf
  {
    L x, y, z, w;
  };

  /** Sixteen rows of four, number by number; load(i) gives row i as a quad. */
  template <typename Load>
  [[gnu::always_inline]] inline FourSingles load_quads(const Load &load)
  {
    const auto four = [&load](const int i) {
      return join(join(load(i), load(i + 4)), join(load(i + 8), load(i + 12)));
    };
    return transpose_quads({four(0), four(1), four(2), four(3)});
  }

  /** Both halves of sixteen twin rows, number by number. */
  struct TwinSingles
  {
    RowLanesOf<Singles> linear, angular;
  };

  /** Sixteen twin rows, number by number; load(i) gives row i as an octet. */
  template <typename Load>
  [[gnu::always_inline]] inline TwinSingles load_octets(const Load &load)
  {
    const auto four = [&load](const int i) {
      return transpose_quads({join(load(i), load(i + 4)), join(load(i + 1), load(i + 5)),
                              join(load(i + 2), load(i + 6)), join(load(i + 3), load(i + 7))});
    };
    const FourSingles low = four(0), high = four(8); // each: linear, angular, linear, angular of four rows
    constexpr auto even = [](const Single p, const Single q) {
      return Singles(__builtin_shufflevector(p, q, 0, 1, 2, 3, 8, 9, 10, 11, 16, 17, 18, 19, 24, 25, 26, 27));
    };
    constexpr auto odd = [](const Single p, const Single q) {
      return Singles(__builtin_shufflevector(p, q, 4, 5, 6, 7, 12, 13, 14, 15, 20, 21, 22, 23, 28, 29, 30, 31));
    };
    return {{even(low.a, high.a), even(low.b, high.b), even(low.c, high.c), even(low.d, high.d)},
            {odd(low.a, high.a), odd(low.b, high.b), odd(low.c, high.c), odd(low.d, high.d)}};
  }

  /** Calls take(i, row) for sixteen rows in their order: load_quads backwards. */
  template <typename Take>
  [[gnu::always_inline]] inline void give_quads(const RowLanesOf<Singles> &v, const Take &take)
  {
    const FourSingles rows = transpose_quads({v.x.v, v.y.v, v.z.v, v.w.v});
    const auto give = [&]<int i>(std::integral_constant<int, i>) {
      take(i + 0, Quad(__builtin_shufflevector(rows.a, rows.a, i, i + 1, i + 2, i + 3)));
      take(i + 1, Quad(__builtin_shufflevector(rows.b, rows.b, i, i + 1, i + 2, i + 3)));
      take(i + 2, Quad(__builtin_shufflevector(rows.c, rows.c, i, i + 1, i + 2, i + 3)));
      take(i + 3, Quad(__builtin_shufflevector(rows.d, rows.d, i, i + 1, i + 2, i + 3)));
    };
    give(std::integral_constant<int, 0>{});
    give(std::integral_constant<int, 4>{});
    give(std::integral_constant<int, 8>{});
    give(std::integral_constant<int, 12>{});
  }

  /** Calls take(i, row) for sixteen twin rows in the order of their numbers. */
  template <typename Take>
  [[gnu::always_inline]] inline void give_octets(const TwinSingles &v, const Take &take)
  {
    constexpr auto low = [](const Singles p, const Singles q) {
      return __builtin_shufflevector(p.v, q.v, 0, 1, 2, 3, 16, 17, 18, 19, 4, 5, 6, 7, 20, 21, 22, 23);
    };
    constexpr auto high = [](const Singles p, const Singles q) {
      return __builtin_shufflevector(p.v, q.v, 8, 9, 10, 11, 24, 25, 26, 27, 12, 13, 14, 15, 28, 29, 30, 31);
    };
    const RowLanesOf<Singles> &l = v.linear, &a = v.angular;
    const auto give = [&take](const FourSingles &columns, const int i) {
      const FourSingles rows = transpose_quads(columns);
      const auto two = [&take](const Single pair, const int k) {
        take(k, Octet(__builtin_shufflevector(pair, pair, 0, 1, 2, 3, 4, 5, 6, 7)));
        take(k + 4, Octet(__builtin_shufflevector(pair, pair, 8, 9, 10, 11, 12, 13, 14, 15)));
      };
      two(rows.a, i), two(rows.b, i + 1), two(rows.c, i + 2), two(rows.d, i + 3);
    };
    give({low(l.x, a.x), low(l.y, a.y), low(l.z, a.z), low(l.w, a.w)}, 0);
    give({high(l.x, a.x), high(l.y, a.y), high(l.z, a.z), high(l.w, a.w)}, 8);
  }
} // namespace dem

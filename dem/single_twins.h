#pragma once

#include "dem/single_law.h"

namespace dem
{
  /**
   * Two vectors of sixteen, each operation done to both in turn, as lanes.h does it for double: one computes while the
   * other waits for what it computed before.
   */
  struct TwinMask
  {
    SinglesMask low, high;
  };

  struct Twins
  {
    Singles low, high;

    Twins() = default;
    [[gnu::always_inline]] Twins(const Singles l, const Singles h) : low(l), high(h) {}
    [[gnu::always_inline]] Twins(const float x) : low(x), high(low) {} ///< the same in all lanes

    [[gnu::always_inline]] friend Twins operator+(const Twins &a, const Twins &b)
    {
      return {a.low + b.low, a.high + b.high};
    }
    [[gnu::always_inline]] friend Twins operator-(const Twins &a, const Twins &b)
    {
      return {a.low - b.low, a.high - b.high};
    }
    [[gnu::always_inline]] friend Twins operator*(const Twins &a, const Twins &b)
    {
      return {a.low * b.low, a.high * b.high};
    }
    [[gnu::always_inline]] friend Twins operator/(const Twins &a, const Twins &b)
    {
      return {a.low / b.low, a.high / b.high};
    }
    [[gnu::always_inline]] friend Twins operator-(const Twins &a) { return {-a.low, -a.high}; }
    [[gnu::always_inline]] friend Twins &operator+=(Twins &a, const Twins &b) { return a = a + b; }
    [[gnu::always_inline]] friend Singles &operator+=(Singles &sum, const Twins &a)
    {
      return sum += a.low, sum += a.high;
    }
    [[gnu::always_inline]] friend TwinMask operator<(const Twins &a, const Twins &b)
    {
      return {a.low < b.low, a.high < b.high};
    }
  };

  template <>
  struct LaneLimits<Twins> : LaneLimits<Singles>
  {};

  [[gnu::always_inline]] inline Twins select(const TwinMask &mask, const Twins &yes, const Twins &no)
  {
    return {select(mask.low, yes.low, no.low), select(mask.high, yes.high, no.high)};
  }

  [[gnu::always_inline]] inline Twins compute_larger(const Twins &a, const Twins &b)
  {
    return {compute_larger(a.low, b.low), compute_larger(a.high, b.high)};
  }

  [[gnu::always_inline]] inline Twins compute_inverse_root(const Twins &value)
  {
    return {compute_inverse_root(value.low), compute_inverse_root(value.high)};
  }

  [[gnu::always_inline]] inline Twins compute_root(const Twins &value)
  {
    return {compute_root(value.low), compute_root(value.high)};
  }

  [[gnu::always_inline]] inline Twins compute_power(const Twins &x, const Twins &y)
  {
    return {compute_power(x.low, y.low), compute_power(x.high, y.high)};
  }

  [[gnu::always_inline]] inline Twins compute_turn(const Twins &square, const Twins &along)
  {
    return {compute_turn(square.low, along.low), compute_turn(square.high, along.high)};
  }

  [[gnu::always_inline]] inline bool is_any(const TwinMask &mask)
  {
    return is_any(mask.low) || is_any(mask.high);
  }

  [[gnu::always_inline]] inline int count(const TwinMask &mask)
  {
    return count(mask.low) + count(mask.high);
  }

  [[gnu::always_inline]] inline double sum_lanes(const Twins &value)
  {
    return sum_lanes(value.low) + sum_lanes(value.high);
  }

  /** How many vectors there are in one of L. */
  template <typename L>
  inline constexpr int n_parts = 1;
  template <>
  inline constexpr int n_parts<Twins> = 2;

  /** An L of what make(part) gives for each of its vectors. */
  template <typename L, typename Make>
  [[gnu::always_inline]] inline L make_lanes(const Make &make)
  {
    if constexpr (n_parts<L> == 1)
      return make(0);
    else
      return {make(0), make(1)};
  }

  /** Calls act(part) for each vector of an L; written out, since what a loop counts through must lie in memory. */
  template <typename L, typename Act>
  [[gnu::always_inline]] inline void for_each_part(const Act &act)
  {
    act(0);
    if constexpr (n_parts<L> == 2)
      act(1);
  }

  template <typename T>
  [[gnu::always_inline]] inline const auto &get_part(const T &lanes, const int part)
  {
    if constexpr (std::is_same_v<T, Twins> || std::is_same_v<T, TwinMask>)
      return part == 0 ? lanes.low : lanes.high;
    else
      return lanes;
  }
} // namespace dem

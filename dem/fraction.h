#pragma once

#include <algorithm>
#include <cmath>

namespace dem
{
  /** A fraction of an edge of the periodic cell as the one in [0, 1] of the same place; 1 by rounding alone. */
  inline double wrap_fraction(const double fraction)
  {
    return fraction - std::floor(fraction);
  }

  /**
   * The step, from 0, in which a wrapped fraction lies when its edge has n of them.
   *
   * The first for what is not a number: the run will say so, the arrays must hold until then.
   */
  inline int locate_fraction(const double wrapped, const double n)
  {
    return wrapped >= 0. ? static_cast<int>(std::min(wrapped * n, n - 1.)) : 0;
  }
} // namespace dem

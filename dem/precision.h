#pragma once

namespace dem
{
  /** What the cycle of a REV computes in. */
  enum class Precision
  {
    full,  ///< double
    single ///< float, but for sums over blocks and for overlaps when a network is built
  };

  /** Below this unbalanced ratio rounding in single precision is not surely out of the way (docs/performance.md) [-].
   */
  inline constexpr double finest_single_ratio = 1e-6;
} // namespace dem

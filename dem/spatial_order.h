#pragma once

#include "dem/cell.h"

#include <cstdint>
#include <span>
#include <vector>

namespace dem
{
  /**
   * The order in which grains that are near in space are near in storage, along Hilbert's curve through the cell; ties
   * by index.
   *
   * @param place  x, y, z: fractions of the cell's edges, any image
   * @return a permutation: order[new] = old
   */
  std::vector<std::uint32_t> compute_spatial_order(const Cell &cell, std::span<const Row> place);
} // namespace dem

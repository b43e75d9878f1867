#pragma once

#include "dem/vector.h"

#include <array>

namespace dem
{
  /** One of the fourteen pieces of a unit sphere. */
  struct Sibling
  {
    Vector centre; ///< [parent radii], from the parent's centre
    double radius; ///< [parent radii]
  };

  inline constexpr int n_siblings = 14;

  /**
   * The fourteen siblings inscribed in a unit sphere (time-to-fracture paper, Fig. 1; docs/theory.md): 6 at the corners
   * of an octahedron, 8 along the diagonals of its cube, each of the 8 tangent to the shell and to three of the 6.
   *
   * @param normal      unit vector from the parent's centre to its largest contact force; sibling 0 is turned onto it
   * @param spin_angle  turn of the whole about that normal [rad]
   */
  std::array<Sibling, n_siblings> compute_siblings(const Vector &normal, double spin_angle);

  /** Share of the parent's volume that the siblings keep [-]: 0.523861. */
  double compute_kept_volume_share();
} // namespace dem

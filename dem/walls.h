#pragma once

#include "dem/cell.h"

#include <cstdint>

namespace dem
{
  /** The walls of a rigid cell in the order x-, x+, y-, y+, z-, z+. */
  inline constexpr std::uint32_t n_walls = 6;

  /** In the place of a second grain the first wall is the number below 2^32 that reads as -1, the last as -6. */
  inline constexpr std::uint32_t first_partner_of_walls = 0u - n_walls;

  /** True where the second partner of a contact is a wall. */
  inline bool is_wall(const std::uint32_t partner)
  {
    return partner >= first_partner_of_walls;
  }

  inline std::uint32_t to_partner(const std::uint32_t wall)
  {
    return 0u - (wall + 1);
  }

  /** @pre is_wall(partner) */
  inline std::uint32_t to_wall(const std::uint32_t partner)
  {
    return 0u - (partner + 1);
  }

  /** -1 to -6, as files name a wall. @pre is_wall(partner) */
  inline int to_number(const std::uint32_t partner)
  {
    return static_cast<int>(partner);
  }

  /** The axis that a wall stands across: 0, 1 or 2. */
  inline int get_axis(const std::uint32_t wall)
  {
    return static_cast<int>(wall / 2);
  }

  /** Unit normal of a wall, out of the cell. */
  inline Vector get_outward_normal(const std::uint32_t wall)
  {
    return (wall % 2 == 0 ? -1. : 1.) * Vector::Unit(get_axis(wall));
  }

  /** From a grain's centre to the wall [m], negative beyond it. @pre cell.has_walls() */
  inline double compute_distance_to_wall(const Cell &cell, const Row &place, const std::uint32_t wall)
  {
    const int axis = get_axis(wall);
    const double fraction = axis == 0 ? place.x : axis == 1 ? place.y : place.z;
    return (wall % 2 == 0 ? fraction : 1. - fraction) * cell.edges(axis, axis);
  }
} // namespace dem

#pragma once

#include "dem/column.h"
#include "dem/vector.h"

#include <cstdint>
#include <vector>

namespace dem
{
  /** Number of a grain, unique in its REV for ever; siblings get new ones. */
  using GrainId = std::uint64_t;

  /**
   * The grains of a REV as arrays of equal length, which lie in the block of its state (dem/rev_arrays.h); position in
   * the arrays is a matter of storage, `id` names a grain.
   *
   * Positions are fractions of the cell's edges, so that a deforming cell carries its grains along and periodic images
   * are whole numbers apart.
   */
  struct Grains
  {
    Column<Row> place;    ///< x, y, z: position in the cell [fraction of its edges]; w: radius [m]
    Column<Row> velocity; ///< x, y, z: velocity beside the cell's own motion [m/s]; w: mass [kg]
    Column<Row> spin;     ///< x, y, z: angular velocity [1/s]; w: moment of inertia [kg m2]

    Column<GrainId> id;
    Column<GrainId> parent;           ///< id of the grain it came from; its own id for a grain of the packing
    Column<std::uint32_t> generation; ///< 0 in the packing, one more at each split

    Column<double> strength;               ///< sigma_lim [Pa]
    Column<double> crack_half_length;      ///< a [m]
    Column<double> crack_velocity;         ///< v at the last equilibrium [m/s]
    Column<double> largest_contact_stress; ///< sigma at the last equilibrium [Pa], compression-positive

    std::size_t size() const { return place.size(); }

    /** Copies grain `from` of `source` into place `to` of this. */
    void assign(std::size_t to, const Grains &source, std::size_t from);

    /** Grain `order[i]` comes to place i. @pre order is a permutation */
    void permute(const std::vector<std::uint32_t> &order);

    /** Keeps the grains whose flag is set, in their order. @pre is_kept.size() == size() */
    void keep(const std::vector<bool> &is_kept);
  };

  /** The one list of arrays, in the order of memory: calls the operation with each array of the first grains and the
   * same one of the others. */
  template <typename Operation, typename First, typename... Others>
  void for_each_array(const Operation &operation, First &grains, Others &...others)
  {
    operation(grains.place, others.place...);
    operation(grains.velocity, others.velocity...);
    operation(grains.spin, others.spin...);
    operation(grains.id, others.id...);
    operation(grains.parent, others.parent...);
    operation(grains.generation, others.generation...);
    operation(grains.strength, others.strength...);
    operation(grains.crack_half_length, others.crack_half_length...);
    operation(grains.crack_velocity, others.crack_velocity...);
    operation(grains.largest_contact_stress, others.largest_contact_stress...);
  }

  /** Volume of the grains [m3]. */
  double compute_solid_volume(const Grains &grains);
} // namespace dem

#pragma once

#include "dem/vector.h"

#include <cstdint>
#include <vector>

namespace dem
{
  /** Number of a grain, unique in its REV for ever; siblings get new ones. */
  using GrainId = std::uint64_t;

  /**
   * The grains of a REV as arrays of equal length; position in the arrays is a matter of storage, `id` names a grain.
   *
   * Positions are fractions of the cell's edges, so that a deforming cell carries its grains along and periodic images
   * are whole numbers apart.
   */
  struct Grains
  {
    std::vector<Row> place;    ///< x, y, z: position in the cell [fraction of its edges]; w: radius [m]
    std::vector<Row> velocity; ///< x, y, z: velocity beside the cell's own motion [m/s]; w: mass [kg]
    std::vector<Row> spin;     ///< x, y, z: angular velocity [1/s]; w: moment of inertia [kg m2]

    std::vector<GrainId> id;
    std::vector<GrainId> parent;           ///< id of the grain it came from; its own id for a grain of the packing
    std::vector<std::uint32_t> generation; ///< 0 in the packing, one more at each split

    std::vector<double> strength;               ///< sigma_lim [Pa]
    std::vector<double> crack_half_length;      ///< a [m]
    std::vector<double> crack_velocity;         ///< v at the last equilibrium [m/s]
    std::vector<double> largest_contact_stress; ///< sigma at the last equilibrium [Pa], compression-positive

    std::size_t size() const { return place.size(); }

    std::size_t count_bytes() const; ///< memory that the arrays hold

    /** Makes room for n grains in every array. */
    void resize(std::size_t n);

    /** Copies grain `from` of `source` into place `to` of this. */
    void assign(std::size_t to, const Grains &source, std::size_t from);

    /** Grain `order[i]` comes to place i. @pre order is a permutation */
    void permute(const std::vector<std::uint32_t> &order);

    /** Keeps the grains whose flag is set, in their order. @pre is_kept.size() == size() */
    void keep(const std::vector<bool> &is_kept);
  };

  /** Volume of the grains [m3]. */
  double compute_solid_volume(const Grains &grains);
} // namespace dem

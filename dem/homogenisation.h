#pragma once

#include "dem/contact.h"
#include "dem/grains.h"

#include <span>

namespace dem
{
  /** d(Cauchy)/d(strain) [Pa]: rows and columns xx, yy, zz, xy, yz, xz. Entry (ij, kl) is C_ijkl: a shear column
   * answers to eps_kl = eps_lk = 1/2. Unsymmetric under prestress. */
  using Tangent = Eigen::Matrix<double, 6, 6>;

  /** The i and j of a row or column of a Tangent. */
  inline constexpr int tangent_index[6][2] = {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {1, 2}, {0, 2}};

  /** Love-Weber stress [Pa], tension-positive: (1/V) sum of f_a x (x_b - x_a). Its antisymmetric part is the
   *  unbalanced moment. @param volume of the cell [m3] */
  Matrix compute_stress(std::span<const Contact> contacts, double volume);

  /** (1/n) sum of n x n over the contacts [-]; trace 1, or zero without contacts. */
  Matrix compute_fabric(std::span<const Contact> contacts);

  struct CoordinationNumbers
  {
    double all = 0.;              ///< 2 contacts / grains; one with a wall counts once
    double without_rattlers = 0.; ///< the same over grains with at least `rattler_limit` contacts
    std::size_t n_rattlers = 0;
  };

  /** Rattlers are grains with fewer than 4 contacts when they turn freely, 3 when they cannot turn. */
  CoordinationNumbers compute_coordination(std::span<const Contact> contacts, std::size_t n_grains,
                                           bool is_rotation_free);

  /** The packing whose tangent is wanted. */
  struct ContactGraph
  {
    std::span<const Contact> contacts;
    std::span<const double> radii; ///< of the grains [m]
    double volume = 0.;            ///< of the cell [m3]
    bool is_rotation_free = false;
  };

  /**
   * Small-strain tangent by static condensation of the contact network (docs/theory.md): normal, shear and geometric
   * terms, sliding contacts without tangential stiffness, grains at rest again after each of six unit strains.
   * NaN throughout when the factorisation fails.
   */
  Tangent compute_condensed_tangent(const ContactGraph &graph);

  /** The same with every grain following the mean strain (Voigt): an upper estimate. */
  Tangent compute_affine_tangent(const ContactGraph &graph);
} // namespace dem

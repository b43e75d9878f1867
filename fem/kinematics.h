#pragma once

#include <deal.II/base/symmetric_tensor.h>
#include <deal.II/base/tensor.h>

namespace fem
{
  /**
   * What a deformation increment means. The problem and its material must be told the same.
   *
   * `finite`: dF is split into rotation and stretch, stress acts in the current configuration (updated Lagrangian).
   * `small`: dF is I + grad du, strain is sym(dF) - I, stress acts in the initial configuration, nothing rotates.
   */
  enum class Kinematics
  {
    finite,
    small
  };

  /** F = rotation exp(log_stretch): the right polar decomposition with the logarithm of its stretch [-]. */
  struct PolarDecomposition
  {
    dealii::Tensor<2, 3> rotation;
    dealii::SymmetricTensor<2, 3> log_stretch;
  };

  /**
   * Splits a deformation gradient. Exact for F = I (rotation I, stretch 0, bit by bit), and as accurate for strains of
   * 1e-12 as for large ones, because it works on F^T F - I.
   *
   * @param deformation  F [-], any rotation and stretch. @pre det F > 0
   */
  PolarDecomposition decompose_polar(const dealii::Tensor<2, 3> &deformation);

  /** Logarithmic strain ln V = R ln U R^T in the current axes [-], tension-positive. @pre det F > 0 */
  dealii::SymmetricTensor<2, 3> compute_log_strain(const dealii::Tensor<2, 3> &deformation);

  /** Q s Q^T. */
  dealii::SymmetricTensor<2, 3> rotate(const dealii::SymmetricTensor<2, 3> &tensor,
                                       const dealii::Tensor<2, 3> &rotation);
} // namespace fem

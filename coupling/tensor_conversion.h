#pragma once

#include "dem/homogenisation.h"

#include <deal.II/base/symmetric_tensor.h>
#include <deal.II/base/tensor.h>

namespace coupling
{
  /**
   * Between the two libraries of tensors; the only place that knows both orders of indices. dem counts xx, yy, zz, xy,
   * yz, xz (dem::tangent_index), deal.II xx, yy, zz, xy, xz, yz: nothing here relies on either, entries go by (i, j).
   */
  dem::Matrix to_matrix(const dealii::Tensor<2, 3> &tensor);
  dealii::Tensor<2, 3> to_tensor(const dem::Matrix &matrix);

  /** The symmetric part: a stress of blocked grains has another one, which the macro scale does not know. */
  dealii::SymmetricTensor<2, 3> to_symmetric_tensor(const dem::Matrix &matrix);
  dem::Matrix to_matrix(const dealii::SymmetricTensor<2, 3> &tensor);

  /** C_ijkl of the 6x6 entries [Pa]; not symmetric in (ij), (kl) under prestress. */
  dealii::SymmetricTensor<4, 3> to_tensor(const dem::Tangent &tangent);

  /** Q_ia Q_jb Q_kc Q_ld C_abcd: a tangent of the REV's axes in the solver's. */
  dealii::SymmetricTensor<4, 3> rotate(const dealii::SymmetricTensor<4, 3> &tangent, const dem::Matrix &rotation);
} // namespace coupling

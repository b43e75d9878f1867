#include "fem/kinematics.h"

#include <cmath>

namespace fem
{
  using dealii::SymmetricTensor;
  using dealii::Tensor;

  PolarDecomposition decompose_polar(const Tensor<2, 3> &deformation)
  {
    const Tensor<2, 3> gradient = deformation - dealii::unit_symmetric_tensor<3>();
    const auto growth =
        dealii::symmetrize(gradient + dealii::transpose(gradient) + dealii::transpose(gradient) * gradient);
    const auto pairs = dealii::eigenvectors(growth, dealii::SymmetricTensorEigenvectorMethod::jacobi);

    PolarDecomposition split;
    SymmetricTensor<2, 3> inverse_stretch;
    for (const auto &[eigenvalue, direction] : pairs)
      {
        const auto projector = dealii::symmetrize(dealii::outer_product(direction, direction));
        split.log_stretch += 0.5 * std::log1p(eigenvalue) * projector;
        inverse_stretch += 1. / std::sqrt(1. + eigenvalue) * projector;
      }
    split.rotation = deformation * Tensor<2, 3>(inverse_stretch);
    return split;
  }

  SymmetricTensor<2, 3> compute_log_strain(const Tensor<2, 3> &deformation)
  {
    const PolarDecomposition split = decompose_polar(deformation);
    return rotate(split.log_stretch, split.rotation);
  }

  SymmetricTensor<2, 3> rotate(const SymmetricTensor<2, 3> &tensor, const Tensor<2, 3> &rotation)
  {
    return dealii::symmetrize(rotation * Tensor<2, 3>(tensor) * dealii::transpose(rotation));
  }
} // namespace fem

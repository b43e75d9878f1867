#include "fem/elastic_material.h"

#include <fmt/format.h>

#include <stdexcept>

namespace fem
{
  dealii::SymmetricTensor<4, 3> compute_isotropic_modulus(double bulk_modulus, double shear_modulus)
  {
    const auto unit = dealii::unit_symmetric_tensor<3>();
    return bulk_modulus * dealii::outer_product(unit, unit) + 2. * shear_modulus * dealii::deviator_tensor<3>();
  }

  ElasticMaterial::ElasticMaterial(const ElasticParameters &parameters, MPI_Comm communicator)
      : CorotationalMaterial(parameters.kinematics, communicator)
  {
    const double E = parameters.youngs_modulus, nu = parameters.poissons_ratio;
    if (!(E > 0.))
      throw std::invalid_argument(fmt::format("elastic material: Young's modulus = {} must be > 0 Pa", E));
    if (!(nu > -1. && nu < 0.5))
      throw std::invalid_argument(fmt::format("elastic material: Poisson's ratio = {} must lie in (-1, 0.5)", nu));
    modulus_ = compute_isotropic_modulus(E / (3. * (1. - 2. * nu)), E / (2. * (1. + nu)));
  }

  LocalAnswer ElasticMaterial::respond(const CorotationalState &baseline,
                                       const dealii::SymmetricTensor<2, 3> &strain_increment) const
  {
    LocalAnswer answer{baseline, modulus_};
    answer.state.stress += modulus_ * strain_increment;
    return answer;
  }
} // namespace fem

#pragma once

#include "fem/corotational_material.h"

namespace fem
{
  struct ElasticParameters
  {
    double youngs_modulus = 1e8;                ///< [Pa], > 0
    double poissons_ratio = 0.25;               ///< [-], in (-1, 0.5)
    Kinematics kinematics = Kinematics::finite; ///< the problem's
  };

  /** Isotropic modulus [Pa] of bulk modulus K and shear modulus G: K 1x1 + 2 G dev. */
  dealii::SymmetricTensor<4, 3> compute_isotropic_modulus(double bulk_modulus, double shear_modulus);

  /** Isotropic linear elasticity between Cauchy stress and logarithmic strain increments, from any initial stress. */
  class ElasticMaterial : public CorotationalMaterial
  {
  public:
    ElasticMaterial(const ElasticParameters &parameters, MPI_Comm communicator);

  protected:
    LocalAnswer respond(const CorotationalState &baseline,
                        const dealii::SymmetricTensor<2, 3> &strain_increment) const override;

  private:
    dealii::SymmetricTensor<4, 3> modulus_;
  };
} // namespace fem

#pragma once

#include "fem/corotational_material.h"

#include <deal.II/base/tensor.h>

namespace fem
{
  /** Burgers: a Maxwell and a Kelvin element in series in the deviator, elastic in volume. */
  struct BurgersParameters
  {
    double bulk_modulus = 1e8;                  ///< K [Pa], > 0
    double maxwell_modulus = 1e8;               ///< G_m [Pa], > 0
    double maxwell_viscosity = 1e12;            ///< eta_m [Pa s], > 0
    double kelvin_modulus = 1e8;                ///< G_k [Pa], > 0
    double kelvin_viscosity = 1e10;             ///< eta_k [Pa s], > 0
    Kinematics kinematics = Kinematics::finite; ///< the problem's
  };

  /** A step of the linear system of (elastic strain, Kelvin strain), both deviatoric and in units of strain. */
  struct BurgersPropagator
  {
    dealii::Tensor<2, 2> carry;    ///< of the state over the step
    dealii::Tensor<1, 2> response; ///< of both to a strain increment that grows linearly over the step
  };

  /** Exact for a constant strain rate: exp(A dt) and (A dt)^-1 (exp(A dt) - 1). @param dt [s], >= 0; 0: elastic. */
  BurgersPropagator compute_propagator(const BurgersParameters &parameters, double dt);

  /**
   * Linear viscoelasticity that takes time in closed form: the strain increment of a step is spread evenly over its dt,
   * which is exact at held strain (relaxation) and of second order otherwise.
   */
  class ViscoelasticMaterial : public CorotationalMaterial
  {
  public:
    ViscoelasticMaterial(const BurgersParameters &parameters, MPI_Comm communicator);

  protected:
    LocalAnswer respond(const CorotationalState &baseline,
                        const dealii::SymmetricTensor<2, 3> &strain_increment) const override;
    void announce(double dt) override { propagator_ = compute_propagator(parameters_, dt); }
    void end_time() override { announce(0.); }

  private:
    BurgersParameters parameters_;
    BurgersPropagator propagator_;
  };
} // namespace fem

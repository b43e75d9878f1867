#include "fem/viscoelastic_material.h"

#include "fem/elastic_material.h"

#include <fmt/format.h>

#include <cmath>
#include <stdexcept>

namespace fem
{
  namespace
  {
    double compute_growth(double z)
    {
      return z == 0. ? 1. : std::expm1(z) / z;
    }

    void require_positive(double value, const char *name)
    {
      if (!(value > 0.))
        throw std::invalid_argument(fmt::format("viscoelastic material: {} = {} must be > 0", name, value));
    }
  } // namespace

  // With x = (s / 2 G_m, e_k): e_k' = (G_m x_1 - G_k x_2) / eta_k, x_1' = e' - G_m x_1 / eta_m - e_k'. Both eigenvalues
  // of this A are real, negative and distinct; a function of A is the line through its values at them.
  BurgersPropagator compute_propagator(const BurgersParameters &parameters, double dt)
  {
    const double maxwell = parameters.maxwell_modulus / parameters.maxwell_viscosity;
    const double shared = parameters.maxwell_modulus / parameters.kelvin_viscosity;
    const double kelvin = parameters.kelvin_modulus / parameters.kelvin_viscosity;
    const double half_trace = -0.5 * (maxwell + shared + kelvin);
    const double root = std::sqrt(half_trace * half_trace - maxwell * kelvin);
    const double slow = maxwell * kelvin / (half_trace - root), fast = half_trace - root;

    dealii::Tensor<2, 2> A, unit;
    A[0][0] = -maxwell - shared;
    A[0][1] = kelvin;
    A[1][0] = shared;
    A[1][1] = -kelvin;
    unit[0][0] = unit[1][1] = 1.;
    const auto slow_part = (A - fast * unit) / (slow - fast);
    const auto fast_part = unit - slow_part;

    dealii::Tensor<1, 2> increment;
    increment[0] = 1.;
    BurgersPropagator propagator;
    propagator.carry = std::exp(slow * dt) * slow_part + std::exp(fast * dt) * fast_part;
    propagator.response = (compute_growth(slow * dt) * slow_part + compute_growth(fast * dt) * fast_part) * increment;
    return propagator;
  }

  ViscoelasticMaterial::ViscoelasticMaterial(const BurgersParameters &parameters, MPI_Comm communicator)
      : CorotationalMaterial(parameters.kinematics, communicator), parameters_(parameters)
  {
    require_positive(parameters.bulk_modulus, "bulk modulus [Pa]");
    require_positive(parameters.maxwell_modulus, "Maxwell modulus [Pa]");
    require_positive(parameters.maxwell_viscosity, "Maxwell viscosity [Pa s]");
    require_positive(parameters.kelvin_modulus, "Kelvin modulus [Pa]");
    require_positive(parameters.kelvin_viscosity, "Kelvin viscosity [Pa s]");
    announce(0.);
  }

  LocalAnswer ViscoelasticMaterial::respond(const CorotationalState &baseline,
                                            const dealii::SymmetricTensor<2, 3> &strain_increment) const
  {
    const double G = parameters_.maxwell_modulus, K = parameters_.bulk_modulus;
    const auto &[carry, response] = propagator_;
    const auto elastic_strain = dealii::deviator(baseline.stress) / (2. * G);
    const auto shear_increment = dealii::deviator(strain_increment);
    const double pressure =
        dealii::trace(baseline.stress) / 3. + K * dealii::trace(strain_increment); // tension-positive

    LocalAnswer answer{baseline, compute_isotropic_modulus(K, G * response[0])};
    answer.state.stress =
        2. * G *
            (carry[0][0] * elastic_strain + carry[0][1] * baseline.delayed_strain + response[0] * shear_increment) +
        pressure * dealii::unit_symmetric_tensor<3>();
    answer.state.delayed_strain =
        carry[1][0] * elastic_strain + carry[1][1] * baseline.delayed_strain + response[1] * shear_increment;
    return answer;
  }
} // namespace fem

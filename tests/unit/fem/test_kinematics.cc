#include "fem/viscoelastic_material.h"
#include "tests/support/fem_cases.h"

#include <deal.II/physics/transformations.h>

#include <gtest/gtest.h>

using namespace fem;
using namespace fem::cases;
using dealii::SymmetricTensor;
using dealii::Tensor;

namespace
{
  const Tensor<2, 3> identity(dealii::unit_symmetric_tensor<3>());

  Tensor<2, 3> create_rotation(double degrees)
  {
    dealii::Point<3> axis(1., -2., 0.5);
    axis /= axis.norm();
    return dealii::Physics::Transformations::Rotations::rotation_matrix_3d(axis, degrees * dealii::numbers::PI / 180.);
  }

  Tensor<2, 3> create_deformation()
  {
    Tensor<2, 3> deformation = identity;
    deformation[0][0] += 0.02;
    deformation[0][1] += 0.05;
    deformation[1][2] -= 0.03;
    deformation[2][0] += 0.01;
    deformation[2][2] -= 0.04;
    return deformation;
  }

  SymmetricTensor<2, 3> create_stress()
  {
    SymmetricTensor<2, 3> stress;
    stress[0][0] = -2e6;
    stress[1][1] = -3e6;
    stress[2][2] = -7e6;
    stress[0][1] = 4e5;
    stress[1][2] = -2e5;
    return stress;
  }

  PointResponse evaluate(ConstitutiveModel &material, const Tensor<2, 3> &deformation)
  {
    const std::vector<PointRequest> requests = {{0, deformation}};
    std::vector<PointResponse> responses(1);
    material.evaluate(requests, responses, true);
    return responses[0];
  }

  /** The two reference materials, with a step of time under way where time matters. */
  std::vector<std::unique_ptr<ConstitutiveModel>> create_materials()
  {
    std::vector<std::unique_ptr<ConstitutiveModel>> materials;
    materials.push_back(std::make_unique<ElasticMaterial>(get_elastic_parameters(Kinematics::finite), MPI_COMM_SELF));
    materials.push_back(std::make_unique<ViscoelasticMaterial>(BurgersParameters(), MPI_COMM_SELF));
    for (const auto &material : materials)
      {
        const std::vector<PointSite> sites = {{0, dealii::Point<3>(), create_stress()}};
        material->initialise(sites);
        material->begin_step(50.);
      }
    return materials;
  }
} // namespace

TEST(Kinematics, PolarDecompositionGivesBackWhatWentIn)
{
  // Law: F = R exp(ln U), R orthogonal.
  const Tensor<2, 3> deformation = create_rotation(50.) * create_deformation();
  const PolarDecomposition split = decompose_polar(deformation);
  EXPECT_LT((dealii::transpose(split.rotation) * split.rotation - identity).norm(), 1e-14); // rounding
  Tensor<2, 3> stretch = identity, power = identity; // exp by its series: |ln U| < 0.1, so 12 terms reach rounding
  for (unsigned int n = 1; n <= 12; ++n)
    {
      power = power * Tensor<2, 3>(split.log_stretch) / n;
      stretch += power;
    }
  EXPECT_LT((split.rotation * stretch - deformation).norm(), 1e-14);
}

TEST(Kinematics, NoDeformationIsNoneToTheLastBit)
{
  // Law: F = I gives R = I and no strain, exactly.
  const PolarDecomposition split = decompose_polar(identity);
  EXPECT_EQ((split.rotation - identity).norm(), 0.);
  EXPECT_EQ(split.log_stretch.norm(), 0.);
}

TEST(Kinematics, TinyStrainsKeepTheirDigits)
{
  // Law: ln U of a stretch 1 + 1e-12 is 1e-12.
  Tensor<2, 3> deformation = identity;
  deformation[2][2] += std::ldexp(1., -40); // exact in the machine
  EXPECT_NEAR(decompose_polar(deformation).log_stretch[2][2] / std::ldexp(1., -40), 1., 1e-11);
}

TEST(CorotationalMaterial, IsObjective)
{
  // Law: evaluate(R dF) = R evaluate(dF) R^T for rotations up to 60 degrees and stretches not coaxial with them, also
  // from a baseline that is rotated and stretched itself.
  for (const auto &material : create_materials())
    for (const bool has_history : {false, true})
      {
        if (has_history)
          {
            evaluate(*material, create_rotation(25.) * create_deformation());
            material->settle(true);
            material->commit();
            material->begin_step(20.);
          }
        const PointResponse plain = evaluate(*material, create_deformation());
        for (const double degrees : {1., 30., 60.})
          {
            const Tensor<2, 3> R = create_rotation(degrees);
            const PointResponse turned = evaluate(*material, R * create_deformation());
            EXPECT_LT((turned.stress - rotate(plain.stress, R)).norm(), 1e-10 * plain.stress.norm());
          }
      }
}

TEST(CorotationalMaterial, APureRotationTurnsTheStressAlone)
{
  // Law: dF = R turns the stress; nothing else changes, so the way back is exact to rounding.
  ElasticMaterial material(get_elastic_parameters(Kinematics::finite), MPI_COMM_SELF);
  const std::vector<PointSite> sites = {{0, dealii::Point<3>(), create_stress()}};
  material.initialise(sites);
  const Tensor<2, 3> R = create_rotation(60.);
  EXPECT_LT((evaluate(material, R).stress - rotate(create_stress(), R)).norm(), 1e-10 * create_stress().norm());
  material.settle(true);
  EXPECT_LT((evaluate(material, dealii::transpose(R)).stress - create_stress()).norm(), 1e-10 * create_stress().norm());
}

TEST(CorotationalMaterial, ItsTangentIsTheSlopeOfItsStress)
{
  // Law: d Cauchy = C : d strain, in the solver's axes, at a rotated baseline.
  for (const auto &material : create_materials())
    {
      evaluate(*material, create_rotation(40.));
      material->settle(true);
      const PointResponse start = evaluate(*material, identity);
      for (unsigned int k = 0; k < 3; ++k)
        for (unsigned int l = k; l < 3; ++l)
          {
            SymmetricTensor<2, 3> strain;
            strain[k][l] = 1e-6;
            const auto change = evaluate(*material, identity + Tensor<2, 3>(strain)).stress - start.stress;
            // ln(1 + e) = e - e^2/2: a relative 1e-6.
            EXPECT_LT((change - start.tangent * strain).norm(), 3e-6 * change.norm());
          }
    }
}

TEST(CorotationalMaterial, RevertDropsTrialAndBaseline)
{
  // Law: after revert the next answer is that of the committed state, to the last bit.
  for (const auto &material : create_materials())
    {
      material->begin_step(0.);
      const auto before = evaluate(*material, create_deformation()).stress;
      material->settle(true);
      material->revert();
      EXPECT_EQ((evaluate(*material, create_deformation()).stress - before).norm(), 0.);
    }
}

TEST(ViscoelasticMaterial, RelaxesAtHeldStrainInAnyNumberOfSteps)
{
  // Law: at held strain the propagator is exact: one step of dt is n steps of dt/n.
  const BurgersParameters parameters;
  const BurgersPropagator whole = compute_propagator(parameters, 300.), part = compute_propagator(parameters, 100.);
  EXPECT_LT((part.carry * part.carry * part.carry - whole.carry).norm(), 1e-14);
}

TEST(ViscoelasticMaterial, CreepsUnderHeldShearStressAsBurgersSays)
{
  // Law: e(t) = s/2 (1/G_m + t/eta_m + (1 - exp(-G_k t/eta_k))/G_k); the strain that keeps s is found step by step.
  BurgersParameters parameters;
  parameters.kinematics = Kinematics::small;
  parameters.maxwell_viscosity = 5e10;
  const double s = 1e5;
  const unsigned int n_steps = 2000;
  const double dt = 400. / n_steps;
  double elastic = s / (2. * parameters.maxwell_modulus), kelvin = 0., strain = elastic;
  const double held = elastic;
  const BurgersPropagator p = compute_propagator(parameters, dt);
  for (unsigned int n = 0; n < n_steps; ++n)
    {
      const double increment = (held - p.carry[0][0] * elastic - p.carry[0][1] * kelvin) / p.response[0];
      kelvin = p.carry[1][0] * elastic + p.carry[1][1] * kelvin + p.response[1] * increment;
      elastic = held;
      strain += increment;
    }
  const double expected =
      0.5 * s *
      (1. / parameters.maxwell_modulus + 400. / parameters.maxwell_viscosity -
       std::expm1(-parameters.kelvin_modulus * 400. / parameters.kelvin_viscosity) / parameters.kelvin_modulus);
  EXPECT_NEAR(strain / expected, 1., 1e-5); // second order in dt over the retardation time: (1/500)^2
}

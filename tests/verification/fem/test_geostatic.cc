#include "fem/geostatic_stress.h"
#include "tests/support/pile_cases.h"

#include <gtest/gtest.h>

namespace fem::cases::geostatic // names of its own: several tests are one translation unit
{

  // A column of ground of height H held laterally, with unit weight gamma.
  namespace
  {
    constexpr double height = 2., gamma_ = 20e3, surcharge = 30e3;

    ProblemParameters get_parameters(unsigned int degree, Kinematics kinematics)
    {
      ProblemParameters parameters = get_exact_parameters(Geometry::axisymmetric, kinematics, degree);
      parameters.unit_weight = gamma_;
      return parameters;
    }
  } // namespace

  TEST(Geostatic, AColumnAtRestStaysAtRest)
  {
    // Law: sigma_zz = -(q + gamma (H - z)) with any K0 is in equilibrium with the weight: exactly, since it is linear
    // in z.
    const GeostaticParameters ground = {gamma_, 0.4, surcharge, height};
    for (const unsigned int degree : {1u, 2u})
      for (const Kinematics kinematics : {Kinematics::small, Kinematics::finite})
        {
          ElasticMaterial material(get_elastic_parameters(kinematics), MPI_COMM_SELF);
          auto conditions = get_oedometer_conditions();
          conditions.back().initial_value = surcharge;
          QuasiStaticProblem<2> problem(create_oedometer_mesh(3, 4, MPI_COMM_SELF), conditions,
                                        get_parameters(degree, kinematics), material,
                                        [&](const dealii::Point<3> &x) { return compute_geostatic_stress(ground, x); });
          EXPECT_LT(problem.compute_unbalanced_share(), 1e-14); // rounding
          ASSERT_EQ(problem.equilibrate({0., 0., 0., surcharge}, true).status, EquilibriumStatus::converged);
          for (const BoundaryResponse &response : problem.compute_boundary_responses())
            EXPECT_EQ(response.displacement.norm(), 0.) << response.name;
          // The bottom carries all of it, the ring K0 times it: over 2 pi.
          const double area = dealii::numbers::PI;
          EXPECT_NEAR(find_response(problem, "bottom").force[2], area * (surcharge + gamma_ * height), 1e-9 * 1e5);
          EXPECT_NEAR(find_response(problem, "outer").force[0],
                      -2. * area * 0.4 * (surcharge * height + 0.5 * gamma_ * height * height), 1e-9 * 1e5);
        }
  }

  TEST(Geostatic, AWeightlessColumnSettlesWhenItGetsItsWeight)
  {
    // Law: u(z) = -gamma / M (H z - z^2 / 2), M the oedometer modulus: the nodes have it exactly, as in any bar.
    for (const unsigned int degree : {1u, 2u})
      {
        ElasticMaterial material(get_elastic_parameters(Kinematics::small), MPI_COMM_SELF);
        QuasiStaticProblem<2> problem(create_oedometer_mesh(2, 3, MPI_COMM_SELF), get_oedometer_conditions(),
                                      get_parameters(degree, Kinematics::small), material);
        ASSERT_EQ(problem.equilibrate({0., 0., 0., 0.}, true).status, EquilibriumStatus::converged);
        const double settlement = 0.5 * gamma_ * height * height / oedometer_modulus;
        EXPECT_NEAR(find_response(problem, "top").displacement[2], -settlement, 1e-9 * settlement); // Newton's 1e-10
      }
  }

  TEST(Geostatic, AWeightDoesNotGrowWithItsGround)
  {
    // Law: mass stays: the bottom carries the weight of the initial volume, however much the ground is compressed.
    ElasticMaterial material(get_elastic_parameters(Kinematics::finite), MPI_COMM_SELF);
    QuasiStaticProblem<2> problem(create_oedometer_mesh(1, 3, MPI_COMM_SELF), get_oedometer_conditions(),
                                  get_parameters(1, Kinematics::finite), material);
    ASSERT_EQ(problem.equilibrate({0., 0., 0., 0.2 * oedometer_modulus}, true).status, EquilibriumStatus::converged);
    const double force = dealii::numbers::PI * (0.2 * oedometer_modulus + gamma_ * height);
    EXPECT_NEAR(find_response(problem, "bottom").force[2], force, 1e-9 * force);
  }
} // namespace fem::cases::geostatic

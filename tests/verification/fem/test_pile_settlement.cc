#include "tests/support/pile_cases.h"

#include <gtest/gtest.h>

namespace fem::cases::settlement // names of its own: several tests are one translation unit
{

  // Settlement of an elastic pile in elastic ground (Randolph and Wroth 1978, "Analysis of deformation of vertically
  // loaded piles", J. Geotech. Eng. Div. ASCE 104, 1465-1488), for a shaft of one radius in uniform ground:
  //
  //   P / (w G r0) = [4 / (1 - nu) + 2 pi / zeta  T L / r0] / [1 + 4 / ((1 - nu) pi lambda)  T L / r0],   T = tanh(mu
  //   L) / (mu L), zeta = ln(rm / r0), rm = 2.5 L (1 - nu), lambda = E_p / G, mu L = sqrt(2 / (zeta lambda)) L / r0.
  //
  // Its assumptions: slices of ground shear independently of one another up to rm, the base is a rigid punch on a half
  // space, ground is bonded to the pile.
  namespace
  {
    constexpr double r0 = 0.125, length = 5.; // of the meshes
    constexpr double ground_shear_modulus = 20e6, nu = 0.3;

    double compute_stiffness(double pile_modulus)
    {
      const double zeta = std::log(2.5 * length * (1. - nu) / r0), lambda = pile_modulus / ground_shear_modulus;
      const double mu_length = std::sqrt(2. / (zeta * lambda)) * length / r0;
      const double share = std::tanh(mu_length) / mu_length * length / r0;
      return ground_shear_modulus * r0 * (4. / (1. - nu) + 2. * dealii::numbers::PI / zeta * share) /
             (1. + 4. / ((1. - nu) * dealii::numbers::PI * lambda) * share);
    }

    struct Answer
    {
      double stiffness;  ///< load over settlement of the head [N/m]
      double base_share; ///< of the load [-]
    };

    Answer push(double pile_modulus, unsigned int n_refinements)
    {
      const auto material = make_elastic_pile({pile_modulus, 0.2, Kinematics::small},
                                              {2. * ground_shear_modulus * (1. + nu), nu, Kinematics::small});
      auto conditions = get_ground_conditions();
      conditions.push_back({"bottom", ConditionKind::displacement, "x"});
      conditions.push_back({"far", ConditionKind::displacement, "z"});
      conditions.push_back({"head", ConditionKind::pressure, ""});
      ProblemParameters parameters = get_exact_parameters(Geometry::axisymmetric, Kinematics::small, 2);
      parameters.newton.tolerance = 1e-8; // rounding: the pile is up to 10^4 times as stiff
      parameters.pile_regions = {pile_region};
      QuasiStaticProblem<2> problem(read_pile_mesh("pile_wide.msh", n_refinements), conditions, parameters, *material);
      const double load = 100e3, pressure = load / (dealii::numbers::PI * r0 * r0);
      EXPECT_EQ(problem.equilibrate({0., 0., 0., 0., 0., pressure}, true).status, EquilibriumStatus::converged);
      const double shaft = find_response(problem, "shaft").force[2], base = find_response(problem, "base").force[2];
      EXPECT_NEAR(shaft + base, -load, 1e-6 * load); // what the head takes is what the ground gets
      return {-load / find_response(problem, "head").displacement[2], -base / load};
    }
  } // namespace

  TEST(PileSettlement, AgreesWithRandolphAndWroth)
  {
    // Law: load over settlement of the head within 10 %, for stiff and for compressible piles.
    for (const double ratio : {300., 1000., 10000.})
      {
        const double modulus = ratio * ground_shear_modulus, expected = compute_stiffness(modulus);
        const Answer coarse = push(modulus, 0), fine = push(modulus, 2);
        std::printf("E_p/G = %g: P/w = %.4g MN/m, formula %.4g (%+.1f %%), on a mesh of four times the cell size %.4g; "
                    "base %.3f of the load\n",
                    ratio, 1e-6 * fine.stiffness, 1e-6 * expected, 100. * (fine.stiffness / expected - 1.),
                    1e-6 * coarse.stiffness, fine.base_share);
        EXPECT_NEAR(fine.stiffness / expected, 1., 0.1);
      }
  }
} // namespace fem::cases::settlement

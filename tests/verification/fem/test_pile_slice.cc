#include "tests/support/pile_cases.h"

#include <deal.II/grid/grid_tools.h>

#include <gtest/gtest.h>

namespace fem::cases::slice // names of its own: several tests are one translation unit
{

  // A horizontal slice of ground around a pile's shaft, sheared by it (Randolph and Wroth 1978): tau = tau0 r0 / r, so
  //   w(r) = tau0 r0 / G ln(rm / r).
  // Every point moves vertically alone, which faces above and below must be held to.
  namespace
  {
    constexpr double r0 = 0.25, rm = 5., tau0 = 20e3;

    /** Ring from r0 to rm, its cells growing as their radius; cells with centre beyond `change` are of region 3. */
    Mesh<2> create_ring(unsigned int n_cells, double inner, double change)
    {
      MeshParameters parameters;
      parameters.kind = MeshKind::cylinder;
      parameters.inner_radius = inner;
      parameters.outer_radius = rm;
      parameters.n_cells = {{n_cells, 1, 1}};
      Mesh<2> mesh = create_mesh<2>(parameters, Geometry::axisymmetric, MPI_COMM_SELF);
      // Equal ratios from inner to change, and from there to rm; half of the cells each.
      dealii::GridTools::transform(
          [&](const dealii::Point<2> &x) {
            const double share = (x[0] - inner) / (rm - inner);
            const double radius = share <= 0.5 ? inner * std::pow(change / inner, 2. * share)
                                               : change * std::pow(rm / change, 2. * share - 1.);
            return dealii::Point<2>(radius, x[1]);
          },
          *mesh.triangulation);
      for (const auto &cell : mesh.triangulation->active_cell_iterators())
        cell->set_material_id(cell->center()[0] > change ? ground_region : pile_region);
      return mesh;
    }

    std::vector<BoundaryCondition> get_conditions()
    {
      std::vector<BoundaryCondition> conditions;
      for (const std::string boundary : {"inner", "outer", "bottom", "top"})
        conditions.push_back({boundary, ConditionKind::displacement, "x"});
      conditions.push_back({"outer", ConditionKind::displacement, "z"});
      conditions.push_back({"inner", ConditionKind::traction, "z"});
      return conditions;
    }

    double compute_settlement(unsigned int n_cells, double inner, double change, const ElasticParameters &within,
                              const ElasticParameters &beyond)
    {
      const auto material = make_elastic_pile(within, beyond);
      QuasiStaticProblem<2> problem(create_ring(n_cells, inner, change), get_conditions(),
                                    get_exact_parameters(Geometry::axisymmetric, Kinematics::small, 2), *material);
      EXPECT_EQ(problem.equilibrate({0., 0., 0., 0., 0., -tau0}, true).status, EquilibriumStatus::converged);
      return -find_response(problem, "inner").displacement[2];
    }

    double compute_shear_modulus(const ElasticParameters &parameters)
    {
      return parameters.youngs_modulus / (2. * (1. + parameters.poissons_ratio));
    }
  } // namespace

  TEST(PileSlice, TheShaftSettlesAsTheLogarithmOfTheRadius)
  {
    // Law: w = tau0 r0 / G ln(rm / r0), to 1e-6 on refinement.
    const ElasticParameters ground = get_elastic_parameters(Kinematics::small);
    const double expected = tau0 * r0 / compute_shear_modulus(ground) * std::log(rm / r0);
    double error = 1.;
    for (const unsigned int n_cells : {4u, 8u, 16u, 32u})
      {
        const double found = compute_settlement(n_cells, r0, std::sqrt(r0 * rm), ground, ground);
        const double last = std::exchange(error, std::abs(found / expected - 1.));
        std::printf("%2u cells: w = %.9g m, relative error %.2e\n", n_cells, found, error);
        EXPECT_LT(error, 0.1 * last); // fourth order at the nodes of Q2, as in one dimension: 1/16
      }
    EXPECT_LT(error, 1e-6);
  }

  TEST(PileSlice, TwoMaterialsShareTheShear)
  {
    // Law: the shear force 2 pi r tau is the same at all radii: w = tau0 r0 (ln(r1/r0)/G1 + ln(rm/r1)/G2), G1 within
    // r1.
    const ElasticParameters within = {5e6, 0.3, Kinematics::small}, beyond = {80e6, 0.2, Kinematics::small};
    const double r1 = 0.4, expected = tau0 * r0 *
                                      (std::log(r1 / r0) / compute_shear_modulus(within) +
                                       std::log(rm / r1) / compute_shear_modulus(beyond));
    EXPECT_NEAR(compute_settlement(32, r0, r1, within, beyond), expected, 1e-6 * expected); // as above
  }
} // namespace fem::cases::slice

#include "tests/support/fem_cases.h"

#include <deal.II/fe/fe_values.h>

#include <gtest/gtest.h>

using namespace fem;
using namespace fem::cases;

// Thick cylinder under inner pressure in plane strain (Lame): u = (p a^2 / (b^2 - a^2)) (1 + nu)/E ((1 - 2 nu) r +
// b^2/r).
namespace
{
  constexpr double a = 1., b = 2., p = 1e6;

  double compute_displacement(double r)
  {
    const double factor = p * a * a / (b * b - a * a) * (1. + poissons_ratio) / youngs_modulus;
    return factor * ((1. - 2. * poissons_ratio) * r + b * b / r);
  }

  double compute_error(unsigned int degree, unsigned int n_cells)
  {
    MeshParameters parameters;
    parameters.kind = MeshKind::cylinder;
    parameters.inner_radius = a;
    parameters.outer_radius = b;
    parameters.n_cells = {{n_cells, 1, 2}};
    ElasticMaterial material(get_elastic_parameters(Kinematics::small), MPI_COMM_SELF);
    QuasiStaticProblem<2> problem(create_mesh<2>(parameters, Geometry::axisymmetric, MPI_COMM_SELF),
                                  {{"inner", ConditionKind::pressure, ""},
                                   {"bottom", ConditionKind::displacement, "z"},
                                   {"top", ConditionKind::displacement, "z"}},
                                  get_exact_parameters(Geometry::axisymmetric, Kinematics::small, degree), material);
    EXPECT_EQ(problem.equilibrate({p, 0., 0.}, true).status, EquilibriumStatus::converged);

    // L2 norm over the cells, with more points than the elements are exact for.
    const auto &dof_handler = problem.get_dof_handler();
    dealii::FEValues<2> values(problem.get_mapping(), dof_handler.get_fe(), dealii::QGauss<2>(5),
                               dealii::update_values | dealii::update_quadrature_points | dealii::update_JxW_values);
    std::vector<dealii::Vector<double>> found(25, dealii::Vector<double>(2));
    double squared = 0.;
    for (const auto &cell : dof_handler.active_cell_iterators())
      {
        values.reinit(cell);
        values.get_function_values(problem.get_displacement(), found);
        for (const unsigned int q : values.quadrature_point_indices())
          squared += std::pow(found[q][0] - compute_displacement(values.quadrature_point(q)[0]), 2) * values.JxW(q);
      }
    return std::sqrt(squared);
  }
} // namespace

TEST(Lame, ThickCylinderConvergesAtTheOrderOfTheElement)
{
  // Law: the L2 error of the displacement falls as h^(degree + 1).
  for (const unsigned int degree : {1u, 2u})
    {
      const double coarse = compute_error(degree, 8), fine = compute_error(degree, 16);
      const double order = std::log2(coarse / fine);
      std::printf("Q%u: error %.3e m with 8 cells, %.3e m with 16, order %.3f\n", degree, coarse, fine, order);
      EXPECT_NEAR(order, degree + 1., 0.15); // the asymptotic range begins near 8 cells
    }
}

TEST(Lame, TheForceOfAPressureIsThatOfItsArea)
{
  // Law: a pressure on the top pushes with p pi r^2; what holds the bottom pushes back as much.
  Oedometer oedometer;
  ASSERT_EQ(oedometer.problem.equilibrate({0., 0., 0., 1e6}, true).status, EquilibriumStatus::converged);
  const double force = 1e6 * dealii::numbers::PI;
  EXPECT_NEAR(oedometer.find_boundary("top").force[2], -force, 1e-9 * force); // rounding of the quadrature
  EXPECT_NEAR(oedometer.find_boundary("bottom").force[2], force, 1e-9 * force);
}

TEST(FiniteStrain, AnOedometerFollowsTheLogarithmicLaw)
{
  // Law: held laterally, Cauchy stress is M ln(stretch): the area does not change, p = -M ln(1 - s), in steps or at
  // once.
  for (const unsigned int n_increments : {1u, 7u})
    {
      Oedometer oedometer(get_exact_parameters(Geometry::axisymmetric, Kinematics::finite), 2);
      LoadStepping<2> stepping(oedometer.problem, {get_load_stage(0.1 * oedometer_modulus, n_increments)}, {});
      ASSERT_EQ(stepping.run().status, StepStatus::ok);
      EXPECT_NEAR(oedometer.compute_strain(), 1. - std::exp(-0.1), 1e-9); // Newton's 1e-10 over the slope of the law
    }
}

TEST(FiniteStrain, APressureFollowsTheCurrentAreaAndADeadOneDoesNot)
{
  // Law: a free cylinder under all-round pressure on current areas is stressed by exactly that pressure.
  ElasticMaterial material(get_elastic_parameters(Kinematics::finite), MPI_COMM_SELF);
  for (const AreaMeasure area : {AreaMeasure::current, AreaMeasure::initial})
    {
      QuasiStaticProblem<2> problem(create_oedometer_mesh(2, 2, MPI_COMM_SELF),
                                    {{"axis", ConditionKind::displacement, "x"},
                                     {"bottom", ConditionKind::displacement, "z"},
                                     {"outer", ConditionKind::pressure, "", 0., area},
                                     {"top", ConditionKind::pressure, "", 0., area}},
                                    get_exact_parameters(Geometry::axisymmetric, Kinematics::finite), material);
      const double pressure = 5e7;
      ASSERT_EQ(problem.equilibrate({0., 0., pressure, pressure}, true).status, EquilibriumStatus::converged);
      material.settle(true);
      problem.move_baseline();
      problem.commit();
      const PointState point = problem.compute_nearest_point_state(dealii::Point<3>(0.5, 0., 1.));
      const double stretch = point.deformation[2][2];
      const double share = area == AreaMeasure::current ? 1. : 1. / (stretch * stretch);
      EXPECT_NEAR(point.stress[2][2] / -pressure, share, 1e-8);
      EXPECT_LT(stretch, 0.98); // K = 0.67 GPa: 2.5 % shorter, so the two differ by 5 %
    }
}

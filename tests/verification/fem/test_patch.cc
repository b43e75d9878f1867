#include "tests/support/fem_cases.h"

#include <gtest/gtest.h>

using namespace fem;
using namespace fem::cases;
using dealii::Tensor;

// A uniform deformation prescribed on the whole boundary of a distorted mesh must be met at every Gauss point.
namespace
{
  /** Moves the inner vertices of a coarse mesh, each in its own direction. */
  template <int dim>
  void distort(dealii::Triangulation<dim> &triangulation, double size)
  {
    std::vector<bool> is_fixed(triangulation.n_vertices(), false);
    for (const auto &cell : triangulation.active_cell_iterators())
      for (const auto &face : cell->face_iterators())
        if (face->at_boundary())
          for (const unsigned int v : face->vertex_indices())
            is_fixed[face->vertex_index(v)] = true;
    for (const auto &cell : triangulation.active_cell_iterators())
      for (const unsigned int v : cell->vertex_indices())
        if (!is_fixed[cell->vertex_index(v)])
          {
            is_fixed[cell->vertex_index(v)] = true;
            for (unsigned int d = 0; d < dim; ++d)
              cell->vertex(v)[d] += size * std::sin(7. * cell->vertex_index(v) + 3. * d);
          }
  }

  template <int dim>
  Mesh<dim> create_distorted_box(Geometry geometry)
  {
    MeshParameters parameters;
    parameters.n_cells = {{3, 3, 3}};
    Mesh<dim> mesh = create_mesh<dim>(parameters, geometry, MPI_COMM_SELF);
    distort(*mesh.triangulation, 0.08);
    return mesh;
  }

  /** Displacement gradient times position on all boundaries, growing with the value of each condition. */
  template <int dim>
  std::vector<BoundaryCondition> create_conditions(const Mesh<dim> &mesh, const Tensor<2, 3> &gradient)
  {
    std::vector<BoundaryCondition> conditions;
    for (const auto &[name, id] : mesh.boundary_ids)
      for (const std::string &component : get_component_names<dim>())
        {
          BoundaryCondition condition{name, ConditionKind::displacement, component};
          const unsigned int axis = component[0] - 'x';
          condition.profile = [gradient, axis](const dealii::Point<3> &x, double value) {
            return value * (gradient * x)[axis];
          };
          conditions.push_back(condition);
        }
    return conditions;
  }

  template <int dim>
  void expect_uniform(Geometry geometry, Kinematics kinematics, unsigned int degree, const Tensor<2, 3> &gradient,
                      ElementKind element = ElementKind::lagrange)
  {
    ElasticMaterial material(get_elastic_parameters(kinematics), MPI_COMM_SELF);
    Mesh<dim> mesh = create_distorted_box<dim>(geometry);
    const auto conditions = create_conditions(mesh, gradient);
    ProblemParameters parameters = get_exact_parameters(geometry, kinematics, degree);
    parameters.newton.tolerance = 1e-13; // the answer is compared to 1e-10
    parameters.element = element;
    if (element == ElementKind::serendipity)
      parameters.n_gauss_points = 2; // the fewest
    QuasiStaticProblem<dim> problem(std::move(mesh), conditions, parameters, material);
    const NewtonResult result = problem.equilibrate(std::vector<double>(conditions.size(), 1.), true);
    ASSERT_EQ(result.status, EquilibriumStatus::converged);
    material.settle(true);
    problem.move_baseline();
    problem.commit();

    Tensor<2, 3> expected = gradient + Tensor<2, 3>(dealii::unit_symmetric_tensor<3>());
    for (const PointState &point : problem.compute_point_states())
      {
        EXPECT_LT((point.deformation - expected).norm(), 1e-10);
        const std::vector<PointRequest> request = {{0, expected}};
        std::vector<PointResponse> response(1);
        ElasticMaterial alone(get_elastic_parameters(kinematics), MPI_COMM_SELF);
        const std::vector<PointSite> site(1, PointSite{0, {}, {}});
        alone.initialise(site);
        alone.evaluate(request, response, false);
        EXPECT_LT((point.stress - response[0].stress).norm(), 1e-10 * response[0].stress.norm());
      }
  }

  Tensor<2, 3> create_plane_gradient(double size)
  {
    Tensor<2, 3> gradient;
    gradient[0][0] = 0.7 * size;
    gradient[0][2] = -0.4 * size;
    gradient[2][0] = 0.9 * size;
    gradient[2][2] = -1.2 * size;
    return gradient;
  }
} // namespace

TEST(Patch, PlaneStrainStaysUniform)
{
  // Law: linear boundary displacement gives one deformation gradient everywhere, on any mesh, element and kinematics.
  for (const unsigned int degree : {1u, 2u})
    {
      expect_uniform<2>(Geometry::plane_strain, Kinematics::small, degree, create_plane_gradient(1e-3));
      expect_uniform<2>(Geometry::plane_strain, Kinematics::finite, degree, create_plane_gradient(0.02));
    }
}

TEST(Patch, SpaceStaysUniform)
{
  // Law: as above, in three dimensions with shear in every plane.
  Tensor<2, 3> gradient = create_plane_gradient(0.01);
  gradient[0][1] = 0.005;
  gradient[1][1] = 0.008;
  gradient[1][2] = -0.006;
  expect_uniform<3>(Geometry::three_dimensional, Kinematics::small, 1, gradient);
  expect_uniform<3>(Geometry::three_dimensional, Kinematics::finite, 1, gradient);
  expect_uniform<3>(Geometry::three_dimensional, Kinematics::small, 2, gradient);
  expect_uniform<3>(Geometry::three_dimensional, Kinematics::small, 2, gradient, ElementKind::serendipity);
  expect_uniform<3>(Geometry::three_dimensional, Kinematics::finite, 2, gradient, ElementKind::serendipity);
}

TEST(Patch, AxisymmetryStaysUniformWhereHoopAndRadialStretchAreEqual)
{
  // Law: u_r = a r, u_z = b z is the uniform field of axisymmetry: radial and hoop strain a, axial strain b.
  Tensor<2, 3> gradient;
  gradient[0][0] = gradient[1][1] = 0.02;
  gradient[2][2] = -0.03;
  for (const unsigned int degree : {1u, 2u})
    for (const Kinematics kinematics : {Kinematics::small, Kinematics::finite})
      expect_uniform<2>(Geometry::axisymmetric, kinematics, degree, gradient);
}

TEST(Tangent, OneCorrectionLeavesAResidualOfSecondOrder)
{
  // Law: with the consistent tangent (geometric part included) the residual after one correction falls with the square
  // of the increment. The stress is half of Young's modulus, so that a missing geometric term leaves a first-order
  // rest.
  dealii::SymmetricTensor<2, 3> stress;
  stress[0][0] = 0.5 * youngs_modulus;
  stress[2][2] = -0.2 * youngs_modulus;
  stress[0][2] = 0.1 * youngs_modulus;
  const auto compute_rest = [&](double value) {
    ElasticMaterial material(get_elastic_parameters(Kinematics::finite), MPI_COMM_SELF);
    Mesh<2> mesh = create_distorted_box<2>(Geometry::plane_strain);
    auto conditions = create_conditions(mesh, create_plane_gradient(1.));
    for (BoundaryCondition &condition : conditions)
      condition.profile = [linear = condition.profile](const dealii::Point<3> &x, double v) {
        return linear(x, v) * (1. + x[0] - x[2]); // not uniform: the inside must move
      };
    ProblemParameters parameters = get_exact_parameters(Geometry::plane_strain, Kinematics::finite);
    parameters.newton.max_evaluations = 1;
    parameters.newton.tolerance = 1e-16;
    QuasiStaticProblem<2> problem(std::move(mesh), conditions, parameters, material,
                                  [&](const dealii::Point<3> &) { return stress; });
    return problem.equilibrate(std::vector<double>(conditions.size(), value), true).residual;
  };
  EXPECT_NEAR(std::log2(compute_rest(2e-3) / compute_rest(1e-3)), 2., 0.05); // third-order rest
}

#include "tests/support/fem_cases.h"

#include <deal.II/physics/transformations.h>

#include <gtest/gtest.h>

using namespace fem;
using namespace fem::cases;
using dealii::SymmetricTensor;
using dealii::Tensor;

namespace
{
  Tensor<2, 3> create_rotation(double angle)
  {
    dealii::Point<3> axis(1., 2., -1.);
    axis /= axis.norm();
    return dealii::Physics::Transformations::Rotations::rotation_matrix_3d(axis, angle);
  }

  /** All surfaces of a block turn by the conditions' value [rad] about an axis through the origin. */
  std::vector<BoundaryCondition> create_turning_conditions()
  {
    std::vector<BoundaryCondition> conditions;
    for (const std::string name : {"left", "right", "front", "back", "bottom", "top"})
      for (const std::string component : {"x", "y", "z"})
        {
          BoundaryCondition condition{name, ConditionKind::displacement, component};
          const unsigned int axis = component[0] - 'x';
          condition.profile = [axis](const dealii::Point<3> &x, double angle) {
            return (create_rotation(angle) * x - x)[axis];
          };
          conditions.push_back(condition);
        }
    return conditions;
  }
} // namespace

TEST(Rotation, OfAWholeSpecimenTurnsItsStressAndChangesNothingElse)
{
  // Law: a stressed block turned by 60 degrees in three steps bears the turned stress and no strain.
  SymmetricTensor<2, 3> stress;
  stress[0][0] = -2e6;
  stress[1][1] = -3e6;
  stress[2][2] = -7e6;
  stress[0][2] = 5e5;
  MeshParameters mesh;
  mesh.n_cells = {{2, 2, 2}};
  ElasticMaterial material(get_elastic_parameters(Kinematics::finite), MPI_COMM_SELF);
  ProblemParameters parameters = get_exact_parameters(Geometry::three_dimensional, Kinematics::finite);
  parameters.newton.tolerance = 1e-12;
  QuasiStaticProblem<3> problem(create_mesh<3>(mesh, parameters.geometry, MPI_COMM_SELF), create_turning_conditions(),
                                parameters, material, [&](const dealii::Point<3> &) { return stress; });
  const double angle = dealii::numbers::PI / 3.;
  Stage stage;
  stage.name = "turn";
  stage.n_increments = 3;
  for (const BoundaryCondition &condition : problem.get_conditions())
    stage.targets.push_back({condition.boundary, condition.kind, condition.component, angle});
  LoadStepping<3> stepping(problem, {stage}, {});
  ASSERT_EQ(stepping.run().status, StepStatus::ok);
  const Tensor<2, 3> R = create_rotation(angle);
  for (const PointState &point : problem.compute_point_states())
    {
      EXPECT_LT((point.stress - rotate(stress, R)).norm(),
                1e-9 * stress.norm()); // Newton's 1e-12 of reactions, on E/stress
      EXPECT_LT(point.strain.norm(), 1e-11);
      EXPECT_LT((point.deformation - R).norm(), 1e-11);
    }
}

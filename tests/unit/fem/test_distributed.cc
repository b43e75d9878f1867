#include "tests/support/fem_cases.h"

#include <gtest/gtest.h>

using namespace fem;
using namespace fem::cases;

namespace
{
  /** Top displacement and bottom force of a block in space under a pressure on part of its surface. */
  std::vector<double> compute_answer(MPI_Comm communicator, LinearSolverKind kind, unsigned int degree)
  {
    MeshParameters mesh;
    mesh.n_cells = {{3, 2, 2}};
    mesh.n_refinements = degree == 1 ? 1 : 0;
    ScriptedMaterial material(Kinematics::finite, communicator);
    material.true_share = 0.4;
    ProblemParameters parameters = get_exact_parameters(Geometry::three_dimensional, Kinematics::finite, degree);
    parameters.linear_solver.kind = kind;
    parameters.linear_solver.tolerance = 1e-12;
    QuasiStaticProblem<3> problem(create_mesh<3>(mesh, parameters.geometry, communicator),
                                  {{"left", ConditionKind::displacement, "x"},
                                   {"front", ConditionKind::displacement, "y"},
                                   {"bottom", ConditionKind::displacement, "z"},
                                   {"bottom", ConditionKind::displacement, "x"},
                                   {"top", ConditionKind::pressure, ""},
                                   {"right", ConditionKind::traction, "y"}},
                                  parameters, material);
    EXPECT_EQ(problem.equilibrate({0., 0., 0., 0., 1e7, 2e6}, true).status, EquilibriumStatus::converged);
    material.settle(true);
    problem.move_baseline();
    problem.commit();
    std::vector<double> answer;
    for (const BoundaryResponse &response : problem.compute_boundary_responses())
      for (unsigned int d = 0; d < 3; ++d)
        {
          answer.push_back(response.force[d] / 1e7);
          answer.push_back(response.displacement[d] / 1e-2);
        }
    const PointState point = problem.compute_nearest_point_state(dealii::Point<3>(0.9, 0.9, 0.2));
    answer.push_back(point.position[0]);
    answer.push_back(point.stress[2][2] / 1e7);
    return answer;
  }

  void expect_same(const std::vector<double> &a, const std::vector<double> &b)
  {
    ASSERT_EQ(a.size(), b.size());
    for (std::size_t i = 0; i < a.size(); ++i)
      EXPECT_NEAR(a[i], b[i], 1e-8); // Newton's tolerance of 1e-10 on quantities scaled to order 1
  }
} // namespace

TEST(Distributed, EveryLinearSolverOnAnyRanksGivesOneAnswer)
{
  // Law: how the equations are solved and on how many ranks changes nothing beyond the solver's tolerance.
  for (const unsigned int degree : {1u, 2u})
    {
      const auto direct = compute_answer(MPI_COMM_SELF, LinearSolverKind::direct, degree);
      expect_same(compute_answer(MPI_COMM_WORLD, LinearSolverKind::automatic, degree), direct);
      expect_same(compute_answer(MPI_COMM_WORLD, LinearSolverKind::gmres, degree), direct);
      expect_same(compute_answer(MPI_COMM_WORLD, LinearSolverKind::direct, degree), direct);
    }
  expect_same(compute_answer(MPI_COMM_WORLD, LinearSolverKind::cg, 1),
              compute_answer(MPI_COMM_SELF, LinearSolverKind::direct, 1));
}

TEST(Distributed, OnItselfEveryRankHasTheSameBits)
{
  // Law: on MPI_COMM_SELF no decision can differ between ranks, because no bit does.
  const auto answer = compute_answer(MPI_COMM_SELF, LinearSolverKind::automatic, 1);
  EXPECT_EQ(dealii::Utilities::MPI::broadcast(MPI_COMM_WORLD, answer, 0), answer);
}

#include "tests/support/fem_cases.h"

#include "fem/assembly.h"

#include <deal.II/fe/fe_q.h>
#include <deal.II/fe/fe_system.h>
#include <deal.II/fe/mapping_q.h>

#include <gtest/gtest.h>

#include <map>

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

  template <int dim>
  std::vector<PointSite> list_sites(const MeshParameters &parameters, Geometry geometry, MPI_Comm communicator)
  {
    const Mesh<dim> mesh = create_mesh<dim>(parameters, geometry, communicator);
    const dealii::FESystem<dim> element(dealii::FE_Q<dim>(1), dim);
    const dealii::MappingQ<dim> mapping(1);
    dealii::DoFHandler<dim> dofs(*mesh.triangulation);
    dofs.distribute_dofs(element);
    return Assembly<dim>(dofs, mapping, geometry, Kinematics::finite, 2).compute_sites();
  }

  template <int dim>
  void expect_own_numbers(const MeshParameters &parameters, Geometry geometry)
  {
    const auto all = list_sites<dim>(parameters, geometry, MPI_COMM_SELF);
    const auto here = list_sites<dim>(parameters, geometry, MPI_COMM_WORLD);
    std::map<PointId, dealii::Point<3>> positions;
    for (const PointSite &site : all)
      positions[site.id] = site.position;
    EXPECT_EQ(positions.size(), all.size());
    EXPECT_EQ(positions.rbegin()->first, all.size() - 1); // no number is left out
    for (const PointSite &site : here)
      EXPECT_EQ(site.position, positions.at(site.id));
    EXPECT_EQ(dealii::Utilities::MPI::sum(here.size(), MPI_COMM_WORLD), all.size());
  }
} // namespace

TEST(Distributed, APointHasOneNumberHoweverTheMeshIsDivided)
{
  // Law: a Gauss point's number, by which its grains are drawn, is a matter of the mesh alone.
  MeshParameters halved;
  halved.n_cells = {{3, 2, 2}};
  halved.n_refinements = 1;
  expect_own_numbers<3>(halved, Geometry::three_dimensional);
  halved.n_refinements = 2;
  expect_own_numbers<2>(halved, Geometry::plane_strain);
  MeshParameters pile;
  pile.kind = MeshKind::file;
  pile.file = SLOWSAND_SOURCE_DIR "/meshes/pile_small.msh";
  expect_own_numbers<2>(pile, Geometry::axisymmetric);
}

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

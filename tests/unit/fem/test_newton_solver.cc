#include "tests/support/fem_cases.h"

#include <gtest/gtest.h>

#include <array>

using namespace fem;
using namespace fem::cases;

namespace
{
  ProblemParameters get_parameters(SecantKind kind, unsigned int n_carried)
  {
    ProblemParameters parameters = get_exact_parameters(Geometry::axisymmetric, Kinematics::small);
    parameters.newton.secant.kind = kind;
    parameters.newton.secant.n_carried = n_carried;
    return parameters;
  }

  NewtonResult load(Oedometer &oedometer, double pressure)
  {
    const NewtonResult result = oedometer.problem.equilibrate({0., 0., 0., pressure}, true);
    oedometer.material.settle(true);
    oedometer.problem.move_baseline();
    oedometer.problem.commit();
    oedometer.material.commit();
    return result;
  }

  /** Two unknowns, a residual [N] as a test writes it, and a multiple of the unit matrix as tangent. */
  class SmallSystem : public NonlinearSystem
  {
  public:
    std::function<std::array<double, 2>(double x, double y)> compute_residual;
    double tangent = 1.; ///< [N/m]

    Status linearise(bool, Vector &residual) override { return evaluate(create_vector(), residual); }
    Status evaluate(const Vector &increment, Vector &residual) override
    {
      const auto [x, y] = compute_residual(increment[0], increment[1]);
      residual = create_vector(x, y);
      return Status::ok;
    }
    void solve_linearised(const Vector &residual, Vector &solution) override
    {
      solution = residual;
      solution /= tangent;
    }
    void impose_boundary(Vector &) const override {}
    double compute_condensed_norm(const Vector &residual) override { return residual.l2_norm(); }
    double compute_norm(const Vector &residual) const override { return residual.l2_norm(); }
    double compute_force_scale() const override { return 1.; }
    Vector create_vector() const override { return Vector(dealii::complete_index_set(2), MPI_COMM_SELF); }

    Vector create_vector(double x, double y) const
    {
      Vector vector = create_vector();
      vector[0] = x;
      vector[1] = y;
      return vector;
    }
  };

  NewtonSolver create_exact_solver(SecantKind kind)
  {
    NewtonParameters parameters;
    parameters.tolerance = 1e-12; // piecewise linear systems are met to rounding
    parameters.secant.kind = kind;
    return NewtonSolver(parameters);
  }

  class Secants : public ::testing::TestWithParam<SecantKind>
  {};
} // namespace

TEST(NewtonSolver, ReachesALinearEquilibriumWithOneEvaluation)
{
  // Law: with the true tangent the first correction is the answer.
  Oedometer oedometer;
  const NewtonResult result = load(oedometer, 1e6);
  EXPECT_EQ(result.status, EquilibriumStatus::converged);
  EXPECT_EQ(result.evaluations, 1u);
  EXPECT_EQ(oedometer.material.n_evaluations, 1u);
  // Rounding of a solve with two unknowns of 1e9 N/m.
  EXPECT_NEAR(oedometer.compute_strain(), 1e6 / oedometer_modulus, 1e-14);
}

TEST_P(Secants, FindATrueStiffnessOfAThirdWithTwoEvaluations)
{
  // Law: if the true stiffness is a uniform share of J0, one secant pair tells it.
  Oedometer oedometer(get_parameters(GetParam(), 0), 2);
  oedometer.material.true_share = 1. / 3.;
  const NewtonResult result = load(oedometer, 1e6);
  EXPECT_EQ(result.status, EquilibriumStatus::converged);
  EXPECT_EQ(result.evaluations, 2u);
  EXPECT_EQ(oedometer.material.n_evaluations, result.evaluations);
  EXPECT_NEAR(oedometer.compute_strain(), 3e6 / oedometer_modulus, 1e-12); // tolerance 1e-10 of a strain of 2.5e-3
}

TEST_P(Secants, CarriedToTheNextEquilibriumSpareTheSecondEvaluation)
{
  // Law: the total pair of the last equilibrium predicts the next one of the same direction.
  Oedometer oedometer(get_parameters(GetParam(), 1), 2);
  oedometer.material.true_share = 1. / 3.;
  EXPECT_EQ(load(oedometer, 1e6).evaluations, 2u);
  EXPECT_EQ(load(oedometer, 2e6).evaluations, 1u);
}

TEST_P(Secants, LearnFromAnOvershoot)
{
  // Law: a carried pair that has become wrong (the material is stiff again) costs one evaluation, not the equilibrium.
  Oedometer oedometer(get_parameters(GetParam(), 1), 2);
  oedometer.material.true_share = 1. / 3.;
  load(oedometer, 1e6);
  oedometer.material.true_share = 1.;
  const NewtonResult result = load(oedometer, 2e6);
  EXPECT_EQ(result.status, EquilibriumStatus::converged);
  EXPECT_EQ(result.evaluations, 2u);
}

TEST_P(Secants, ThatMisleadAreForgotten)
{
  // Law: where no share of the secants' correction lowers the residual and none teaches better, the tangent's does.
  // A push along x was answered along y once, but no more. By hand: H f = (1, -1) and K H f = (-1, -1), so that every
  // share a takes |r|^2 from 1 to (1 + a)^2 + a^2; the pair that this shows is too soft to be learned. The tangent's
  // correction f = (1, 0) is the answer.
  SmallSystem system;
  system.compute_residual = [](double x, double y) { return std::array{x + 2. * y - 1., y}; };
  NewtonSolver solver = create_exact_solver(GetParam());
  solver.set_memory({{system.create_vector(1., 0.), system.create_vector(1., 1.)}});
  Vector increment = system.create_vector();
  const NewtonResult result = solver.solve(system, increment, true);
  EXPECT_EQ(result.status, EquilibriumStatus::converged);
  EXPECT_NEAR(increment[0], 1., 1e-12);
  EXPECT_NEAR(increment[1], 0., 1e-12);
}

TEST_P(Secants, LeadBeyondADropOfTheForce)
{
  // Law: where the force drops before it reaches the load, the equilibrium beyond the drop is found.
  // By hand: the force is x up to 1 and x - 1 beyond, the load 1.1, so that x = 2.1; before the drop |r| > 0.1.
  SmallSystem system;
  system.compute_residual = [](double x, double) { return std::array{(x > 1. ? x - 1. : x) - 1.1, 0.}; };
  system.tangent = 2.; // the first correction ends before the drop
  NewtonSolver solver = create_exact_solver(GetParam());
  Vector increment = system.create_vector();
  const NewtonResult result = solver.solve(system, increment, true);
  EXPECT_EQ(result.status, EquilibriumStatus::converged);
  EXPECT_NEAR(increment[0], 2.1, 1e-12);
}

INSTANTIATE_TEST_SUITE_P(NewtonSolver, Secants, ::testing::Values(SecantKind::broyden, SecantKind::anderson));

TEST(NewtonSolver, WithoutSecantsASoftMaterialTakesManyEvaluations)
{
  // Law: modified Newton on a third of the stiffness shrinks the residual by 2/3 an iteration: 1e-3 after 18.
  ProblemParameters parameters = get_parameters(SecantKind::none, 0);
  parameters.newton.tolerance = 1e-3;
  Oedometer oedometer(parameters);
  oedometer.material.true_share = 1. / 3.;
  const NewtonResult result = load(oedometer, 1e6);
  EXPECT_EQ(result.status, EquilibriumStatus::converged);
  // The force scale is load plus support: the count lies within 3 of ln(1e-3)/ln(2/3) = 17.
  EXPECT_NEAR(result.evaluations, 17, 3);
}

TEST(NewtonSolver, MeetsADisplacementConditionAndItsReaction)
{
  // Law: the force on a moved boundary is modulus times strain times area, with the sign of the push on the body.
  ScriptedMaterial material;
  QuasiStaticProblem<2> problem(create_oedometer_mesh(2, 2, MPI_COMM_SELF),
                                {{"axis", ConditionKind::displacement, "r"},
                                 {"outer", ConditionKind::displacement, "x"},
                                 {"bottom", ConditionKind::displacement, "z"},
                                 {"top", ConditionKind::displacement, "z"}},
                                get_exact_parameters(Geometry::axisymmetric, Kinematics::small), material);
  material.true_share = 0.5;
  const NewtonResult result = problem.equilibrate({0., 0., 0., -2e-3}, true);
  ASSERT_EQ(result.status, EquilibriumStatus::converged);
  const auto responses = problem.compute_boundary_responses();
  dealii::Tensor<1, 3> sum;
  for (const BoundaryResponse &response : responses)
    sum += response.force;
  const double expected = -0.5 * oedometer_modulus * 1e-3 * dealii::numbers::PI;
  EXPECT_EQ(responses.back().name, "top");
  EXPECT_NEAR(responses.back().force[2], expected, 1e-9 * std::abs(expected)); // tolerance 1e-10 of the reactions
  EXPECT_NEAR(sum[2], 0., 1e-9 * std::abs(expected));
  EXPECT_NEAR(responses.back().displacement[2], -2e-3, 1e-15);
}

TEST(NewtonSolver, HalvesOnceAStepThatAPointRefuses)
{
  // Law: one refusal is answered with half the step; the second in the same search ends the equilibrium with its
  // status.
  Oedometer oedometer;
  oedometer.material.on_evaluate = [](unsigned int n) { return n == 1 ? Status::step_too_large : Status::ok; };
  EXPECT_EQ(load(oedometer, 1e6).status, EquilibriumStatus::converged);
  Oedometer other;
  other.material.on_evaluate = [](unsigned int) { return Status::step_too_large; };
  const NewtonResult refused = other.problem.equilibrate({0., 0., 0., 1e6}, true);
  EXPECT_EQ(refused.status, EquilibriumStatus::step_too_large);
  EXPECT_EQ(refused.evaluations, 2u);
}

TEST(NewtonSolver, StopsAtItsCap)
{
  // Law: no more evaluations than allowed; the state is told, not thrown.
  ProblemParameters parameters = get_parameters(SecantKind::none, 0);
  parameters.newton.max_evaluations = 4;
  Oedometer oedometer(parameters);
  oedometer.material.true_share = 1. / 3.;
  const NewtonResult result = oedometer.problem.equilibrate({0., 0., 0., 1e6}, true);
  EXPECT_EQ(result.status, EquilibriumStatus::no_convergence);
  EXPECT_EQ(oedometer.material.n_evaluations, 4u);
}

TEST(NewtonSolver, AStressThatIsNoNumberIsAFailure)
{
  // Law: NaN never becomes a state.
  Oedometer oedometer;
  const NewtonResult result =
      oedometer.problem.equilibrate({0., 0., 0., std::numeric_limits<double>::quiet_NaN()}, true);
  EXPECT_NE(result.status, EquilibriumStatus::converged);
}

#include "fem/viscoelastic_material.h"
#include "tests/support/fem_cases.h"

#include <gtest/gtest.h>

#include <complex>

using namespace fem;
using namespace fem::cases;

// Oedometer creep of a Burgers material with elastic bulk. With D = d/dt the deviatoric law is s = 2 G(D) e,
//   1/G(D) = 1/G_m + 1/(eta_m D) + 1/(G_k + eta_k D);
// held laterally the axial stress is (K + 4/3 G(D)) strain. Under a step of stress the strain's transform is
//   s^-1 / (K + 4/3 G(s)), a sum of a constant and two exponentials at the roots of a quadratic.
namespace
{
  struct ClosedForm
  {
    explicit ClosedForm(const BurgersParameters &m)
    {
      // G(s) = N(s)/P(s): P = (G_k + eta_k s)(eta_m s + G_m) + G_m eta_m s, N = G_m eta_m s (G_k + eta_k s).
      const double Gm = m.maxwell_modulus, hm = m.maxwell_viscosity, Gk = m.kelvin_modulus, hk = m.kelvin_viscosity;
      P = {Gk * Gm, hk * Gm + Gk * hm + Gm * hm, hk * hm};
      const double N1 = Gm * hm * Gk, N2 = Gm * hm * hk;
      Q = {m.bulk_modulus * P[0], m.bulk_modulus * P[1] + 4. / 3. * N1, m.bulk_modulus * P[2] + 4. / 3. * N2};
      const double root = std::sqrt(Q[1] * Q[1] - 4. * Q[0] * Q[2]);
      roots = {(-Q[1] - root) / (2. * Q[2]), 2. * Q[0] / (-Q[1] - root)};
    }

    /** Strain per stress [1/Pa] a time after the stress was applied: residues of P / (s Q) at 0 and the roots of Q. */
    double compute_compliance(double time) const
    {
      double compliance = P[0] / Q[0];
      for (const double s : roots)
        compliance += (P[0] + s * (P[1] + s * P[2])) / (s * (Q[1] + 2. * Q[2] * s)) * std::exp(s * time);
      return compliance;
    }

    std::array<double, 3> P, Q;
    std::array<double, 2> roots;
  };
} // namespace

TEST(BurgersCreep, AnOedometerFollowsTheClosedForm)
{
  // Law: strain(t) = stress times the oedometer compliance, from the elastic answer to the viscous end (bulk alone).
  BurgersParameters parameters;
  parameters.kinematics = Kinematics::small;
  parameters.maxwell_viscosity = 1e11;
  const ClosedForm law(parameters);
  ViscoelasticMaterial material(parameters, MPI_COMM_SELF);
  QuasiStaticProblem<2> problem(create_oedometer_mesh(1, 1, MPI_COMM_SELF), get_oedometer_conditions(),
                                get_exact_parameters(Geometry::axisymmetric, Kinematics::small), material);
  Stage creep = get_creep_stage(1e5, 2.);
  creep.first_output = 0.1;
  creep.steps_per_decade = 400.;
  double largest = 0.;
  unsigned int n_outputs = 0;
  StepObserver observer;
  observer.on_commit = [&](const StepReport &report) {
    if (!report.is_output)
      return;
    ++n_outputs;
    const double strain = -report.boundaries.back().displacement[2] / 2.;
    largest = std::max(largest, std::abs(strain / (1e5 * law.compute_compliance(report.time)) - 1.));
  };
  LoadStepping<2> stepping(problem, {get_load_stage(1e5), creep}, {}, observer);
  ASSERT_EQ(stepping.run().status, StepStatus::ok);
  std::printf("largest relative error of the creep strain: %.2e\n", largest);
  EXPECT_EQ(n_outputs, 14u);
  EXPECT_LT(largest, 1e-6); // second order: (ln 10 / 400)^2 / 12 = 3e-6 times the share of creep in a step
}

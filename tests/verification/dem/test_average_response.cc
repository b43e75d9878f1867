// Law: the stress from contacts does the work that the contacts store, and the condensed tangent is its derivative.

#include "dem/contact_law.h"
#include "dem/packing.h"
#include "dem/rev.h"

#include <gtest/gtest.h>

namespace
{
  using namespace dem;

  constexpr std::size_t n_grains = 100;

  RevModel make_model(const double friction)
  {
    RevModel model;
    model.material.friction = friction;
    model.fracture.is_active = false;
    return model;
  }

  /** A packing without friction at an isotropic pressure [Pa], at rest to an unbalanced ratio of 1e-9. */
  RevState make_frictionless_packing(const double pressure)
  {
    const RevModel model = make_model(0.);
    PackingRule rule;
    rule.n_grains = n_grains;
    rule.friction = 0.;
    const Packing packing = generate_packing(rule, model.material, model.dynamics);
    EXPECT_EQ(packing.report.status, RestStatus::at_rest);
    RevModel tight = model;
    tight.equilibrium.unbalanced_ratio = 1e-9;
    tight.equilibrium.stress_tolerance = 1e-6;
    tight.equilibrium.cycle_cap = 1000000;
    Rev rev = make_rev(tight, packing.state);
    CellControl control;
    control.is_stress_controlled = {true, true, true, false, false, false};
    control.target_stress = -pressure * Matrix::Identity();
    const RestReport report = rev.control(control);
    EXPECT_EQ(report.status, RestStatus::at_rest) << describe(report.status);
    rev.accept();
    // The servo has let go: the forces of a held cell.
    EXPECT_EQ(rev.relax().status, RestStatus::at_rest);
    return rev.get_baseline();
  }

  Rev make_tight_rev(const RevState &state, const double friction)
  {
    RevModel model = make_model(friction);
    model.equilibrium.unbalanced_ratio = 1e-9;
    model.equilibrium.cycle_cap = 1000000;
    return Rev(model, state);
  }

  double compute_stored_energy(const RevState &state)
  {
    const ContactLaw law = make_contact_law(make_model(0.).material);
    double energy = 0.;
    for (const Contact &contact : list_contacts(state, law))
      energy += dem::compute_stored_energy(law, contact.overlap, contact.effective_radius);
    return energy;
  }

  Matrix make_strain(const int m, const double size)
  {
    Matrix strain = Matrix::Zero();
    const int i = tangent_index[m][0], j = tangent_index[m][1];
    strain(i, j) += 0.5 * size;
    strain(j, i) += 0.5 * size;
    return strain;
  }

  TEST(AverageResponse, StressDoesTheWorkThatContactsStore)
  {
    Rev rev = make_tight_rev(make_frictionless_packing(10e6), 0.);
    const Matrix step = Vector(0.2e-5, -0.1e-5, -1e-5).asDiagonal();
    for (int k = 0; k < 5; ++k)
      {
        const RevState before = rev.get_baseline();
        ASSERT_EQ(rev.deform(Matrix::Identity() + step).status, RestStatus::at_rest);
        const RevState &after = rev.get_trial();
        const Matrix mean =
            0.5 * (before.cell.compute_volume() * before.stress + after.cell.compute_volume() * after.stress);
        // What the cell did, not what was asked: the grid of strains, 6e-11, is some 1e-6 of a step.
        const Matrix stretch = after.cell.edges * before.cell.edges.inverse();
        const Matrix strain = stretch.diagonal().array().log().matrix().asDiagonal();
        const double work = mean.cwiseProduct(strain).sum();
        const double stored = compute_stored_energy(after) - compute_stored_energy(before);
        // The trapezoid's error is (d stress/stress)^2/12, some 1e-7 here; energies differ in their tenth digit.
        EXPECT_NEAR(work / stored, 1., 1e-6) << "step " << k;
        rev.accept();
      }
  }

  class CondensedTangent : public ::testing::TestWithParam<double>
  {};

  TEST_P(CondensedTangent, IsTheDerivativeOfTheRelaxedStress)
  {
    constexpr double size = 1e-6;
    Rev rev = make_tight_rev(make_frictionless_packing(GetParam()), 10.); // so much friction that nothing slides
    const Tangent tangent = rev.compute_tangent(rev.get_baseline(), TangentKind::condensed);
    const double largest = tangent.cwiseAbs().maxCoeff();
    for (int m = 0; m < 6; ++m)
      {
        ASSERT_EQ(rev.deform(Matrix::Identity() + make_strain(m, size)).status, RestStatus::at_rest);
        const Matrix plus = rev.get_trial().stress;
        ASSERT_EQ(rev.deform(Matrix::Identity() - make_strain(m, size)).status, RestStatus::at_rest);
        const Matrix minus = rev.get_trial().stress;
        const Matrix difference = (plus - minus) / (2. * size);
        for (int k = 0; k < 6; ++k)
          {
            const int i = tangent_index[k][0], j = tangent_index[k][1];
            const double probed = 0.5 * (difference(i, j) + difference(j, i));
            EXPECT_NEAR(tangent(k, m) / largest, probed / largest, 1e-3) << "entry " << k << ", " << m;
          }
      }
  }

  INSTANTIATE_TEST_SUITE_P(Pressures, CondensedTangent, ::testing::Values(0.1e6, 10e6, 21.7e6));
} // namespace

#include "dem/equilibrium.h"

#include "dem/homogenisation.h"
#include "tests/support/rev_cases.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace
{
  using namespace dem;
  using namespace dem::cases;

  /** Mean resultant on a grain over mean normal force, from the reference law and the listed contacts. */
  double compute_unbalanced_ratio(const RevState &state)
  {
    std::vector<Vector> force(state.grains.size(), Vector::Zero());
    double normal = 0.;
    const auto contacts = list_contacts(state, make_contact_law(GrainMaterial{}));
    for (const Contact &contact : contacts)
      {
        force[contact.a] += compute_force_on_a(contact);
        force[contact.b] -= compute_force_on_a(contact);
        normal += contact.normal_force / static_cast<double>(contacts.size());
      }
    double resultant = 0.;
    for (const Vector &f : force)
      resultant += f.norm() / static_cast<double>(force.size());
    return resultant / normal;
  }

  /** Distance of two places [m] once whole edges are taken away. */
  double compute_image_distance(const Cell &cell, const Vector &first, const Vector &second)
  {
    const Vector fraction = cell.edges.inverse() * (first - second);
    return (cell.edges * (fraction - fraction.array().round().matrix())).norm();
  }

  TEST(Equilibrium, ServoHoldsAllSixStresses)
  {
    // Law: at rest each held stress lies within 0.2 % of the largest target, and the unbalanced ratio below 1e-4.
    // Tolerances: those of the rule; the ratio from the reference law differs by rounding.
    RevState state = get_packing().state;
    CellControl control;
    control.is_stress_controlled.fill(true);
    control.target_stress << -250e3, 20e3, 10e3, 20e3, -200e3, -15e3, 10e3, -15e3, -300e3;
    const RestReport report = bring_to_rest(state, make_rest_rule(), control);
    ASSERT_EQ(report.status, RestStatus::at_rest) << describe(report.status);
    const Matrix stress = 0.5 * (state.stress + state.stress.transpose());
    EXPECT_LE((stress - control.target_stress).cwiseAbs().maxCoeff(), 2e-3 * 300e3);
    EXPECT_LT(report.unbalanced_ratio, 1e-4);
    EXPECT_NEAR(compute_unbalanced_ratio(state), report.unbalanced_ratio, 1e-9);
    EXPECT_EQ(report.n_cycles, state.counters.cycles - get_packing().state.counters.cycles);
    EXPECT_NEAR(report.largest_deviation[2], 200e3, 1e3); // it began there, 200 kPa above its target
  }

  TEST(Equilibrium, StrainControlReachesTheStretch)
  {
    // Law: F = U F0 for the cell's edges and its deformation gradient; many small increments multiply up to it.
    // Tolerance: rounding of some hundred products.
    RevState state = get_packing().state;
    const RevState before = state;
    CellControl control;
    control.stretch << 0.996, 0.002, -0.001, 0.002, 1.001, 0.0005, -0.001, 0.0005, 0.998;
    const RestReport report = bring_to_rest(state, make_rest_rule(), control);
    ASSERT_EQ(report.status, RestStatus::at_rest);
    EXPECT_LT((state.cell.deformation - control.stretch * before.cell.deformation).norm(), 1e-13);
    EXPECT_LT((state.cell.edges - control.stretch * before.cell.edges).norm(), 1e-13 * before.cell.edges.norm());
    EXPECT_GE(report.n_cycles, 400u); // no faster than 1e-5 a cycle
    EXPECT_EQ(report.duration, 0.);   // scaled masses: no time
  }

  TEST(Equilibrium, MixedControlStrainsWhatIsNotHeld)
  {
    // Law: strained components reach their stretch while the others hold their stress; an oedometer keeps its width.
    RevState state = get_packing().state;
    CellControl control = make_oedometer(400e3);
    control.stretch(2, 2) = 17.; // under stress control: unused
    control.stretch(0, 0) = 1.0005;
    const RestReport report = bring_to_rest(state, make_rest_rule(), control);
    ASSERT_EQ(report.status, RestStatus::at_rest);
    EXPECT_NEAR(state.stress(2, 2), -400e3, 2e-3 * 400e3);
    const Matrix relative = state.cell.deformation * get_packing().state.cell.deformation.inverse();
    EXPECT_NEAR(relative(0, 0), 1.0005, 1e-13);
    EXPECT_EQ(state.cell.deformation(1, 1), get_packing().state.cell.deformation(1, 1));
    EXPECT_LT(relative(2, 2), 1.);
  }

  TEST(Equilibrium, FixedCyclesAreRunExactly)
  {
    // Law: the paper's rule: just so many cycles, at rest or not, but never before the strain is on.
    for (const std::size_t n : {1, 37, 257})
      for (const std::size_t n_straining : {0, 103})
        {
          RevState state = get_packing().state;
          RestRule rule = make_rest_rule();
          rule.equilibrium.fixed_cycles = n;
          CellControl control;
          control.stretch(2, 2) = 1. - 0.9999e-5 * static_cast<double>(n_straining);
          const RestReport report = bring_to_rest(state, rule, control);
          EXPECT_EQ(report.status, RestStatus::at_rest);
          EXPECT_EQ(report.n_cycles, std::max(n, n_straining));
          EXPECT_NEAR(state.cell.deformation(2, 2) / get_packing().state.cell.deformation(2, 2), control.stretch(2, 2),
                      1e-14);
        }
  }

  TEST(Equilibrium, TighterRuleGivesSmallerUnbalance)
  {
    // Law: at rest means below the ratio that was asked for.
    for (const double ratio : {1e-2, 1e-5, 1e-8})
      {
        RevState state = get_packing().state;
        RestRule rule = make_rest_rule();
        rule.equilibrium.unbalanced_ratio = ratio;
        CellControl control;
        control.stretch(2, 2) = 0.9995;
        EXPECT_EQ(bring_to_rest(state, rule, control).status, RestStatus::at_rest);
        EXPECT_LT(compute_unbalanced_ratio(state), ratio);
      }
  }

  TEST(Equilibrium, SaysWhyItGaveUp)
  {
    // Law: a status, never a hang and never a wrong "at rest": too few cycles, a cell too narrow, a number that is
    // none.
    RevState state = get_packing().state;
    RestRule rule = make_rest_rule();
    rule.equilibrium.cycle_cap = 50;
    CellControl control = make_oedometer(1e6);
    const RestReport capped = bring_to_rest(state, rule, control);
    EXPECT_EQ(capped.status, RestStatus::cap_reached);
    EXPECT_EQ(capped.n_cycles, 50u);

    RevState loose = make_state({Vector::Zero(), Vector::Constant(5. * radius)}, 10. * radius);
    rule = make_rest_rule();
    rule.equilibrium.strain_per_cycle = 1e-2;
    control = CellControl{};
    control.stretch(2, 2) = 0.3;
    EXPECT_EQ(bring_to_rest(loose, rule, control).status, RestStatus::cell_too_narrow);

    control = make_oedometer(std::numeric_limits<double>::quiet_NaN());
    rule.equilibrium.cycle_cap = 1000;
    RevState poisoned = get_packing().state;
    EXPECT_EQ(bring_to_rest(poisoned, rule, control).status, RestStatus::not_finite);
  }

  TEST(Equilibrium, AGrainThatIsNowhereIsNotAtRest)
  {
    // Law: a grain whose place is no number is reported, not overlooked because it touches nobody.
    RevState state = get_packing().state;
    CycleHook hook = [&](Dynamics &dynamics) {
      if (dynamics.get_n_cycles() == 15)
        state.grains.velocity[7].x = std::numeric_limits<double>::quiet_NaN();
      return CycleVerdict::may_rest;
    };
    CellControl control;
    control.stretch(2, 2) = 0.9995;
    EXPECT_EQ(bring_to_rest(state, make_rest_rule(), control, hook).status, RestStatus::not_finite);
  }

  TEST(Equilibrium, ALeaningLatticeIsReplacedByAnUprightOne)
  {
    // Law: one lattice has many bases; the reduced one is as wide as the packing's own, holds the same grains at the
    // same places, and nothing has moved. Tolerance: fractions rounded once more, times the steepness of contacts.
    RevState state = get_packing().state;
    RevState leaning = state;
    Matrix change = Matrix::Identity();
    change(0, 1) = 1.; // an edge that leans over its neighbour by its whole length
    leaning.cell.edges = (state.cell.edges * change).eval();
    for (Row &place : leaning.grains.place)
      place.x -= place.y;
    const RestReport report = bring_to_rest(leaning, make_rest_rule(), CellControl{});
    EXPECT_EQ(report.status, RestStatus::at_rest);
    EXPECT_EQ(report.n_cycles, 0u);
    EXPECT_NEAR(compute_narrowest_width(leaning.cell), compute_narrowest_width(state.cell),
                1e-14 * state.cell.edges.norm());
    EXPECT_EQ(leaning.cell.deformation, state.cell.deformation);
    EXPECT_LT((leaning.stress - state.stress).norm(), 1e-9 * state.stress.norm());
    for (std::size_t i = 0; i < n_grains; ++i)
      EXPECT_LT(compute_image_distance(state.cell, leaning.cell.edges * to_vector(leaning.grains.place[i]),
                                       state.cell.edges * to_vector(state.grains.place[i])),
                1e-14 * state.cell.edges.norm());
  }
} // namespace

// Law: a grain under held force splits after (r - a0)/v, v = v0 (sigma/sigma_lim)^n (time-to-fracture paper, Eq. 3, 7).

#include "dem/rev.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace
{
  using namespace dem;

  constexpr double radius = 0.1e-3;    // [m]
  constexpr double crack = 0.03e-3;    // a0 of the middle grain [m]
  constexpr double strength = 10e9;    // of the middle grain [Pa]
  constexpr double never_broken = 1e3; // times as strong: the outer grains

  /** Three grains in a column along z, periodic: the middle one lies between two others. */
  Rev make_column()
  {
    RevModel model;
    // The cell's edges carry 16 digits and the overlap is a hundredth of them: the force has 13 at best.
    model.equilibrium.unbalanced_ratio = 1e-11;
    model.equilibrium.stress_tolerance = 1e-11;
    RevState state;
    state.resize_grains(3);
    const double height = 6. * radius;
    state.cell.edges = Vector(height, height, height).asDiagonal();
    for (int i = 0; i < 3; ++i)
      state.grains.place[i] = {0.5, 0.5, (i + 0.5) / 3., radius};
    Rev rev = make_rev(model, state);
    RevState prepared = rev.get_committed();
    for (int i = 0; i < 3; ++i)
      {
        prepared.grains.strength[i] = i == 1 ? strength : never_broken * strength;
        prepared.grains.crack_half_length[i] = crack;
      }
    return Rev(model, prepared);
  }

  /** The column with an axial force [N] at rest. */
  Rev load_column(const double force)
  {
    Rev rev = make_column();
    CellControl control;
    control.is_stress_controlled[2] = true;
    const double area = std::pow(6. * radius, 2);
    control.target_stress(2, 2) = -force / area;
    const RestReport report = rev.control(control);
    EXPECT_EQ(report.status, RestStatus::at_rest) << describe(report.status);
    rev.accept();
    rev.commit();
    return rev;
  }

  struct Broken
  {
    double time, contact_stress;
  };

  Broken break_middle_grain(const double force)
  {
    Rev rev = load_column(force);
    const double time = rev.compute_time_to_next_batch();
    const double early = time * (1. - 1e-12);
    EXPECT_EQ(rev.age(early), 0u);
    rev.revert();
    EXPECT_EQ(rev.age(time), 1u);
    EXPECT_EQ(rev.get_baseline().grains.size(), 2u + 14u);
    rev.revert();
    return {time, rev.get_committed().grains.largest_contact_stress[1]};
  }

  const std::vector<double> forces = {0.2, 0.5, 1., 2., 4.}; // [N], asperities and transition

  TEST(OneGrain, BreaksWhenItsCrackHasGrownThrough)
  {
    const ContactLaw law = make_contact_law(GrainMaterial{});
    for (const double force : forces)
      {
        // The overlap that carries the force, by bisection of the law: independent of the moving grains.
        double low = 0., high = 0.1 * radius;
        for (int k = 0; k < 200; ++k)
          (compute_normal_response(law, 0.5 * (low + high), 0.5 * radius).force < force ? low : high) =
              0.5 * (low + high);
        const double stress = force / (std::numbers::pi * 0.5 * radius * low);
        const double velocity = 0.1 * std::pow(stress / strength, 60.);
        const double expected = (radius - crack) / velocity;
        // What equilibrium leaves of the force (1e-11) is up to 60 times larger in the velocity.
        EXPECT_NEAR(break_middle_grain(force).time / expected, 1., 1e-9) << force << " N";
      }
  }

  TEST(OneGrain, TimeFallsWithTheSixtiethPowerOfContactStress)
  {
    const Broken first = break_middle_grain(forces.front());
    for (std::size_t i = 1; i < forces.size(); ++i)
      {
        const Broken next = break_middle_grain(forces[i]);
        const double slope = std::log(next.time / first.time) / std::log(next.contact_stress / first.contact_stress);
        EXPECT_NEAR(slope, -60., 1e-10) << forces[i]
                                        << " N"; // a function of the stress that is read: rounding of logarithms
      }
  }

  TEST(OneGrain, AgainstForceTheSlopeFollowsTheStage)
  {
    // Asperities: sigma ~ N/d ~ N^(1 - 1/c). Both forces below N1 of this pair.
    const ContactLaw law = make_contact_law(GrainMaterial{});
    ASSERT_GT(law.force_scale_1 * std::sqrt(0.5 * radius), 0.18);
    const Broken soft = break_middle_grain(0.08), hard = break_middle_grain(0.16);
    const double slope = std::log(hard.time / soft.time) / std::log(2.);
    EXPECT_NEAR(slope, -60. * (1. - 1. / law.c), 1e-8);
  }
} // namespace

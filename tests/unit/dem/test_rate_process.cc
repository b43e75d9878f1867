#include "dem/rate_process.h"

#include <gtest/gtest.h>

#include <cmath>

namespace
{
  using namespace dem;

  constexpr HeldContact contact{2., 5e5}; // N, N/m: a contact of a sand at some 20 MPa

  TEST(RateProcess, ConstantsAreThoseOfTheTheory)
  {
    // Law: v0 = 2 lambda (kT/h) exp(-dF/RT), alpha = lambda/(2 k T n1). Values by hand, R = 8.314463 J/(mol K);
    // tolerance: its digits in the exponent, 43 1e-7.
    const RateProcessLaw law;
    EXPECT_NEAR(compute_reference_slip_velocity(law) /
                    (2. * 2.8e-10 * 6.105084e12 * std::exp(-105e3 / (8.314463 * 293.))),
                1., 1e-5);
    EXPECT_NEAR(compute_friction_sensitivity(law), 2.8e-10 / (2. * 1.380649e-23 * 293. * 1e9), 1e-12);
  }

  TEST(RateProcess, AHeldContactRelaxesAsTheIntegratedLaw)
  {
    // Law: the closed form solves dt/dtime = -kt v0 sinh(alpha t/N). Held against 4th order Runge-Kutta in 20000 steps
    // of equal decrease of log time; tolerance: its error, found by halving its steps to be below 1e-9.
    const RateProcessLaw law;
    const double start = 0.2 * contact.normal_force, end_time = 1e7;
    double t = start, time = 0.;
    const auto slope = [&](const double shear) {
      return -contact.shear_stiffness * compute_slip_velocity(law, shear / contact.normal_force);
    };
    const int n = 20000;
    for (int i = 0; i < n; ++i)
      {
        const double next = end_time * std::expm1(12. * (i + 1.) / n) / std::expm1(12.), h = next - time;
        const double k1 = slope(t), k2 = slope(t + 0.5 * h * k1), k3 = slope(t + 0.5 * h * k2), k4 = slope(t + h * k3);
        t += h / 6. * (k1 + 2. * k2 + 2. * k3 + k4);
        time = next;
      }
    EXPECT_LT(t, 0.8 * start); // it does relax
    EXPECT_NEAR(compute_relaxed_shear_force(law, contact, start, end_time) / t, 1., 1e-8);
  }

  TEST(RateProcess, StepsOfAnyLengthLeadToTheSameForce)
  {
    // Law: the solution of an autonomous equation is a semi-group: one step of dt, or a thousand of dt/1000, or two
    // unequal ones. It never changes sign, whatever dt. Tolerance: rounding of a thousand steps.
    const RateProcessLaw law;
    for (const double start : {1e-6, 0.1, 0.55, 20.}) // the last: far above what friction allows, alpha t/N = 340
      for (const double dt : {1e-3, 1e3, 1e6, 1e9, 1e15})
        {
          const double once = compute_relaxed_shear_force(law, contact, start, dt);
          double often = start;
          for (int i = 0; i < 1000; ++i)
            often = compute_relaxed_shear_force(law, contact, often, 1e-3 * dt);
          EXPECT_NEAR(often, once, 1e-11 * start) << start << " " << dt;
          EXPECT_GE(once, 0.);
          EXPECT_LE(once, start);
        }
    EXPECT_EQ(compute_relaxed_shear_force(law, contact, 0.3, 0.), 0.3);
    EXPECT_EQ(compute_relaxed_shear_force(law, {0., 0.}, 0., 1.), 0.); // a touch of no force
  }

  TEST(RateProcess, RelaxationIsLinearInLogTimeBetweenItsTwoEnds)
  {
    // Law: while alpha t/N >> 1 >> its end, t = N/alpha ln(2/(rate time)): a decade takes N ln(10)/alpha. Tolerance:
    // the neglected terms, 1/(rate time sinh x0) and rate time, below 1 %.
    RateProcessLaw law;
    law.bonds_per_force = 3e8; // a wider middle
    const double alpha = compute_friction_sensitivity(law), x0 = 30.;
    const double rate = contact.shear_stiffness * compute_reference_slip_velocity(law) * alpha / contact.normal_force;
    const double start = x0 * contact.normal_force / alpha;
    const double early = compute_relaxed_shear_force(law, contact, start, 1e-6 / rate);
    const double late = compute_relaxed_shear_force(law, contact, start, 1e-5 / rate);
    EXPECT_NEAR((early - late) / (contact.normal_force * std::log(10.) / alpha), 1., 1e-2);
  }

  TEST(RateProcess, UnderAConstantForceAContactCreepsAtTheLawsVelocity)
  {
    // Law: relax by dt, load again to the same force, repeat: the slips (what was lost over kt) add up to v time as dt
    // falls. Tolerance: a step loses the share 1e-3 of the argument of the sinh, half of which is the mean error.
    const RateProcessLaw law;
    const double force = 0.2 * contact.normal_force;
    const double velocity = compute_slip_velocity(law, force / contact.normal_force);
    const double dt =
        1e-3 * contact.normal_force / compute_friction_sensitivity(law) / (contact.shear_stiffness * velocity);
    double slip = 0.;
    for (int i = 0; i < 100; ++i)
      slip += (force - compute_relaxed_shear_force(law, contact, force, dt)) / contact.shear_stiffness;
    EXPECT_NEAR(slip / (velocity * 100. * dt), 1., 1e-3);
  }
} // namespace

#include "dem/contact_law.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <utility>

namespace
{
  using namespace dem;

  constexpr double effective_radius = 0.0525e-3;

  GrainMaterial make_material(double n1, double n2)
  {
    GrainMaterial material;
    material.n1 = n1;
    material.n2 = n2;
    return material;
  }

  /** Integral of N from 0 to an overlap by Simpson's rule; d = end t^2 smooths the power law's start. */
  double integrate_force(const ContactLaw &law, double end)
  {
    constexpr int n = 20000;
    const auto integrand = [&](double t) {
      return compute_normal_response(law, end * t * t, effective_radius).force * 2. * end * t;
    };
    double sum = integrand(0.) + integrand(1.);
    for (int i = 1; i < n; ++i)
      sum += (i % 2 == 1 ? 4. : 2.) * integrand(static_cast<double>(i) / n);
    return sum / (3. * n);
  }

  TEST(ContactLaw, ConstantsAgreeWithTheTable)
  {
    // Law: b, c, dT1/S and dT2/S are functions of n1 and n2 alone. Tolerance: half the last printed digit.
    struct Row
    {
      double n1, n2, b, c, dT1, dT2;
    };
    for (const Row &row :
         {Row{0.05, 5., 1.83472, 1.87590, 2.27728, 27.4570}, Row{0.82, 1.24, 1.58301, 2.58980, 2.10932, 24.4670}})
      for (const double roughness : {0.1e-6, 0.6e-6, 3e-6})
        {
          GrainMaterial material = make_material(row.n1, row.n2);
          material.roughness = roughness;
          const ContactLaw law = make_contact_law(material);
          EXPECT_NEAR(law.b, row.b, 5e-6);
          EXPECT_NEAR(law.c, row.c, 5e-6);
          EXPECT_NEAR(law.dT1 / roughness, row.dT1, 5e-6);
          EXPECT_NEAR(law.dT2 / roughness, row.dT2, 5e-5);
        }
  }

  TEST(ContactLaw, StageEndsCarryThePublishedForces)
  {
    // Law: N(dT1) = N1 = S E* sqrt(2 R* S), N(dT2) = 100 N1, and dT2 follows from N2 through Hertz. Tolerance: rounding
    // of a few operations, 1e-13 relative.
    const ContactLaw law = make_contact_law(GrainMaterial{});
    const double modulus = 32e9 / (1. - 0.19);
    const double S = 0.6e-6;
    const double N1 = S * modulus * std::sqrt(2. * effective_radius * S);
    const double dT2 =
        law.d1 + law.d2 + std::pow(3. * 100. * N1 / (4. * modulus * std::sqrt(effective_radius)), 2. / 3.);
    EXPECT_NEAR(law.dT2, dT2, 1e-13 * dT2);
    EXPECT_NEAR(compute_normal_response(law, law.dT1, effective_radius).force, N1, 1e-13 * N1);
    EXPECT_NEAR(compute_normal_response(law, law.dT2, effective_radius).force, 100. * N1, 1e-11 * N1);
  }

  TEST(ContactLaw, ForceAndStiffnessAreContinuousAtBothStageEnds)
  {
    // Law: N and dN/dd agree on both sides of a stage's end. Tolerance: one step of the overlap's last bit changes N by
    // about 3e-16 relative; powers near 100 carry a few 1e-16 more, so 1e-12 is rounding and no jump.
    for (const auto &[n1, n2] : {std::pair{0.05, 5.}, {0.82, 1.24}, {0., 0.}})
      {
        const ContactLaw law = make_contact_law(make_material(n1, n2));
        for (const double end : {law.dT1, law.dT2})
          {
            const double beyond = std::nextafter(end, std::numeric_limits<double>::infinity());
            const NormalResponse below = compute_normal_response(law, end, effective_radius);
            const NormalResponse above = compute_normal_response(law, beyond, effective_radius);
            EXPECT_NEAR(above.force, below.force, 1e-12 * below.force);
            EXPECT_NEAR(above.stiffness, below.stiffness, 1e-12 * below.stiffness);
          }
      }
  }

  TEST(ContactLaw, SmoothGrainsAreHertz)
  {
    // Law: S_q = 0 gives N = 4/3 E* sqrt(R*) d^1.5, kn = 1.5 N/d, energy 2/5 N d. Tolerance: rounding.
    GrainMaterial material;
    material.roughness = 0.;
    for (const RoughnessRule rule : {RoughnessRule::combined, RoughnessRule::per_grain})
      {
        material.roughness_rule = rule;
        const ContactLaw law = make_contact_law(material);
        for (const double overlap : {1e-12, 1e-8, 1e-6, 1e-5})
          {
            const double modulus = 32e9 / (1. - 0.19);
            const double force = 4. / 3. * modulus * std::sqrt(effective_radius) * std::pow(overlap, 1.5);
            const NormalResponse response = compute_normal_response(law, overlap, effective_radius);
            EXPECT_NEAR(response.force, force, 1e-14 * force);
            EXPECT_NEAR(response.stiffness, 1.5 * force / overlap, 1e-14 * 1.5 * force / overlap);
            EXPECT_NEAR(compute_stored_energy(law, overlap, effective_radius), 0.4 * force * overlap,
                        1e-14 * force * overlap);
          }
      }
  }

  TEST(ContactLaw, TangentAndSeparatedGrainsFeelNothing)
  {
    // Law: N = kn = energy = 0 exactly at d <= 0, rough or smooth; a NaN would fail the comparison too.
    for (const double roughness : {0., 0.6e-6})
      {
        GrainMaterial material;
        material.roughness = roughness;
        const ContactLaw law = make_contact_law(material);
        for (const double overlap : {0., -0., -1e-9, -1e-3})
          {
            const NormalResponse response = compute_normal_response(law, overlap, effective_radius);
            EXPECT_EQ(response.force, 0.);
            EXPECT_EQ(response.stiffness, 0.);
            EXPECT_EQ(compute_stored_energy(law, overlap, effective_radius), 0.);
          }
      }
  }

  TEST(ContactLaw, StiffnessIsTheDerivativeOfTheForce)
  {
    // Law: kn = dN/dd in every stage. Tolerance: a central difference over 1e-5 d errs by 1e-10 (truncation) and
    // 1e-11 (rounding) relative.
    const ContactLaw law = make_contact_law(GrainMaterial{});
    for (const double overlap : {0.01 * law.dT1, 0.5 * law.dT1, 2. * law.dT1, 0.9 * law.dT2, 1.1 * law.dT2})
      {
        const double step = 1e-5 * overlap;
        const double difference = compute_normal_response(law, overlap + step, effective_radius).force -
                                  compute_normal_response(law, overlap - step, effective_radius).force;
        const double stiffness = compute_normal_response(law, overlap, effective_radius).stiffness;
        EXPECT_NEAR(difference / (2. * step), stiffness, 1e-9 * stiffness);
      }
  }

  TEST(ContactLaw, StoredEnergyIsTheIntegralOfTheForce)
  {
    // Law: energy = integral of N from 0 to d through all three stages, the stage ends included. Tolerance: Simpson's
    // rule with 2e4 intervals errs by about 1e-12 at the kinks of dN/dd.
    const ContactLaw law = make_contact_law(GrainMaterial{});
    for (const double overlap :
         {0.3 * law.dT1, law.dT1, 1.0001 * law.dT1, 0.5 * law.dT2, law.dT2, 1.0001 * law.dT2, 3. * law.dT2})
      {
        const double energy = integrate_force(law, overlap);
        EXPECT_NEAR(compute_stored_energy(law, overlap, effective_radius), energy, 1e-10 * energy);
      }
  }

  TEST(ContactLaw, ShearStiffnessIsMindlins)
  {
    // Law: kt/kn = 8 G* a / (2 E* a) with G* = G/(2 (2 - nu)) for equal grains. Tolerance: rounding.
    const ContactLaw law = make_contact_law(GrainMaterial{});
    const double G = 32e9, nu = 0.19;
    EXPECT_NEAR(law.shear_ratio, 4. * (G / (2. * (2. - nu))) / (G / (1. - nu)), 1e-15);
    EXPECT_EQ(law.friction, 0.275);
  }

  TEST(ContactLaw, RoughnessPerGrainAddsInQuadrature)
  {
    // Law: S = sqrt(Sq_a^2 + Sq_b^2) of two equal grains. Tolerance: rounding.
    GrainMaterial material;
    const double combined = make_contact_law(material).roughness;
    material.roughness_rule = RoughnessRule::per_grain;
    EXPECT_EQ(combined, 0.6e-6);
    EXPECT_NEAR(make_contact_law(material).roughness, std::hypot(0.6e-6, 0.6e-6), 1e-15 * 0.6e-6);
  }
} // namespace

#include "dem/contact_law.h"

#include <cassert>
#include <cmath>
#include <initializer_list>
#include <numbers>

namespace dem
{
  namespace
  {
    /** N2/N1: where the published law ends its transition stage. */
    constexpr double stage_force_ratio = 100.;

    double compute_pair_roughness(const GrainMaterial &material)
    {
      return material.roughness_rule == RoughnessRule::combined ? material.roughness
                                                                : std::numbers::sqrt2 * material.roughness;
    }

    /** Hertz constant 4/3 E* sqrt(R*) [N/m^1.5]. */
    double compute_hertz_factor(const ContactLaw &law, double effective_radius)
    {
      return 4. / 3. * law.effective_modulus * std::sqrt(effective_radius);
    }
  } // namespace

  ContactLaw make_contact_law(const GrainMaterial &material)
  {
    assert(material.shear_modulus > 0. && material.poisson_ratio >= 0. && material.poisson_ratio <= 0.5);
    assert(material.roughness >= 0. && material.n1 >= 0. && material.n2 >= 0.);
    const double nu = material.poisson_ratio;

    ContactLaw law;
    law.effective_modulus = material.shear_modulus / (1. - nu);
    law.friction = material.friction;
    law.shear_ratio = 2. * (1. - nu) / (2. - nu);
    law.roughness = compute_pair_roughness(material);
    law.wall_friction = material.wall_friction;
    law.wall_roughness = material.roughness;
    if (law.roughness == 0.)
      return law; // stages 1 and 2 have no width: every overlap is Hertz's

    // With overlaps in units of S, R* and E* cancel from all but the forces.
    const double S = law.roughness;
    const double X = std::pow(0.75 * stage_force_ratio * std::numbers::sqrt2, 2. / 3.);
    law.b = 1.5 * (X + material.n2) / X;
    law.d1 = material.n1 * S;
    law.d2 = material.n2 * S;
    law.dT2 = X * S + law.d1 + law.d2;
    law.dT1 = law.d1 + (law.dT2 - law.d1) * std::pow(stage_force_ratio, -1. / law.b);
    law.c = law.b * law.dT1 / (law.dT1 - law.d1);
    law.force_scale_1 = S * law.effective_modulus * std::sqrt(2. * S);
    law.force_scale_2 = stage_force_ratio * law.force_scale_1;
    return law;
  }

  ContactLaw make_wall_law(const ContactLaw &law)
  {
    ContactLaw wall = law;
    wall.effective_modulus = 2. * law.effective_modulus; // one of the two bodies does not yield
    wall.friction = law.wall_friction;
    if (law.roughness == 0.)
      return wall;
    // All lengths are multiples of S, and N1 is one of E* S^1.5.
    const double share = law.wall_roughness / law.roughness;
    for (double *const length : {&wall.roughness, &wall.d1, &wall.d2, &wall.dT1, &wall.dT2})
      *length *= share;
    for (double *const force_scale : {&wall.force_scale_1, &wall.force_scale_2})
      *force_scale *= 2. * share * std::sqrt(share);
    return wall;
  }

  NormalResponse compute_normal_response(const ContactLaw &law, double overlap, double effective_radius)
  {
    if (!(overlap > 0.))
      return {0., 0.};
    if (overlap <= law.dT1)
      {
        const double force = law.force_scale_1 * std::sqrt(effective_radius) * std::pow(overlap / law.dT1, law.c);
        return {force, law.c * force / overlap};
      }
    if (overlap <= law.dT2)
      {
        const double force =
            law.force_scale_2 * std::sqrt(effective_radius) * std::pow((overlap - law.d1) / (law.dT2 - law.d1), law.b);
        return {force, law.b * force / (overlap - law.d1)};
      }
    const double hertz_overlap = overlap - law.d1 - law.d2;
    const double secant = compute_hertz_factor(law, effective_radius) * std::sqrt(hertz_overlap);
    return {secant * hertz_overlap, 1.5 * secant};
  }

  double compute_stored_energy(const ContactLaw &law, double overlap, double effective_radius)
  {
    if (!(overlap > 0.))
      return 0.;
    const double root = std::sqrt(effective_radius);

    double energy = 0.;
    if (law.dT1 > 0.)
      {
        const double share = std::fmin(overlap / law.dT1, 1.);
        energy += law.force_scale_1 * root * law.dT1 / (law.c + 1.) * std::pow(share, law.c + 1.);
      }
    if (overlap > law.dT1 && law.dT2 > 0.)
      {
        const double width = law.dT2 - law.d1;
        const double begin = (law.dT1 - law.d1) / width;
        const double end = std::fmin((overlap - law.d1) / width, 1.);
        energy +=
            law.force_scale_2 * root * width / (law.b + 1.) * (std::pow(end, law.b + 1.) - std::pow(begin, law.b + 1.));
      }
    if (overlap > law.dT2)
      {
        const double begin = law.dT2 - law.d1 - law.d2;
        const double end = overlap - law.d1 - law.d2;
        energy += 0.4 * compute_hertz_factor(law, effective_radius) * (std::pow(end, 2.5) - std::pow(begin, 2.5));
      }
    return energy;
  }
} // namespace dem

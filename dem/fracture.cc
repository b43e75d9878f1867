#include "dem/fracture.h"

#include <cassert>
#include <cmath>
#include <limits>
#include <numbers>

namespace dem
{
  double draw_strength_factor(const StrengthLaw &law, RandomStream &stream)
  {
    return 1. + law.variation * stream.draw_truncated_normal(law.truncation);
  }

  double compute_strength(const StrengthLaw &law, double diameter, double factor)
  {
    assert(diameter > 0. && law.reference_diameter > 0. && law.size_exponent > 0.);
    return law.reference_strength * std::pow(diameter / law.reference_diameter, -3. / law.size_exponent) * factor;
  }

  double draw_initial_crack(const CharlesLaw &law, double diameter, RandomStream &stream)
  {
    const double width = law.largest_crack_share - law.smallest_crack_share;
    return diameter * (law.smallest_crack_share + width * stream.draw_uniform());
  }

  double compute_contact_stress(double normal_force, double effective_radius, double overlap)
  {
    if (!(overlap > 0.))
      return 0.; // freshly split siblings are tangent: 0/0
    return normal_force / (std::numbers::pi * effective_radius * overlap);
  }

  double compute_crack_velocity(const CharlesLaw &law, double contact_stress, double strength)
  {
    assert(contact_stress >= 0. && strength > 0.);
    return law.reference_velocity * std::pow(contact_stress / strength, law.exponent);
  }

  double compute_time_to_fracture(double radius, double crack_half_length, double crack_velocity)
  {
    if (crack_half_length >= radius)
      return 0.;
    if (!(crack_velocity > 0.))
      return std::numeric_limits<double>::infinity();
    return (radius - crack_half_length) / crack_velocity;
  }
} // namespace dem

#include "dem/rate_process.h"

#include <cassert>
#include <cmath>

namespace dem
{
  namespace
  {
    // Exact by the definition of the units (SI 2019).
    constexpr double boltzmann = 1.380649e-23; // [J/K]
    constexpr double planck = 6.62607015e-34;  // [J s]
    constexpr double avogadro = 6.02214076e23; // [1/mol]
  }                                            // namespace

  double compute_reference_slip_velocity(const RateProcessLaw &law)
  {
    const double attempts = boltzmann * law.temperature / planck; // [1/s]
    const double share = std::exp(-law.activation_energy / (avogadro * boltzmann * law.temperature));
    return 2. * law.unit_displacement * attempts * share;
  }

  double compute_friction_sensitivity(const RateProcessLaw &law)
  {
    return law.unit_displacement / (2. * boltzmann * law.temperature * law.bonds_per_force);
  }

  double compute_slip_velocity(const RateProcessLaw &law, const double mobilised_friction)
  {
    return compute_reference_slip_velocity(law) * std::sinh(compute_friction_sensitivity(law) * mobilised_friction);
  }

  double compute_relaxed_shear_force(const RateProcessLaw &law, const HeldContact &contact, const double shear_force,
                                     const double dt)
  {
    assert(shear_force >= 0. && dt >= 0.);
    if (!(contact.normal_force > 0.) || shear_force == 0. || dt == 0.)
      return shear_force;
    const double alpha = compute_friction_sensitivity(law);
    const double rate =
        contact.shear_stiffness * compute_reference_slip_velocity(law) * alpha / contact.normal_force; // [1/s]
    // tanh(x/2) falls as exp(-rate dt) for x = alpha t/N. Written in what is small, lest tanh of a large x be one.
    const double decay = std::exp(-rate * dt), decayed = -std::expm1(-rate * dt);
    const double before = alpha * shear_force / contact.normal_force;
    const double tail = std::exp(-before), rise = -std::expm1(-before); // e^-x and 1 - e^-x
    const double after = std::log1p(2. * decay * rise / (decayed + tail * (1. + decay)));
    return after * contact.normal_force / alpha;
  }
} // namespace dem

#pragma once

#include "dem/random.h"

namespace dem
{
  /** Strength of a grain under a contact force (time-to-fracture paper, Eq. 2). */
  struct StrengthLaw
  {
    double reference_strength = 3.75e9; ///< sigma_lim0 [Pa]
    double reference_diameter = 2e-3;   ///< d0 [m]; the paper gives none: a choice
    double size_exponent = 12.;         ///< m [-]
    double variation = 0.38;            ///< var [-]
    double truncation = 2.5;            ///< |X| <= truncation [-], so that f = 1 + var X stays positive: a choice
  };

  /** Sub-critical crack growth (Charles 1958; time-to-fracture paper, Eq. 3-4). */
  struct CharlesLaw
  {
    double reference_velocity = 0.1;     ///< v0 [m/s]
    double exponent = 60.;               ///< n [-]
    double smallest_crack_share = 0.001; ///< smallest initial half-length over diameter [-]
    double largest_crack_share = 0.5;    ///< largest initial half-length over diameter [-]; a grain splits beyond 0.5
  };

  /** f = 1 + var X of a grain [-]. */
  double draw_strength_factor(const StrengthLaw &law, RandomStream &stream);

  /** sigma_lim of a grain [Pa]. @param diameter [m] @param factor f [-] */
  double compute_strength(const StrengthLaw &law, double diameter, double factor);

  /** Initial crack half-length [m], uniform in [smallest, largest] share of the diameter [m]. */
  double draw_initial_crack(const CharlesLaw &law, double diameter, RandomStream &stream);

  /** sigma = N / (pi r' d) [Pa]; 0 at overlap 0. @param effective_radius r' [m] @param overlap d [m] */
  double compute_contact_stress(double normal_force, double effective_radius, double overlap);

  /** dv/dt of the crack's half-length [m/s]: v0 (sigma/sigma_lim)^n. @pre contact_stress >= 0, strength > 0 */
  double compute_crack_velocity(const CharlesLaw &law, double contact_stress, double strength);

  /** (r - a)/v [s]: time left at frozen forces; infinity at v == 0, 0 when a >= r already. */
  double compute_time_to_fracture(double radius, double crack_half_length, double crack_velocity);
} // namespace dem

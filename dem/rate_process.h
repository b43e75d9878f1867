#pragma once

namespace dem
{
  /**
   * Sliding as a rate process: bonds in a contact are broken by heat, the shear force only leans on the barrier (Eyring
   * 1936; contacts after Kuhn and Mitchell 1993; docs/theory.md Eq. 6.5-6.9). No default is the time-to-fracture
   * paper's: all are choices.
   */
  struct RateProcessLaw
  {
    double temperature = 293.;          ///< T [K]
    double activation_energy = 105e3;   ///< dF of a bond [J/mol]
    double unit_displacement = 2.8e-10; ///< lambda, from one resting place of a bond to the next [m]
    double bonds_per_force = 1e9;       ///< n1, bonds in a contact over its normal force [1/N]
  };

  /** v0 in v = v0 sinh(alpha t/N) [m/s]. */
  double compute_reference_slip_velocity(const RateProcessLaw &law);

  /** alpha = lambda / (2 k T n1): what a unit of mobilised friction t/N is worth in the argument of the sinh [-]. */
  double compute_friction_sensitivity(const RateProcessLaw &law);

  /** Sliding velocity v0 sinh(alpha t/N) [m/s]. @param mobilised_friction  t/N [-] */
  double compute_slip_velocity(const RateProcessLaw &law, double mobilised_friction);

  /** A contact held in place, as relaxation sees it. */
  struct HeldContact
  {
    double normal_force;    ///< N [N]
    double shear_stiffness; ///< kt [N/m]
  };

  /**
   * Shear force that is left after dt at held displacement and held normal force, dt/dtime = -kt v0 sinh(alpha t/N) in
   * closed form: steps of any length (docs/theory.md Eq. 6.9).
   *
   * @param shear_force  t >= 0 [N]   @param dt >= 0 [s]
   */
  double compute_relaxed_shear_force(const RateProcessLaw &law, const HeldContact &contact, double shear_force,
                                     double dt);
} // namespace dem

#pragma once

#include "dem/contact_forces.h"

namespace dem
{
  /** How grains move towards equilibrium. */
  struct MotionRule
  {
    bool is_rotation_free = false; ///< false: grains cannot turn, which stands for the interlock of angular grains
    bool has_true_masses = false;  ///< false: masses follow the contact stiffness, one cycle is the unit of time
    double density = 2650.;        ///< of the grains [kg/m3]
    double local_damping = 0.7;    ///< share of a force taken away where it drives, added where it brakes [-]
    double time_step_share = 0.5;  ///< time step over the critical one, true masses [-]
  };

  /** What the motion takes from the present contacts. */
  struct Kinetics
  {
    double smallest_mass = 1.;    ///< scaled masses only [kg]
    double smallest_inertia = 1.; ///< scaled masses only [kg m2]
    double time_step = 1.;        ///< [s], or 1 cycle
  };

  /** Sets true mass and moment of inertia of every grain from its radius. */
  void update_true_masses(Grains &grains, double density);

  /**
   * Masses and time step for the present contacts.
   *
   * Scaled: m = sum of kn dt^2 with dt = 1, at least a fifth of the mean: by Gershgorin no frequency exceeds sqrt(2)
   * per cycle (limit 2), whatever the size of a grain. True: dt = share * min over grains of sqrt(2 m / sum kn).
   */
  void update_kinetics(Kinetics &kinetics, const MotionRule &rule, const Grains &grains, const Forces &forces,
                       const ContactSums &sums);

  /** What moves the grains. */
  struct MotionTask
  {
    const Cell &cell;
    const ForceRows rows;
    const Kinetics &kinetics;
    const MotionRule &rule;
  };

  /**
   * One leapfrog step with local (non-viscous) damping, F (1 - alpha sign(F v)) in each component, of the grains from
   * `begin` to `end`.
   *
   * @return bound on the displacement of each of them beside the cell's own motion [m]
   */
  double advance_grains(Grains &grains, std::size_t begin, std::size_t end, const MotionTask &task);

  /** Mean resultant force on a grain [N]. */
  double compute_mean_resultant(const Forces &forces);
} // namespace dem

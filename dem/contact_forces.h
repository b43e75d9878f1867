#pragma once

#include "dem/contact_law.h"
#include "dem/contact_network.h"
#include "dem/force_rows.h"
#include "dem/team.h"

#include <functional>

namespace dem
{
  /** Sums over all contacts, found on the way. */
  struct ContactSums
  {
    Matrix force_times_branch = Matrix::Zero(); ///< sum of f_a x (x_b - x_a) [N m]
    double normal_force = 0.;                   ///< sum of N [N]
    double stiffness = 0.;                      ///< sum of kn over contacts of all grains, each contact twice [N/m]
    double turning_stiffness = 0.; ///< likewise of kn (lever arm)(mean lever arm) [N m]; free rotation only
    double stiffness_moment = 0.;  ///< sum of kn |x_b - x_a|^2 [N m]
    std::size_t n_touching = 0;
    Vector wall_force = Vector::Zero(); ///< from both walls across x, y, z on the grains, outward positive [N]
  };

  /** What acts on the grains, and room for its computation. */
  struct Forces
  {
    /** Force: x, y, z [N]; w: sum of kn over the grain's contacts [N/m]. Torque, when rotation is free: x, y, z [N m];
     * w: sum of kn (lever arm)(mean lever arm) [N m], half a row sum of the stiffness against spins. */
    ForceTable on_grains;
    std::vector<double> largest_stress; ///< per grain, of N/(pi r' d) over its contacts [Pa]; filled when
                                        ///< Motion::has_contact_stress

    ForceTable of_far;                         ///< what each far pair does to its second grain, likewise
    ForceTable passing;                        ///< on the grains of the one block that each thread has at hand
    std::vector<double> normal_force, overlap; ///< of each pair [N; m]; filled when Motion::has_contact_stress
    std::vector<ContactSums> block_sums;

    std::size_t count_bytes() const; ///< memory that it holds
  };

  /** How the grains have moved since forces were last computed. */
  struct Motion
  {
    double time_step = 1.;                    ///< dt [s], or 1 cycle
    Matrix strain_increment = Matrix::Zero(); ///< L dt of the cell: its affine part belongs to the relative velocity
    bool is_rotation_free = false;
    bool has_contact_stress = false;
    bool has_sums = true; ///< false: nothing is added up, and all of ContactSums are no numbers
  };

  /** What forces follow from. */
  struct ForceTask
  {
    const RevState &state;
    const ContactLaw &law;
    const Motion &motion;
  };

  /** Called with the number of a block and what acts on its grains, once nothing will add to that, nor look at where
   * they are. */
  using BlockHook = std::function<void(std::size_t, const ForceRows &)>;

  /**
   * The hot loop: forces of all touching pairs, their shear history brought up to date (docs/theory.md Eq. 12-13).
   *
   * Relative displacement at a contact: (v_b - v_a) dt + L dt (x_b - x_a) plus the spins' part. The shear force turns
   * with the contact plane (and with the grains' mean spin about the normal when they turn), grows by kt du_t with the
   * current kn, and is capped at mu N. The team shares the blocks of the network; the sums do not depend on its size.
   *
   * @param is_complete  by the thread that has the block in its cache; may move its grains. Then forces and torques are
   *                     not kept: they would pass through memory for nobody
   */
  ContactSums compute_contact_forces(const ForceTask &task, ContactNetwork &network, Forces &forces, Team &team,
                                     const BlockHook &is_complete = {});

  /** The same by the calling thread alone. */
  ContactSums compute_contact_forces(const RevState &state, const ContactLaw &law, const Motion &motion,
                                     ContactNetwork &network, Forces &forces);

  /** Where nothing has been added up. */
  ContactSums get_unknown_sums();

  /** Adds what contacts of some blocks or lists come to. */
  void add_to(ContactSums &sums, const ContactSums &part);

  /** Sums of the blocks, in their order. */
  ContactSums add_up(const std::vector<ContactSums> &parts);

  /** Largest contact stress of each grain from the normal forces and overlaps of the pairs. */
  void update_largest_stress(const ContactNetwork &network, const Grains &grains, Forces &forces);
} // namespace dem

#pragma once

#include "dem/motion.h"
#include "dem/network_builder.h"
#include "dem/passed_grains.h"
#include "dem/precision.h"
#include "dem/profile.h"
#include "dem/skins.h"

#include <memory>

namespace dem
{
  class SingleDynamics;
  struct TwinRow;

  /** Parameters of a REV's motion. */
  struct DynamicsRule
  {
    MotionRule motion;
    Precision precision = Precision::full;
    double skin_share = 0.2;         ///< skin of the contact network over the mean radius [-]
    bool has_contact_stress = false; ///< the largest contact stress of each grain is kept up to date
    std::size_t n_threads = 1;       ///< that share the grains of one REV; results do not depend on it
  };

  /**
   * A REV in motion: its state and what a sequence of cycles needs beside it (network, forces, masses). Made afresh for
   * each dynamic computation, from the state alone, so that a restart finds the same bits.
   *
   * One cycle is `compute_forces`, `move`, `strain`; after the first, forces, shear history and stress belong to the
   * present positions. `compute_forces_and_move` does the first two to the same bits in one walk through the grains.
   */
  class Dynamics
  {
  public:
    /** Scaled masses: the grains start at rest. Single precision: their places are rounded to whole 2^-32 of an edge.
     *  Throws std::invalid_argument for single precision between walls. @param state outlives this. */
    Dynamics(RevState &state, const ContactLaw &law, const DynamicsRule &rule);
    ~Dynamics();

    void compute_forces();

    /** Moves grains by their forces. */
    void move();

    /** For cycles in which nobody asks before the grains move on: each block moves while it lies in the cache. Forces
     * and what follows from them are not known afterwards, nor in single precision the state's grains. @param
     * has_stress whether stress and stiffness are; else they are not numbers, and no time goes into them */
    void compute_forces_and_move(bool has_stress);

    /** Strains the cell, F <- (1 + increment) F, and ends the cycle. */
    void strain(const Matrix &increment);

    /** Masses and time step for the present contacts; to be called now and then, since stiffness changes. */
    void refresh_masses();

    /** For a state whose grains have been replaced from outside: network and arrays anew; forces computed again in the
     *  same cycle follow no motion, since contacts that stay have followed it already. */
    void rebuild();

    /** Writes the shear history into the state, whose arrays may move by it: cycles go on after rebuild() alone. */
    void store_contacts();

    /** Writes shear history, stress and unbalanced ratio into the state; scaled masses: takes velocities away. */
    void store();

    /** False once the cell is narrower than two reaches: then nothing may be computed. */
    bool is_wide_enough() const { return is_wide_enough_; }

    Matrix compute_stress() const; ///< Love-Weber [Pa], tension-positive
    /** What a servo goes by [Pa], tension-positive: Love-Weber; between walls the normal stresses on them. */
    Matrix compute_servo_stress() const;
    double compute_unbalanced_ratio() const; ///< mean resultant force over mean normal contact force [-]
    double compute_stiffness() const;        ///< (1/3V) sum of kn |branch|^2 [Pa], an upper bound of the P-wave modulus
    /** False once a grain or the cell is nowhere: places that are not numbers touch nobody, so forces do not tell. */
    bool is_finite() const;

    double get_time_step() const { return kinetics_.time_step; }
    double get_last_step() const { return motion_.time_step; } ///< that led to the present places [s]; 0: none
    std::size_t get_n_cycles() const { return n_cycles_; }
    /** Largest contact stress of each grain [Pa], where the rule has it. */
    const std::vector<double> &get_largest_contact_stress() const { return forces_.largest_stress; }
    const ContactNetwork &get_network() const { return network_; }
    /** Search as it was; forces and motion of those cycles alone in which the two can be told apart. */
    const Profile &get_profile() const { return profile_; }
    /** All that it holds beside the state [bytes]. */
    std::size_t count_bytes() const;

  private:
    void build_network();
    void update_network();
    bool is_network_due();
    void pass_grains();
    void move_block(std::size_t k, const ForceRows &rows);
    void move_block(std::size_t k, const TwinRow *forces);

    RevState &state_;
    const ContactLaw &law_;
    const DynamicsRule rule_;
    NetworkBuilder builder_;
    ContactNetwork network_;
    PassedGrains passed_;
    Skins skins_;
    Forces forces_;
    Kinetics kinetics_;
    std::unique_ptr<SingleDynamics> single_; ///< none: double precision
    ContactSums sums_;
    Motion motion_;
    Team team_;
    std::vector<double> block_steps_; // largest step of a grain in each block [m]
    bool has_masses_ = false;
    bool is_wide_enough_ = true;
    std::size_t n_cycles_ = 0;
    Profile profile_;
  };
} // namespace dem

#pragma once

#include "dem/breakage.h"
#include "dem/creep_law.h"
#include "dem/dynamic_computation.h"
#include "dem/equilibrium.h"
#include "dem/homogenisation.h"

namespace dem
{
  /** Every parameter of a REV. */
  struct RevModel
  {
    GrainMaterial material;
    FractureRule fracture;
    DynamicsRule dynamics;
    EquilibriumRule equilibrium;
    RevIdentity identity;
    CreepLaw creep;
  };

  enum class TangentKind
  {
    condensed,
    affine
  };

  /**
   * One representative volume of grains with its three states (docs/theory.md, section 8).
   *
   * committed: the last accepted step. baseline: committed, moved on by ageing and by each equilibrium accepted since.
   * trial: the answer to the last question, which always starts at the baseline. With scaled masses fracture is frozen
   * in every question; only age() and split_overstressed() break grains, and both do so in the baseline. With true
   * masses a question is a dynamic computation: time passes, cracks grow and grains break in the trial.
   *
   * Where only strains are prescribed, the cell's deformation gradient is rounded to multiples of 2^-34: strains that
   * differ by rounding alone are answered by the same bits. `cell.deformation` keeps what was asked.
   */
  class Rev
  {
  public:
    /** All three states are `state`. */
    Rev(const RevModel &model, const RevState &state);

    /** A REV in the middle of a step; trial = baseline. */
    Rev(const RevModel &model, const RevState &committed, const RevState &baseline);

    /** Trial = baseline strained by a symmetric stretch, at rest again. A stretch that the grid does not tell from one
     *  runs no cycle and keeps every bit of the grains. */
    RestReport deform(const Matrix &stretch);

    /** Trial = baseline with the given components held at stresses or strained, at rest again. */
    RestReport control(const CellControl &control);

    /** The same while cracks grow by a clock and grains break in the trial: scaled time, with masses of either kind. */
    RestReport control(const CellControl &control, const CrackClock &clock);

    /** The trial becomes the baseline. */
    void accept() { copy(get_trial(), baseline_); }

    /** Time until the next batch of fractures in the baseline [s]; infinity: none. */
    double compute_time_to_next_batch(unsigned int n_cuts = 0) const;

    /** The same, or the time in which contacts creep as far as a step may, whichever is less [s]. A jump cut n_cuts
     * times is 2^-n_cuts as long. */
    double compute_longest_jump(unsigned int n_cuts = 0) const;

    /** Whether a jump that has been cut n_cuts times can be cut once more. */
    bool can_cut_jump(unsigned int n_cuts) const;

    /** Moves the baseline on by dt [s] at frozen crack velocities and contact forces; grains whose time has come split.
     *  @return number of grains broken; then the baseline is not at rest */
    std::size_t age(double dt);

    /** Grains of the baseline whose limit force is exceeded. */
    std::size_t count_overstressed() const;

    /** Splits the most overstressed grains of the baseline, at most one batch. @return their number */
    std::size_t split_overstressed();

    /** Brings the baseline to rest at held strain. */
    RestReport relax();

    void commit();

    /** Baseline and trial are dropped. */
    void revert();

    /** Tangent of one of the three states in its own axes [Pa]. Throws std::invalid_argument between walls. */
    Tangent compute_tangent(const RevState &state, TangentKind kind) const;

    const RevState &get_committed() const { return committed_; }
    const RevState &get_baseline() const { return baseline_; }
    const RevState &get_trial() const;
    /** The trial with crack velocities that may be from before its run to rest: enough for its stress and tangent,
     * which is all that most trials are asked for. */
    const RevState &peek_trial() const { return trial_; }
    /** What split between the last two commits, in order. */
    const std::vector<Fracture> &get_last_fractures() const { return last_fractures_; }

    const RevModel &get_model() const { return model_; }
    const ContactLaw &get_law() const { return law_; }
    const Profile &get_profile() const { return profile_; }

    /** Memory of the three states and of what the last run to rest held beside them [bytes]. */
    std::size_t count_bytes() const;

    /** Turns the trial's axes: Q in stress = Q sigma Q^T. */
    void set_trial_rotation(const Matrix &rotation) { trial_.rotation = rotation; }

  private:
    RestReport bring_to_rest(RevState &state, CellControl control, const CrackClock *clock = nullptr);
    RestReport bring_trial_to_rest(const CellControl &control, const CrackClock *clock = nullptr);
    void update_cracks(RevState &state) const;
    void copy(const RevState &from, RevState &to);
    void set_trial(const RevState &state);

    RevModel model_;
    ContactLaw law_;
    RevState committed_, baseline_;
    mutable RevState trial_;
    mutable bool has_old_cracks_ = false; ///< the trial's crack velocities are from before its run to rest
    mutable Profile profile_;
    std::size_t n_bytes_at_rest_ = 0;
    std::vector<Fracture> last_fractures_;
  };

  /** A REV from a packing: strengths and cracks drawn, clocks and counters at zero. */
  Rev make_rev(const RevModel &model, RevState packing);
} // namespace dem

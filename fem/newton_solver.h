#pragma once

#include "fem/constitutive_model.h"
#include "fem/linear_solver.h"
#include "fem/secant_memory.h"

namespace fem
{
  /** When the tangent of the material is asked for anew. */
  enum class RefreshPolicy
  {
    each_equilibrium,
    each_step
  };

  struct NewtonParameters
  {
    double tolerance = 1e-3;           ///< norm of the residual over the norm of reactions and loads [-], in (0, 1)
    double force_floor = 1e-6;         ///< smallest force scale [N], > 0; matters where nothing is loaded
    unsigned int max_evaluations = 30; ///< of the material in one equilibrium, >= 1
    RefreshPolicy refresh = RefreshPolicy::each_equilibrium;
    SecantParameters secant;
  };

  enum class EquilibriumStatus
  {
    converged,
    no_convergence,
    step_too_large, ///< said by a material point
    failed          ///< said by a material point or the linear solver
  };

  struct NewtonResult
  {
    EquilibriumStatus status = EquilibriumStatus::no_convergence;
    unsigned int iterations = 0;  ///< accepted corrections
    unsigned int evaluations = 0; ///< of the material; its tangent at zero increment is not one
    double residual = std::numeric_limits<double>::quiet_NaN();      ///< of the free unknowns [N]
    double reaction_norm = std::numeric_limits<double>::quiet_NaN(); ///< force scale [N]
  };

  /**
   * What Newton's method asks of a problem. Vectors hold an entry for every unknown: for a free one the residual is
   * internal minus external force [N]; for a prescribed one it is the displacement increment still missing, with its
   * sign turned [m].
   */
  class NonlinearSystem
  {
  public:
    virtual ~NonlinearSystem() = default;

    /** Residual at zero increment since the baseline, which costs the material nothing but, if asked for, its tangent.
     */
    virtual Status linearise(bool refresh_tangent, Vector &residual) = 0;

    /** Residual at an increment since the baseline [m]: the expensive call. Same status on every rank. */
    virtual Status evaluate(const Vector &increment, Vector &residual) = 0;

    /** x = J0^-1 r in which prescribed entries are passed on. Throws SolverControl::NoConvergence. */
    virtual void solve_linearised(const Vector &residual, Vector &solution) = 0;

    /** Sets the prescribed entries of an increment to what they must become, to the last bit. */
    virtual void impose_boundary(Vector &increment) const = 0;

    /** Norm [N] of the free residual once the missing boundary displacement is made, as J0 foresees. */
    virtual double compute_condensed_norm(const Vector &residual) = 0;

    /** Norm [N] of the free residual as it is; infinite while boundary displacement is missing. */
    virtual double compute_norm(const Vector &residual) const = 0;

    /** Norm of reactions and loads at the last evaluation [N]. */
    virtual double compute_force_scale() const = 0;

    /** A zero vector of the owned unknowns. */
    virtual Vector create_vector() const = 0;
  };

  /**
   * Quasi-Newton solver for materials whose evaluation is dear: J0 from the tangent at the baseline, its factors kept,
   * and secant corrections of its inverse learned from every evaluation, failed ones included.
   *
   * A point at which the residual has grown is left again, but what it taught stays; after the second one in a row all
   * secants are forgotten, and shorter and shorter shares of J0's own correction are tried. If they do not help either,
   * the solver goes on from the best of these points: where the material's answer drops, equilibrium lies beyond. The
   * total secant pair of the last equilibria serves as predictor of the next one; it is part of the state (get_memory)
   * and follows commit and revert.
   */
  class NewtonSolver
  {
  public:
    explicit NewtonSolver(const NewtonParameters &parameters);

    /** Solves for the increment since the baseline, starting from zero. @param is_step_start  first equilibrium of a
     * step
     */
    NewtonResult solve(NonlinearSystem &system, Vector &increment, bool is_step_start);

    void commit() { committed_memory_ = memory_; }
    void revert() { memory_ = committed_memory_; }

    const NewtonParameters &get_parameters() const { return parameters_; }

    /** Sets tolerance and cap alone. */
    void set_effort(double tolerance, unsigned int max_evaluations)
    {
      parameters_.tolerance = tolerance;
      parameters_.max_evaluations = max_evaluations;
    }

    const SecantHistory &get_memory() const { return committed_memory_; }
    void set_memory(const SecantHistory &memory);

  private:
    /** An increment since the baseline and what belongs to it. */
    struct Iterate
    {
      Vector increment;
      Vector residual;
      double condensed_norm;
    };

    NewtonResult iterate(NonlinearSystem &system, SecantMemory &secants, Iterate &current) const;
    EquilibriumStatus find_better(NonlinearSystem &system, SecantMemory &secants, Iterate &current,
                                  unsigned int &n_evaluations) const;
    static void correct(NonlinearSystem &system, const SecantMemory &secants, double share, const Iterate &current,
                        Iterate &trial);
    static SecantPair compute_pair(const Iterate &start, const Iterate &end);
    void remember(const Iterate &start, const Iterate &end);

    NewtonParameters parameters_;
    SecantHistory memory_, committed_memory_;
  };
} // namespace fem

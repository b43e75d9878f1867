#include "fem/newton_solver.h"

#include <cmath>

namespace fem
{
  namespace
  {
    // Corrections in a row that raise the residual: after so many the secants are forgotten, after so many the search
    // for a lower one ends. The last has been an eighth of a correction or less.
    constexpr unsigned int max_secant_setbacks = 2, max_setbacks = 4;

    EquilibriumStatus to_equilibrium_status(Status status)
    {
      return status == Status::step_too_large ? EquilibriumStatus::step_too_large : EquilibriumStatus::failed;
    }
  } // namespace

  NewtonSolver::NewtonSolver(const NewtonParameters &parameters) : parameters_(parameters) {}

  void NewtonSolver::set_memory(const SecantHistory &memory)
  {
    memory_ = committed_memory_ = memory;
  }

  NewtonResult NewtonSolver::solve(NonlinearSystem &system, Vector &increment, bool is_step_start)
  {
    NewtonResult result;
    increment = 0.;
    Iterate current{increment, system.create_vector(), 0.};
    const bool refresh = is_step_start || parameters_.refresh == RefreshPolicy::each_equilibrium;
    const Status opening = system.linearise(refresh, current.residual);
    if (opening != Status::ok)
      {
        result.status = to_equilibrium_status(opening);
        return result;
      }
    try
      {
        SecantMemory secants(parameters_.secant, [&](const Vector &r, Vector &x) { system.solve_linearised(r, x); });
        for (const SecantPair &pair : memory_)
          secants.learn(pair);
        current.condensed_norm = system.compute_condensed_norm(current.residual);
        const Iterate start = current;
        result = iterate(system, secants, current);
        increment = current.increment;
        if (result.status == EquilibriumStatus::converged && result.evaluations > 0)
          remember(start, current);
      }
    catch (const dealii::SolverControl::NoConvergence &)
      {
        result.status = EquilibriumStatus::failed;
      }
    return result;
  }

  NewtonResult NewtonSolver::iterate(NonlinearSystem &system, SecantMemory &secants, Iterate &current) const
  {
    NewtonResult result;
    while (true)
      {
        result.residual = system.compute_norm(current.residual);
        result.reaction_norm = std::max(system.compute_force_scale(), parameters_.force_floor);
        result.status = EquilibriumStatus::converged;
        if (result.residual <= parameters_.tolerance * result.reaction_norm)
          return result;
        result.status = find_better(system, secants, current, result.evaluations);
        if (result.status != EquilibriumStatus::converged)
          return result;
        ++result.iterations;
      }
  }

  // Tries corrections until one lowers the residual. The one that does is the last that the material has evaluated, as
  // settling requires. A pair can mislead where grains have broken since, and what its setbacks show be of no use: then
  // no share of its correction helps, but one of the tangent's does. Where that helps no more either, the material's
  // answer drops between here and there (grains have slipped through), and the way on begins beyond the drop.
  EquilibriumStatus NewtonSolver::find_better(NonlinearSystem &system, SecantMemory &secants, Iterate &current,
                                              unsigned int &n_evaluations) const
  {
    Iterate trial = current, best_setback = current;
    best_setback.condensed_norm = std::numeric_limits<double>::infinity();
    double share = 1.; // of the correction that is tried
    bool was_refused = false;
    unsigned int n_setbacks = 0;
    while (n_evaluations < parameters_.max_evaluations && n_setbacks < max_setbacks)
      {
        correct(system, secants, share, current, trial);
        const Status status = system.evaluate(trial.increment, trial.residual);
        ++n_evaluations;
        if (status != Status::ok)
          {
            if (was_refused) // one shorter try: a point may take half of a step that it refuses
              return to_equilibrium_status(status);
            was_refused = true;
            share *= 0.5;
            continue;
          }
        trial.condensed_norm = system.compute_condensed_norm(trial.residual);
        const bool is_better = trial.condensed_norm <= current.condensed_norm;
        const bool has_learned =
            (is_better || n_setbacks < max_secant_setbacks) && secants.learn(compute_pair(current, trial));
        if (is_better)
          {
            current = trial;
            return EquilibriumStatus::converged;
          }
        if (trial.condensed_norm < best_setback.condensed_norm)
          best_setback = trial;
        if (++n_setbacks == max_secant_setbacks)
          secants.forget();
        share = has_learned && n_setbacks == 1 ? 1. : 0.5 * share;
      }
    if (n_setbacks < max_setbacks || !std::isfinite(best_setback.condensed_norm))
      return EquilibriumStatus::no_convergence;
    current = best_setback;
    return EquilibriumStatus::converged;
  }

  void NewtonSolver::correct(NonlinearSystem &system, const SecantMemory &secants, double share, const Iterate &current,
                             Iterate &trial)
  {
    Vector direction(current.increment);
    secants.apply(current.residual, direction);
    trial.increment = current.increment;
    trial.increment.add(-share, direction);
    if (share == 1.)
      system.impose_boundary(trial.increment);
  }

  SecantPair NewtonSolver::compute_pair(const Iterate &start, const Iterate &end)
  {
    SecantPair pair{end.increment, end.residual};
    pair.step.add(-1., start.increment);
    pair.change.add(-1., start.residual);
    return pair;
  }

  void NewtonSolver::remember(const Iterate &start, const Iterate &end)
  {
    memory_.push_back(compute_pair(start, end));
    while (memory_.size() > parameters_.secant.n_carried)
      memory_.erase(memory_.begin());
  }
} // namespace fem

#include "fem/step_report.h"

namespace fem
{
  StepStatus translate(Status status)
  {
    switch (status)
      {
      case Status::ok:
        return StepStatus::ok;
      case Status::step_too_large:
        return StepStatus::step_too_large;
      default:
        return StepStatus::failed;
      }
  }

  StepStatus translate(EquilibriumStatus status)
  {
    switch (status)
      {
      case EquilibriumStatus::converged:
        return StepStatus::ok;
      case EquilibriumStatus::step_too_large:
        return StepStatus::step_too_large;
      case EquilibriumStatus::no_convergence:
        return StepStatus::no_convergence;
      default:
        return StepStatus::failed;
      }
  }

  std::string get_reason(StepStatus status)
  {
    switch (status)
      {
      case StepStatus::ok:
        return "no failure";
      case StepStatus::excessive:
        return "more grains are overstressed than a batch allows, in the smallest step";
      case StepStatus::step_too_large:
        return "the material refuses even the smallest step";
      case StepStatus::failed:
        return "a material point or the linear solver failed, even in the smallest step";
      case StepStatus::no_convergence:
        return "no equilibrium within the cap on evaluations, even in the smallest step";
      case StepStatus::overshoot:
        return "the step brought about more than the step control allows";
      case StepStatus::rupture:
        return "rupture: an avalanche that does not end";
      default:
        return "one event follows the other and no time passes";
      }
  }

  void record_equilibrium(const NewtonResult &newton, bool is_first, StepReport &report)
  {
    report.newton_iterations += newton.iterations;
    (is_first ? report.evaluations : report.avalanche_evaluations) += newton.evaluations;
    report.residual = newton.residual;
    report.reaction_norm = newton.reaction_norm;
  }
} // namespace fem

#pragma once

#include "fem/boundary_conditions.h"
#include "fem/newton_solver.h"
#include "fem/step_control.h"

#include <functional>
#include <limits>
#include <string>
#include <vector>

namespace fem
{
  /** What a step came to. */
  enum class StepStatus
  {
    ok,
    excessive,      ///< more grains overstressed than a batch allows
    step_too_large, ///< said by the material
    failed,         ///< said by the material or the linear solver
    no_convergence, ///< Newton's cap on evaluations
    overshoot,      ///< a controlled step that brought about more than it may
    rupture,        ///< an avalanche that does not end
    no_progress     ///< one event after the other at the same instant
  };

  /** What ended a step where it did. */
  enum class StepBound
  {
    milestone, ///< a scheduled time, an output, an increment of a load
    event,     ///< of the material
    share      ///< only a share of the way to the next milestone was tried, after cuts or because the control says so
  };

  /** A committed step, as observers see it. */
  struct StepReport
  {
    double time = 0.;       ///< [s]
    unsigned int stage = 0; ///< number from 0
    std::string stage_name;
    unsigned int step = 0;                                           ///< from 1
    unsigned int newton_iterations = 0;                              ///< of all equilibria of the step
    unsigned int evaluations = 0;                                    ///< material evaluations of the first equilibrium
    unsigned int avalanche_rounds = 0;                               ///< equilibria after the first
    unsigned int avalanche_evaluations = 0;                          ///< material evaluations of those
    unsigned int n_broken = 0;                                       ///< grains that settling split
    unsigned int n_cuts = 0;                                         ///< since the increment began
    double residual = std::numeric_limits<double>::quiet_NaN();      ///< last equilibrium [N]
    double reaction_norm = std::numeric_limits<double>::quiet_NaN(); ///< its force scale [N]
    double length = 0.;                                              ///< [s]
    StepBound bound = StepBound::milestone;
    StepEffects effects;
    double unbalanced_ratio = std::numeric_limits<double>::quiet_NaN(); ///< largest of all points at the last
                                                                        ///< equilibrium [-]; NaN where none says
    bool is_output = false; ///< an output time, an increment of a load stage, or a stage's end
    bool is_stage_end = false;
    std::vector<BoundaryResponse> boundaries;
  };

  /** A step that was taken back. */
  struct CutReport
  {
    double time = 0.; ///< of the last committed step [s]
    unsigned int stage = 0;
    StepStatus status = StepStatus::ok;
    unsigned int evaluations = 0; ///< material evaluations lost
    double step_share = 1.;
    unsigned int n_event_cuts = 0;
    bool is_final = false; ///< no shorter step is left: the run ends
  };

  /** Called on every rank; empty members are not. */
  struct StepObserver
  {
    std::function<void(const StepReport &)> on_commit;
    std::function<void(const CutReport &)> on_cut;
  };

  StepStatus translate(Status status);
  StepStatus translate(EquilibriumStatus status);

  /** The reason of a failure in words. */
  std::string get_reason(StepStatus status);

  /** Adds an equilibrium to a step's report. @param is_first  not one of an avalanche */
  void record_equilibrium(const NewtonResult &newton, bool is_first, StepReport &report);
} // namespace fem

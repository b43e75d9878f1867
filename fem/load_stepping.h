#pragma once

#include "fem/quasi_static_problem.h"

#include <functional>
#include <limits>
#include <string>
#include <vector>

namespace fem
{
  enum class StageKind
  {
    load, ///< conditions go to their targets in increments
    creep ///< conditions are held, time passes
  };

  enum class Spacing
  {
    linear,
    geometric ///< equal ratios; start and end have the same sign and are not zero
  };

  /** Where a condition of the problem stands at the end of a stage. */
  struct Target
  {
    std::string boundary;
    ConditionKind kind = ConditionKind::displacement;
    std::string component; ///< as in the condition; unused by pressure
    double value = 0.;     ///< [m] or [Pa]
  };

  /** A part of the loading programme. Conditions without a target keep their value. */
  struct Stage
  {
    std::string name;
    StageKind kind = StageKind::load;
    double duration = 0.;          ///< [s], >= 0; 0 (load only): time stands still. Creep: > 0
    unsigned int n_increments = 1; ///< of a load stage, >= 1
    Spacing spacing = Spacing::linear;
    std::vector<Target> targets;    ///< of a load stage
    double first_output = 1.;       ///< creep: first output and schedule time since its start [s], > 0
    double outputs_per_decade = 5.; ///< creep: outputs a decade of time since its start, >= 0; 0: at its end
    double steps_per_decade = 0.;   ///< creep: scheduled steps a decade, >= 0; 0: only events and outputs
  };

  struct SteppingParameters
  {
    double smallest_step_share = 1. / 64.;   ///< of an increment, in (0, 1]; below it the run gives up
    unsigned int max_avalanche_rounds = 200; ///< equilibria in a step, >= 1; beyond it: rupture
    unsigned int max_cuts = 100;             ///< within one increment, >= 1; beyond it the run gives up
    unsigned int max_idle_steps = 1000;      ///< in a row during which no time passes, >= 1
  };

  /** What a step came to. */
  enum class StepStatus
  {
    ok,
    excessive,      ///< more grains overstressed than a batch allows
    step_too_large, ///< said by the material
    failed,         ///< said by the material or the linear solver
    no_convergence, ///< Newton's cap on evaluations
    rupture         ///< an avalanche that does not end
  };

  /** Where the programme stands; with the problem's and the material's state it is all that the future depends on. */
  struct Progress
  {
    double time = 0.;              ///< [s]
    unsigned int stage = 0;        ///< number from 0
    double stage_start = 0.;       ///< time [s]
    double position = 0.;          ///< in the stage: time [s], or share of the load where time stands still
    double increment_start = 0.;   ///< position at which the present increment began
    unsigned int step = 0;         ///< committed ones
    double step_share = 1.;        ///< of an increment, halved by cuts
    unsigned int n_event_cuts = 0; ///< the batch is 2^-n of the largest
    unsigned int n_cuts = 0;       ///< since the increment began
    unsigned int n_idle_steps = 0;
    unsigned int n_successes = 0;     ///< since the last cut
    std::vector<double> stage_values; ///< of the conditions at the stage's start
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

  /** How a run ended. The last committed state is intact whatever it says. */
  struct RunResult
  {
    StepStatus status = StepStatus::ok;
    std::string message; ///< of a failure: stage, time and reason
  };

  /** Takes a problem and its material through a loading programme: try, commit or cut. */
  template <int dim>
  class LoadStepping
  {
  public:
    /** Throws std::invalid_argument naming stage, parameter, value and range, or a target without its condition. */
    LoadStepping(QuasiStaticProblem<dim> &problem, const std::vector<Stage> &stages,
                 const SteppingParameters &parameters, StepObserver observer = {});

    /** Runs to the end of the programme, or until no shorter step is left. */
    RunResult run();

    /** Takes one step, however often it must be cut. */
    StepStatus advance();

    bool is_finished() const { return progress_.stage >= stages_.size(); }
    const Progress &get_progress() const { return progress_; }

    /** Continues from a checkpoint: problem and material must be at the same state. */
    void set_progress(const Progress &progress) { progress_ = progress; }

  private:
    /** A step to try, from the committed position. */
    struct Step
    {
      double dt = 0.; ///< [s]
      double end_position = 0.;
      bool ends_increment = false;
      std::vector<double> values; ///< of the conditions at its end
      bool accept_excess = false; ///< it cannot be cut further
    };

    /** What a tried step came to. */
    struct Outcome
    {
      StepStatus status = StepStatus::ok;
      StepReport report;
    };

    Step propose_step() const;
    Outcome try_step(const Step &step);
    void commit(const Step &step, Outcome &outcome);
    bool cut(const Step &step, const Outcome &outcome);
    bool can_halve_load() const;
    bool can_cut_events(double dt) const;
    void begin_stage();
    std::vector<double> compute_values(double position) const;
    std::string describe(StepStatus status) const;

    QuasiStaticProblem<dim> &problem_;
    ConstitutiveModel &material_;
    std::vector<Stage> stages_;
    std::vector<std::vector<double>> end_values_; ///< of each stage, one a condition; NaN: held
    SteppingParameters parameters_;
    StepObserver observer_;
    Progress progress_;
  };
} // namespace fem

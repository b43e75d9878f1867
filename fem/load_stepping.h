#pragma once

#include "fem/loading_programme.h"
#include "fem/quasi_static_problem.h"
#include "fem/step_report.h"

#include <string>
#include <vector>

namespace fem
{
  struct SteppingParameters
  {
    double smallest_step_share = 1. / 64.;   ///< of an increment, in (0, 1]; below it the run gives up
    unsigned int max_avalanche_rounds = 200; ///< equilibria in a step, >= 1; beyond it: rupture
    unsigned int max_cuts = 100;             ///< within one increment, >= 1; beyond it the run gives up
    unsigned int max_idle_steps = 1000;      ///< in a row during which no time passes, >= 1
    StepControl control;                     ///< of creep
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
    void set_progress(const Progress &progress);

  private:
    /** A step to try, from the committed position. */
    struct Step
    {
      Advance advance;
      std::vector<double> values;    ///< of the conditions at its end
      bool is_event_limited = false; ///< it ends at the material's next event
      bool accept_excess = false;    ///< it cannot be cut further
      double carried_share = 0.;     ///< of what the stage's beginning has set free
      double share = 1.;             ///< of the way to the milestone, as it was asked for
      double length = 0.;            ///< that this is of, in the stage's position
    };

    /** What a tried step came to. */
    struct Outcome
    {
      StepStatus status = StepStatus::ok;
      StepReport report;
    };

    StepStatus begin_stage();
    const Phase &get_phase_before(unsigned int stage) const { return stage > 0 ? phases_[stage - 1] : initial_phase_; }
    Step propose_step() const;
    Outcome try_step(const Step &step);
    Outcome find_equilibria(const Step &step);
    void commit(const Step &step, StepReport &report);
    bool shorten(const Step &step, StepStatus status);
    void control_share(const Step &step, const StepEffects &effects);
    bool is_controlled() const;
    bool can_halve_load() const;
    bool can_cut_events(double dt) const;
    void report_cut(const Outcome &outcome, bool is_final) const;
    std::string describe(StepStatus status) const;

    QuasiStaticProblem<dim> &problem_;
    ConstitutiveModel &material_;
    std::vector<Stage> stages_;
    std::vector<std::vector<double>> end_values_; ///< of each stage, one a condition
    Phase initial_phase_;
    std::vector<Phase> phases_; ///< of each stage
    bool has_begun_ = false;    ///< the stage
    SteppingParameters parameters_;
    StepObserver observer_;
    Progress progress_;
  };
} // namespace fem

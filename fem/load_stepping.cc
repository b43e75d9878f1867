#include "fem/load_stepping.h"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

namespace fem
{
  namespace
  {
    void check_parameters(const SteppingParameters &parameters)
    {
      if (!(parameters.smallest_step_share > 0. && parameters.smallest_step_share <= 1.))
        throw std::invalid_argument(
            fmt::format("stepping: smallest step share = {} must lie in (0, 1]", parameters.smallest_step_share));
      check_control(parameters.control, parameters.smallest_step_share);
    }
  } // namespace

  template <int dim>
  LoadStepping<dim>::LoadStepping(QuasiStaticProblem<dim> &problem, const std::vector<Stage> &stages,
                                  const SteppingParameters &parameters, StepObserver observer)
      : problem_(problem), material_(problem.get_material()), stages_(stages),
        end_values_(resolve_targets(problem.get_conditions(), stages)), initial_phase_(problem.get_phase()),
        phases_(resolve_phases(problem.get_conditions(), stages, initial_phase_)), parameters_(parameters),
        observer_(std::move(observer))
  {
    check_parameters(parameters_);
    for (const BoundaryCondition &condition : problem_.get_conditions())
      progress_.stage_values.push_back(condition.initial_value);
  }

  template <int dim>
  RunResult LoadStepping<dim>::run()
  {
    while (!is_finished())
      {
        const StepStatus status = advance();
        if (status != StepStatus::ok)
          return {status, describe(status)};
      }
    return {};
  }

  template <int dim>
  StepStatus LoadStepping<dim>::advance()
  {
    if (progress_.n_idle_steps > parameters_.max_idle_steps)
      return StepStatus::no_progress;
    if (const StepStatus status = begin_stage(); status != StepStatus::ok)
      return status;
    while (true)
      {
        const Step step = propose_step();
        Outcome outcome = try_step(step);
        if (outcome.status == StepStatus::ok)
          {
            commit(step, outcome.report); // the only line that makes history
            return StepStatus::ok;
          }
        problem_.revert();
        material_.revert();
        const bool is_shorter = shorten(step, outcome.status);
        report_cut(outcome, !is_shorter);
        if (!is_shorter)
          return outcome.status;
      }
  }

  // A stage that changes nothing leaves the problem as it is.
  template <int dim>
  StepStatus LoadStepping<dim>::begin_stage()
  {
    if (has_begun_)
      return StepStatus::ok;
    has_begun_ = true;
    const unsigned int stage = progress_.stage;
    problem_.set_phase(get_phase_before(stage));
    return phases_[stage] == get_phase_before(stage) ? StepStatus::ok : translate(problem_.begin_phase(phases_[stage]));
  }

  template <int dim>
  void LoadStepping<dim>::set_progress(const Progress &progress)
  {
    progress_ = progress;
    has_begun_ = progress_.position > 0.; // a changing stage has no duration: its first step moves it on
    problem_.set_phase(has_begun_ ? phases_[progress_.stage] : get_phase_before(progress_.stage));
  }

  // A creep step is judged by what it has brought about once nothing breaks any more.
  template <int dim>
  typename LoadStepping<dim>::Outcome LoadStepping<dim>::try_step(const Step &step)
  {
    Outcome outcome = find_equilibria(step);
    if (outcome.status != StepStatus::ok)
      return outcome;
    StepEffects &effects = outcome.report.effects;
    effects = problem_.compute_step_effects();
    const EventCount events = material_.count_events();
    if (events.n_points > 0)
      effects.fractures = static_cast<double>(events.n_events) / static_cast<double>(events.n_points);
    if (is_controlled() && is_overshoot(effects, step.share, parameters_.control))
      outcome.status = StepStatus::overshoot;
    return outcome;
  }

  // Age, find the equilibrium, and as long as it breaks grains settle and find the next one: an avalanche is a sequence
  // of equilibria at one load.
  template <int dim>
  typename LoadStepping<dim>::Outcome LoadStepping<dim>::find_equilibria(const Step &step)
  {
    Outcome outcome;
    StepReport &report = outcome.report;
    problem_.set_carried_share(step.carried_share);
    outcome.status = translate(material_.begin_step(step.advance.dt));
    for (bool is_first = true; outcome.status == StepStatus::ok; is_first = false)
      {
        const NewtonResult newton = problem_.equilibrate(step.values, is_first);
        record_equilibrium(newton, is_first, report);
        outcome.status = translate(newton.status);
        if (outcome.status != StepStatus::ok)
          return outcome;

        const Settlement settlement = material_.settle(step.accept_excess);
        outcome.status = translate(settlement.status);
        if (outcome.status == StepStatus::ok && settlement.is_excessive && !step.accept_excess)
          outcome.status = StepStatus::excessive;
        if (outcome.status != StepStatus::ok)
          return outcome;

        problem_.move_baseline();
        report.n_broken += settlement.n_broken;
        if (settlement.n_broken == 0)
          return outcome;
        if (++report.avalanche_rounds > parameters_.max_avalanche_rounds)
          outcome.status = StepStatus::rupture;
      }
    return outcome;
  }

  template <int dim>
  typename LoadStepping<dim>::Step LoadStepping<dim>::propose_step() const
  {
    const Stage &stage = stages_[progress_.stage];
    const double milestone = compute_next_milestone(stage, progress_.increment_start);
    Step step;
    double length = progress_.step_share * (milestone - progress_.increment_start);
    if (stage.duration > 0.)
      {
        const double to_event = material_.compute_time_to_next_event(progress_.n_event_cuts);
        step.is_event_limited = progress_.step_share * to_event < length;
        if (step.is_event_limited)
          length = progress_.step_share * std::max(to_event, 0.);
      }
    step.share = progress_.step_share;
    step.length = length;
    const double remaining = milestone - progress_.position;
    Advance &advance = step.advance;
    // What is left of an increment after cuts and events may differ from a step by rounding alone.
    advance.ends_increment = length >= remaining * (1. - 1e-12);
    advance.end_position = advance.ends_increment ? milestone : progress_.position + length;
    // The length itself, not a difference of positions: an event must be reached to the last bit of its own time.
    if (stage.duration > 0.)
      advance.dt = advance.ends_increment ? remaining : length;
    step.accept_excess = !can_halve_load() && !can_cut_events(step.advance.dt);
    for (std::size_t i = 0; i < progress_.stage_values.size(); ++i)
      step.values.push_back(interpolate(stage, progress_.stage_values[i], end_values_[progress_.stage][i],
                                        advance.end_position / compute_stage_length(stage)));
    if (phases_[progress_.stage] != get_phase_before(progress_.stage))
      step.carried_share = 1. - advance.end_position / compute_stage_length(stage);
    return step;
  }

  template <int dim>
  void LoadStepping<dim>::commit(const Step &step, StepReport &report)
  {
    problem_.commit();
    material_.commit();

    const Stage &stage = stages_[progress_.stage];
    report.is_stage_end = step.advance.end_position == compute_stage_length(stage);
    report.is_output = step.advance.ends_increment && is_output_position(stage, step.advance.end_position);
    report.stage = progress_.stage;
    report.stage_name = stage.name;
    report.n_cuts = progress_.n_cuts;
    report.unbalanced_ratio = problem_.compute_largest_unbalanced_ratio();
    report.length = step.advance.dt;
    report.bound = step.is_event_limited         ? StepBound::event
                   : step.advance.ends_increment ? StepBound::milestone
                                                 : StepBound::share;
    const bool was_controlled = is_controlled();
    update_progress(stage, end_values_[progress_.stage], step.advance, progress_);
    if (was_controlled)
      control_share(step, report.effects);
    has_begun_ &= progress_.stage == report.stage;
    report.step = progress_.step;
    report.time = progress_.time;
    if (observer_.on_commit)
      {
        report.boundaries = problem_.compute_boundary_responses();
        observer_.on_commit(report);
      }
  }

  // What overloads the grains is made smaller: the load while it can be halved, else the batch of grains that age
  // breaks.
  template <int dim>
  bool LoadStepping<dim>::shorten(const Step &step, StepStatus status)
  {
    if (status == StepStatus::rupture || ++progress_.n_cuts > parameters_.max_cuts)
      return false;
    progress_.n_successes = 0;
    const bool is_load = stages_[progress_.stage].kind == StageKind::load;
    const bool is_for_batch = status == StepStatus::excessive ? !can_halve_load() : !is_load && step.is_event_limited;
    if (is_for_batch && can_cut_events(step.advance.dt))
      {
        ++progress_.n_event_cuts;
        return true;
      }
    progress_.step_share *= 0.5;
    return progress_.step_share >= parameters_.smallest_step_share;
  }

  // The rest of an increment may be much shorter than what was asked for, and says little.
  template <int dim>
  void LoadStepping<dim>::control_share(const Step &step, const StepEffects &effects)
  {
    progress_.step_share =
        step.advance.dt < 0.5 * step.length ? step.share : compute_next_share(effects, step.share, parameters_.control);
  }

  template <int dim>
  bool LoadStepping<dim>::is_controlled() const
  {
    return parameters_.control.is_active && stages_[progress_.stage].kind == StageKind::creep;
  }

  template <int dim>
  bool LoadStepping<dim>::can_halve_load() const
  {
    return stages_[progress_.stage].kind == StageKind::load &&
           0.5 * progress_.step_share >= parameters_.smallest_step_share;
  }

  template <int dim>
  bool LoadStepping<dim>::can_cut_events(double dt) const
  {
    return dt > 0. && material_.can_cut_events(progress_.n_event_cuts);
  }

  template <int dim>
  void LoadStepping<dim>::report_cut(const Outcome &outcome, bool is_final) const
  {
    if (observer_.on_cut)
      observer_.on_cut({progress_.time, progress_.stage, outcome.status,
                        outcome.report.evaluations + outcome.report.avalanche_evaluations, progress_.step_share,
                        progress_.n_event_cuts, is_final});
  }

  template <int dim>
  std::string LoadStepping<dim>::describe(StepStatus status) const
  {
    return fmt::format("stage '{}', {} s: {}; the last committed step is intact", stages_[progress_.stage].name,
                       progress_.time, get_reason(status));
  }

  template class LoadStepping<2>;
  template class LoadStepping<3>;
} // namespace fem

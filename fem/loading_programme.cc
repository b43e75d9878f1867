#include "fem/loading_programme.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace fem
{
  namespace
  {
    // Positions closer than this share of their size are one: far above rounding, far below any schedule.
    constexpr double same = 1e-9;

    /** First time of a logarithmic series that lies beyond a position. */
    double compute_next_in_decades(double first, double per_decade, double position)
    {
      if (position < first * (1. - same))
        return first;
      double k = std::floor(std::log10(position / first) * per_decade);
      while (first * std::pow(10., k / per_decade) <= position * (1. + same))
        k += 1.;
      return first * std::pow(10., k / per_decade);
    }

    double compute_next_output(const Stage &stage, double position)
    {
      double next = stage.outputs_per_decade > 0.
                        ? compute_next_in_decades(stage.first_output, stage.outputs_per_decade, position)
                        : std::numeric_limits<double>::infinity();
      for (const double output : stage.more_outputs)
        if (output > position * (1. + same))
          next = std::min(next, output);
      return next;
    }

    [[noreturn]] void refuse(const Stage &stage, const std::string &name, double value, const std::string &range)
    {
      throw std::invalid_argument(fmt::format("stage '{}': {} = {} must be {}", stage.name, name, value, range));
    }

    void check_stage(const Stage &stage)
    {
      if (!(stage.duration >= 0.) || !std::isfinite(stage.duration))
        refuse(stage, "duration", stage.duration, ">= 0 s and finite");
      if (stage.kind == StageKind::load && stage.n_increments < 1)
        refuse(stage, "number of increments", stage.n_increments, ">= 1");
      if (stage.kind == StageKind::load)
        return;
      if (!(stage.duration > 0.))
        refuse(stage, "duration", stage.duration, "> 0 s in a creep stage");
      if (!(stage.first_output > 0.))
        refuse(stage, "first output", stage.first_output, "> 0 s");
      if (!(stage.outputs_per_decade >= 0.))
        refuse(stage, "outputs per decade", stage.outputs_per_decade, ">= 0");
      if (!(stage.steps_per_decade >= 0.))
        refuse(stage, "steps per decade", stage.steps_per_decade, ">= 0");
      if (!stage.targets.empty())
        throw std::invalid_argument(
            fmt::format("stage '{}': a creep stage holds all conditions, but has targets", stage.name));
    }

    bool is_changing(const Stage &stage)
    {
      return stage.places_pile || !stage.releases.empty() || !stage.holds.empty();
    }

    std::string describe(const BoundaryCondition &condition)
    {
      const char *kinds[] = {"displacement", "traction", "pressure"};
      return fmt::format("{} {}{}{}", condition.boundary, kinds[static_cast<int>(condition.kind)],
                         condition.component.empty() ? "" : " ", condition.component);
    }

    std::size_t find_condition(const std::vector<BoundaryCondition> &conditions, const Stage &stage,
                               const Target &target)
    {
      const BoundaryCondition wanted{target.boundary, target.kind, target.component};
      std::string known;
      for (std::size_t i = 0; i < conditions.size(); ++i)
        {
          if (describe(conditions[i]) == describe(wanted))
            return i;
          known += (i > 0 ? ", " : "") + describe(conditions[i]);
        }
      throw std::invalid_argument(
          fmt::format("stage '{}': no condition '{}' for this target; known: {}", stage.name, describe(wanted), known));
    }

    /** Lets conditions go or begins to hold them. */
    void set_held(const std::vector<BoundaryCondition> &conditions, const Stage &stage, const bool is_held,
                  Phase &phase)
    {
      for (const Target &target : is_held ? stage.holds : stage.releases)
        {
          const std::size_t i = find_condition(conditions, stage, target);
          if (target.kind != ConditionKind::displacement || phase.is_held[i] == is_held)
            throw std::invalid_argument(fmt::format("stage '{}': '{}' cannot be {}: {}", stage.name,
                                                    describe(conditions[i]), is_held ? "held" : "released",
                                                    target.kind != ConditionKind::displacement ? "not a displacement"
                                                    : is_held                                  ? "it is already"
                                                                                               : "it is not held"));
          phase.is_held[i] = is_held;
        }
    }
  } // namespace

  std::vector<Phase> resolve_phases(const std::vector<BoundaryCondition> &conditions, const std::vector<Stage> &stages,
                                    Phase before)
  {
    std::vector<Phase> phases;
    for (const Stage &stage : stages)
      {
        if (is_changing(stage) && (stage.kind != StageKind::load || stage.duration > 0.))
          throw std::invalid_argument(fmt::format(
              "stage '{}': only a load without duration can place a pile, release or hold a displacement", stage.name));
        if (stage.places_pile && !before.is_pile_absent)
          throw std::invalid_argument(fmt::format("stage '{}': there is no absent pile to place", stage.name));
        set_held(conditions, stage, false, before);
        set_held(conditions, stage, true, before);
        before.is_pile_absent &= !stage.places_pile;
        phases.push_back(before);
      }
    return phases;
  }

  double compute_stage_length(const Stage &stage)
  {
    return stage.duration > 0. ? stage.duration : 1.;
  }

  double compute_next_milestone(const Stage &stage, double position)
  {
    const double length = compute_stage_length(stage);
    double next = length;
    if (stage.kind == StageKind::load)
      {
        const double n_done = std::floor(position / length * stage.n_increments * (1. + same) + same);
        next = length * (n_done + 1.) / stage.n_increments;
      }
    else
      {
        next = compute_next_output(stage, position);
        if (stage.steps_per_decade > 0.)
          next = std::min(next, compute_next_in_decades(stage.first_output, stage.steps_per_decade, position));
      }
    return next > length * (1. - same) ? length : next;
  }

  bool is_output_position(const Stage &stage, double position)
  {
    if (position == compute_stage_length(stage))
      return true;
    if (stage.kind == StageKind::load)
      {
        const double increment = position / compute_stage_length(stage) * stage.n_increments;
        return std::abs(increment - std::round(increment)) <= same * increment;
      }
    return position > 0. &&
           std::abs(compute_next_output(stage, position * (1. - 10. * same)) - position) <= same * position;
  }

  double interpolate(const Stage &stage, double start, double end, double share)
  {
    if (share >= 1. || start == end)
      return end;
    return stage.spacing == Spacing::linear ? start + share * (end - start) : start * std::pow(end / start, share);
  }

  std::vector<std::vector<double>> resolve_targets(const std::vector<BoundaryCondition> &conditions,
                                                   const std::vector<Stage> &stages)
  {
    std::vector<double> values;
    for (const BoundaryCondition &condition : conditions)
      values.push_back(condition.initial_value);
    std::vector<std::vector<double>> end_values;
    for (const Stage &stage : stages)
      {
        check_stage(stage);
        for (const Target &target : stage.targets)
          {
            double &value = values[find_condition(conditions, stage, target)];
            if (stage.spacing == Spacing::geometric && !(value * target.value > 0.))
              refuse(stage, fmt::format("target on '{}'", target.boundary), target.value,
                     fmt::format("of the sign of its start, {}, and neither zero, for geometric spacing", value));
            value = target.value;
          }
        end_values.push_back(values);
      }
    return end_values;
  }

  Progress prolong_creep(const std::vector<Stage> &stages, Progress progress)
  {
    const bool is_between_stages =
        progress.stage > 0 && progress.stage <= stages.size() && progress.position == 0. && progress.n_idle_steps == 0;
    if (!is_between_stages)
      return progress;
    const Stage &last = stages[progress.stage - 1];
    double start = 0.; // summed as update_progress() does: what has not been changed has the same bits
    for (unsigned int k = 0; k + 1 < progress.stage; ++k)
      start += stages[k].duration;
    if (!(start + last.duration > progress.time))
      return progress;
    if (last.kind != StageKind::creep || !(progress.time > start))
      throw std::invalid_argument(fmt::format(
          "stage '{}' has ended at {} s: only a creep that has just ended can be given more time; add a stage instead",
          last.name, progress.time));
    --progress.stage; // the conditions are held: their values at its start are those at its end
    progress.stage_start = start;
    progress.position = progress.increment_start = progress.time - start;
    return progress;
  }

  void update_progress(const Stage &stage, const std::vector<double> &end_values, const Advance &advance,
                       Progress &progress)
  {
    ++progress.step;
    const bool is_idle = stage.duration > 0. && advance.end_position == progress.position;
    progress.position = advance.end_position;
    if (stage.duration > 0.)
      progress.time = progress.stage_start + progress.position;
    progress.n_idle_steps = is_idle ? progress.n_idle_steps + 1 : 0;
    if (++progress.n_successes >= 2)
      {
        progress.step_share = std::min(1., 2. * progress.step_share);
        progress.n_event_cuts -= progress.n_event_cuts > 0 ? 1 : 0;
        progress.n_successes = 0;
      }
    if (!advance.ends_increment)
      return;
    progress.increment_start = progress.position;
    progress.n_cuts = 0;
    if (progress.position < compute_stage_length(stage))
      return;
    ++progress.stage;
    progress.stage_start = progress.time;
    progress.position = progress.increment_start = 0.;
    progress.stage_values = end_values;
  }
} // namespace fem

#pragma once

#include "fem/boundary_conditions.h"

#include <string>
#include <vector>

namespace fem
{
  /** What takes part in a problem during a stage: it changes when a pile is placed and what held its hole is let go. */
  struct Phase
  {
    std::vector<bool> is_held; ///< displacements, one a condition; true for other conditions
    bool is_pile_absent = false;

    bool operator==(const Phase &) const = default;
  };

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
    std::vector<Target> targets;      ///< of a load stage
    double first_output = 1.;         ///< creep: first output and schedule time since its start [s], > 0
    double outputs_per_decade = 5.;   ///< creep: outputs a decade of time since its start, >= 0; 0: at its end
    double steps_per_decade = 0.;     ///< creep: scheduled steps a decade, >= 0; 0: only events and outputs
    std::vector<double> more_outputs; ///< creep: further output times since its start [s], ascending, > 0

    // What changes at the start of a load stage without duration; forces that this sets free go to zero by its end.
    bool places_pile = false;     ///< the pile's cells, absent until then, enter free of stress
    std::vector<Target> releases; ///< displacement conditions that are let go; their values are not used
    std::vector<Target> holds;    ///< displacement conditions that begin to hold, counted from where things are then
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
    unsigned int n_successes = 0;          ///< since the last cut
    std::vector<double> stage_values = {}; ///< of the conditions at the stage's start
  };

  /** The part of a programme that a committed step has covered. */
  struct Advance
  {
    double dt = 0.;              ///< [s]
    double end_position = 0.;    ///< in the stage
    bool ends_increment = false; ///< the increment's milestone is reached
  };

  /** Moves the programme on by a committed step; the step grows back after two successes in a row.
   *  @param end_values  of the conditions at the stage's end */
  void update_progress(const Stage &stage, const std::vector<double> &end_values, const Advance &advance,
                       Progress &progress);

  /**
   * Where a checkpoint's progress goes on if the programme now gives the creep that has just ended more time: inside
   * that creep, at the end it had. Any other progress stays as it is.
   *
   * Throws std::invalid_argument naming the stage if a load that has ended is given more time: its rate is history.
   */
  Progress prolong_creep(const std::vector<Stage> &stages, Progress progress);

  /** Values of all conditions at each stage's end. Throws std::invalid_argument naming stage, parameter, value and
   * range, or a target that matches no condition with the conditions there are. */
  std::vector<std::vector<double>> resolve_targets(const std::vector<BoundaryCondition> &conditions,
                                                   const std::vector<Stage> &stages);

  /** A phase for each stage. Throws std::invalid_argument naming the stage and what contradicts: a condition that is
   * let go but not held or the other way round, a pile that is there already, a change in a stage that takes time.
   *  @param before  the phase before the first stage */
  std::vector<Phase> resolve_phases(const std::vector<BoundaryCondition> &conditions, const std::vector<Stage> &stages,
                                    Phase before);

  /** Length of a stage in its own position: seconds, or 1 where time stands still. */
  double compute_stage_length(const Stage &stage);

  /** End of the increment that begins at a position: the next load increment, output or scheduled time, never beyond
   * the stage's end. */
  double compute_next_milestone(const Stage &stage, double position);

  /** True for milestones at which results are written: outputs, load increments, the stage's end. */
  bool is_output_position(const Stage &stage, double position);

  /** Value of a condition on its way through a load stage. @param share  of the way, 0 to 1 */
  double interpolate(const Stage &stage, double start, double end, double share);
} // namespace fem

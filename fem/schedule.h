#pragma once

#include <string>

namespace fem
{
  struct Stage;

  /** Length of a stage in its own position: seconds, or 1 where time stands still. */
  double compute_stage_length(const Stage &stage);

  /** End of the increment that begins at a position: the next load increment, output or scheduled time, never beyond
   * the stage's end. */
  double compute_next_milestone(const Stage &stage, double position);

  /** True where the position is one at which results are written: outputs, load increments, the end. Exact for
   * positions that compute_next_milestone() returned. */
  bool is_output_position(const Stage &stage, double position);

  /** Value of a condition on its way through a load stage. @param share  of the way, 0 to 1 */
  double interpolate(const Stage &stage, double start, double end, double share);

  /** Throws std::invalid_argument naming stage, parameter, value and range. */
  void check_stage(const Stage &stage);
} // namespace fem

#pragma once

#include "dem/laboratory.h"

namespace dem
{
  /** What the cell is told to do once `position.share` of a stage's load is on. */
  CellControl compute_control(const LaboratoryStage &stage, const LaboratoryPosition &position, double share,
                              const RevState &baseline);

  /** Time left until the stage's next certain output or its end [s]. */
  double compute_time_to_output(const LaboratoryStage &stage, double time_in_stage);

  /** True for a stage whose load stays as it is. */
  bool is_held(const LaboratoryStage &stage);
} // namespace dem

#pragma once

#include "dem/motion.h"
#include "dem/single_grains.h"

namespace dem
{
  /** What moves the grains in single precision. */
  struct SingleMotionTask
  {
    const Cell &cell;
    const TwinRow *forces; ///< found by the number of a grain
    const Kinetics &kinetics;
    const MotionRule &rule;
  };

  /**
   * The step of advance_grains in single precision: steps of places are rounded to whole counts.
   *
   * @return bound on the displacement of each of the grains from `begin` to `end` beside the cell's own motion [m]
   */
  double advance_singles(SingleGrains &grains, std::size_t begin, std::size_t end, const SingleMotionTask &task);
} // namespace dem

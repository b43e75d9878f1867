#pragma once

#include "dem/grains.h"

#include <vector>

namespace dem
{
  struct TimeToFracture
  {
    double time;       ///< [s] from now, at frozen crack velocity
    std::size_t place; ///< of the grain in the arrays
  };

  /** Grains that will break at present crack velocities, the first first (ties by id); those that never will are left
   *  out. (Time-to-fracture paper, Eq. 7.) */
  std::vector<TimeToFracture> sort_times_to_fracture(const Grains &grains);

  /** Time until at most `batch_limit` grains have broken [s]: the batch's last grain's. Infinity when none will. */
  double compute_time_to_batch(const Grains &grains, std::size_t batch_limit);

  /**
   * The off-DEM jump: adds v dt to every crack (time-to-fracture paper, Eq. 6).
   *
   * @return places of the grains whose time has come: those listed within dt, not those that rounding of a > r selects
   */
  std::vector<std::size_t> advance_cracks(Grains &grains, double dt);
} // namespace dem

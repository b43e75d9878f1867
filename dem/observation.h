#pragma once

#include "dem/rev.h"

#include <array>

namespace dem
{
  enum class ObservationKind
  {
    load,
    dynamic,
    ageing,
    relaxed,
    rupture ///< where a rupture was given up, at rest or not
  };

  /** One equilibrium, or the end of a jump. In the program's sign: tension-positive. */
  struct Observation
  {
    double time = 0.;      ///< since the beginning of the first stage [s]
    std::size_t stage = 0; ///< from 0
    ObservationKind kind = ObservationKind::load;
    Counters counters;
    Matrix strain, stress; ///< logarithmic [-], Cauchy [Pa]
    Vector wall_stress;    ///< on the walls: xx, yy, zz [Pa]; NaN without walls
    double void_ratio = 0., void_ratio_with_fines = 0., coordination = 0., unbalanced_ratio = 0.;
    std::size_t n_grains = 0;
  };

  /** One dynamic computation of a step in which time passed: what disturbed the rest, and how far the controlled
   * stresses went from their targets on the way back to it. In the program's sign: tension-positive. */
  struct DynamicRecord
  {
    std::size_t stage = 0; ///< from 0
    double time = 0.;      ///< at which the jump before it began; without a jump: at which it began itself [s]
    double jump = 0.;      ///< length of that jump [s]; 0 after an overload within an avalanche
    std::size_t n_broken = 0;
    BreakageCause cause = BreakageCause::delayed; ///< of what broke
    std::size_t n_cycles = 0;
    std::array<bool, 6> is_stress_controlled{};                      ///< xx, yy, zz, xy, yz, xz
    std::array<double, 6> largest_deviation{}, smallest_deviation{}; ///< from the targets [Pa]
    Matrix strain_change = Matrix::Zero();                           ///< logarithmic [-]
  };

  const char *describe(ObservationKind kind);

  Observation observe(const RevState &state, const RevModel &model);
} // namespace dem

#pragma once

#include "dem/dynamics.h"

#include <array>
#include <functional>
#include <limits>

namespace dem
{
  /** When a REV is at rest. */
  struct EquilibriumRule
  {
    double unbalanced_ratio = 1e-4; ///< mean resultant on a grain over mean normal contact force, below [-]
    double stress_tolerance = 2e-3; ///< of the controlled stress, relative to the largest target [-]
    std::size_t fixed_cycles = 0;   ///< run just so many instead (150000 in the time-to-fracture paper); 0: criterion
    std::size_t cycle_cap = 200000; ///< give up beyond this
    double strain_per_cycle = 1e-5; ///< largest entry of a cell's strain increment in one cycle [-]
    double servo_gain = 0.2;        ///< share of the stress error that one cycle's strain takes away [-]
  };

  /** Six components xx, yy, zz, xy, yz, xz: each is strained or held at a stress. */
  struct CellControl
  {
    Matrix stretch = Matrix::Identity(); ///< symmetric, total for this run; entries under stress control unused
    std::array<bool, 6> is_stress_controlled{};
    Matrix target_stress = Matrix::Zero(); ///< [Pa], tension-positive; entries under strain control unused
    /** The volume goes with that of `stretch`, whatever its shape, while the three normal stresses are held at their
     * common mean: their targets are unused, and all three are under stress control. */
    bool follows_volume = false;

    bool has_servo() const;

    /** False where a shear component is strained or held at a stress: walls do neither. */
    bool is_along_axes() const;
  };

  /** How a run to equilibrium ended. */
  enum class RestStatus
  {
    at_rest,
    cap_reached,    ///< still moving after the cap of cycles
    not_finite,     ///< a force or a stress is not a number
    cell_too_narrow ///< narrower than two largest diameters plus skin
  };

  const char *describe(RestStatus status);

  struct RestReport
  {
    RestStatus status = RestStatus::at_rest;
    std::size_t n_cycles = 0;
    Profile profile;         ///< forces, search, motion and servo
    std::size_t n_bytes = 0; ///< held meanwhile beside the state
    double duration = 0.;    ///< time that passed meanwhile [s]; 0 with scaled masses
    double unbalanced_ratio = std::numeric_limits<double>::quiet_NaN();
    /** Largest and smallest deviation of each controlled stress from its target on the way [Pa]. */
    std::array<double, 6> largest_deviation{}, smallest_deviation{};

    /** Another run after this one: its end, the cycles and the deviations of both. Profile and memory stay. */
    RestReport &operator+=(const RestReport &next);
  };

  /** What decides how a REV moves to rest. */
  struct RestRule
  {
    ContactLaw law;
    DynamicsRule dynamics;
    EquilibriumRule equilibrium;
  };

  /** What a hook makes of its cycle. */
  enum class CycleVerdict
  {
    may_rest, ///< the run ends here if the REV is at rest
    goes_on,  ///< it does not, whatever the REV does; the cycle does not count for the cap or the fixed number
    ends      ///< it does, at rest or not, and is taken to be at rest
  };

  /** Called after the forces of each cycle; may replace grains (and then rebuilds and computes forces again). */
  using CycleHook = std::function<CycleVerdict(Dynamics &)>;

  /**
   * Strains the cell as told, holds the stresses as told, until the REV is at rest. Fracture is frozen, unless the hook
   * breaks grains. Between walls the stresses held are those on the walls.
   *
   * @pre with walls control.is_along_axes()
   * @post the state's contacts, stress, unbalanced ratio and cycle count are those of the end, at rest or not
   */
  RestReport bring_to_rest(RevState &state, const RestRule &rule, const CellControl &control,
                           const CycleHook &hook = {});
} // namespace dem

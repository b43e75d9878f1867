#pragma once

#include "dem/cell.h"
#include "dem/rev_arrays.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace dem
{
  /** How much has happened to a REV since its packing was made. */
  struct Counters
  {
    std::uint64_t cycles = 0;
    std::uint64_t broken_instant = 0;
    std::uint64_t broken_delayed = 0;
    std::uint64_t next_id = 0; ///< id that the next sibling gets
  };

  enum class BreakageCause
  {
    instant, ///< a contact force beyond the limit
    delayed  ///< a crack that has grown through
  };

  /** A grain that has split. */
  struct Fracture
  {
    double time; ///< when it was replaced by its siblings: the end of a jump, or that of the equilibrium [s]
    GrainId grain;
    std::uint32_t generation; ///< of the grain that split
    double diameter;          ///< [m]
    double strength;          ///< sigma_lim [Pa]
    BreakageCause cause;
  };

  /** Everything that the future of a REV at rest depends on, beside its parameters; grains and contacts are among its
   * arrays. */
  struct RevState : RevArrays
  {
    Cell cell;
    Matrix stress = Matrix::Zero();       ///< Love-Weber [Pa], tension-positive, in the REV's axes
    Matrix rotation = Matrix::Identity(); ///< Q: turns the REV's axes into the solver's
    double time = 0.;                     ///< [s]
    double unbalanced_ratio = 0.;         ///< [-]
    double initial_solid_volume = 0.;     ///< [m3], grains before any split; the lost part is fines
    Counters counters;
    /** What has split since the last commit, in order. Nothing depends on it, and it is not part of the bytes. */
    std::vector<Fracture> fractures;
  };

  /** Memory that a state holds [bytes]. */
  std::size_t count_bytes(const RevState &state);

  /** Stores grains that are near in space near each other, so that they share caches; what they are and remember stays.
   */
  void sort_in_space(RevState &state);

  /** One contiguous, self-describing copy (magic, version, lengths, checksum), for messages and checkpoints. */
  std::vector<std::byte> serialise(const RevState &state);

  /** Throws std::runtime_error saying what is wrong with the bytes. */
  RevState deserialise(std::span<const std::byte> bytes);

  /** Pore volume over volume of the grains [-]; fines count as pores. */
  double compute_void_ratio(const RevState &state);

  /** Pore volume over solid volume [-]; fines count as solids. */
  double compute_void_ratio_with_fines(const RevState &state);
} // namespace dem

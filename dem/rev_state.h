#pragma once

#include "dem/cell.h"
#include "dem/grains.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace dem
{
  /** What a touching pair remembers. The order of these is the order in which forces are summed: part of the state. */
  struct ContactMemory
  {
    std::uint32_t a, b; ///< places in the arrays of the grains; b may stand for a wall (dem/walls.h)
    Vector shear_force; ///< t, acts on a [N]
    bool is_sliding;
  };

  /** What has crept at a Burgers contact. Grains by their ids, so that it outlives sorting, splitting and new networks;
   * a wall's id is its number below zero. It is forgotten once the contact is open at rest. */
  struct CreptContact
  {
    GrainId a, b;           ///< a below b
    double normal_viscous;  ///< of the dashpot in series; the overlap's spring feels so much less [m]
    double normal_retarded; ///< of the Kelvin element, likewise [m]
    Vector shear_retarded;  ///< slip of b beside a that the Kelvin element holds [m]
  };

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

  /** Everything that the future of a REV at rest depends on, beside its parameters. */
  struct RevState
  {
    Cell cell;
    Grains grains;
    std::vector<ContactMemory> contacts;
    std::vector<CreptContact> crept_contacts; ///< by a, then b; empty but for Burgers contacts
    Matrix stress = Matrix::Zero();           ///< Love-Weber [Pa], tension-positive, in the REV's axes
    Matrix rotation = Matrix::Identity();     ///< Q: turns the REV's axes into the solver's
    double time = 0.;                         ///< [s]
    double unbalanced_ratio = 0.;             ///< [-]
    double initial_solid_volume = 0.;         ///< [m3], grains before any split; the lost part is fines
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

#pragma once

#include "dem/contact.h"
#include "dem/contact_law.h"
#include "dem/lane_rows.h"
#include "dem/large_pages.h"
#include "dem/rev_state.h"
#include "dem/team.h"

#include <span>
#include <vector>

namespace dem
{
  inline constexpr std::size_t undivided_grains = 1024; ///< so many, or fewer, are one block
  inline constexpr std::size_t grains_per_block = 2048; ///< at most, of a REV of more grains
  inline constexpr std::size_t cached_grains = 30000; ///< more, with their contacts, do not lie in the caches of a core

  /** What a candidate pair is at the moment. */
  enum class PairStatus : std::uint8_t
  {
    is_apart,
    sticks,
    slides
  };

  /**
   * Some grains next to each other in storage, and the pairs whose first grain is one of them: far pairs, the second
   * grain in another block, then near pairs. A block is the unit of work that threads share; blocks depend on the
   * number of grains alone, so that sums do not depend on the number of threads.
   */
  struct GrainBlock
  {
    std::size_t grain_begin, grain_end;
    std::size_t far_begin, near_begin, near_end; ///< places of pairs, multiples of the number of lanes
    std::size_t first_far;                       ///< place of its first far pair among all far pairs
    std::size_t incoming_begin, incoming_end;    ///< far pairs of other blocks whose second grain is here
    std::size_t first_source, last_source;       ///< lowest and highest block with such a pair, or the block itself
    std::size_t first_target, last_target;       ///< of the blocks that its own far pairs reach into, likewise
  };

  /** A grain and a wall that may touch. */
  struct WallPair
  {
    std::uint32_t grain, wall;
    Vector shear_force; ///< on the grain [N]; zero where apart
    PairStatus status;
    double crept_overlap = 0.; ///< [m]
  };

  /**
   * The pairs that may touch, each once, and what touching pairs remember. The first grain of a near pair is the one
   * that comes first in storage; a far pair belongs to the block that comes first, or to the other one where that is
   * less far to go round the end of storage. Valid until a grain has used up its skin (Skins). Built from a state
   * alone, by a fixed rule: the order of pairs is the order in which forces are summed, and a restart must find the
   * same.
   *
   * Each list is filled up to whole vectors of lanes with grains beside themselves, which touch nothing.
   */
  struct ContactNetwork
  {
    std::vector<std::uint32_t> a, b;
    LongArray<RowOffset> row_a, row_b;           ///< of the grains' rows in their arrays; b: or a copy's (PassedGrains)
    LongArray<double> radius_sum;                ///< Ra + Rb, less what has crept [m]
    LongArray<double> root_radius;               ///< sqrt(R*) [m^0.5]
    LongArray<double> shear_x, shear_y, shear_z; ///< shear force on a [N]; zero where apart
    std::vector<PairStatus> status;

    std::vector<GrainBlock> blocks;
    std::vector<std::uint32_t> incoming_far, incoming_grain; ///< far pairs by their second grain, and that grain

    std::vector<WallPair> wall_pairs; ///< by the grain's place, then by the wall's

    double reach = 0.;                 ///< the largest of a pair, skins included [m]
    std::vector<Row> place_when_built; ///< w: radius plus the grain's own skin [m]
    Matrix edges_when_built = Matrix::Identity();
    std::size_t n_far = 0; ///< room for far pairs

    std::size_t size() const { return a.size(); }
    std::size_t count_bytes() const; ///< memory that it holds
    bool is_pair(const std::size_t k) const { return a[k] != b[k]; }
    Vector get_shear(const std::size_t k) const { return {shear_x[k], shear_y[k], shear_z[k]}; }
    void set_shear(std::size_t k, const Vector &force, PairStatus now);
  };

  /** The block that a far pair belongs to. @param far  its place among all far pairs */
  std::size_t find_source(const ContactNetwork &network, std::size_t far);

  /** Largest reach of a pair: twice the largest radius plus the skin [m]. */
  double compute_reach(const Grains &grains, double skin);

  /** True when the cell is wide enough for each pair to touch through one image only; between walls: for the nearest
   *  image of what a grain touches to be that grain itself. */
  bool is_wide_enough(const Cell &cell, double reach);

  /** For who builds once and for one skin of all pairs [m], by the calling thread alone (NetworkBuilder builds again
   * and again).
   *
   * @pre is_wide_enough(state.cell, compute_reach(state.grains, skin)) */
  ContactNetwork build_contact_network(const RevState &state, double skin);

  /** What its touching pairs remember, in the network's order; walls after all grains. */
  std::vector<ContactMemory> collect_memories(const ContactNetwork &network);

  /** The same into the contacts of a state, by a team. */
  void store_memories(const ContactNetwork &network, Team &team, RevArrays &state);

  /** The touching pairs of a state with all that is known of them, in the order of state.contacts; forces by the
   *  reference law. */
  std::vector<Contact> list_contacts(const RevState &state, const ContactLaw &law);

  /** Those of them that one of some grains is in. @param places  of the grains */
  std::vector<Contact> list_contacts_of(const RevState &state, std::span<const std::size_t> places,
                                        const ContactLaw &law);

  /** x_b - x_a between the nearest images [m]. */
  Vector compute_branch(const Cell &cell, const Row &place_a, const Row &place_b);
} // namespace dem

#pragma once

#include "dem/contact_network.h"
#include "dem/contact_search.h"

namespace dem
{
  /**
   * Builds contact networks, which the threads of a team share block by block; the network depends on state and skins
   * alone. Keeps its memory from one network to the next, as the network does: it is built thousands of times.
   */
  class NetworkBuilder
  {
  public:
    /**
     * @param skins  of each grain [m]: pairs closer than both radii and both skins are in the network
     *
     * @pre is_wide_enough(state.cell, twice the largest sum of radius and skin)
     */
    void build(const RevState &state, std::span<const double> skins, Team &team, ContactNetwork &network);

    std::size_t count_bytes() const; ///< memory that it holds

  private:
    /** Far or near; touching, apart by so little that they will touch soon, or apart: the order of a block's pairs. */
    enum Sort : std::uint8_t
    {
      far_touching,
      far_close,
      far_apart,
      near_touching,
      near_close,
      near_apart,
      n_sorts
    };

    /** What must be known of one block before the next can be laid out. */
    struct Layout
    {
      std::array<std::size_t, n_sorts> n; ///< pairs of each sort

      std::size_t count(Sort first, Sort last) const; ///< pairs of these sorts and those between
    };

    static void set_reaches(const RevState &state, std::span<const double> skins, ContactNetwork &network);
    void sort_block(const RevState &state, const ContactNetwork &network, std::size_t k);
    void lay_out_blocks(ContactNetwork &network) const;
    void fill_block(const RevState &state, std::size_t k, ContactNetwork &network);
    void list_incoming(const RevState &state, Team &team, ContactNetwork &network);
    void count_incoming(const ContactNetwork &network, std::size_t begin, std::size_t end);
    void fill_incoming(std::size_t begin, std::size_t end, ContactNetwork &network);
    void find_neighbours(ContactNetwork &network) const;
    void restore_memories(const RevState &state, Team &team, ContactNetwork &network) const;
    void restore_memory(const ContactMemory &memory, ContactNetwork &network) const;

    ContactSearch search_;
    const std::vector<NearPair> *pairs_ = nullptr; // of the present network
    std::vector<Sort> sorts_;                      ///< of each pair
    std::vector<std::uint32_t> place_of_pair_;     ///< in the network
    std::vector<Layout> layouts_;                  ///< of each block
    std::vector<std::uint32_t> incoming_;          ///< of each grain: how many far pairs, then where the next one goes
  };
} // namespace dem

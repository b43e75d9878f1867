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
    /** Far or near; touching, apart by so little that they will touch soon, or apart: the order of a block's pairs.
     * Those that are left go to the block of their other grain, as far pairs. */
    enum Sort : std::uint8_t
    {
      far_touching,
      far_close,
      far_apart,
      near_touching,
      near_close,
      near_apart,
      n_sorts,
      left_touching = n_sorts,
      left_close,
      left_apart
    };

    /** That far pair in the block that it goes to. */
    static Sort take(const Sort left) { return static_cast<Sort>(left - left_touching + far_touching); }

    /** What must be known of one block before the next can be laid out. */
    struct Layout
    {
      std::array<std::size_t, n_sorts> n; ///< pairs of each sort
      std::vector<std::uint32_t> left;    ///< pairs that go to later blocks

      std::size_t count(Sort first, Sort last) const; ///< pairs of these sorts and those between
    };

    static void set_reaches(const RevState &state, std::span<const double> skins, ContactNetwork &network);
    void sort_block(const RevState &state, const ContactNetwork &network, std::size_t k);
    template <typename Take>
    void for_each_taken(const ContactNetwork &network, std::size_t k, const Take &take_pair) const;
    void lay_out_blocks(ContactNetwork &network);
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

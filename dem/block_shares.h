#pragma once

#include "dem/contact_network.h"
#include "dem/team.h"

#include <functional>

/** How the threads of a team share the blocks of a network, whatever the precision of what they compute. */
namespace dem
{
  /** Grains of the largest block: blocks differ by one at most. */
  std::size_t count_largest_block(const ContactNetwork &network);

  /** First block of each thread's share of a network, and the number of blocks behind them. */
  std::vector<std::size_t> list_shares(const ContactNetwork &network, std::size_t n_threads);

  /** What is to be done with each block of a network. */
  struct BlockWork
  {
    /** Computes the far pairs of block k alone, ahead of its turn. */
    std::function<void(std::size_t k)> compute_far;
    /** Computes the pairs of block k on a thread of the team, less the far ones where they have been; with is_complete
     * all that reach into the block have been computed, and it is finished at once. */
    std::function<void(std::size_t k, std::size_t thread, bool has_far, bool is_complete)> compute;
    /** Finishes a block once all pairs that reach into it have been computed. */
    std::function<void(std::size_t k)> complete;
  };

  /**
   * Each thread takes one run of blocks, with pairs that take all about the same time, and finishes them itself, since
   * they lie in its cache. Threads first compute what reaches into blocks of other threads, or back into blocks that
   * come before in their own share, and seldom wait for each other. Results need not depend on how many threads there
   * are.
   */
  void share_blocks(const ContactNetwork &network, Team &team, const BlockWork &work);
} // namespace dem

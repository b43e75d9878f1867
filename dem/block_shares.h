#pragma once

#include "dem/contact_network.h"
#include "dem/team.h"

#include <functional>

/** How the threads of a team share the blocks of a network, whatever the precision of what they compute. */
namespace dem
{
  /** Grains of the largest block: blocks differ by one at most. */
  std::size_t count_largest_block(const ContactNetwork &network);

  /** Rows from `first` on as if they belonged to the grains from `grain` on. */
  template <typename R>
  R *shift_rows(R *const first, const std::size_t grain)
  {
    return reinterpret_cast<R *>(reinterpret_cast<std::uintptr_t>(first) - grain * sizeof(R));
  }

  /** What is to be done with each block of a network. */
  struct BlockWork
  {
    /** Computes the pairs of block k on a thread of the team; with is_complete no other thread's pairs reach into the
     * block, and it is finished at once. */
    std::function<void(std::size_t k, std::size_t thread, bool is_complete)> compute;
    /** Finishes a block that other threads' pairs reach into, once all pairs have been computed. */
    std::function<void(std::size_t k)> complete;
  };

  /** Each thread takes one run of blocks, with pairs that take all about the same time; results need not depend on how
   * many threads there are. */
  void share_blocks(const ContactNetwork &network, Team &team, const BlockWork &work);
} // namespace dem

#include "dem/passed_grains.h"

#include "dem/block_shares.h"
#include "dem/memory.h"

#include <numeric>

namespace dem
{
  namespace
  {
    /** Place in the network of one of all far pairs. */
    std::size_t find_far_pair(const ContactNetwork &network, const std::size_t far)
    {
      const GrainBlock &source = network.blocks[find_source(network, far)];
      return source.far_begin + (far - source.first_far);
    }
  } // namespace

  void PassedGrains::list(ContactNetwork &network, Team &team)
  {
    const std::size_t n_blocks = network.blocks.size();
    n_grains_ = network.place_when_built.size();
    grains_.resize(n_blocks);
    for (std::vector<std::uint32_t> &grains : grains_)
      grains.clear();
    first_.assign(n_blocks + 1, 0);
    if (team.size() == 1)
      return;
    const std::vector<std::size_t> shares = list_shares(network, team.size());
    team.run(team.size(), [&](const std::size_t number) {
      for (std::size_t k = shares[number]; k < shares[number + 1]; ++k)
        list_block(network, k, shares[number], shares[number + 1]);
    });
    for (std::size_t k = 0; k < n_blocks; ++k)
      first_[k + 1] = first_[k] + grains_[k].size();
    team.run(n_blocks, [&](const std::size_t k) { redirect(network, k); });
  }

  /** Grains of block k that pairs of blocks outside of its thread's share reach. */
  void PassedGrains::list_block(const ContactNetwork &network, const std::size_t k, const std::size_t share_begin,
                                const std::size_t share_end)
  {
    const GrainBlock &block = network.blocks[k], &last = network.blocks[share_end - 1];
    const std::size_t first_own = network.blocks[share_begin].first_far;
    const std::size_t end_of_own = last.first_far + (last.near_begin - last.far_begin);
    for (std::size_t i = block.incoming_begin; i < block.incoming_end; ++i)
      {
        const std::uint32_t far = network.incoming_far[i], grain = network.incoming_grain[i];
        const bool is_own = far >= first_own && far < end_of_own;
        if (!is_own && (grains_[k].empty() || grains_[k].back() != grain))
          grains_[k].push_back(grain);
      }
  }

  /** All pairs of other blocks that reach these grains: those of the same thread find a copy as well. */
  void PassedGrains::redirect(ContactNetwork &network, const std::size_t k) const
  {
    const GrainBlock &block = network.blocks[k];
    std::size_t next = 0; // of the copies
    for (std::size_t i = block.incoming_begin; i < block.incoming_end && next < grains_[k].size(); ++i)
      {
        const std::uint32_t grain = network.incoming_grain[i];
        while (next < grains_[k].size() && grains_[k][next] < grain)
          ++next;
        if (next < grains_[k].size() && grains_[k][next] == grain)
          network.row_b[find_far_pair(network, network.incoming_far[i])] =
              static_cast<RowOffset>((n_grains_ + first_[k] + next) * sizeof(Row));
      }
  }

  std::size_t PassedGrains::count_bytes() const
  {
    return std::accumulate(grains_.begin(), grains_.end(), dem::count_bytes(grains_, first_),
                           [](const std::size_t n, const auto &grains) { return n + dem::count_bytes(grains); });
  }
} // namespace dem

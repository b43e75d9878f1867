#include "dem/block_shares.h"

#include <algorithm>

namespace dem
{
  namespace
  {
    /** Share of the pairs that belongs to the threads before a thread. */
    double compute_share_before(const std::size_t number, const std::size_t n_threads)
    {
      // The first thread completes its blocks on the way, which takes a fifth of the time of their pairs; nearly all
      // those of the others wait until all pairs have been computed.
      constexpr double completion = 0.2;
      const double others = static_cast<double>(n_threads) - 1., first = 1. / (1. + (1. + completion) * others);
      return number == 0 ? 0. : first + (1. - first) * (static_cast<double>(number) - 1.) / others;
    }

    /** First block of a thread's share of the pairs. */
    std::size_t find_share(const ContactNetwork &network, const std::size_t number, const std::size_t n_threads)
    {
      if (number == n_threads)
        return network.blocks.size();
      const auto is_before = [](const GrainBlock &block, const double pair) {
        return static_cast<double>(block.near_begin) < pair;
      };
      const auto begin = network.blocks.begin(), end = network.blocks.end();
      const double pair = compute_share_before(number, n_threads) * static_cast<double>(network.size());
      return std::lower_bound(begin, end, pair, is_before) - begin;
    }

    /** Blocks that pairs of another thread reach into: complete once all pairs have been computed. */
    std::vector<std::size_t> list_incomplete(const ContactNetwork &network, const std::size_t n_threads)
    {
      std::vector<std::size_t> blocks;
      for (std::size_t number = 1; number < n_threads; ++number)
        {
          const std::size_t begin = find_share(network, number, n_threads);
          for (std::size_t k = begin; k < find_share(network, number + 1, n_threads); ++k)
            if (network.blocks[k].first_source < begin)
              blocks.push_back(k);
        }
      return blocks;
    }
  } // namespace

  std::size_t count_largest_block(const ContactNetwork &network)
  {
    const std::size_t n_grains = network.blocks.back().grain_end, n_blocks = network.blocks.size();
    return (n_grains + n_blocks - 1) / n_blocks;
  }

  void share_blocks(const ContactNetwork &network, Team &team, const BlockWork &work)
  {
    const std::size_t n_threads = team.size();
    team.run(n_threads, [&](const std::size_t number) {
      // Pairs reach forwards only: a block is complete after its own, unless another thread's reach into it.
      const std::size_t begin = find_share(network, number, n_threads);
      for (std::size_t k = begin; k < find_share(network, number + 1, n_threads); ++k)
        work.compute(k, number, network.blocks[k].first_source >= begin);
    });
    const std::vector<std::size_t> rest = list_incomplete(network, n_threads);
    team.run(rest.size(), [&](const std::size_t i) { work.complete(rest[i]); });
  }
} // namespace dem

#include "dem/block_shares.h"

#include <algorithm>
#include <atomic>

namespace dem
{
  namespace
  {
    /** What blocks before a place cost: a pair costs about three times what moving a grain does, or adding what a far
     * pair does to its second grain (docs/performance.md). */
    std::size_t add_up_cost(const std::size_t pairs, const std::size_t grains, const std::size_t incoming)
    {
      return 3 * pairs + grains + incoming;
    }

    /** First block of a thread's share of the cost: the one that begins nearest to where the share does. */
    std::size_t find_share(const ContactNetwork &network, const std::size_t number, const std::size_t n_threads)
    {
      const std::vector<GrainBlock> &blocks = network.blocks;
      if (number == n_threads)
        return blocks.size();
      const GrainBlock &last = blocks.back();
      const std::size_t cost = add_up_cost(last.near_end, last.grain_end, last.incoming_end);
      const auto is_before = [=](const GrainBlock &block) {
        const std::size_t before = add_up_cost(block.far_begin, block.grain_begin, block.incoming_begin);
        const std::size_t after = add_up_cost(block.near_end, block.grain_end, block.incoming_end);
        return (before + after) / 2 < cost * number / n_threads;
      };
      return static_cast<std::size_t>(std::partition_point(blocks.begin(), blocks.end(), is_before) - blocks.begin());
    }

    /** One cycle's work, which threads come together at. */
    class Sharing
    {
    public:
      Sharing(const ContactNetwork &network, const std::size_t n_threads, const BlockWork &work)
          : blocks_(network.blocks), network_(network), work_(work), is_ahead_(n_threads)
      {}

      void do_share(const std::size_t number)
      {
        const std::size_t begin = find_share(network_, number, is_ahead_.size());
        const std::size_t end = find_share(network_, number + 1, is_ahead_.size());
        const auto is_ahead_of_turn = [&](const std::size_t k) {
          return blocks_[k].first_target < k || blocks_[k].last_target >= end;
        };
        const auto is_own = [&](const std::size_t k) {
          return blocks_[k].first_source >= begin && blocks_[k].last_source < end;
        };
        for (std::size_t k = begin; k < end; ++k)
          if (is_ahead_of_turn(k))
            work_.compute_far(k);
        is_ahead_[number].store(true, std::memory_order_release);

        const auto complete_until = [&](const std::size_t last) {
          for (std::size_t k = begin; k < last; ++k)
            if (!is_own(k))
              work_.complete(k);
        };
        bool is_met = is_ahead_.size() == 1;
        for (std::size_t k = begin; k < end; ++k)
          {
            if (!is_met && are_ahead())
              {
                is_met = true;
                complete_until(k);
              }
            work_.compute(k, number, is_ahead_of_turn(k), is_met || is_own(k));
          }
        if (is_met)
          return;
        wait_until([&] { return are_ahead(); });
        complete_until(end);
      }

    private:
      /** Whether all threads have computed what reaches into blocks of others. */
      bool are_ahead() const
      {
        return std::all_of(is_ahead_.begin(), is_ahead_.end(),
                           [](const std::atomic<bool> &is_ahead) { return is_ahead.load(std::memory_order_acquire); });
      }

      const std::vector<GrainBlock> &blocks_;
      const ContactNetwork &network_;
      const BlockWork &work_;
      std::vector<std::atomic<bool>> is_ahead_;
    };
  } // namespace

  std::size_t count_largest_block(const ContactNetwork &network)
  {
    const std::size_t n_grains = network.blocks.back().grain_end, n_blocks = network.blocks.size();
    return (n_grains + n_blocks - 1) / n_blocks;
  }

  std::vector<std::size_t> list_shares(const ContactNetwork &network, const std::size_t n_threads)
  {
    std::vector<std::size_t> shares(n_threads + 1);
    for (std::size_t number = 0; number <= n_threads; ++number)
      shares[number] = find_share(network, number, n_threads);
    return shares;
  }

  void share_blocks(const ContactNetwork &network, Team &team, const BlockWork &work)
  {
    Sharing sharing(network, team.size(), work);
    team.run(team.size(), [&](const std::size_t number) { sharing.do_share(number); });
  }
} // namespace dem

#include "dem/passed_grains.h"

#include "dem/block_shares.h"
#include "dem/network_builder.h"
#include "tests/support/rev_cases.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <set>

namespace
{
  using namespace dem;
  using namespace dem::cases;

  /** Grains of eight blocks thrown into a cell: each block reaches into four others. */
  const RevState &get_state()
  {
    static const RevState state = [] {
      std::mt19937_64 random(1);
      std::uniform_real_distribution<double> place(0., 1.), size(0.5, 1.);
      RevState scattered = make_state(std::vector<Vector>(9000, Vector::Zero()), 1.);
      for (Row &row : scattered.grains.place)
        row = {place(random), place(random), place(random), size(random) * radius};
      scattered.cell.edges = 43. * radius * Matrix::Identity();
      return scattered;
    }();
    return state;
  }

  ContactNetwork build()
  {
    Team alone(1);
    ContactNetwork network;
    const RevState &state = get_state();
    NetworkBuilder().build(state, std::vector<double>(state.grains.size(), 0.1 * radius), alone, network);
    return network;
  }

  /** The thread whose share a grain is in. */
  std::size_t find_thread(const ContactNetwork &network, const std::vector<std::size_t> &shares,
                          const std::size_t grain)
  {
    std::size_t thread = 0;
    while (network.blocks[shares[thread + 1] - 1].grain_end <= grain)
      ++thread;
    return thread;
  }

  TEST(PassedGrains, PairsOfOtherThreadsFindCopies)
  {
    // Law: where both grains of a pair belong to one thread, and no other thread reaches its second grain, the pair
    // finds that grain's own row; pairs of two threads find a row behind all grains. Each has in it what the second
    // grain has, and no grain has two copies. Exact.
    const RevState &state = get_state();
    for (const std::size_t n_threads : {2, 3, 8})
      {
        ContactNetwork network = build();
        const std::vector<std::size_t> shares = list_shares(network, n_threads);
        Team team(n_threads);
        PassedGrains passed;
        passed.list(network, team);
        ASSERT_GT(passed.size(), 100u);
        std::vector<Row> rows(state.grains.place.begin(), state.grains.place.end());
        rows.resize(state.grains.size() + passed.size());
        passed.copy_all(rows.data());
        std::set<std::uint32_t> grains;
        std::set<RowOffset> copies;
        for (std::size_t k = 0; k < network.size(); ++k)
          {
            const std::uint32_t a = network.a[k], b = network.b[k];
            const std::size_t row = network.row_b[k] / sizeof(Row);
            ASSERT_LT(row, rows.size());
            EXPECT_EQ(rows[row].x, state.grains.place[b].x);
            if (find_thread(network, shares, a) != find_thread(network, shares, b))
              {
                EXPECT_GE(row, state.grains.size());
              }
            if (row >= state.grains.size())
              {
                grains.insert(b);
                copies.insert(network.row_b[k]);
              }
            else
              EXPECT_EQ(row, b);
          }
        EXPECT_EQ(grains.size(), passed.size());
        EXPECT_EQ(copies.size(), passed.size());
      }
  }

  TEST(PassedGrains, OneThreadNeedsNone)
  {
    // Law: alone, a thread reads the grains themselves, even after it has read copies of another network. Exact.
    ContactNetwork network = build(), shared = build();
    const std::vector<RowOffset> before(network.row_b.begin(), network.row_b.end());
    Team alone(1), two(2);
    PassedGrains passed;
    passed.list(shared, two);
    passed.list(network, alone);
    EXPECT_EQ(passed.size(), 0u);
    EXPECT_TRUE(std::equal(before.begin(), before.end(), network.row_b.begin(), network.row_b.end()));
  }
} // namespace

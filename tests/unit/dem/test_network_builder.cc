#include "dem/network_builder.h"

#include "tests/support/memory_cases.h"
#include "tests/support/rev_cases.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <map>
#include <random>
#include <set>

namespace
{
  using namespace dem;
  using namespace dem::cases;

  constexpr double skin = 0.2 * radius;

  /** Grains of some blocks thrown into a cell, with shear forces at those that touch. */
  RevState scatter(const std::size_t n, const double edge, const std::uint64_t seed)
  {
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> place(-1., 2.), size(0.5, 1.), force(-1., 1.);
    RevState state = make_state(std::vector<Vector>(n, Vector::Zero()), 1.);
    for (Row &row : state.grains.place)
      row = {place(random), place(random), place(random), size(random) * radius};
    state.cell.edges = edge * radius * Matrix::Identity();
    for (const NearPair &pair : list_near_pairs(state.cell, state.grains.place, 0.))
      state.add(ContactMemory{pair.a, pair.b, Vector(force(random), force(random), force(random)), force(random) > 0.});
    return state;
  }

  std::vector<double> make_skins(const RevState &state)
  {
    return std::vector<double>(state.grains.size(), 0.5 * skin);
  }

  ContactNetwork build(const RevState &state, const std::size_t n_threads)
  {
    Team team(n_threads);
    ContactNetwork network;
    NetworkBuilder().build(state, make_skins(state), team, network);
    return network;
  }

  TEST(NetworkBuilder, BuildsTheSameWhateverTheTeam)
  {
    // Law: a network depends on state and skin alone: not on how many threads build it, nor on what builder and network
    // held before, which was more or less. Exact.
    const RevState state = scatter(3000, 30., 1), smaller = scatter(1800, 25., 2), larger = scatter(4000, 30., 3);
    const ContactNetwork expected = build(state, 1);
    ASSERT_GT(expected.blocks.size(), 3u);
    ASSERT_GT(expected.n_far, 100u);
    NetworkBuilder builder;
    ContactNetwork network;
    for (const std::size_t n_threads : {2, 3, 1})
      for (const RevState *before : {&smaller, &larger})
        {
          Team team(n_threads);
          builder.build(*before, make_skins(*before), team, network);
          builder.build(state, make_skins(state), team, network);
          EXPECT_EQ(network.a, expected.a);
          EXPECT_EQ(network.b, expected.b);
          EXPECT_EQ(network.row_b, expected.row_b);
          EXPECT_EQ(network.radius_sum, expected.radius_sum);
          EXPECT_EQ(network.root_radius, expected.root_radius);
          EXPECT_EQ(network.shear_y, expected.shear_y);
          EXPECT_EQ(network.status, expected.status);
          EXPECT_EQ(network.incoming_far, expected.incoming_far);
          EXPECT_EQ(network.incoming_grain, expected.incoming_grain);
          EXPECT_EQ(network.n_far, expected.n_far);
          RevArrays stored;
          store_memories(network, team, stored);
          expect_same_memories(stored.contacts, collect_memories(expected));
        }
  }

  TEST(NetworkBuilder, PairsThatMayTouchSoonStandTogether)
  {
    // Law: touching pairs stand first, then those apart by less than 0.07 of their skins, then the others; of each sort
    // near pairs are in the order of (a, b), far ones in that of (b, a). Exact: no pair lies at a bound.
    const RevState state = scatter(3000, 30., 1);
    const ContactNetwork network = build(state, 1);
    const auto find_sort = [&](const std::size_t k) {
      const Row &a = state.grains.place[network.a[k]], &b = state.grains.place[network.b[k]];
      const double gap = compute_branch(state.cell, a, b).norm() - a.w - b.w;
      return gap < 0. ? 0u : gap < 0.07 * skin ? 1u : 2u;
    };
    std::array<std::size_t, 3> n{};
    for (const GrainBlock &block : network.blocks)
      for (const bool is_far : {true, false})
        {
          const std::size_t begin = is_far ? block.far_begin : block.near_begin;
          const std::size_t end = is_far ? block.near_begin : block.near_end;
          std::vector<std::array<std::uint32_t, 3>> keys;
          for (std::size_t k = begin; k < end && network.is_pair(k); ++k)
            {
              const std::uint32_t sort = find_sort(k);
              ++n[sort];
              keys.push_back({sort, is_far ? network.b[k] : network.a[k], is_far ? network.a[k] : network.b[k]});
            }
          EXPECT_TRUE(std::is_sorted(keys.begin(), keys.end())) << block.grain_begin << ' ' << is_far;
        }
    EXPECT_GT(*std::min_element(n.begin(), n.end()), 20u);
  }

  /** Far pairs are those whose second grain is in another block, one of the `farthest` next ones round the end; each is
   * incoming once, at its second grain, in rising order; sources and targets are their bounds. */
  void expect_reach(const ContactNetwork &network, const std::size_t farthest)
  {
    const std::size_t n_blocks = network.blocks.size();
    const auto find_block = [&](const std::uint32_t grain) {
      std::size_t k = 0;
      while (network.blocks[k].grain_end <= grain)
        ++k;
      return k;
    };
    std::vector<std::set<std::size_t>> sources(n_blocks), targets(n_blocks); // and the block itself
    std::map<std::uint32_t, std::uint32_t> second_grain;                     // of each far pair
    for (std::size_t k = 0; k < n_blocks; ++k)
      {
        sources[k].insert(k);
        targets[k].insert(k);
        const GrainBlock &block = network.blocks[k];
        for (std::size_t i = block.far_begin; i < block.near_begin && network.is_pair(i); ++i)
          {
            const std::size_t target = find_block(network.b[i]);
            EXPECT_NE(target, k);
            EXPECT_LE((target + n_blocks - k) % n_blocks, farthest);
            sources[target].insert(k);
            targets[k].insert(target);
            second_grain[static_cast<std::uint32_t>(block.first_far + i - block.far_begin)] = network.b[i];
          }
        for (std::size_t i = block.near_begin; i < block.near_end; ++i)
          EXPECT_EQ(find_block(network.b[i]), k);
      }
    ASSERT_EQ(network.incoming_far.size(), second_grain.size());
    for (std::size_t i = 0; i < network.incoming_far.size(); ++i)
      {
        EXPECT_EQ(second_grain.at(network.incoming_far[i]), network.incoming_grain[i]);
        if (i > 0)
          {
            EXPECT_LT(std::make_pair(network.incoming_grain[i - 1], network.incoming_far[i - 1]),
                      std::make_pair(network.incoming_grain[i], network.incoming_far[i]));
          }
      }
    for (std::size_t k = 0; k < network.blocks.size(); ++k)
      {
        EXPECT_EQ(network.blocks[k].first_source, *sources[k].begin());
        EXPECT_EQ(network.blocks[k].last_source, *sources[k].rbegin());
        EXPECT_EQ(network.blocks[k].first_target, *targets[k].begin());
        EXPECT_EQ(network.blocks[k].last_target, *targets[k].rbegin());
      }
  }

  TEST(NetworkBuilder, BlocksKnowWhoReachesIntoThem)
  {
    // Law: blocks reach into the nearer half of the others, round the end of storage; where they are more than sixteen,
    // into later ones alone. Grains are scattered, so that each block reaches into all that it may. Exact.
    const ContactNetwork ring = build(scatter(9000, 43., 1), 2), line = build(scatter(33000, 66., 1), 2);
    ASSERT_EQ(ring.blocks.size(), 8u);
    expect_reach(ring, 4);
    EXPECT_EQ(ring.blocks[7].first_target, 0u);
    ASSERT_EQ(line.blocks.size(), 32u);
    expect_reach(line, 31);
    for (std::size_t k = 0; k < 32; ++k)
      {
        EXPECT_EQ(line.blocks[k].first_target, k);
        EXPECT_EQ(line.blocks[k].last_target, 31u);
      }
  }
} // namespace

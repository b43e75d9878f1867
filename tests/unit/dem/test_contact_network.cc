#include "dem/dynamics.h"
#include "dem/network_builder.h"
#include "dem/skins.h"

#include "tests/support/memory_cases.h"
#include "tests/support/rev_cases.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <random>
#include <utility>

namespace
{
  using namespace dem;
  using namespace dem::cases;
  using Pair = std::pair<std::uint32_t, std::uint32_t>;

  /** Grains thrown into a cell with edges of some size [radii] that lean by given shares of each other. */
  RevState scatter(const std::size_t n, const double edge, const double lean, const std::uint64_t seed)
  {
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> place(-1., 2.), size(0.5, 1.); // also outside the cell: images
    RevState state = make_state(std::vector<Vector>(n, Vector::Zero()), 1.);
    for (Row &row : state.grains.place)
      row = {place(random), place(random), place(random), size(random) * radius};
    state.cell.edges << 1., lean, -lean, 0., 1.1, lean, 0., 0., 0.9;
    state.cell.edges *= edge * radius;
    return state;
  }

  /** Distance of the nearest of 343 images. */
  double compute_distance(const RevState &state, const std::size_t i, const std::size_t j)
  {
    Vector fraction = to_vector(state.grains.place[j]) - to_vector(state.grains.place[i]);
    for (int k = 0; k < 3; ++k)
      fraction[k] -= std::floor(fraction[k]);
    double nearest = std::numeric_limits<double>::infinity();
    for (int x = -3; x <= 3; ++x)
      for (int y = -3; y <= 3; ++y)
        for (int z = -3; z <= 3; ++z)
          nearest = std::min(nearest, (state.cell.edges * (fraction + Vector(x, y, z))).norm());
    return nearest;
  }

  std::vector<Pair> list_near_pairs(const RevState &state, const double skin)
  {
    std::vector<Pair> pairs;
    for (std::uint32_t i = 0; i < state.grains.size(); ++i)
      for (std::uint32_t j = i + 1; j < state.grains.size(); ++j)
        if (compute_distance(state, i, j) < state.grains.place[i].w + state.grains.place[j].w + skin)
          pairs.emplace_back(i, j);
    return pairs;
  }

  std::vector<Pair> list_pairs(const ContactNetwork &network)
  {
    std::vector<Pair> pairs;
    for (std::size_t k = 0; k < network.size(); ++k)
      if (network.is_pair(k))
        pairs.emplace_back(network.a[k], network.b[k]);
    return pairs;
  }

  TEST(ContactNetwork, HoldsEveryNearPairOnceInOrder)
  {
    // Law: the pairs whose nearest images are closer than both radii and the skin, first those that touch, then those
    // apart by less than 0.07 of the skin, then the others, each sorted; upright and leaning cells, with many boxes a
    // side and with fewer than three.
    const double skin = 0.2 * radius;
    for (const double edge : {6.2, 8., 14.})
      for (const double lean : {0., 0.3, 0.7})
        {
          const RevState state = scatter(80, edge, lean, 7);
          if (!is_wide_enough(state.cell, compute_reach(state.grains, skin)))
            continue;
          auto expected = list_near_pairs(state, skin);
          ASSERT_GT(expected.size(), 20u);
          const auto touching = list_near_pairs(state, 0.), close = list_near_pairs(state, 0.07 * skin);
          for (const auto &first : {close, touching})
            std::stable_partition(expected.begin(), expected.end(), [&](const Pair &pair) {
              return std::binary_search(first.begin(), first.end(), pair);
            });
          EXPECT_EQ(list_pairs(build_contact_network(state, skin)), expected) << edge << " " << lean;
        }
  }

  TEST(ContactNetwork, RefusesCellsInWhichAPairCouldTouchTwice)
  {
    // Law: through one image only means a cell wider than two reaches, of the narrowest width and not of the edges.
    RevState state = scatter(2, 5., 0., 1);
    const double reach = compute_narrowest_width(state.cell) / 2.;
    EXPECT_TRUE(is_wide_enough(state.cell, 0.999 * reach));
    EXPECT_FALSE(is_wide_enough(state.cell, 1.001 * reach));
    state.cell.edges(0, 1) = state.cell.edges(1, 1); // leans by 45 degrees
    EXPECT_FALSE(is_wide_enough(state.cell, 0.999 * reach));
  }

  TEST(ContactNetwork, KeepsMemoriesWhicheverGrainIsNamedFirst)
  {
    // Law: t acts on a; the same contact named b before a carries -t. Pairs without memory are apart.
    RevState state = scatter(60, 7., 0.2, 3);
    const auto pairs = list_near_pairs(state, 0.);
    ASSERT_GT(pairs.size(), 20u);
    for (std::size_t k = 0; k < pairs.size(); k += 2)
      {
        const auto [a, b] = pairs[k];
        const Vector t(double(k) + 1., -2. * double(k), 0.5);
        state.add(k % 4 == 0 ? ContactMemory{a, b, t, k % 8 == 0} : ContactMemory{b, a, -t, k % 8 == 0});
      }
    std::reverse(state.contacts.begin(), state.contacts.end());

    const auto memories = collect_memories(build_contact_network(state, 0.1 * radius));
    ASSERT_EQ(memories.size(), state.contacts.size());
    for (std::size_t i = 0; i < memories.size(); ++i)
      {
        const double k = 2. * static_cast<double>(i);
        EXPECT_EQ(Pair(memories[i].a, memories[i].b), pairs[2 * i]);
        EXPECT_EQ(memories[i].shear_force, Vector(k + 1., -2. * k, 0.5));
        EXPECT_EQ(memories[i].is_sliding, i % 4 == 0);
      }
  }

  TEST(ContactNetwork, BuiltAgainFromItsOwnMemoriesIsTheSame)
  {
    // Law: collecting and building are inverse to each other, on a packing under load with real shear forces.
    RevState state = get_loaded_state();
    ASSERT_GT(state.contacts.size(), n_grains);
    expect_same_memories(collect_memories(build_contact_network(state, 0.3 * radius)), state.contacts);
  }

  TEST(ContactNetwork, NoPairIsMissedBeforeASkinIsUsedUp)
  {
    // Law: pairs outside the network do not touch as long as no grain has used up its own skin, whatever the grains and
    // the cell have done. Exact: the bound holds without tolerance.
    std::mt19937_64 random(5);
    std::normal_distribution<double> normal;
    std::uniform_real_distribution<double> size(0.05, 0.4);
    std::size_t n_valid = 0;
    for (int trial = 0; trial < 60; ++trial)
      {
        RevState state = scatter(40, 9., 0.2, static_cast<std::uint64_t>(trial));
        std::vector<double> skins;
        for (std::size_t i = 0; i < state.grains.size(); ++i)
          skins.push_back(size(random) * radius);
        Team alone(1);
        ContactNetwork network;
        NetworkBuilder().build(state, skins, alone, network);
        auto known = list_pairs(network);
        std::sort(known.begin(), known.end());
        const double step = 0.004 * (trial % 5) / radius; // [fractions], of a skin as large as a radius
        for (std::size_t i = 0; i < skins.size(); ++i)
          {
            Row &place = state.grains.place[i];
            place = {place.x + step * skins[i] * normal(random), place.y + step * skins[i] * normal(random), place.z,
                     place.w};
          }
        const Matrix strain = 0.004 * (trial % 3) * Matrix::NullaryExpr([&] { return normal(random); });
        state.cell.deform(Matrix::Identity() + strain);
        const SkinUse use = compute_skin_use(network, state.cell, state.grains, 0, skins.size());
        EXPECT_EQ(use.share > 1., use.rest < 0.);
        if (use.share >= 1.)
          continue;
        n_valid += trial % 15 != 0; // something has moved
        for (const Pair &pair : list_near_pairs(state, 0.))
          EXPECT_TRUE(std::binary_search(known.begin(), known.end(), pair));
      }
    EXPECT_GT(n_valid, 10u);
  }

  TEST(ContactNetwork, TheSkinChangesNoResult)
  {
    // Law: the skin decides when pairs are looked up, not what they do. Tolerance: which pairs touch when a network is
    // built decides the order of sums, and their last bits; these grow some 400 times in 100 cycles of this strain, to
    // 4e-11 in 300. A pair that is looked up too late is worth its force, 1e-4.
    const ContactLaw law = make_contact_law(GrainMaterial{});
    const Matrix increment = Vector(0., 0., -1e-5).asDiagonal();
    std::vector<Matrix> stresses;
    for (const double share : {0.2, 0.02, 0.01})
      {
        RevState state = get_packing().state;
        DynamicsRule rule;
        rule.skin_share = share;
        Dynamics dynamics(state, law, rule);
        const Matrix first = dynamics.get_network().edges_when_built;
        for (int cycle = 0; cycle < 300; ++cycle)
          {
            dynamics.compute_forces();
            dynamics.move();
            dynamics.strain(increment);
          }
        EXPECT_EQ(dynamics.get_network().edges_when_built == first, share == 0.2); // a new network, or none yet
        dynamics.compute_forces();
        stresses.push_back(dynamics.compute_stress());
      }
    for (const Matrix &other : {stresses[1], stresses[2]})
      EXPECT_LT((other - stresses[0]).norm(), 1e-8 * stresses[0].norm());
  }
} // namespace

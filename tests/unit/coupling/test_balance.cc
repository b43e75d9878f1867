// Law: migration makes the busiest rank less busy, to within the tolerance where the REVs allow it, with each REV moved
// once.

#include "coupling/balance.h"

#include <gtest/gtest.h>

#include <numeric>

namespace
{
  using coupling::Move;

  std::vector<unsigned int> carry_out(std::vector<unsigned int> owners, const std::vector<Move> &moves)
  {
    for (const Move &move : moves)
      {
        EXPECT_EQ(owners[move.rev], move.from) << "REV " << move.rev << " is moved twice, or was never there";
        owners[move.rev] = move.to;
      }
    return owners;
  }
} // namespace

TEST(Balance, EqualRevsAreSharedOutEvenly)
{
  const std::vector<unsigned int> owners(12, 0); // all on the first rank
  const std::vector<double> costs(12, 2.);
  const auto moves = coupling::plan_migration(owners, costs, 4, 0.01);
  EXPECT_EQ(moves.size(), 9);
  EXPECT_EQ(coupling::compute_loads(carry_out(owners, moves), costs, 4), std::vector<double>(4, 6.));
}

TEST(Balance, WhatIsWithinTheToleranceStays)
{
  const std::vector<unsigned int> owners = {0, 1, 0, 1};
  const std::vector<double> costs = {1., 1., 1.08, 1.};
  EXPECT_TRUE(coupling::plan_migration(owners, costs, 2, 0.05).empty());
  EXPECT_TRUE(coupling::plan_migration(owners, std::vector<double>(4, 0.), 2, 0.).empty());
}

TEST(Balance, ARevThatIsMoreThanAllOthersStaysAlone)
{
  const std::vector<unsigned int> owners = {0, 0, 0, 1};
  const std::vector<double> costs = {10., 1., 1., 1.};
  const auto after = carry_out(owners, coupling::plan_migration(owners, costs, 2, 0.01));
  // Moving it would only change who waits; the small ones leave it.
  EXPECT_EQ(coupling::compute_loads(after, costs, 2), (std::vector<double>{10., 3.}));
}

TEST(Balance, ManyUnequalRevsEndWithinTheTolerance)
{
  constexpr unsigned int n_ranks = 16;
  std::vector<unsigned int> owners;
  std::vector<double> costs;
  for (unsigned int i = 0; i < 640; ++i)
    {
      owners.push_back(i * i % n_ranks); // uneven
      costs.push_back(1. + (i * 7919u) % 101u / 10.);
    }
  const double before = coupling::compute_imbalance(coupling::compute_loads(owners, costs, n_ranks));
  const auto after = carry_out(owners, coupling::plan_migration(owners, costs, n_ranks, 0.02));
  EXPECT_GT(before, 1.);
  EXPECT_LE(coupling::compute_imbalance(coupling::compute_loads(after, costs, n_ranks)), 0.02);
}

// Law: a REV that moves brings its state and stays; cost says where a REV lives and nothing else. Costs are those of a
// clock of the tests' own: how long anything takes on this machine decides nothing here.

#include "tests/unit/coupling/counting_revs.h"

#include <algorithm>

namespace
{
  using namespace counting_revs;

  constexpr int n_rounds = 4;

  void expect_counts(CountingRevs &revs, const bool has_steps)
  {
    for (int round = 1; round <= n_rounds; ++round)
      {
        const auto answers = revs.ask();
        if (has_steps)
          revs.get_pool().close_step();
        for (PointId id = 0; id < CountingRevs::n_revs; ++id)
          {
            EXPECT_EQ(answers[2 * id], id);
            EXPECT_EQ(answers[2 * id + 1], round) << "REV " << id << " has lost its state or was asked twice";
          }
        EXPECT_EQ(revs.count_present(), CountingRevs::n_revs);
      }
  }
} // namespace

TEST(MovingRevs, RevsThatAreTakenOverBringTheirStateAndStay)
{
  for (const unsigned int n_threads : {1u, 2u})
    {
      CountingRevs revs({true, 0., 1e9}, n_threads);
      revs.wait_for_a_departure();
      expect_counts(revs, false);
      const coupling::WorkTally &tally = revs.get_pool().get_tally();
      if (revs.get_pool().get_n_ranks() == 1)
        EXPECT_EQ(tally.n_taken, 0);
      else
        EXPECT_GT(tally.n_taken, 0);
      EXPECT_EQ(tally.n_migrated, 0); // the tolerance forbids it
    }
}

TEST(MovingRevs, RevsMigrateBetweenStepsUntilTheirCostsBalance)
{
  CountingRevs revs({true, 1e9, 0.1}, 1); // too dear a limit to be taken over in mid-phase
  expect_counts(revs, true);
  const RevPool &pool = revs.get_pool();
  EXPECT_EQ(pool.get_tally().n_taken, 0);
  if (pool.get_n_ranks() == 1)
    return;
  EXPECT_GT(pool.get_tally().n_migrated, 0);
  std::vector<unsigned int> owners;
  for (const PointId id : pool.get_points())
    owners.push_back(pool.get_owner(id));
  const auto loads = coupling::compute_loads(owners, pool.get_step_costs(), pool.get_n_ranks());
  // Migration ends within the tolerance, or where one more dear REV would only change the busiest rank's name.
  const auto [least, most] = std::minmax_element(loads.begin(), loads.end());
  EXPECT_TRUE(coupling::compute_imbalance(loads) <= 0.1 || *most - *least <= dear) << *least << " to " << *most;
}

TEST(MovingRevs, RevsStayWhereTheyWereDealtToIfTheyMayNotMove)
{
  CountingRevs revs({false, 0., 0.}, 1);
  expect_counts(revs, true);
  for (const PointId id : revs.get_pool().get_points())
    EXPECT_EQ(revs.get_pool().get_owner(id), id % revs.get_pool().get_n_ranks());
}

TEST(MovingRevs, TallyIsThatOfTheWork)
{
  CountingRevs revs({false, 0., 0.}, 1);
  revs.ask();
  const coupling::WorkTally &tally = revs.get_pool().get_tally();
  const unsigned int n_ranks = revs.get_pool().get_n_ranks();
  ASSERT_EQ(tally.work_s.size(), n_ranks);
  const double n_each = static_cast<double>(CountingRevs::n_revs) / n_ranks;
  const double rounding = 1e-12; // sums of some ten numbers below one
  EXPECT_NEAR(tally.longest_s, n_each * dear, rounding);
  EXPECT_NEAR(tally.idle_s[0], 0., rounding);
  for (unsigned int rank = 0; rank < n_ranks; ++rank)
    {
      EXPECT_NEAR(tally.work_s[rank], n_each * (rank == 0 ? dear : cheap), rounding);
      EXPECT_NEAR(tally.work_s[rank] + tally.idle_s[rank], n_each * dear, rounding);
    }
  EXPECT_NEAR(tally.compute_efficiency(), (dear + (n_ranks - 1) * cheap) / (n_ranks * dear), rounding);
}

namespace
{
  /** What all ranks are told. */
  std::string get_failure(CountingRevs &revs)
  {
    try
      {
        revs.ask();
        revs.get_pool().close_step();
      }
    catch (const std::runtime_error &error)
      {
        return error.what();
      }
    return "";
  }

  // Whether REVs are taken over in mid-phase or migrate between steps.
  constexpr coupling::BalanceRule taking_over{true, 0., 1e9}, migrating{true, 1e9, 0.1};
} // namespace

TEST(MovingRevs, OneThatCannotLeaveEndsTheJobOnAllRanks)
{
  if (dealii::Utilities::MPI::n_mpi_processes(MPI_COMM_WORLD) == 1)
    GTEST_SKIP() << "nothing moves on one rank";
  for (const coupling::BalanceRule &rule : {taking_over, migrating})
    {
      CountingRevs revs(rule, 1);
      if (rule.smallest_cost == 0.) // else nobody leaves before the step is closed
        revs.wait_for_a_departure();
      if (revs.get_pool().get_rank() == 0)
        revs.fail_once_in_packing();
      const std::string failure = get_failure(revs);
      EXPECT_NE(failure.find("the REV of point "), std::string::npos) << failure;
      EXPECT_NE(failure.find(" cannot leave rank 0: it is too heavy"), std::string::npos) << failure;
    }
}

TEST(MovingRevs, OneThatDoesNotArriveWholeEndsTheJobOnAllRanks)
{
  if (dealii::Utilities::MPI::n_mpi_processes(MPI_COMM_WORLD) == 1)
    GTEST_SKIP() << "nothing moves on one rank";
  for (const coupling::BalanceRule &rule : {taking_over, migrating})
    {
      CountingRevs revs(rule, 1);
      if (rule.smallest_cost == 0.) // else nobody leaves before the step is closed
        revs.wait_for_a_departure();
      revs.fail_once_in_unpacking(); // on whatever rank
      const std::string failure = get_failure(revs);
      EXPECT_NE(failure.find("the REV of point "), std::string::npos) << failure;
      EXPECT_NE(failure.find(": it has lost a grain"), std::string::npos) << failure;
    }
}

// Law: an answer is that of its own question, wherever it was found: any number of ranks, threads, any order of asking,
// REVs moving or not; a REV that moves brings its state and stays; cost says where a REV lives and nothing else.

#include "coupling/cpu_clock.h"
#include "coupling/rev_pool.h"

#include <gtest/gtest.h>

#include <numeric>
#include <stdexcept>

namespace
{
  using coupling::PointId;
  using coupling::RevPool;

  const std::vector<PointId> points = {40, 7, 12, 3, 99, 20, 1};

  void respond(const PointId id, std::span<const double> question, std::span<double> answer)
  {
    answer[0] = id;
    answer[1] = question[0] / 3. + id;
  }

  /** Asks in the given order and looks whether each answer belongs to its question. */
  void expect_own_answers(RevPool &pool, const std::vector<PointId> &ids)
  {
    RevPool::Questions questions{ids, {}, 1};
    for (const PointId id : ids)
      questions.rows.push_back(1. / (1. + id));
    const auto answers = pool.ask(questions, 2, respond);
    ASSERT_EQ(answers.size(), 2 * ids.size());
    for (std::size_t i = 0; i < ids.size(); ++i)
      {
        EXPECT_EQ(answers[2 * i], ids[i]);
        EXPECT_EQ(answers[2 * i + 1], 1. / (1. + ids[i]) / 3. + ids[i]); // the same bits
      }
  }
} // namespace

TEST(RevPool, AnswersThoseWhoAllAskTheSame)
{
  for (const unsigned int n_threads : {1u, 3u})
    {
      RevPool pool(MPI_COMM_WORLD, true, n_threads);
      pool.set_points(points);
      expect_own_answers(pool, points);
      expect_own_answers(pool, {12, 99});
    }
}

namespace
{
  /** REVs that count what they were asked, and take their time if they were dealt to the first rank. */
  class CountingRevs
  {
  public:
    CountingRevs(const coupling::BalanceRule &rule, const unsigned int n_threads, const double milliseconds)
        : pool_(MPI_COMM_WORLD, true, n_threads, rule), milliseconds_(milliseconds)
    {
      pool_.set_travel({[this](const PointId id) {
                          std::vector<std::byte> bytes(1 + 7 * id); // of different lengths
                          bytes[0] = static_cast<std::byte>(counts_.at(id));
                          counts_.at(id) = absent;
                          return bytes;
                        },
                        [this](const PointId id, const std::vector<std::byte> &bytes) {
                          EXPECT_EQ(bytes.size(), 1 + 7 * id);
                          EXPECT_EQ(counts_.at(id), absent);
                          counts_.at(id) = static_cast<int>(bytes.at(0));
                        }});
      for (PointId id = 0; id < n_revs; ++id)
        counts_[id] = absent;
      std::vector<PointId> ids(n_revs);
      std::iota(ids.begin(), ids.end(), 0);
      pool_.set_points(ids);
      for (const PointId id : pool_.get_local_points())
        counts_[id] = 0;
    }

    std::vector<double> ask()
    {
      return pool_.ask_all(coupling::WorkKind::evaluate, 2, [&](const PointId id, std::span<double> row) {
        work(id % pool_.get_n_ranks() == 0 ? milliseconds_ : 0.01 * milliseconds_);
        row[0] = id;
        row[1] = ++counts_.at(id);
      });
    }

    RevPool &get_pool() { return pool_; }

    /** How many of them are where the pool says they are. */
    unsigned int count_present()
    {
      unsigned int n = 0;
      for (const PointId id : pool_.get_local_points())
        n += counts_.at(id) != absent ? 1 : 0;
      return dealii::Utilities::MPI::sum(n, MPI_COMM_WORLD);
    }

    static constexpr PointId n_revs = 24;

  private:
    static void work(const double milliseconds) // uses the processor, since that is what is measured
    {
      for (const double start = coupling::measure_thread_seconds();
           coupling::measure_thread_seconds() - start < 1e-3 * milliseconds;)
        ;
    }

    static constexpr int absent = -1;
    RevPool pool_;
    double milliseconds_;
    std::map<PointId, int> counts_;
  };

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

TEST(RevPool, RevsThatAreTakenOverBringTheirStateAndStay)
{
  for (const unsigned int n_threads : {1u, 2u})
    {
      CountingRevs revs({true, 1e-6, 1e9}, n_threads, 10.);
      expect_counts(revs, false);
      const coupling::WorkTally &tally = revs.get_pool().get_tally();
      if (revs.get_pool().get_n_ranks() == 1)
        EXPECT_EQ(tally.n_taken, 0);
      else // nothing makes up for one rank's costing a hundred times the others' but taking over
        EXPECT_GT(tally.n_taken, 0);
      EXPECT_EQ(tally.n_migrated, 0); // the tolerance forbids it
    }
}

TEST(RevPool, RevsMigrateBetweenStepsUntilTheirCostsBalance)
{
  CountingRevs revs({true, 1e9, 0.1}, 1, 10.); // too dear a limit to be taken over in mid-phase
  expect_counts(revs, true);
  const RevPool &pool = revs.get_pool();
  EXPECT_EQ(pool.get_tally().n_taken, 0);
  if (pool.get_n_ranks() == 1)
    return;
  EXPECT_GT(pool.get_tally().n_migrated, 0);
  std::vector<unsigned int> owners;
  for (const PointId id : pool.get_points())
    owners.push_back(pool.get_owner(id));
  // Twelve REVs of 10 ms (eight, on three ranks) can be shared out within one of them, and migration stops at a tenth.
  const auto loads = coupling::compute_loads(owners, pool.get_step_costs(), pool.get_n_ranks());
  EXPECT_LT(coupling::compute_imbalance(loads), 0.2);
}

TEST(RevPool, RevsStayWhereTheyWereDealtToIfTheyMayNotMove)
{
  CountingRevs revs({false, 0., 0.}, 1, 2.);
  expect_counts(revs, true);
  for (const PointId id : revs.get_pool().get_points())
    EXPECT_EQ(revs.get_pool().get_owner(id), id % revs.get_pool().get_n_ranks());
}

TEST(RevPool, TallyIsThatOfTheWork)
{
  CountingRevs revs({false, 0., 0.}, 1, 10.);
  revs.ask();
  const coupling::WorkTally &tally = revs.get_pool().get_tally();
  const unsigned int n_ranks = revs.get_pool().get_n_ranks();
  const double n_dear = CountingRevs::n_revs / n_ranks, expected = n_dear * 10e-3;
  EXPECT_NEAR(tally.longest_s, expected, 0.2 * expected); // the threads' own time comes on top
  EXPECT_EQ(tally.work_s.size(), n_ranks);
  EXPECT_NEAR(tally.compute_efficiency(), n_ranks == 1 ? 1. : 1. / n_ranks, 0.1);
  EXPECT_NEAR(tally.idle_s[0], 0., 1e-12);
}

TEST(RevPool, AnswersEachRankForItsPart)
{
  RevPool pool(MPI_COMM_WORLD, false, 1);
  std::vector<PointId> mine;
  for (std::size_t i = 0; i < points.size(); ++i)
    if ((points.size() - i) / 2 % pool.get_n_ranks() == pool.get_rank())
      mine.push_back(points[i]);
  pool.set_points(mine);
  EXPECT_EQ(pool.get_points(), (std::vector<PointId>{1, 3, 7, 12, 20, 40, 99}));
  expect_own_answers(pool, mine);
}

TEST(RevPool, EachPointLivesOnOneRank)
{
  RevPool pool(MPI_COMM_WORLD, true, 1);
  pool.set_points(points);
  const unsigned int n_here = pool.get_local_points().size();
  EXPECT_EQ(dealii::Utilities::MPI::sum(n_here, MPI_COMM_WORLD), points.size());
  const auto rows = pool.collect(1, [](const PointId id, std::span<double> row) { row[0] = id; });
  EXPECT_EQ(rows, (std::vector<double>{1., 3., 7., 12., 20., 40., 99.}));
}

TEST(RevPool, WhatOneRankThrowsAllThrow)
{
  RevPool pool(MPI_COMM_WORLD, true, 2);
  pool.set_points(points);
  const auto work = [](const PointId id) {
    if (id == 20)
      throw std::runtime_error("point 20 has no grains");
  };
  try
    {
      pool.for_each_local(work);
      FAIL() << "nothing was thrown";
    }
  catch (const std::runtime_error &error)
    {
      EXPECT_STREQ(error.what(), "point 20 has no grains");
    }
}

// Law: an answer is that of its own question, wherever it was found: any number of ranks, threads, any order of asking.

#include "coupling/rev_pool.h"

#include <gtest/gtest.h>

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

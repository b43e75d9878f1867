#include "dem/contact_search.h"

#include "dem/contact_network.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

namespace
{
  using namespace dem;

  /** Grains thrown into a leaning cell, as many of each class of size, down to largest / size_ratio. */
  struct Scatter
  {
    Cell cell;
    std::vector<Row> place;
    double largest = 1e-4; ///< [m]

    /** @param edge  of the cell [largest radii]; @param lean  of its edges, as a share of their length */
    Scatter(const std::size_t n, const double size_ratio, const double edge, const double lean,
            const std::uint64_t seed = 1)
    {
      std::mt19937_64 random(seed);
      std::uniform_real_distribution<double> fraction(-1., 2.), size(0., std::log(size_ratio)); // also other images
      for (std::size_t i = 0; i < n; ++i)
        place.push_back({fraction(random), fraction(random), fraction(random), largest * std::exp(-size(random))});
      if (n > 1)
        place[n / 2].w = largest / size_ratio;
      cell.edges << 1., lean, -lean, 0., 1.1, lean, 0., 0., 0.9;
      cell.edges *= edge * largest;
    }

    bool is_valid(const double skin) const { return is_wide_enough(cell, 2. * largest + skin); }
  };

  std::vector<NearPair> list_by_force(const Cell &cell, const std::vector<Row> &place, const double skin)
  {
    std::vector<NearPair> pairs;
    for (std::uint32_t a = 0; a < place.size(); ++a)
      for (std::uint32_t b = a + 1; b < place.size(); ++b)
        {
          const double reach = place[a].w + place[b].w + skin;
          if (compute_branch(cell, place[a], place[b]).squaredNorm() < reach * reach)
            pairs.push_back({a, b});
        }
    return pairs;
  }

  TEST(ContactSearch, FindsWhatBruteForceFinds)
  {
    // Law: the pairs that a loop over all of them finds, each once, by (a, b): for every ratio of sizes, upright and
    // leaning cells, few boxes and many. Exact: the criterion is the same to the last bit.
    ContactSearch search; // one for all: what it remembers must not matter
    std::size_t n_tried = 0;
    for (const double size_ratio : {1., 3., 20., 100.})
      for (const double edge : {4.6, 6.2, 9., 25.})
        for (const double lean : {0., 0.3, 0.7})
          for (const double skin_share : {0., 0.05, 0.3})
            {
              const Scatter grains(700, size_ratio, edge, lean, 7);
              const double skin = skin_share * grains.largest;
              if (!grains.is_valid(skin))
                continue;
              ++n_tried;
              const auto expected = list_by_force(grains.cell, grains.place, skin);
              ASSERT_GT(expected.size(), 20u);
              EXPECT_EQ(search.list_near_pairs(grains.cell, grains.place, skin), expected)
                  << size_ratio << " " << edge << " " << lean << " " << skin_share;
            }
    EXPECT_GT(n_tried, 80u);
  }

  TEST(ContactSearch, FindsWhatBruteForceFindsAmongFewGrains)
  {
    // Law: as among many; none and one make no pair. Two grains across a face are one. Exact.
    for (std::size_t n = 0; n < 12; ++n)
      for (std::uint64_t seed = 0; seed < 40; ++seed)
        {
          const Scatter grains(n, seed % 2 ? 1. : 50., 4.5, 0.1, seed);
          ASSERT_TRUE(grains.is_valid(0.));
          EXPECT_EQ(list_near_pairs(grains.cell, grains.place, 0.), list_by_force(grains.cell, grains.place, 0.));
        }
    Scatter grains(2, 1., 5., 0.);
    grains.place[0] = {0.01, 0.5, 0.99, grains.largest};
    grains.place[1] = {0.99, 0.5, 3.01, grains.largest};
    EXPECT_EQ(list_near_pairs(grains.cell, grains.place, 0.), (std::vector<NearPair>{{0, 1}}));
  }

  TEST(ContactSearch, SharesBoxesAndGrainsWithoutChangingAPair)
  {
    // Law: the list does not depend on the size of the team, nor on what teams of other sizes have left; one that is
    // larger than the number of grains has nothing to do for some. Exact.
    ContactSearch search;
    for (const std::size_t n : {2, 700})
      for (const double size_ratio : {1., 20.})
        {
          const Scatter grains(n, size_ratio, 6.2, 0.3, 3);
          const auto expected = list_by_force(grains.cell, grains.place, 0.);
          for (const std::size_t n_threads : {1, 4, 2, 3})
            {
              Team team(n_threads);
              EXPECT_EQ(search.list_near_pairs(grains.cell, grains.place, 0., team), expected) << n_threads;
              const auto &first = search.get_first_pairs();
              for (std::uint32_t a = 0; a < n; ++a)
                for (std::uint32_t i = first[a]; i < first[a + 1]; ++i)
                  ASSERT_EQ(expected[i].a, a);
              EXPECT_EQ(first[n], expected.size());
            }
        }
  }

  TEST(ContactSearch, DrawsTheLineInDoublePrecision)
  {
    // Law: a pair counts when strictly closer than radii and skin; 1e-14 of the cell on either side decide, far below
    // the single precision of the first look, and a cell a hair wider than two reaches gives no pair twice.
    Scatter grains(2, 1., 4. * (1. + 1e-9), 0.);
    grains.cell.edges = 4. * (1. + 1e-9) * grains.largest * Matrix::Identity();
    const double reach = 2. * grains.largest, edge = grains.cell.edges(0, 0);
    for (const double sign : {-1., 1.})
      {
        grains.place[0] = {0.25, 0.7, 0.1, grains.largest};
        grains.place[1] = {0.25 + reach / edge + sign * 1e-14, 0.7, 0.1, grains.largest};
        EXPECT_EQ(list_near_pairs(grains.cell, grains.place, 0.).size(), sign < 0. ? 1u : 0u);
      }
  }

  TEST(ContactSearch, OutlivesWhatIsNotANumber)
  {
    // Law: a grain without a place is near nobody, and the others are found as if it were not there. Exact.
    Scatter grains(200, 10., 6., 0.2);
    const auto invalid = std::numeric_limits<double>::quiet_NaN(), endless = std::numeric_limits<double>::infinity();
    grains.place[17].x = invalid;
    grains.place[18].y = -endless;
    grains.place[19].w = invalid;
    const auto pairs = list_near_pairs(grains.cell, grains.place, 0.);
    EXPECT_GT(pairs.size(), 20u);
    EXPECT_EQ(pairs, list_by_force(grains.cell, grains.place, 0.));
  }
} // namespace

#include "dem/spatial_order.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <random>
#include <set>

namespace
{
  using namespace dem;

  /** Places in a cube of edge 1 and in its images. */
  std::vector<Row> scatter(const std::size_t n)
  {
    std::mt19937_64 random(1);
    std::uniform_real_distribution<double> fraction(-1., 2.);
    std::vector<Row> place(n);
    for (Row &row : place)
      row = {fraction(random), fraction(random), fraction(random), 0.01};
    return place;
  }

  TEST(SpatialOrder, HoldsEveryGrainOnceAndIsAlwaysTheSame)
  {
    // Law: a permutation that depends on the places alone; grains in one place stay in their order.
    auto place = scatter(5000);
    for (std::size_t i = 100; i < 120; ++i)
      place[i] = place[99];
    const auto order = compute_spatial_order(Cell(), place);
    EXPECT_EQ(order, compute_spatial_order(Cell(), place));
    EXPECT_EQ(std::set<std::uint32_t>(order.begin(), order.end()).size(), 5000u);
    EXPECT_LT(*std::max_element(order.begin(), order.end()), 5000u);
    const auto first = std::find(order.begin(), order.end(), 99u);
    for (std::uint32_t i = 0; i <= 20; ++i)
      EXPECT_EQ(*(first + i), 99u + i);
  }

  TEST(SpatialOrder, NextInOrderIsNearInSpace)
  {
    // Law: the curve fills the cell step by step, from one eighth only into one that shares a face with it. Of n
    // scattered grains neighbours are some n^-1/3 of the cell apart, strangers half of it; twice that spacing is
    // allowed on average (1.04 measured), a quarter of the cell for any step (0.17 measured).
    const std::size_t n = 8000;
    const auto place = scatter(n);
    const auto order = compute_spatial_order(Cell(), place);
    double sum = 0., largest = 0.;
    for (std::size_t i = 1; i < n; ++i)
      {
        Vector step = to_vector(place[order[i]]) - to_vector(place[order[i - 1]]);
        for (double &component : step)
          component -= std::floor(component + 0.5);
        sum += step.norm();
        largest = std::max(largest, step.norm());
      }
    EXPECT_LT(sum / static_cast<double>(n), 2. * std::cbrt(1. / static_cast<double>(n)));
    EXPECT_LT(largest, 0.25);
  }

  /** Which of the cubes that n halvings of the cell make a place lies in. */
  std::array<int, 3> find_cube(const Row &place, const int n)
  {
    const auto locate = [n](const double fraction) {
      return static_cast<int>(std::ldexp(fraction - std::floor(fraction), n));
    };
    return {locate(place.x), locate(place.y), locate(place.z)};
  }

  TEST(SpatialOrder, FillsEachCubeBeforeItGoesOnToItsNeighbour)
  {
    // Law: the curve leaves a cube for good once its grains have come, five halvings deep, whatever number is left over
    // from whole vectors; and where no cube is empty, it goes on through a face. Exact.
    for (const std::size_t n : {1, 63, 64, 65, 5000})
      for (int depth = 1; depth <= 5; ++depth)
        {
          const auto place = scatter(n);
          const auto order = compute_spatial_order(Cell(), place);
          std::set<std::array<int, 3>> seen;
          std::size_t n_runs = 0, n_steps = 0;
          auto before = find_cube(place[order[0]], depth);
          for (const std::uint32_t i : order)
            {
              const auto here = find_cube(place[i], depth);
              n_runs += seen.empty() || here != before;
              for (int k = 0; k < 3; ++k)
                n_steps += static_cast<std::size_t>(std::abs(here[k] - before[k]));
              seen.insert(before = here);
            }
          EXPECT_EQ(n_runs, seen.size()) << n << " " << depth;
          if (seen.size() == std::size_t(1) << (3 * depth))
            {
              EXPECT_EQ(n_steps, n_runs - 1) << n << " " << depth;
            }
        }
  }

  TEST(SpatialOrder, OutlivesWhatIsNotANumber)
  {
    // Law: a permutation even then; a wrapped fraction that rounding makes 1 is within the cell.
    auto place = scatter(3);
    place[0].x = std::numeric_limits<double>::quiet_NaN();
    place[1].y = std::numeric_limits<double>::infinity();
    place[2].z = -1e-18;
    auto order = compute_spatial_order(Cell(), place);
    std::sort(order.begin(), order.end());
    EXPECT_EQ(order, (std::vector<std::uint32_t>{0, 1, 2}));
  }
} // namespace

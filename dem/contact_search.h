#pragma once

#include "dem/cell.h"

#include <array>
#include <cstdint>
#include <vector>

namespace dem
{
  /** Two grains by their places in storage, a < b. */
  struct NearPair
  {
    std::uint32_t a, b;

    bool operator==(const NearPair &) const = default;
  };

  /**
   * Finds the pairs of grains that are near each other, at a cost per grain that does not depend on the ratio of the
   * largest to the smallest.
   *
   * Grains are sorted into levels by size, each with a grid of boxes made for its own largest grain. A pair is looked
   * for from the box of the smaller grain, in its own level and in those above: a small grain sees few large ones, and
   * a large one never has to look through boxes full of dust. Distances are taken in single precision with a margin
   * that covers its rounding; who falls within the margin is asked again in double.
   *
   * Keeps its memory from one call to the next; the result depends on the arguments alone.
   */
  class ContactSearch
  {
  public:
    /**
     * All pairs with |edges (d - rint(d))| < Ra + Rb + skin, sorted by (a, b); d is the difference of their places.
     * Between walls nothing is found across them: |edges d| counts.
     *
     * @param place  x, y, z: fractions of the cell's edges, any image (between walls there is one); w: radius [m]
     * @param skin   [m]
     * @return valid until the next call. A grain whose place is not a number is in no pair.
     *
     * @pre the cell is wider than twice the largest reach, 2 max R + skin (is_wide_enough)
     */
    const std::vector<NearPair> &list_near_pairs(const Cell &cell, const std::vector<Row> &place, double skin);

    std::size_t count_bytes() const; ///< memory that it holds

  private:
    /** The grains of one class of size, as boxes numbered from first_box on, x fastest. */
    struct Level
    {
      double largest_radius = 0.; ///< [m]
      std::uint32_t n_grains = 0, first_box = 0;
      std::array<int, 3> n = {1, 1, 1}; ///< boxes along each edge

      std::uint32_t get_n_boxes() const { return static_cast<std::uint32_t>(n[0]) * n[1] * n[2]; }
    };

    /** Positions in boxes of the levels, or the candidates of one box: [m] from the cell's corner. */
    struct Spheres
    {
      std::vector<float> x, y, z, radius;
      std::vector<std::uint32_t> grain;

      void resize(std::size_t n);
    };

    /** One box whose grains look for partners. */
    struct Box
    {
      std::size_t level = 0;
      std::array<int, 3> at = {0, 0, 0};
      std::uint32_t begin = 0, end = 0; ///< its grains in sorted_
    };

    /** From the cell to one of its images [m]. */
    struct Shift
    {
      float x = 0.f, y = 0.f, z = 0.f;
    };

    void update_levels(const std::vector<Row> &place);
    void update_boxes();
    void sort_into_boxes(const std::vector<Row> &place);
    std::size_t find_level(double radius) const;
    std::uint32_t find_box(const Row &place) const;
    double wrap(double fraction) const;

    void search_from_level(std::size_t level, const std::vector<Row> &place);
    void collect_candidates(const Box &box, std::size_t level);
    void append_candidates(std::uint32_t begin, std::uint32_t end, const Shift &shift);
    std::size_t find_hits(std::uint32_t p, std::size_t begin);
    void test_candidates(const Box &box, bool is_own_level, const std::vector<Row> &place);
    bool is_near(const Row &a, const Row &b) const;
    void sort_pairs(std::size_t n_grains);

    Cell cell_;
    std::array<double, 3> per_length_ = {0., 0., 0.}; ///< fractions that a sphere of unit radius spans [1/m]
    double skin_ = 0., margin_ = 0.;                  ///< [m]

    std::vector<Level> levels_;              ///< largest grains first
    std::vector<double> smallest_;           ///< radius [m] below which a grain belongs to a later level
    std::vector<std::uint32_t> box_, start_; ///< of each grain; where each box begins in sorted_
    Spheres sorted_, candidates_;
    std::array<Shift, 27> shifts_; ///< to the image (i, j, k) at 13 + i + 3 j + 9 k
    std::size_t n_candidates_ = 0, n_found_ = 0;
    std::vector<float> excess_; ///< of each hit: squared distance less the square of that which counts [m2]
    std::vector<std::uint32_t> hits_, first_, later_;
    std::vector<NearPair> found_, pairs_;
  };

  /** The pairs that ContactSearch finds, for who asks once. @pre as there */
  std::vector<NearPair> list_near_pairs(const Cell &cell, const std::vector<Row> &place, double skin);
} // namespace dem

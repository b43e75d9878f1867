#pragma once

#include "dem/pair_seeker.h"
#include "dem/team.h"

namespace dem
{
  /**
   * Finds the pairs of grains that are near each other, at a cost per grain that does not depend on the ratio of the
   * largest to the smallest.
   *
   * Grains are sorted into levels by size, each with a grid of boxes made for its own largest grain. A pair is looked
   * for from the box of the smaller grain, in its own level and in those above: a small grain sees few large ones, and
   * a large one never has to look through boxes full of dust.
   *
   * The threads of a team share boxes, then grains. Keeps its memory from one call to the next; the result depends on
   * cell, places and skin alone.
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
    const std::vector<NearPair> &list_near_pairs(const Cell &cell, std::span<const Row> place, double skin, Team &team);

    /** The same by the calling thread alone. */
    const std::vector<NearPair> &list_near_pairs(const Cell &cell, std::span<const Row> place, double skin);

    /** Where the pairs of each first grain begin in the last list; one number more than grains. */
    const std::vector<std::uint32_t> &get_first_pairs() const { return first_; }

    std::size_t count_bytes() const; ///< memory that it holds

  private:
    /** A run of grains whose pairs one thread sorts. */
    struct Owner
    {
      std::uint32_t begin, end;   ///< grains
      std::size_t room, n, first; ///< its room in later_, how many pairs it has, their place in the list
    };

    void share_grains(std::size_t n_grains, std::size_t n_owners);
    void seek(std::span<const Row> place, Team &team);
    void sort_pairs(std::size_t number);
    void write_pairs(const Owner &owner);

    GrainBoxes boxes_;
    std::vector<PairSeeker> seekers_; ///< of each thread
    std::vector<Owner> owners_;
    std::vector<std::uint32_t> owner_ends_;
    std::vector<std::uint32_t> first_, count_, later_; ///< of each grain: where its pairs begin, how many, with whom
    std::vector<NearPair> pairs_;
  };

  /** The pairs that ContactSearch finds, for who asks once. @pre as there */
  std::vector<NearPair> list_near_pairs(const Cell &cell, std::span<const Row> place, double skin);
} // namespace dem

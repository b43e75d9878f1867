#pragma once

#include "dem/grain_boxes.h"

#include <span>

namespace dem
{
  /** Two grains by their places in storage, a < b. */
  struct NearPair
  {
    std::uint32_t a, b;

    bool operator==(const NearPair &) const = default;
  };

  /**
   * Looks for the partners of the grains of some boxes: one thread's part of a ContactSearch. Distances are taken in
   * single precision with a margin that covers its rounding; who falls within the margin is asked again in double.
   *
   * Keeps its memory from one call to the next.
   */
  class PairSeeker
  {
  public:
    /**
     * Finds the pairs that the grains of boxes `begin` to `end` look for, each some time and seldom twice.
     *
     * @param owners  first grains from which on a pair, by its first grain, goes to the next list
     */
    void seek(const GrainBoxes &boxes, std::span<const Row> place, std::uint32_t begin, std::uint32_t end,
              std::span<const std::uint32_t> owners);

    std::span<const NearPair> get_found(const std::size_t owner) const
    {
      return {lists_[owner].pairs.data(), lists_[owner].n};
    }

    std::size_t count_bytes() const; ///< memory that it holds

  private:
    /** One box whose grains look for partners. */
    struct Box
    {
      std::size_t level = 0;
      std::array<int, 3> at = {0, 0, 0};
      std::uint32_t begin = 0, end = 0; ///< its grains
    };

    /** Pairs that have been found, and room for more. */
    struct List
    {
      std::vector<NearPair> pairs;
      std::size_t n = 0;
    };

    void seek_from(const Box &box);
    void collect_candidates(const Box &box, std::size_t level);
    void append_candidates(std::uint32_t begin, std::uint32_t end, const Shift &shift);
    std::size_t find_hits(std::uint32_t p, std::size_t begin);
    void test_candidates(const Box &box, bool is_own_level);
    bool is_near(const Row &a, const Row &b) const;
    std::size_t find_owner(std::uint32_t grain) const;

    const GrainBoxes *boxes_ = nullptr;     // of the present call
    const Row *place_ = nullptr;            // likewise
    std::span<const std::uint32_t> owners_; // likewise
    Spheres candidates_;                    ///< of one box
    std::size_t n_candidates_ = 0;
    std::vector<float> excess_; ///< of each hit: squared distance less the square of that which counts [m2]
    std::vector<std::uint32_t> hits_;
    std::vector<List> lists_;
  };
} // namespace dem

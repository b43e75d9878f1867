#pragma once

#include <array>
#include <cstdint>

namespace dem
{
  /** What a random number is for: two purposes never share a stream. */
  enum class Purpose : std::uint64_t
  {
    diameter,
    position,
    strength,
    crack,
    sibling_spin,
    shuffle,
    test
  };

  /** Whose random number it is. */
  struct StreamKey
  {
    std::uint64_t seed = 1;
    std::uint64_t rev = 0;
    std::uint64_t grain = 0;
    Purpose purpose = Purpose::test;
  };

  /**
   * Random numbers that are a function of their key and their place in the stream (Philox 4x64): no result depends on
   * the order in which grains, REVs, ranks or threads ask, nor on a restart.
   */
  class RandomStream
  {
  public:
    explicit RandomStream(const StreamKey &key);

    /** Uniform in the open interval (0, 1). */
    double draw_uniform();

    /** Standard normal. */
    double draw_normal();

    /** Standard normal, redrawn until its size is at most `bound`. @pre bound > 0 */
    double draw_truncated_normal(double bound);

  private:
    std::array<std::uint64_t, 2> key_;
    std::array<std::uint64_t, 4> counter_;
    std::array<std::uint64_t, 4> block_;
    unsigned int n_used_;
  };
} // namespace dem

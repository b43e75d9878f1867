#include "dem/random.h"

#include <Random123/philox.h>

#include <cassert>
#include <cmath>
#include <numbers>

namespace dem
{
  namespace
  {
    constexpr unsigned int words_per_block = 4;
    constexpr std::size_t block_number = 2; ///< the counter's word that counts blocks; 0 is the grain, 1 the purpose
  }                                         // namespace

  RandomStream::RandomStream(const StreamKey &key)
      : key_{key.seed, key.rev}, counter_{key.grain, static_cast<std::uint64_t>(key.purpose), 0, 0}, block_{},
        n_used_(words_per_block)
  {}

  double RandomStream::draw_uniform()
  {
    if (n_used_ == words_per_block)
      {
        const r123::Philox4x64::ctr_type counter = {{counter_[0], counter_[1], counter_[2], counter_[3]}};
        const r123::Philox4x64::key_type key = {{key_[0], key_[1]}};
        const r123::Philox4x64::ctr_type words = r123::Philox4x64()(counter, key);
        for (std::size_t i = 0; i < words_per_block; ++i)
          block_[i] = words[i];
        ++counter_[block_number];
        n_used_ = 0;
      }
    // 53 bits fill a double's significand: k 2^-53 is exact and below 1. Zero, one case in 9e15, moves to 2^-54 so that
    // a logarithm of the result is finite.
    const std::uint64_t bits = block_[n_used_++] >> 11;
    return bits == 0 ? 0x1p-54 : static_cast<double>(bits) * 0x1p-53;
  }

  double RandomStream::draw_normal()
  {
    // Box and Muller's transform. Its second number is not kept: a stream's place is then a count of words alone.
    const double radius = std::sqrt(-2. * std::log(draw_uniform()));
    const double angle = 2. * std::numbers::pi * draw_uniform();
    return radius * std::cos(angle);
  }

  double RandomStream::draw_truncated_normal(double bound)
  {
    assert(bound > 0.);
    double number = draw_normal();
    while (std::fabs(number) > bound)
      number = draw_normal();
    return number;
  }
} // namespace dem

#include "dem/random.h"

#include <Random123/philox.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <set>
#include <vector>

namespace
{
  using namespace dem;

  using Philox = r123::Philox4x64;

  double convert_to_uniform(std::uint64_t word)
  {
    return static_cast<double>(word >> 11) * 0x1p-53;
  }

  TEST(Random, GeneratorGivesThePublishedVectors)
  {
    // Law: Philox 4x64-10 of Salmon et al. 2011, known answers of the Random123 distribution (digits of pi and e).
    const Philox::ctr_type counter = {
        {0x243f6a8885a308d3u, 0x13198a2e03707344u, 0xa4093822299f31d0u, 0x082efa98ec4e6c89u}};
    const Philox::key_type key = {{0x452821e638d01377u, 0xbe5466cf34e90c6cu}};
    const Philox::ctr_type expected = {
        {0xa528f45403e61d95u, 0x38c72dbd566e9788u, 0xa5a1610e72fd18b5u, 0x57bd43b5e52b7fe6u}};
    EXPECT_EQ(Philox()(counter, key), expected);
  }

  TEST(Random, StreamOfZeroKeyGivesThePublishedVector)
  {
    // Law: the words of a stream are Philox 4x64-10 of its key; all zero is a known answer of the Random123
    // distribution.
    RandomStream stream({.seed = 0, .rev = 0, .grain = 0, .purpose = Purpose{0}});
    for (const std::uint64_t word :
         {0x16554d9eca36314cu, 0xdb20fe9d672d0fdcu, 0xd7e772cee186176bu, 0x7e68b68aec7ba23bu})
      EXPECT_EQ(stream.draw_uniform(), convert_to_uniform(word));
  }

  TEST(Random, KeyIsSeedAndRevCounterIsGrainPurposeAndBlock)
  {
    // Law: snapshots and restarts rely on this layout, so it must not change unnoticed.
    RandomStream stream({.seed = 11, .rev = 12, .grain = 13, .purpose = Purpose::crack});
    for (std::uint64_t block = 0; block < 3; ++block)
      {
        const Philox::ctr_type words =
            Philox()({{13, static_cast<std::uint64_t>(Purpose::crack), block, 0}}, {{11, 12}});
        for (const std::uint64_t word : words)
          EXPECT_EQ(stream.draw_uniform(), convert_to_uniform(word));
      }
  }

  TEST(Random, StreamsDoNotDependOnTheOrderOfAsking)
  {
    // Law: a number is a function of its key and place; interleaving two streams changes neither.
    const StreamKey key_a{.seed = 5, .rev = 1, .grain = 7}, key_b{.seed = 5, .rev = 1, .grain = 8};
    std::vector<double> first, second;
    for (RandomStream stream(key_a); first.size() < 10;)
      first.push_back(stream.draw_normal());
    RandomStream a(key_a), b(key_b);
    for (int i = 0; i < 10; ++i)
      {
        b.draw_uniform();
        second.push_back(a.draw_normal());
        b.draw_normal();
      }
    EXPECT_EQ(first, second);
  }

  TEST(Random, EveryPartOfTheKeyMakesAnotherStream)
  {
    // Law: seed, REV, grain and purpose each change the stream. 53-bit numbers of 5 streams of 1000 collide with
    // probability 1e-9.
    const StreamKey base{.seed = 1, .rev = 2, .grain = 3, .purpose = Purpose::strength};
    std::vector<StreamKey> keys(5, base);
    keys[1].seed = 2;
    keys[2].rev = 3;
    keys[3].grain = 4;
    keys[4].purpose = Purpose::crack;
    std::set<double> numbers;
    for (const StreamKey &key : keys)
      {
        RandomStream stream(key);
        for (int i = 0; i < 1000; ++i)
          numbers.insert(stream.draw_uniform());
      }
    EXPECT_EQ(numbers.size(), 5000u);
  }

  TEST(Random, UniformNumbersHaveTheMomentsOfTheUnitInterval)
  {
    // Law: mean 1/2, variance 1/12, neighbours uncorrelated, along a stream and from grain to grain. Tolerance: 3
    // standard errors of n draws; the seed is fixed, so the outcome does not vary.
    constexpr int n = 200000;
    for (const bool is_across_grains : {false, true})
      {
        RandomStream stream(StreamKey{});
        double sum = 0., squares = 0., products = 0., last = 0.;
        for (int i = 0; i < n; ++i)
          {
            const double u =
                is_across_grains ? RandomStream({.grain = std::uint64_t(i)}).draw_uniform() : stream.draw_uniform();
            ASSERT_GT(u, 0.);
            ASSERT_LT(u, 1.);
            sum += u - 0.5;
            squares += (u - 0.5) * (u - 0.5);
            products += (u - 0.5) * last;
            last = u - 0.5;
          }
        EXPECT_NEAR(sum / n, 0., 3. * std::sqrt(1. / 12. / n));
        EXPECT_NEAR(squares / n, 1. / 12., 3. * std::sqrt((1. / 80. - 1. / 144.) / n));
        EXPECT_NEAR(products / n, 0., 3. / 12. / std::sqrt(n));
      }
  }

  TEST(Random, NormalNumbersHaveTheMomentsOfTheStandardNormal)
  {
    // Law: moments 0, 1, 0, 3; those beyond 2.5 have the share erfc(2.5/sqrt 2). Tolerance: 3 standard errors, from the
    // moments 1, 3, 15, 105 of even order.
    constexpr int n = 200000;
    RandomStream stream({.seed = 2});
    double moments[5] = {};
    int n_beyond = 0;
    for (int i = 0; i < n; ++i)
      {
        const double x = stream.draw_normal();
        for (int order = 1; order <= 4; ++order)
          moments[order] += std::pow(x, order) / n;
        n_beyond += std::fabs(x) > 2.5;
      }
    EXPECT_NEAR(moments[1], 0., 3. * std::sqrt(1. / n));
    EXPECT_NEAR(moments[2], 1., 3. * std::sqrt(2. / n));
    EXPECT_NEAR(moments[3], 0., 3. * std::sqrt(15. / n));
    EXPECT_NEAR(moments[4], 3., 3. * std::sqrt(96. / n));
    const double share = std::erfc(2.5 / std::numbers::sqrt2);
    EXPECT_NEAR(static_cast<double>(n_beyond) / n, share, 3. * std::sqrt(share / n));
  }

  TEST(Random, TruncatedNormalStaysWithinItsBound)
  {
    // Law: |X| <= bound, and variance 1 - 2 k phi(k)/(2 Phi(k) - 1). Tolerance: 3 standard errors with the normal's
    // fourth moment, an upper bound of the truncated one's.
    constexpr int n = 100000;
    constexpr double bound = 1.2;
    RandomStream stream({.seed = 3});
    double squares = 0.;
    for (int i = 0; i < n; ++i)
      {
        const double x = stream.draw_truncated_normal(bound);
        ASSERT_LE(std::fabs(x), bound);
        squares += x * x;
      }
    const double density = std::exp(-0.5 * bound * bound) / std::sqrt(2. * std::numbers::pi);
    const double variance = 1. - 2. * bound * density / std::erf(bound / std::numbers::sqrt2);
    EXPECT_NEAR(squares / n, variance, 3. * std::sqrt(2. / n));
  }
} // namespace

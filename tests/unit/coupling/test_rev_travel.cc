// Law: a REV that has been sent answers as the one that stayed, bit by bit, in the middle of a step as between two.

#include "coupling/macro_clock.h"
#include "coupling/rev_travel.h"

#include "tests/unit/coupling/rev_sample.h"

#include <gtest/gtest.h>

namespace
{
  dem::Rev make_aged_rev()
  {
    dem::Rev rev = rev_sample::make_rev(rev_sample::make_model());
    coupling::age(rev, rev.compute_time_to_next_batch(), {}); // a grain has split since the last commit
    return rev;
  }

  void expect_same(dem::Rev &stayed, dem::Rev &sent)
  {
    const dem::Matrix stretch = dem::Vector(1., 1., 1. - 2e-3).asDiagonal();
    stayed.deform(stretch);
    sent.deform(stretch);
    EXPECT_EQ(dem::serialise(stayed.get_trial()), dem::serialise(sent.get_trial()));
    EXPECT_EQ(dem::serialise(stayed.get_committed()), dem::serialise(sent.get_committed()));
  }
} // namespace

TEST(RevTravel, InTheMiddleOfAStep)
{
  dem::Rev stayed = make_aged_rev();
  ASSERT_NE(dem::serialise(stayed.get_committed()), dem::serialise(stayed.get_baseline()));
  const auto sent = coupling::unpack_rev(stayed.get_model(), coupling::pack_rev(stayed));
  EXPECT_EQ(sent->get_baseline().fractures.size(), stayed.get_baseline().fractures.size());
  EXPECT_FALSE(sent->get_baseline().fractures.empty());
  expect_same(stayed, *sent);
  stayed.revert();
  sent->revert();
  expect_same(stayed, *sent);
}

TEST(RevTravel, BetweenStepsOnceIsEnough)
{
  dem::Rev stayed = make_aged_rev();
  const std::size_t n_bytes = coupling::pack_rev(stayed).size();
  stayed.commit();
  const auto bytes = coupling::pack_rev(stayed);
  EXPECT_LT(bytes.size(), 0.6 * n_bytes);
  const auto sent = coupling::unpack_rev(stayed.get_model(), bytes);
  expect_same(stayed, *sent);
}

TEST(RevTravel, SaysWhatIsWrongWithTheBytes)
{
  const dem::Rev rev = rev_sample::make_rev(rev_sample::make_model());
  auto bytes = coupling::pack_rev(rev);
  EXPECT_THROW(coupling::unpack_rev(rev.get_model(), std::span(bytes).first(bytes.size() / 2)), std::runtime_error);
  bytes[bytes.size() / 3] ^= std::byte{1};
  EXPECT_THROW(coupling::unpack_rev(rev.get_model(), bytes), std::runtime_error); // the state's checksum
}

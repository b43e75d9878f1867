// Law: a jump to the earliest fracture breaks the grain whose time has come and no other, whatever the clock's
// rounding.

#include "coupling/macro_clock.h"

#include "dem/ageing.h"

#include "tests/unit/coupling/rev_sample.h"

#include <gtest/gtest.h>

namespace
{
  using coupling::AgeingMode;
  using coupling::AgeingRule;

  /** A REV at 10 MPa, where cracks grow in seconds to years. */
  dem::Rev make_loaded_rev()
  {
    const dem::Rev rev = rev_sample::make_rev(rev_sample::make_model());
    return coupling::consolidate(rev, -10e6 * dem::Matrix::Identity(), {});
  }
} // namespace

TEST(MacroClock, EventIsTheFirstFractureAndBreaksOneGrain)
{
  dem::Rev rev = make_loaded_rev();
  const auto times = dem::sort_times_to_fracture(rev.get_baseline().grains);
  ASSERT_GT(times.size(), 3u);
  const double dt = coupling::compute_time_to_next_event(rev, {}, 0);
  EXPECT_EQ(dt, times[0].time); // batches of one grain in a REV of seventy
  EXPECT_EQ(coupling::age(rev, 0.999 * dt, {}).n_broken, 0u);
  EXPECT_EQ(coupling::age(rev, coupling::compute_time_to_next_event(rev, {}, 0), {}).n_broken, 1u);
}

TEST(MacroClock, SnapsOnlyWithinTheRoundingOfTheClock)
{
  dem::Rev rev = make_loaded_rev();
  const dem::Grains &grains = rev.get_baseline().grains;
  const double first = dem::sort_times_to_fracture(grains)[0].time;
  EXPECT_EQ(coupling::snap_to_fracture(grains, first * (1. - 4e-16), 0.), first);
  EXPECT_EQ(coupling::snap_to_fracture(grains, 0.5 * first, 0.), 0.5 * first);
  // At an age of 1e6 times the jump, the clock cannot tell 1e-10 of the jump.
  EXPECT_EQ(coupling::snap_to_fracture(grains, first * (1. - 1e-10), 1e6 * first), first);
}

TEST(MacroClock, ScheduleGoesThroughAllBatchesOfAStep)
{
  dem::Rev rev = make_loaded_rev();
  const AgeingRule rule{AgeingMode::schedule, 1000};
  EXPECT_TRUE(std::isinf(coupling::compute_time_to_next_event(rev, rule, 0)));
  const auto times = dem::sort_times_to_fracture(rev.get_baseline().grains);
  const double dt = 1.001 * times[0].time;
  const auto report = coupling::age(rev, dt, rule);
  EXPECT_FALSE(report.has_failed());
  EXPECT_GE(report.n_broken, 1u);
  // The sum of the parts: a rounding for each of them.
  EXPECT_NEAR(rev.get_baseline().time, dt, 1e-12 * dt);
  EXPECT_GT(rev.compute_time_to_next_batch(), 0.);
}

TEST(MacroClock, BatchOfOneGrainCannotBeCut)
{
  dem::Rev rev = make_loaded_rev();
  EXPECT_FALSE(coupling::can_cut_batch(rev, {}, 0));
  dem::RevModel model = rev.get_model();
  model.fracture.batch_limit = 4;
  rev = dem::Rev(model, rev.get_committed());
  EXPECT_TRUE(coupling::can_cut_batch(rev, {}, 0));
  EXPECT_TRUE(coupling::can_cut_batch(rev, {}, 1));
  EXPECT_FALSE(coupling::can_cut_batch(rev, {}, 2));
}

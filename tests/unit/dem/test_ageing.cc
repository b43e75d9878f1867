#include "dem/ageing.h"

#include "tests/support/rev_cases.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

namespace
{
  using namespace dem;
  using namespace dem::cases;

  /** Grains with cracks a [radii] and crack velocities [radii/s]; ids run against the order of places. */
  RevState make_cracked(const std::vector<double> &cracks, const std::vector<double> &velocities)
  {
    RevState state;
    state.resize_grains(cracks.size());
    Grains &grains = state.grains;
    for (std::size_t i = 0; i < cracks.size(); ++i)
      {
        grains.place[i].w = radius;
        grains.id[i] = 100 - i;
        grains.crack_half_length[i] = cracks[i] * radius;
        grains.crack_velocity[i] = velocities[i] * radius;
      }
    return state;
  }

  std::vector<std::size_t> list_places(const std::vector<TimeToFracture> &times)
  {
    std::vector<std::size_t> places;
    for (const TimeToFracture &time : times)
      places.push_back(time.place);
    return places;
  }

  TEST(Ageing, ListsTheFirstFirstAndTiesById)
  {
    // Law: (r - a)/v in rising order; equal times by id, whatever the place; what never breaks is not listed; a crack
    // already through has no time left. Halves and quarters: exact.
    const RevState state = make_cracked({0.5, 0.25, 0.5, 0.5, 1.5, 0.}, {0.5, 0.25, 0.5, 0., 1., 1e-300});
    const auto times = sort_times_to_fracture(state.grains);
    EXPECT_EQ(list_places(times), (std::vector<std::size_t>{4, 2, 0, 1, 5}));
    EXPECT_EQ(times[0].time, 0.);
    EXPECT_NEAR(times[1].time, 1., 1e-15);
    EXPECT_NEAR(times[3].time, 3., 1e-15);
  }

  TEST(Ageing, TheBatchEndsWithItsLastGrain)
  {
    // Law: the jump ends when at most N_max grains have failed; fewer breakable ones than that end it with the last;
    // none: infinity.
    const RevState state = make_cracked({0.5, 0.5, 0.5, 0.5}, {0.5, 0.25, 0.125, 0.});
    EXPECT_NEAR(compute_time_to_batch(state.grains, 1), 1., 1e-15);
    EXPECT_NEAR(compute_time_to_batch(state.grains, 2), 2., 1e-15);
    EXPECT_NEAR(compute_time_to_batch(state.grains, 30), 4., 1e-15);
    EXPECT_EQ(compute_time_to_batch(make_cracked({0.5}, {0.}).grains, 1), std::numeric_limits<double>::infinity());
  }

  TEST(Ageing, EveryCrackGrowsByItsVelocity)
  {
    // Law: a += v dt, breaking or not.
    RevState state = make_cracked({0.5, 0.25, 0.125}, {0.5, 0.25, 0.});
    const RevState kept = state;
    Grains &grains = state.grains;
    const Grains &before = kept.grains;
    EXPECT_EQ(advance_cracks(grains, 1.5), std::vector<std::size_t>{0});
    for (std::size_t i = 0; i < 3; ++i)
      EXPECT_EQ(grains.crack_half_length[i], before.crack_half_length[i] + before.crack_velocity[i] * 1.5);
  }

  TEST(Ageing, AJumpBreaksThoseOnItsListWhateverRoundingSays)
  {
    // Law: a jump to the time of the k-th grain breaks exactly the first k, though a + v dt rounds to either side of r.
    RandomStream stream({1, 0, 0, Purpose::test});
    std::size_t n_rounded_short = 0, n_rounded_far = 0;
    for (int trial = 0; trial < 200; ++trial)
      {
        std::vector<double> cracks(20), velocities(20);
        for (std::size_t i = 0; i < 20; ++i)
          {
            cracks[i] = stream.draw_uniform();
            velocities[i] = std::exp(20. * stream.draw_normal());
          }
        const RevState state = make_cracked(cracks, velocities);
        const Grains &grains = state.grains;
        const auto listed = list_places(sort_times_to_fracture(grains));
        for (std::size_t k = 1; k <= 20; ++k)
          {
            RevState later = state;
            Grains &aged = later.grains;
            const auto broken = advance_cracks(aged, compute_time_to_batch(grains, k));
            ASSERT_EQ(broken, std::vector<std::size_t>(listed.begin(), listed.begin() + static_cast<long>(k)));
            (aged.crack_half_length[broken.back()] > radius ? n_rounded_far : n_rounded_short) += 1;
          }
      }
    EXPECT_GT(n_rounded_short, 100u); // a test of a > r would have been wrong so often
    EXPECT_GT(n_rounded_far, 100u);
  }

  TEST(Ageing, NoWholeGrainKeepsACrackThatIsThrough)
  {
    // Law: what a jump leaves whole has time left, whatever rounding says; else a run would wait for it for ever. Jumps
    // a last bit short of fracture.
    std::mt19937_64 random(11);
    std::uniform_real_distribution<double> uniform(0.01, 0.99);
    int n_through = 0;
    for (int n = 0; n < 1000; ++n)
      {
        RevState state = make_cracked({uniform(random)}, {uniform(random)});
        Grains &grains = state.grains;
        const double dt = std::nextafter(sort_times_to_fracture(grains)[0].time, 0.);
        const bool is_broken = !advance_cracks(grains, dt).empty();
        EXPECT_TRUE(is_broken || sort_times_to_fracture(grains)[0].time > 0.) << n;
        n_through += is_broken;
      }
    EXPECT_GT(n_through, 0); // rounding does that
  }

  TEST(Ageing, ManySmallJumpsAreOneLargeOne)
  {
    // Law: at frozen velocities the time left falls by what has passed. Tolerance: rounding of 1000 additions.
    RevState state = make_cracked({0.3, 0.1}, {0.01, 0.001});
    Grains &grains = state.grains;
    const double before = compute_time_to_batch(grains, 1);
    for (int i = 0; i < 1000; ++i)
      EXPECT_TRUE(advance_cracks(grains, 0.03).empty());
    EXPECT_NEAR(compute_time_to_batch(grains, 1), before - 30., 1e-11);
  }
} // namespace

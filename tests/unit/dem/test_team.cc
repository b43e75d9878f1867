#include "dem/team.h"

#include "tests/support/rev_cases.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

namespace
{
  using namespace dem;
  using namespace dem::cases;

  TEST(Team, DoesEachTaskOnceWhateverItsSize)
  {
    // Law: run(n) calls task 0 ... n - 1 once each and returns when all are done; none is no work; again and again.
    for (const std::size_t n_threads : {1, 2, 3, 8})
      {
        Team team(n_threads);
        EXPECT_EQ(team.size(), n_threads);
        for (int round = 0; round < 200; ++round)
          for (const std::size_t n_tasks : {0, 1, 5, 64})
            {
              std::vector<int> n_done(n_tasks, 0);
              team.run(n_tasks, [&](const std::size_t k) { ++n_done[k]; });
              EXPECT_EQ(std::accumulate(n_done.begin(), n_done.end(), 0), static_cast<int>(n_tasks));
              EXPECT_EQ(std::count(n_done.begin(), n_done.end(), 1), static_cast<long>(n_tasks));
            }
      }
  }

  /** Four blocks of grains. */
  const RevState &get_packing()
  {
    static const RevState packing = [] {
      PackingRule rule;
      rule.n_grains = 3200;
      rule.friction = 0.08;
      return generate_packing(rule, GrainMaterial{}, DynamicsRule{}).state;
    }();
    return packing;
  }

  /** The packing after a strain. */
  RevState strain(const std::size_t n_threads, const bool is_rotation_free)
  {
    RevModel model;
    model.dynamics.n_threads = n_threads;
    model.dynamics.motion.is_rotation_free = is_rotation_free;
    RevState state = get_packing();
    CellControl control;
    control.stretch(2, 2) = 0.995; // the network is built again on the way
    bring_to_rest(state, make_rest_rule(model), control);
    return state;
  }

  TEST(Team, SharesTheGrainsOfARevWithoutChangingABit)
  {
    // Law: results do not depend on the number of threads, bit by bit; grains free to turn and blocked.
    for (const bool is_rotation_free : {false, true})
      {
        const RevState alone = strain(1, is_rotation_free);
        ASSERT_GT(alone.grains.size(), undivided_grains);
        ASSERT_GT(alone.counters.cycles, 500u);
        for (const std::size_t n_threads : {2, 3})
          EXPECT_TRUE(are_equal_bits(strain(n_threads, is_rotation_free), alone)) << n_threads;
      }
  }

  /** Some cycles of a packing of several blocks, each in one walk through the grains or in two. */
  RevState run_cycles(const bool is_fused, const std::size_t n_threads, const bool has_true_masses,
                      const bool has_stress = true)
  {
    RevState state = get_packing();
    RevModel model;
    model.dynamics.n_threads = n_threads;
    model.dynamics.motion.has_true_masses = has_true_masses;
    model.dynamics.motion.is_rotation_free = true;
    update_true_masses(state.grains, model.dynamics.motion.density);
    const ContactLaw law = make_contact_law(model.material);
    Dynamics dynamics(state, law, model.dynamics);
    dynamics.compute_forces();
    dynamics.move();
    Matrix increment = Matrix::Zero();
    increment(2, 2) = -1e-5;
    for (int cycle = 0; cycle < 50; ++cycle)
      {
        dynamics.strain(increment);
        if (is_fused)
          {
            dynamics.compute_forces_and_move(has_stress);
            continue;
          }
        dynamics.compute_forces();
        dynamics.move();
      }
    dynamics.strain(increment);
    dynamics.compute_forces(); // after which the unbalanced ratio is known
    dynamics.store();
    return state;
  }

  TEST(Team, MovesABlockOfGrainsBeforeOthersAreComputedWithoutChangingABit)
  {
    // Law: forces of all grains before any moves, or each block as soon as nobody needs it where it is, with or
    // without the stress on the way: the same bits.
    for (const bool has_true_masses : {false, true})
      {
        const RevState apart = run_cycles(false, 1, has_true_masses);
        for (const std::size_t n_threads : {1, 2, 3, 4})
          for (const bool has_stress : {true, false})
            EXPECT_TRUE(are_equal_bits(run_cycles(true, n_threads, has_true_masses, has_stress), apart)) << n_threads;
      }
  }
} // namespace

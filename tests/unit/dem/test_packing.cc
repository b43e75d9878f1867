#include "dem/packing.h"

#include "dem/contact_network.h"
#include "tests/support/rev_cases.h"

#include <gtest/gtest.h>

namespace
{
  using namespace dem;
  using namespace dem::cases;

  TEST(Packing, HoldsItsPressureAtRest)
  {
    // Law: isotropic stress at the pressure within 0.2 %, unbalanced ratio below 1e-4, sizes those of the grading.
    const Packing &packing = get_packing();
    ASSERT_EQ(packing.report.status, RestStatus::at_rest);
    const Matrix stress = packing.state.stress;
    for (int k = 0; k < 3; ++k)
      EXPECT_NEAR(stress(k, k), -100e3, 2e-3 * 100e3);
    EXPECT_LT(packing.state.unbalanced_ratio, 1e-4);
    EXPECT_EQ(packing.report.friction, 0.08);
    EXPECT_EQ(packing.report.n_tried, 1u);
    auto diameters = sample_diameters(make_ne34_grading(), n_grains, {3, 0, 0, Purpose::diameter});
    std::sort(diameters.begin(), diameters.end());
    std::vector<double> found;
    for (const Row &place : packing.state.grains.place)
      found.push_back(2. * place.w);
    std::sort(found.begin(), found.end());     // grains are stored by their place, not by their size
    for (std::size_t i = 0; i < n_grains; ++i) // grown to it in steps: rounding
      EXPECT_NEAR(found[i], diameters[i], 1e-13 * diameters[i]);
    EXPECT_EQ(compute_void_ratio_with_fines(packing.state), compute_void_ratio(packing.state));
  }

  TEST(Packing, NoGrainsOverlapBeyondTheirContacts)
  {
    // Law: at 100 kPa overlaps are a few roughnesses: growing grains must not have passed through each other.
    for (const Contact &contact : list_contacts(get_packing().state, make_contact_law(GrainMaterial{})))
      EXPECT_LT(contact.overlap, 0.02 * radius);
  }

  TEST(Packing, SeedAndNumberDecideIt)
  {
    // Law: the same seed and number give the same packing bit by bit; another number or seed another one.
    PackingRule rule = make_packing_rule();
    const auto generate = [&] { return generate_packing(rule, GrainMaterial{}, DynamicsRule{}).state; };
    EXPECT_TRUE(are_equal_bits(generate(), get_packing().state));
    rule.number = 1;
    const RevState other = generate();
    std::size_t n_elsewhere = 0; // not near the place that the grain of this number has in the other packing
    for (std::size_t i = 0; i < n_grains; ++i)
      {
        const Row &first = get_packing().state.grains.place[i], &second = other.grains.place[i];
        n_elsewhere += compute_branch(other.cell, first, second).norm() > 2. * radius ? 1 : 0;
      }
    EXPECT_GT(n_elsewhere, n_grains / 2);
    rule.number = 0;
    rule.seed = 4;
    EXPECT_NE(generate().cell.edges(0, 0), get_packing().state.cell.edges(0, 0));
  }

  TEST(Packing, FrictionDecidesTheVoidRatio)
  {
    // Law: rougher grains jam looser.
    PackingRule rule = make_packing_rule();
    rule.friction = 0.4;
    const Packing loose = generate_packing(rule, GrainMaterial{}, DynamicsRule{});
    ASSERT_EQ(loose.report.status, RestStatus::at_rest);
    EXPECT_GT(loose.report.void_ratio, get_packing().report.void_ratio + 0.01);
  }

  TEST(Packing, TheSearchMeetsTheVoidRatioOrSaysThatItDidNot)
  {
    // Law: found means within the tolerance, of the packing that is returned; a void ratio that no friction gives is
    // reported, with the best packing, after the given number of tries.
    PackingRule rule = make_packing_rule();
    rule.friction = -1.;
    rule.void_ratio = get_packing().report.void_ratio + 0.01;
    rule.tolerance = 0.01;
    const Packing found = generate_packing(rule, GrainMaterial{}, DynamicsRule{});
    ASSERT_TRUE(found.report.is_found);
    EXPECT_NEAR(compute_void_ratio(found.state), rule.void_ratio, 0.01);
    EXPECT_NEAR(compute_void_ratio(found.state), found.report.void_ratio, 1e-12);

    rule.void_ratio = 0.2;
    rule.search_cap = 3;
    rule.positions_cap = 2;
    const Packing impossible = generate_packing(rule, GrainMaterial{}, DynamicsRule{});
    EXPECT_FALSE(impossible.report.is_found);
    EXPECT_EQ(impossible.report.n_tried, 6u);
    EXPECT_LE(impossible.report.friction, 0.08); // it went the right way; one packing's void ratio jumps
    EXPECT_EQ(impossible.state.grains.size(), n_grains);
  }
} // namespace

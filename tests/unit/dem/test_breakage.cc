#include "dem/breakage.h"

#include "dem/splitting.h"
#include "dem/walls.h"
#include "tests/support/rev_cases.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

namespace
{
  using namespace dem;
  using namespace dem::cases;

  std::vector<Contact> list(const RevState &state)
  {
    return list_contacts(state, make_contact_law(GrainMaterial{}));
  }

  RevState split(const std::vector<std::size_t> &places, const RevIdentity &identity = {})
  {
    RevState state = get_loaded_state();
    split_grains(state, places, list(state), FractureRule{}, identity);
    return state;
  }

  TEST(Breakage, SiblingsKeepTheirShareOfTheVolumeAndOfTheMass)
  {
    // Law: 0.523861 of the parent's volume stays, at unchanged density and velocity; the rest is fines, so the void
    // ratio rises without them and keeps with them. Tolerance: rounding.
    const RevState &before = get_loaded_state();
    const RevState after = split({3, 10, 40});
    ASSERT_EQ(after.grains.size(), n_grains - 3 + 3 * n_siblings);
    double lost = 0.;
    for (const std::size_t i : {3, 10, 40})
      lost += (1. - 0.523861) * 4. / 3. * std::numbers::pi * std::pow(before.grains.place[i].w, 3);
    const double solids = compute_solid_volume(before.grains);
    EXPECT_NEAR((solids - compute_solid_volume(after.grains)) / lost, 1., 2e-6); // of the six printed digits
    EXPECT_EQ(compute_void_ratio_with_fines(after), compute_void_ratio_with_fines(before));
    EXPECT_GT(compute_void_ratio(after), compute_void_ratio(before));
    for (std::size_t i = 0; i < after.grains.size(); ++i)
      {
        const double mass = 4. / 3. * std::numbers::pi * 2650. * std::pow(after.grains.place[i].w, 3);
        EXPECT_NEAR(after.grains.velocity[i].w, mass, 1e-13 * mass);
        EXPECT_NEAR(after.grains.spin[i].w / (0.4 * mass * std::pow(after.grains.place[i].w, 2)), 1., 1e-13);
      }
  }

  TEST(Breakage, SiblingsLieInTheirParentAndTheFirstPointsAtItsLargestForce)
  {
    // Law: all fourteen inside the parent's shell; sibling 0 on the line to the largest contact force. Tolerance:
    // rounding of fractions of the cell.
    const RevState &before = get_loaded_state();
    std::size_t n_first = 0, n_second = 0; // parents that are grain a, and grain b, of their largest contact
    for (std::size_t parent = 0; parent < n_grains; parent += 7)
      {
        Vector direction = Vector::Zero();
        double largest = 0.;
        bool is_first = false;
        for (const Contact &contact : list(before))
          if ((contact.a == parent || contact.b == parent) && contact.normal_force > largest)
            {
              largest = contact.normal_force;
              is_first = contact.a == parent;
              direction = is_first ? contact.normal : Vector(-contact.normal);
            }
        if (largest == 0.)
          continue; // a rattler
        (is_first ? n_first : n_second) += 1;
        const RevState after = split({parent});
        const double shell = before.grains.place[parent].w;
        for (std::size_t k = 0; k < n_siblings; ++k)
          {
            const Row &sibling = after.grains.place[n_grains - 1 + k];
            const Vector arm = compute_branch(before.cell, before.grains.place[parent], sibling);
            EXPECT_LE(arm.norm() + sibling.w, shell * (1. + 1e-11));
            if (k == 0)
              {
                EXPECT_LT((arm.normalized() - direction).norm(), 1e-11);
              }
          }
      }
    EXPECT_GT(n_first, 0u);
    EXPECT_GT(n_second, 0u);
  }

  TEST(Breakage, NothingDependsOnTheOrderOfTheList)
  {
    // Law: ids of siblings follow their parents' ids, so that who found a grain first does not matter, bit by bit.
    const RevState after = split({3, 10, 40});
    EXPECT_TRUE(are_equal_bits(split({40, 3, 10}), after));
    for (std::size_t k = 0; k < 3 * n_siblings; ++k)
      {
        const std::size_t i = n_grains - 3 + k;
        const std::size_t parents[] = {3, 10, 40};
        EXPECT_EQ(after.grains.id[i], n_grains + k);
        EXPECT_EQ(after.grains.parent[i], get_loaded_state().grains.id[parents[k / n_siblings]]);
        EXPECT_EQ(after.grains.generation[i], 1u);
        EXPECT_EQ(after.grains.crack_velocity[i], 0.);
        EXPECT_GT(after.grains.strength[i], 0.);
        EXPECT_LT(after.grains.crack_half_length[i], after.grains.place[i].w);
      }
    EXPECT_EQ(after.counters.next_id, n_grains + 3 * n_siblings);
  }

  TEST(Breakage, ASplitAsksForTheContactsOfItsGrainsAlone)
  {
    // Law: a split that is told the contacts of the grains to split, few of all, walls among them, does what one does
    // that is told all. Bit by bit.
    const ContactLaw law = make_contact_law(GrainMaterial{});
    for (const RevState &before :
         {get_loaded_state(), make_rev(RevModel{}, get_walled_packing().state).get_committed()})
      {
        std::vector<std::size_t> places = {3, 10, 40};
        for (const ContactMemory &memory : before.contacts)
          if (is_wall(memory.b) && places.size() < 6 && std::ranges::count(places, memory.a) == 0)
            places.push_back(memory.a);
        ASSERT_EQ(places.size() > 3, before.cell.has_walls());
        const std::vector<Contact> all = list(before), some = list_contacts_of(before, places, law);
        ASSERT_GT(some.size(), places.size());
        ASSERT_LT(some.size(), all.size() / 2);
        RevState told_all = before, told_some = before;
        split_grains(told_all, places, all, FractureRule{}, {});
        split_grains(told_some, places, some, FractureRule{}, {});
        EXPECT_TRUE(are_equal_bits(told_some, told_all));
      }
  }

  TEST(Breakage, SiblingsDrawFromTheirOwnStreams)
  {
    // Law: another REV or seed draws other strengths and another spin about the force; the same ones the same.
    EXPECT_TRUE(are_equal_bits(split({10}, {1, 7}), split({10}, {1, 7})));
    const RevState one = split({10}, {1, 7}), other = split({10}, {1, 8}), seeded = split({10}, {2, 7});
    EXPECT_NE(one.grains.strength.back(), other.grains.strength.back());
    EXPECT_NE(one.grains.strength.back(), seeded.grains.strength.back());
    EXPECT_GT((to_vector(one.grains.place.back()) - to_vector(other.grains.place.back())).norm(), 1e-6);
    EXPECT_EQ(one.grains.strength[5], other.grains.strength[5]); // survivors keep theirs
  }

  TEST(Breakage, SurvivorsKeepTheirContacts)
  {
    // Law: a contact between grains that stay keeps forces and history to the last bit, in its order; those of the
    // parents are forgotten.
    const auto name = [](const RevState &state, const ContactMemory &memory) {
      return std::pair(state.grains.id[memory.a], state.grains.id[memory.b]);
    };
    const RevState &before = get_loaded_state();
    const RevState after = split({0, 41});
    std::vector<ContactMemory> expected;
    for (const ContactMemory &memory : before.contacts)
      if (memory.a != 0 && memory.b != 0 && memory.a != 41 && memory.b != 41)
        expected.push_back(memory);
    ASSERT_LT(expected.size(), before.contacts.size());
    ASSERT_EQ(after.contacts.size(), expected.size());
    for (std::size_t i = 0; i < expected.size(); ++i)
      {
        EXPECT_EQ(name(after, after.contacts[i]), name(before, expected[i]));
        EXPECT_EQ(after.contacts[i].shear_force, expected[i].shear_force);
        EXPECT_EQ(after.contacts[i].is_sliding, expected[i].is_sliding);
      }
  }

  TEST(Breakage, CracksGrowOnlyInGrainsThatMayBreak)
  {
    // Law: v = v0 (sigma/sigma_lim)^n from the largest contact stress; 0 below the comminution limit, and everywhere
    // when fracture is off. Tolerance: none, the same function of the same numbers.
    RevState state = get_loaded_state();
    Grains &grains = state.grains;
    const auto contacts = list(get_loaded_state());
    FractureRule rule;
    std::vector<double> diameters;
    for (const Row &place : grains.place)
      diameters.push_back(2. * place.w);
    std::nth_element(diameters.begin(), diameters.begin() + n_grains / 2, diameters.end());
    rule.comminution_diameter = diameters[n_grains / 2]; // half of them
    update_crack_velocities(grains, contacts, rule);
    std::size_t n_growing = 0;
    for (std::size_t i = 0; i < n_grains; ++i)
      {
        const bool may_break = 2. * grains.place[i].w >= rule.comminution_diameter;
        const double expected =
            may_break ? compute_crack_velocity(rule.crack, grains.largest_contact_stress[i], grains.strength[i]) : 0.;
        EXPECT_EQ(grains.crack_velocity[i], expected);
        n_growing += grains.crack_velocity[i] > 0. ? 1 : 0;
      }
    EXPECT_GT(n_growing, n_grains / 4);
    EXPECT_LE(n_growing, n_grains / 2 + 1);
    rule.is_active = false;
    update_crack_velocities(grains, contacts, rule);
    EXPECT_EQ(*std::max_element(grains.crack_velocity.begin(), grains.crack_velocity.end()), 0.);
    EXPECT_TRUE(list_overstressed(grains, rule).empty());
  }

  TEST(Breakage, TheMostOverstressedComesFirst)
  {
    // Law: F > F_lim is sigma > sigma_lim; in falling order of sigma/sigma_lim, ties by id, none below the comminution
    // limit.
    RevState state;
    state.resize_grains(6);
    Grains &grains = state.grains;
    const std::vector<double> stress = {2., 4., 1., 4., 9., 3.};
    for (std::size_t i = 0; i < 6; ++i)
      {
        grains.place[i].w = i == 4 ? 0.05e-3 : 0.1e-3; // grain 4: 0.1 mm, below 0.1155 mm
        grains.id[i] = 10 - i;
        grains.strength[i] = 1e9;
        grains.largest_contact_stress[i] = 1e9 * stress[i];
      }
    EXPECT_EQ(list_overstressed(grains, FractureRule{}), (std::vector<std::size_t>{3, 1, 5, 0}));
  }

  TEST(Breakage, ABatchIsAShareOfTheGrainsAndIsHalvedByCuts)
  {
    // Law: N_max = 0.26 % of the grains (30 of 11497 within rounding down) or a number; each cut halves it, never below
    // one grain.
    FractureRule rule;
    EXPECT_EQ(compute_batch_limit(rule, 11540), 30u);
    EXPECT_EQ(compute_batch_limit(rule, 80), 1u);
    rule.batch_limit = 30;
    EXPECT_EQ(compute_batch_limit(rule, 80), 30u);
    EXPECT_EQ(compute_batch_limit(rule, 80, 1), 15u);
    EXPECT_EQ(compute_batch_limit(rule, 80, 4), 1u);
    EXPECT_EQ(compute_batch_limit(rule, 80, 200), 1u);
  }
} // namespace

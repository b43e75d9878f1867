#include "dem/contact_creep.h"

#include "dem/contact_forces.h"
#include "dem/rev_snapshot.h"
#include "dem/splitting.h"
#include "dem/wall_contacts.h"
#include "dem/walls.h"
#include "tests/support/rev_cases.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <limits>

#include <unistd.h>

namespace
{
  using namespace dem;
  using namespace dem::cases;

  constexpr double overlap = 0.02 * radius;

  /** Soft and quick enough for all of its parts to show within a thousand seconds. */
  CreepLaw make_burgers()
  {
    CreepLaw law;
    law.kind = CreepKind::burgers;
    law.burgers = {{3e9, 5e6, 1e9}, {2e9, 4e6, 5e8}};
    return law;
  }

  CreepLaw make_rate_process()
  {
    CreepLaw law;
    law.kind = CreepKind::rate_process;
    return law;
  }

  ContactLaw make_law()
  {
    return make_contact_law(GrainMaterial{});
  }

  /** Two grains that touch, with a shear force across. */
  RevState make_sheared_pair()
  {
    const Vector normal = Vector(1., 2., -0.5).normalized();
    RevState state = make_pair(overlap, normal);
    const double force = compute_normal_response(make_law(), overlap, 0.5 * radius).force;
    state.add(ContactMemory{0, 1, 0.2 * force * normal.unitOrthogonal(), false});
    return state;
  }

  std::vector<Contact> list(const RevState &state)
  {
    return list_contacts(state, make_law());
  }

  void creep(RevState &state, const CreepLaw &law, const double dt)
  {
    advance_contact_creep(state, list(state), law, dt);
  }

  /** The packing under load, with what has crept at its contacts within a while. */
  RevState make_crept(RevState state, const CreepLaw &law = make_burgers())
  {
    creep(state, law, 1000.);
    return state;
  }

  /** All forces of a state by the hot loop, nothing having moved. */
  std::vector<Row> compute_forces(const RevState &state)
  {
    ContactNetwork network = build_contact_network(state, 0.1 * radius);
    Forces forces;
    const Motion still{0., Matrix::Zero(), false, false};
    const ContactLaw law = make_law();
    ContactSums sums = compute_contact_forces(state, law, still, network, forces);
    if (state.cell.has_walls())
      add_wall_forces({state, law, still}, network, forces, sums);
    std::vector<Row> on_grains;
    for (std::size_t i = 0; i < state.grains.size(); ++i)
      on_grains.push_back(forces.on_grains.force(i));
    return on_grains;
  }

  /** The same by the reference law, contact by contact. */
  std::vector<Vector> compute_reference_forces(const RevState &state)
  {
    std::vector<Vector> forces(state.grains.size(), Vector::Zero());
    for (const Contact &contact : list(state))
      {
        forces[contact.a] += compute_force_on_a(contact);
        if (!is_wall(contact.b))
          forces[contact.b] -= compute_force_on_a(contact);
      }
    return forces;
  }

  TEST(ContactCreep, AHeldContactRelaxesByTheRateProcess)
  {
    // Law: at held grains the shear force falls as the closed form says, its direction and the normal force stay.
    // Tolerance: rounding.
    RevState state = make_sheared_pair();
    const Contact before = list(state)[0];
    const double size = before.shear_force.norm();
    const double left =
        compute_relaxed_shear_force(RateProcessLaw{}, {before.normal_force, before.shear_stiffness}, size, 1e7);
    ASSERT_LT(left, 0.9 * size);
    creep(state, make_rate_process(), 1e7);
    EXPECT_LT((state.contacts[0].shear_force - left / size * before.shear_force).norm(), 1e-14 * size);
    EXPECT_EQ(list(state)[0].normal_force, before.normal_force);
    EXPECT_TRUE(state.crept_contacts.empty());
  }

  TEST(ContactCreep, AHeldBurgersContactHasCreptByItsElements)
  {
    // Law: at frozen force both parts grow by the closed form; the spring feels the overlap less what has crept, and
    // the shear spring has given way by kt times the slip. Tolerance: rounding of the overlap.
    RevState state = make_sheared_pair();
    const Contact before = list(state)[0];
    const BurgersLaw law = make_burgers().burgers;
    const auto normal = compute_creep(law.normal, before.normal_force, 0., 100.);
    const auto shear = compute_creep(law.shear, before.shear_force, Vector(Vector::Zero()), 100.);
    creep(state, make_burgers(), 100.);
    const Contact after = list(state)[0];
    EXPECT_NEAR(after.crept_overlap, normal.viscous + normal.retarded, 1e-12 * overlap);
    EXPECT_NEAR(after.overlap, overlap - normal.viscous - normal.retarded, 1e-10 * overlap);
    EXPECT_NEAR(after.normal_force, compute_normal_response(make_law(), after.overlap, 0.5 * radius).force,
                1e-10 * before.normal_force);
    EXPECT_LT(
        (after.shear_force - before.shear_force + before.shear_stiffness * (shear.viscous + shear.retarded)).norm(),
        1e-13 * before.shear_force.norm());
    EXPECT_LT(after.normal_force, 0.99 * before.normal_force);
  }

  TEST(ContactCreep, ItDoesNotMatterWhichGrainComesFirst)
  {
    // Law: a contact has no first grain: named the other way round, its shear force and what has crept are the same but
    // for the sign of what acts on the other. Bits: a change of sign rounds nothing.
    RevState one = make_sheared_pair(), other = one;
    std::swap(other.contacts[0].a, other.contacts[0].b);
    other.contacts[0].shear_force *= -1.;
    for (const double dt : {10., 100., 500.})
      {
        creep(one, make_burgers(), dt);
        creep(other, make_burgers(), dt);
        EXPECT_EQ(one.contacts[0].shear_force, Vector(-other.contacts[0].shear_force));
        EXPECT_EQ(one.crept_contacts[0].normal_viscous, other.crept_contacts[0].normal_viscous);
        EXPECT_LT((one.crept_contacts[0].shear_retarded - other.crept_contacts[0].shear_retarded).norm(),
                  1e-15 * one.crept_contacts[0].shear_retarded.norm());
      }
  }

  TEST(ContactCreep, TheHotLoopFeelsWhatHasCrept)
  {
    // Law: forces of the hot loop are those of the reference law at overlaps less by what has crept, in a periodic cell
    // and between walls. Tolerance: that between the two laws, 1e-10 of a force, times the contacts of a grain.
    const RevState loaded = get_loaded_state(), walled = get_walled_packing().state;
    for (const RevState &state : {make_crept(loaded), make_crept(walled)})
      {
        ASSERT_EQ(state.crept_contacts.size(), state.contacts.size());
        const auto forces = compute_forces(state);
        const auto expected = compute_reference_forces(state);
        double largest = 0., mean = 0.;
        for (std::size_t i = 0; i < forces.size(); ++i)
          {
            largest = std::max(largest, (to_vector(forces[i]) - expected[i]).norm());
            mean += expected[i].norm() / static_cast<double>(forces.size());
          }
        EXPECT_GT(mean, 0.);
        EXPECT_LT(largest, 1e-8 * mean);
      }
  }

  TEST(ContactCreep, AWallsSpringFeelsTheOverlapLessWhatHasCrept)
  {
    // Law: N of a grain at a wall is the wall's law at R - h - u, h the distance and u what has crept. Tolerance:
    // rounding of the overlap, a thousandth of R, times the law's steepness.
    const RevState state = make_crept(get_walled_packing().state);
    std::size_t n_walls_touched = 0;
    for (const Contact &contact : list(state))
      if (is_wall(contact.b))
        {
          const Row &place = state.grains.place[contact.a];
          const double crept = find_crept_overlap(state, contact.a, contact.b);
          const double left = place.w - compute_distance_to_wall(state.cell, place, to_wall(contact.b)) - crept;
          EXPECT_GT(crept, 0.);
          EXPECT_NEAR(contact.normal_force, compute_normal_response(make_wall_law(make_law()), left, place.w).force,
                      1e-9 * contact.normal_force);
          ++n_walls_touched;
        }
    EXPECT_GT(n_walls_touched, 20u);
  }

  TEST(ContactCreep, WhatIsOpenAtRestIsForgotten)
  {
    // Law: unloaded until its grains part, a column has forgotten what crept; loaded again, it starts anew. One that
    // was not parted has not.
    RevModel model;
    model.fracture.is_active = false;
    model.creep = make_burgers();
    Rev rev = make_rev(model, make_column(overlap));
    rev.relax();
    rev.age(100.);
    EXPECT_EQ(rev.relax().status, RestStatus::at_rest);
    EXPECT_EQ(rev.get_baseline().crept_contacts.size(), 3u);
    Matrix stretch = Matrix::Identity();
    stretch(2, 2) = 1.1;
    EXPECT_EQ(rev.deform(stretch).status, RestStatus::at_rest);
    EXPECT_TRUE(rev.get_trial().crept_contacts.empty());
    EXPECT_EQ(rev.get_baseline().crept_contacts.size(), 3u);
  }

  TEST(ContactCreep, MemoryOutlivesSortingAndFiles)
  {
    // Law: what has crept belongs to grains, not to places: stored in another order, as bytes or in a file, each pair
    // of ids has the same contact, every bit.
    const RevState state = make_crept(get_loaded_state());
    const auto file = std::filesystem::temp_directory_path() / ("crept_" + std::to_string(::getpid()) + ".h5");
    write_snapshot(file.string(), state, list(state), {});
    const RevState read = read_snapshot(file.string()).state;
    std::filesystem::remove(file);
    EXPECT_TRUE(are_equal_bits(state, read));
    EXPECT_TRUE(are_equal_bits(state, deserialise(serialise(state))));

    RevState shuffled = state;
    std::vector<std::uint32_t> order(state.grains.size());
    for (std::uint32_t i = 0; i < order.size(); ++i)
      order[i] = (7 * i + 3) % static_cast<std::uint32_t>(order.size()); // 80 grains: a permutation
    shuffled.grains.permute(order);
    for (ContactMemory &memory : shuffled.contacts)
      for (std::uint32_t *const place : {&memory.a, &memory.b})
        *place = static_cast<std::uint32_t>(std::find(order.begin(), order.end(), *place) - order.begin());
    const auto before = list(state), after = list(shuffled);
    for (std::size_t i = 0; i < before.size(); ++i)
      {
        EXPECT_GT(before[i].crept_overlap, 0.);
        EXPECT_EQ(before[i].crept_overlap, after[i].crept_overlap);
        EXPECT_EQ(before[i].normal_force, after[i].normal_force);
      }
  }

  TEST(ContactCreep, ContactsOfAGrainThatSplitsAreForgottenAndTheOthersKept)
  {
    // Law: siblings are new grains and have not crept; contacts of other grains have. Open contacts are forgotten, once
    // they are asked for.
    RevState state = make_crept(get_loaded_state());
    const auto before = list(state);
    const GrainId parent = state.grains.id[before[0].a];
    split_grains(state, {before[0].a}, before, FractureRule{}, RevIdentity{});
    for (const Contact &contact : list(state))
      EXPECT_GT(contact.crept_overlap, 0.);
    forget_open_contacts(state);
    EXPECT_EQ(state.crept_contacts.size(), state.contacts.size());
    EXPECT_LT(state.crept_contacts.size(), before.size());
    for (const CreptContact &contact : state.crept_contacts)
      EXPECT_TRUE(contact.a != parent && contact.b != parent);
  }

  TEST(ContactCreep, AStepDisturbsAsMuchAsItMay)
  {
    // Law: the disturbance rises with dt, and is the share asked for at the longest step; a law that does not creep has
    // no longest step. Tolerance: the step's exponent is found to its rounding.
    const RevState state = get_loaded_state();
    const auto contacts = list(state);
    for (CreepLaw law : {make_rate_process(), make_burgers()})
      for (const double share : {1e-3, 5e-3, 2e-2})
        {
          law.step_share = share;
          const double dt = compute_longest_creep_step(state, contacts, law);
          EXPECT_NEAR(compute_creep_disturbance(state, contacts, law, dt) / share, 1., 1e-9);
          EXPECT_GT(compute_creep_disturbance(state, contacts, law, 1.5 * dt), share);
          EXPECT_LT(compute_creep_disturbance(state, contacts, law, 0.5 * dt), share);
        }
    const double infinity = std::numeric_limits<double>::infinity();
    EXPECT_EQ(compute_longest_creep_step(state, contacts, CreepLaw{}), infinity);
    CreepLaw patient = make_rate_process();
    patient.step_share = 1.; // more than friction lets a shear force be
    EXPECT_EQ(compute_longest_creep_step(state, contacts, patient), infinity);
  }

  /** Three grains in a column under a constant axial force, a dashpot and a Kelvin element in each contact. */
  double compute_column_creep(const CreepLaw &law, const double force, const double end)
  {
    RevModel model;
    model.equilibrium.unbalanced_ratio = model.equilibrium.stress_tolerance = 1e-9;
    model.fracture.is_active = false;
    model.creep = law;
    RevState column = make_column(overlap);
    Rev rev = make_rev(model, column);
    const double area = std::pow(6. * radius, 2);
    EXPECT_EQ(rev.control(make_oedometer(force / area)).status, RestStatus::at_rest);
    rev.accept();
    const double height = rev.get_baseline().cell.edges(2, 2);
    while (rev.get_baseline().time < end)
      {
        rev.age(std::min(rev.compute_longest_jump(), end - rev.get_baseline().time));
        EXPECT_EQ(rev.control(make_oedometer(force / area)).status, RestStatus::at_rest);
        rev.accept();
      }
    return (height - rev.get_baseline().cell.edges(2, 2)) / 3.; // of one contact [m]
  }

  TEST(ContactCreep, AColumnUnderAConstantForceFollowsTheCreepFunction)
  {
    // Law: steps at frozen force with equilibria between them give u = N (t/Cm + (1 - exp(-t Kk/Ck))/Kk) for every
    // contact of a chain. Tolerance: the servo's, 1e-9 of the force, over the ratio of creep to the spring's overlap,
    // times the steps.
    CreepLaw law = make_burgers();
    law.step_share = 0.02;
    const BurgersElements &n = law.burgers.normal;
    for (const double end : {20., 200., 1000.})
      {
        const double expected =
            0.8 * (end / n.viscosity +
                   -std::expm1(-end * n.retarded_stiffness / n.retarded_viscosity) / n.retarded_stiffness);
        EXPECT_NEAR(compute_column_creep(law, 0.8, end) / expected, 1., 1e-6) << end;
      }
  }
} // namespace

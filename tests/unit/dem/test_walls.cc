#include "dem/breakage.h"
#include "dem/fracture.h"
#include "dem/homogenisation.h"
#include "dem/wall_contacts.h"
#include "tests/support/rev_cases.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace
{
  using namespace dem;
  using namespace dem::cases;

  /** Every grain far from the walls but for those that a test moves. */
  RevState make_box(const std::vector<Vector> &places, const double edge)
  {
    RevState state = make_state(places, edge);
    state.cell.kind = CellKind::rigid;
    return state;
  }

  /** One step's forces. */
  struct Pushed
  {
    RevState state;
    Forces forces;
    ContactSums sums;

    Pushed(const RevState &pushed, const GrainMaterial &material, const Motion &motion) : state(pushed)
    {
      const ContactLaw law = make_contact_law(material);
      const ForceTask task{state, law, motion};
      ContactNetwork network = build_contact_network(state, 0.1 * radius);
      Team alone(1);
      sums = compute_contact_forces(task, network, forces, alone);
      add_wall_forces(task, network, forces, sums);
      state.set_contacts(collect_memories(network));
    }
  };

  constexpr double edge = 10. * radius;

  TEST(Walls, PushAGrainByTheClosedForm)
  {
    // Law: a smooth grain against a rigid wall is Hertz with R* = R, E* = 2G/(1-nu): N = 4/3 E* sqrt(R) d^1.5 inwards,
    // kn = 1.5 N/d; sums count it once. Tolerance: rounding of d = R - h, 1e-16 R/d of it, to the power 1.5.
    GrainMaterial material;
    material.roughness = 0.;
    const double d = 1e-3 * radius;
    const double modulus = 2. * material.shear_modulus / (1. - material.poisson_ratio);
    const double expected = 4. / 3. * modulus * std::sqrt(radius) * std::pow(d, 1.5);
    for (std::uint32_t wall = 0; wall < n_walls; ++wall)
      {
        const Vector inwards = -get_outward_normal(wall);
        const Vector place = Vector::Constant(0.5 * edge) - (0.5 * edge - radius + d) * inwards;
        Motion motion;
        motion.has_contact_stress = true;
        const Pushed pushed(make_box({place}, edge), material, motion);
        EXPECT_LT((to_vector(pushed.forces.on_grains.force(0)) - expected * inwards).norm(), 1e-11 * expected);
        EXPECT_NEAR(pushed.forces.on_grains.force(0).w, 1.5 * expected / d, 1e-11 * expected / d);
        EXPECT_EQ(pushed.sums.n_touching, 1u);
        EXPECT_EQ(pushed.sums.stiffness, pushed.forces.on_grains.force(0).w);
        const double stress = expected / (std::numbers::pi * radius * d);
        EXPECT_NEAR(pushed.forces.largest_stress[0], stress, 1e-11 * stress);
        ASSERT_EQ(pushed.state.contacts.size(), 1u);
        EXPECT_EQ(pushed.state.contacts[0].b, to_partner(wall));
        EXPECT_EQ(to_number(pushed.state.contacts[0].b), -1 - static_cast<int>(wall));
      }
  }

  TEST(Walls, LawIsThatOfAStifferPair)
  {
    // Law: rough or not, the wall's law is that of two grains with twice the modulus and S = S_q; E* alone for per
    // grain, where the pair has sqrt2 S_q. Tolerance: rounding.
    GrainMaterial material, stiff;
    stiff.shear_modulus = 2. * material.shear_modulus;
    const ContactLaw reference = make_contact_law(stiff);
    for (const RoughnessRule rule : {RoughnessRule::combined, RoughnessRule::per_grain})
      {
        material.roughness_rule = rule;
        material.wall_friction = 0.3;
        const ContactLaw wall = make_wall_law(make_contact_law(material));
        EXPECT_EQ(wall.friction, 0.3);
        for (const double overlap : {1e-7, 3e-6, 1e-4})
          {
            const NormalResponse found = compute_normal_response(wall, overlap, radius);
            const NormalResponse expected = compute_normal_response(reference, overlap, radius);
            EXPECT_NEAR(found.force, expected.force, 1e-13 * expected.force);
            EXPECT_NEAR(found.stiffness, expected.stiffness, 1e-13 * expected.stiffness);
          }
      }
  }

  TEST(Walls, ShearForceGrowsUpToTheCap)
  {
    // Law: t = -kt u_t for a grain sliding by u along a wall at frozen overlap, at most mu N against the motion; no
    // friction, no shear. Tolerance: rounding of the overlap.
    for (const double friction : {0., 0.4})
      for (const bool slides : {false, true})
        {
          GrainMaterial material;
          material.roughness = 0.;
          material.wall_friction = friction;
          const double d = 1e-3 * radius, u = slides ? 1e-2 * d : 1e-6 * d;
          RevState state = make_box({Vector(0.5 * edge, 0.5 * edge, radius - d)}, edge);
          state.grains.velocity[0].x = u;
          const Pushed pushed(state, material, Motion{});
          const ContactLaw law = make_wall_law(make_contact_law(material));
          const NormalResponse normal = compute_normal_response(law, d, radius);
          const double grown = law.shear_ratio * normal.stiffness * u, cap = friction * normal.force;
          const double expected = std::min(grown, cap);
          EXPECT_NEAR(pushed.forces.on_grains.force(0).x, -expected, 1e-11 * normal.force);
          EXPECT_EQ(pushed.state.contacts[0].is_sliding, grown > cap);
        }
  }

  TEST(Walls, TurnAGrainThatSlides)
  {
    // Law: shear force t on the grain at the foot of its centre turns it by (R - d) n x t.
    GrainMaterial material;
    material.wall_friction = 0.4;
    const double d = 1e-3 * radius;
    RevState state = make_box({Vector(0.5 * edge, 0.5 * edge, radius - d)}, edge);
    state.grains.spin[0].y = 1e-7;
    Motion motion;
    motion.is_rotation_free = true;
    const Pushed pushed(state, material, motion);
    const Vector shear = pushed.state.contacts[0].shear_force;
    EXPECT_GT(shear.x(), 0.); // the foot moves towards -x where the grain turns about +y
    const Vector torque = to_vector(pushed.forces.on_grains.torque(0));
    const Vector expected = (radius - d) * (-Vector::UnitZ()).cross(shear);
    EXPECT_LT((torque - expected).norm(), 1e-12 * expected.norm());
    EXPECT_LT(torque.y(), 0.); // against the spin
  }

  TEST(Walls, HaveNoImages)
  {
    // Law: two grains at opposite walls, near through the boundary, do not touch; in a periodic cell they do.
    const Vector low(0.9 * radius, 0.5 * edge, 0.5 * edge), high(edge - 0.9 * radius, 0.5 * edge, 0.5 * edge);
    RevState state = make_box({low, high}, edge);
    EXPECT_TRUE(list_near_pairs(state.cell, state.grains.place, 0.1 * radius).empty());
    state.cell.kind = CellKind::periodic;
    EXPECT_EQ(list_near_pairs(state.cell, state.grains.place, 0.1 * radius).size(), 1u);
  }

  TEST(Walls, SearchFindsWhatADirectOneDoes)
  {
    // Law: the pairs nearer than R_a + R_b + skin without images, some of them pressed beyond a wall.
    RevState state = make_box(std::vector<Vector>(300, Vector::Zero()), 12. * radius);
    RandomStream stream({1, 0, 0, Purpose::position});
    for (Row &place : state.grains.place)
      {
        for (double *const fraction : {&place.x, &place.y, &place.z})
          *fraction = -0.02 + 1.04 * stream.draw_uniform();
        place.w = radius * (0.1 + 0.9 * stream.draw_uniform());
      }
    const double skin = 0.2 * radius;
    std::vector<NearPair> expected;
    for (std::uint32_t a = 0; a < 300; ++a)
      for (std::uint32_t b = a + 1; b < 300; ++b)
        {
          const Row &first = state.grains.place[a], &second = state.grains.place[b];
          if ((state.cell.edges * (to_vector(first) - to_vector(second))).norm() < first.w + second.w + skin)
            expected.push_back({a, b});
        }
    EXPECT_EQ(list_near_pairs(state.cell, state.grains.place, skin), expected);
  }

  TEST(Walls, ColumnPressesThemAsSprings)
  {
    // Law: three grains in a row between two walls, strained by e: one force N in all four contacts, whose overlaps
    // d_w + 2 d_g + d_w make up the strain; that force over the area is the wall's stress, and Love-Weber's. Tolerance:
    // the unbalanced ratio 1e-8 asked for.
    const double height = 6. * radius;
    RevState state = make_box(std::vector<Vector>(3, Vector::Zero()), edge);
    state.cell.edges(2, 2) = height;
    for (int i = 0; i < 3; ++i)
      state.grains.place[i] = {0.5, 0.5, (2. * i + 1.) / 6., radius};
    RestRule rule = make_rest_rule();
    rule.equilibrium.unbalanced_ratio = 1e-8;
    CellControl control;
    const double strain = 1e-3;
    control.stretch(2, 2) = 1. - strain;
    ASSERT_EQ(bring_to_rest(state, rule, control).status, RestStatus::at_rest);

    const auto contacts = list_contacts(state, rule.law);
    ASSERT_EQ(contacts.size(), 4u);
    double overlap = 0.;
    for (const Contact &contact : contacts)
      {
        EXPECT_NEAR(contact.normal_force, contacts[0].normal_force, 1e-6 * contacts[0].normal_force);
        const ContactLaw law = is_wall(contact.b) ? make_wall_law(rule.law) : rule.law;
        const double R = is_wall(contact.b) ? radius : 0.5 * radius;
        EXPECT_EQ(contact.normal_force, compute_normal_response(law, contact.overlap, R).force);
        overlap += contact.overlap;
      }
    EXPECT_NEAR(overlap, strain * height, 1e-12 * height);
    const double expected = -contacts[0].normal_force / (edge * edge);
    EXPECT_NEAR(compute_wall_stress(state.cell, contacts).z(), expected, 1e-6 * -expected);
    EXPECT_NEAR(state.stress(2, 2), expected, 1e-6 * -expected);
  }

  /** Love-Weber stress and that on the walls differ by what is out of balance: (1/V) sum of x (resultant). */
  void expect_balance(const RevState &state, const ContactLaw &law)
  {
    const auto contacts = list_contacts(state, law);
    Vector on_low = Vector::Zero(), on_high = Vector::Zero();
    double mean_force = 0.;
    for (const Contact &contact : contacts)
      {
        mean_force += contact.normal_force / static_cast<double>(contacts.size());
        if (is_wall(contact.b))
          (to_wall(contact.b) % 2 == 0 ? on_low : on_high) += compute_force_on_a(contact);
      }
    // At most every resultant pushes one way, half an edge from the middle of the box.
    const double n = static_cast<double>(state.grains.size());
    const double resultants = n * state.unbalanced_ratio * mean_force;
    EXPECT_LT((on_low + on_high).cwiseAbs().maxCoeff(), resultants);
    const Vector wall_stress = compute_wall_stress(state.cell, contacts);
    for (int k = 0; k < 3; ++k)
      {
        const double bound = 0.5 * resultants * state.cell.edges(k, k) / state.cell.compute_volume();
        EXPECT_NEAR(wall_stress[k], state.stress(k, k), bound);
        EXPECT_LT(bound, 0.05 * std::abs(wall_stress[k]));
        EXPECT_GT(on_low[k], 0.);
        EXPECT_LT(on_high[k], 0.);
      }
  }

  TEST(Walls, PackingHoldsItsPressureOnThem)
  {
    // Law: 100 kPa on each wall within 0.2 %; no grain's centre is outside; void ratio is that of the box.
    const RevState &state = get_walled_packing().state;
    const ContactLaw law = make_contact_law(GrainMaterial{});
    ASSERT_EQ(get_walled_packing().report.status, RestStatus::at_rest);
    const Vector stress = compute_wall_stress(state.cell, list_contacts(state, law));
    for (int k = 0; k < 3; ++k)
      EXPECT_NEAR(stress[k], -100e3, 2e-3 * 100e3);
    expect_balance(state, law);
    for (const Row &place : state.grains.place)
      for (const double fraction : {place.x, place.y, place.z})
        EXPECT_TRUE(fraction > 0. && fraction < 1.);
    EXPECT_NEAR(get_walled_packing().report.void_ratio,
                state.cell.edges.diagonal().prod() / compute_solid_volume(state.grains) - 1., 1e-12);
  }

  TEST(Walls, LoadsStayInBalance)
  {
    // Law: isotropic and oedometric loading reach their stress on the walls within 0.2 %; an oedometer's lateral walls
    // stand still and bear less than the axial ones.
    const ContactLaw law = make_contact_law(GrainMaterial{});
    Rev rev = make_rev(RevModel{}, get_walled_packing().state);
    CellControl isotropic;
    isotropic.target_stress = -1e6 * Matrix::Identity();
    isotropic.is_stress_controlled = {true, true, true, false, false, false};
    ASSERT_EQ(rev.control(isotropic).status, RestStatus::at_rest);
    for (const double stress : compute_wall_stress(rev.get_trial().cell, list_contacts(rev.get_trial(), law)))
      EXPECT_NEAR(stress, -1e6, 2e-3 * 1e6);
    expect_balance(rev.get_trial(), law);

    rev.accept();
    const Cell before = rev.get_baseline().cell;
    ASSERT_EQ(rev.control(make_oedometer(5e6)).status, RestStatus::at_rest);
    const RevState &state = rev.get_trial();
    const Vector stress = compute_wall_stress(state.cell, list_contacts(state, law));
    EXPECT_NEAR(stress.z(), -5e6, 2e-3 * 5e6);
    EXPECT_EQ(state.cell.edges(0, 0), before.edges(0, 0));
    EXPECT_LT(state.cell.edges(2, 2), before.edges(2, 2));
    EXPECT_GT(stress.x(), stress.z());
    EXPECT_LT(stress.x(), -1e6);
    expect_balance(state, law);
  }

  TEST(Walls, BitsDoNotDependOnThreads)
  {
    // Law: the same state loaded by one thread and by three has the same bytes. Grains of two blocks.
    const auto load = [](const std::size_t n_threads) {
      RevState state = make_box(std::vector<Vector>(1331, Vector::Zero()), 22. * radius);
      for (std::size_t i = 0; i < 1331; ++i) // a loose lattice, jittered, its outer layers in touch with the walls
        {
          RandomStream stream({1, 0, i, Purpose::position});
          const auto draw = [&](const std::size_t k) {
            return (static_cast<double>(k) + 0.5 + 0.1 * (stream.draw_uniform() - 0.5)) / 11.;
          };
          const double x = draw(i % 11), y = draw(i / 11 % 11), z = draw(i / 121);
          state.grains.place[i] = {x, y, z, radius};
        }
      RestRule rule = make_rest_rule();
      rule.equilibrium.fixed_cycles = 30;
      rule.dynamics.n_threads = n_threads;
      CellControl control;
      control.stretch(2, 2) = 0.9999;
      control.is_stress_controlled[0] = true;
      control.target_stress(0, 0) = -1e5;
      bring_to_rest(state, rule, control);
      EXPECT_TRUE(std::any_of(state.contacts.begin(), state.contacts.end(),
                              [](const ContactMemory &memory) { return is_wall(memory.b); }));
      return state;
    };
    EXPECT_TRUE(are_equal_bits(load(1), load(3)));
  }

  TEST(Walls, SiblingsStayInside)
  {
    // Law: siblings lie within their parent's sphere, so none reaches farther beyond a wall than it did.
    RevState state = get_walled_packing().state;
    const Rev rev = make_rev(RevModel{}, state);
    state = rev.get_committed();
    const auto contacts = list_contacts(state, rev.get_law());
    const auto touching = std::find_if(contacts.begin(), contacts.end(), [](const Contact &c) { return is_wall(c.b); });
    ASSERT_NE(touching, contacts.end());
    EXPECT_GE(state.grains.largest_contact_stress[touching->a],
              compute_contact_stress(touching->normal_force, touching->effective_radius, touching->overlap));
    const double overlap = touching->overlap;
    const std::uint32_t wall = to_wall(touching->b);
    const std::size_t n_before = state.grains.size();
    split_grains(state, {touching->a}, contacts, rev.get_model().fracture, RevIdentity{});
    ASSERT_EQ(state.grains.size(), n_before + 13);
    for (std::size_t i = n_before - 1; i < state.grains.size(); ++i)
      {
        const Row &place = state.grains.place[i];
        EXPECT_LE(place.w - compute_distance_to_wall(state.cell, place, wall), overlap + 1e-12 * radius);
      }
    for (const ContactMemory &memory : state.contacts) // those of its neighbours follow them
      EXPECT_LT(memory.a, state.grains.size());
    EXPECT_EQ(bring_to_rest(state, make_rest_rule(), CellControl{}).status, RestStatus::at_rest);
  }

  TEST(Walls, HaveNoTangent)
  {
    // Law: a tangent is asked of points of a continuum; a box is refused with a message.
    const Rev rev = make_rev(RevModel{}, get_walled_packing().state);
    EXPECT_THROW(rev.compute_tangent(rev.get_committed(), TangentKind::condensed), std::invalid_argument);
  }
} // namespace

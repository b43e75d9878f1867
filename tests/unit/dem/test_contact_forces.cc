#include "dem/contact_forces.h"

#include "dem/fracture.h"
#include "tests/support/rev_cases.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

namespace
{
  using namespace dem;
  using namespace dem::cases;

  Vector draw_direction(std::mt19937_64 &random)
  {
    std::normal_distribution<double> normal;
    return Vector(normal(random), normal(random), normal(random)).normalized();
  }

  /** Pairs far from each other in one cell: more than one block of the hot loop, and a rest. */
  RevState make_pairs(const std::vector<double> &overlaps, std::mt19937_64 &random)
  {
    const double edge = 8. * radius * 7.;
    std::uniform_real_distribution<double> size(0.4, 1.);
    std::vector<Vector> places;
    std::vector<double> radii;
    for (std::size_t k = 0; k < overlaps.size(); ++k)
      {
        const Vector middle = 8. * radius * Vector(0.5 + k % 7, 0.5 + k / 7 % 7, 0.5 + k / 49 % 7);
        const double a = size(random) * radius, b = size(random) * radius;
        const Vector direction = draw_direction(random);
        places.push_back(middle - a * direction);
        places.push_back(middle + (b - overlaps[k]) * direction);
        radii.insert(radii.end(), {a, b});
      }
    RevState state = make_state(places, edge);
    for (std::size_t i = 0; i < radii.size(); ++i)
      state.grains.place[i].w = radii[i];
    return state;
  }

  struct Result
  {
    ContactNetwork network;
    Forces forces;
    ContactSums sums;
  };

  Result compute(const RevState &state, const ContactLaw &law, const Motion &motion = {})
  {
    Result result;
    result.network = build_contact_network(state, 0.1 * radius);
    result.sums = compute_contact_forces(state, law, motion, result.network, result.forces);
    return result;
  }

  Vector force_on(const Result &result, const std::size_t grain)
  {
    return to_vector(result.forces.on_grains.force(grain));
  }

  /** N and kn of each pair by the fast loop against the reference law at the same overlap. */
  void expect_reference(const ContactLaw &law, const std::vector<double> &overlaps)
  {
    std::mt19937_64 random(4);
    const RevState state = make_pairs(overlaps, random);
    const Result result = compute(state, law);
    ASSERT_EQ(result.sums.n_touching, overlaps.size());
    for (std::size_t k = 0; k < overlaps.size(); ++k)
      {
        const Row &a = state.grains.place[2 * k], &b = state.grains.place[2 * k + 1];
        const Vector branch = compute_branch(state.cell, a, b);
        const double overlap = a.w + b.w - branch.norm();
        const NormalResponse expected = compute_normal_response(law, overlap, compute_effective_radius(a.w, b.w));
        // The overlap is a small difference of lengths: one unit of their last place, times the law's exponent.
        const double tolerance = 1e-12 + 3. * 2.3e-16 * (a.w + b.w) / overlap;
        EXPECT_NEAR(force_on(result, 2 * k).norm() / expected.force, 1., tolerance) << overlap;
        EXPECT_NEAR(result.forces.on_grains.force(2 * k).w / expected.stiffness, 1., tolerance) << overlap;
        EXPECT_LT(force_on(result, 2 * k).dot(branch), 0.); // pushed apart
      }
  }

  TEST(ContactForces, FastLawIsTheReferenceLaw)
  {
    // Law: N and kn of the three-stage contact, all stages and their ends, for 300 pairs of unequal grains.
    for (const double n1 : {0.05, 0.82, 2.})
      {
        GrainMaterial material;
        material.n1 = n1;
        const ContactLaw law = make_contact_law(material);
        std::mt19937_64 random(1);
        std::uniform_real_distribution<double> share(0.1, 2.);
        std::vector<double> overlaps = {law.dT1 * (1. - 1e-9), law.dT1 * (1. + 1e-9), law.dT2 * (1. - 1e-9),
                                        law.dT2 * (1. + 1e-9)};
        while (overlaps.size() < 300)
          overlaps.push_back(share(random) * (overlaps.size() % 2 == 0 ? law.dT1 : law.dT2));
        expect_reference(law, overlaps);
      }
  }

  TEST(ContactForces, SmoothGrainsAreHertz)
  {
    // Law: S_q = 0 is plain Hertz at every depth, in the fast loop too.
    GrainMaterial material;
    material.roughness = 0.;
    std::vector<double> overlaps;
    for (int k = 0; k < 290; ++k)
      overlaps.push_back(1e-4 * radius * std::pow(10., 3. * k / 290.));
    expect_reference(make_contact_law(material), overlaps);
  }

  TEST(ContactForces, ATouchOfNoDepthIsNoForce)
  {
    // Law: N = kn = 0 at d = 0, no 0/0, also where rounding leaves a touch whose depth is zero or below; rough (with
    // mild and steep exponents) and smooth. Tolerance: what the law gives at the depth that rounding may leave.
    for (const auto &[roughness, n1] : {std::pair{0.6e-6, 0.05}, {0.6e-6, 0.82}, {0., 0.}})
      {
        GrainMaterial material;
        material.roughness = roughness;
        material.n1 = n1;
        const ContactLaw law = make_contact_law(material);
        const NormalResponse most = compute_normal_response(law, 1e-14 * radius, radius);
        std::mt19937_64 random(9);
        std::size_t n_touching = 0;
        RevState state = make_pair(0., Vector::UnitX());
        state.grains.place[0] = {0., 0., 0., radius}; // keeps every bit of the branch
        for (int trial = 0; trial < 3000; ++trial)
          {
            const Vector place = 2. * radius / state.cell.edges(0, 0) * draw_direction(random);
            state.grains.place[1] = {place.x(), place.y(), place.z(), radius};
            const Result result = compute(state, law);
            n_touching += result.sums.n_touching;
            ASSERT_LE(force_on(result, 0).norm(), most.force);
            ASSERT_GE(result.forces.on_grains.force(0).w, 0.);
            ASSERT_LE(result.forces.on_grains.force(0).w, most.stiffness);
          }
        EXPECT_GT(n_touching, 300u); // of tangent pairs, by their last bit
      }
  }

  TEST(ContactForces, LoadingAndUnloadingFollowOneCurve)
  {
    // Law: the normal force is a function of the overlap: what was stored comes back, to the last bit.
    const ContactLaw law = make_contact_law(GrainMaterial{});
    RevState state = make_pair(0., Vector::UnitX());
    ContactNetwork network = build_contact_network(state, radius);
    const double start = state.grains.place[1].x;
    std::vector<double> up, down;
    Forces forces;
    const auto push = [&](const int step, std::vector<double> &to) {
      state.grains.place[1].x = start - 4e-5 * step;
      compute_contact_forces(state, law, Motion{}, network, forces);
      to.push_back(to_vector(forces.on_grains.force(0)).norm());
    };
    for (int step = 1; step <= 300; ++step)
      push(step, up);
    for (int step = 300; step >= 1; --step)
      push(step, down);
    EXPECT_GT(up.back(), 100. * law.force_scale_1 * std::sqrt(0.5 * radius)); // into Hertz
    EXPECT_TRUE(std::equal(up.begin(), up.end(), down.rbegin()));
  }

  TEST(ContactForces, SumsAreThoseOfTheListedContacts)
  {
    // Law: stress sum, mean force and counts of the fast loop are those of the contacts that writers see. Tolerance:
    // rounding of a few hundred terms; for a grain's stress a few last bits of the distance, which the overlap, so much
    // smaller, multiplies.
    const RevState &state = get_loaded_state();
    const ContactLaw law = make_contact_law(GrainMaterial{});
    Motion motion;
    motion.time_step = 0.;
    motion.has_contact_stress = true;
    const Result result = compute(state, law, motion);
    const auto contacts = list_contacts(state, law);
    ASSERT_EQ(result.sums.n_touching, contacts.size());
    const Matrix stress = compute_stress(contacts, 1.);
    EXPECT_LT((result.sums.force_times_branch - stress).norm(), 1e-12 * stress.norm());
    double sum = 0., moment = 0.;
    for (const Contact &contact : contacts)
      {
        sum += contact.normal_force;
        moment += contact.normal_stiffness * contact.branch.squaredNorm();
      }
    EXPECT_NEAR(result.sums.normal_force, sum, 1e-12 * sum);
    EXPECT_NEAR(result.sums.stiffness_moment, moment, 1e-12 * moment);
    std::vector<double> bound(state.grains.size(), 0.);
    for (const Contact &contact : contacts)
      {
        const double stress = compute_contact_stress(contact.normal_force, contact.effective_radius, contact.overlap);
        const double rounding = std::numeric_limits<double>::epsilon() * contact.branch.norm() / contact.overlap;
        for (const std::size_t i : {contact.a, contact.b})
          bound[i] = std::max(bound[i], 8. * rounding * stress);
      }
    for (std::size_t i = 0; i < state.grains.size(); ++i)
      EXPECT_NEAR(result.forces.largest_stress[i], state.grains.largest_contact_stress[i], bound[i]);
  }

  TEST(ContactForces, ActionIsReaction)
  {
    // Law: forces on all grains of a packing under load sum to nothing. Tolerance: rounding.
    const Result result = compute(get_loaded_state(), make_contact_law(GrainMaterial{}));
    Vector sum = Vector::Zero();
    for (std::size_t i = 0; i < result.forces.on_grains.size(); ++i)
      sum += force_on(result, i);
    EXPECT_LT(sum.norm(), 1e-13 * result.sums.normal_force);
  }
} // namespace

// The hot loop's vectors against a plain walk through the pairs, one after the other: what one step gives every grain.

#include "dem/contact_forces.h"

#include "tests/support/rev_cases.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <random>
#include <tuple>

namespace
{
  using namespace dem;
  using namespace dem::cases;

  constexpr double epsilon = std::numeric_limits<double>::epsilon();

  Vector draw_vector(std::mt19937_64 &random, const double size)
  {
    std::normal_distribution<double> normal(0., size);
    return {normal(random), normal(random), normal(random)};
  }

  Row draw_row(std::mt19937_64 &random, const double size)
  {
    const Vector v = draw_vector(random, size);
    return {v.x(), v.y(), v.z(), 1.};
  }

  /** In the order in which a lattice is walked through, pairs are near; in any order, most of them are far. */
  enum class Storage
  {
    in_rows,
    shuffled
  };

  /** A leaning lattice of 11 x 10 x 10 grains, shaken by a few roughnesses, so that pairs touch at all stages of the
   *  law or just do not; four blocks of the hot loop. Unequal, moving and turning grains, some of them outside. */
  RevState make_lattice(const Storage storage, const std::uint64_t seed)
  {
    constexpr int counts[] = {11, 10, 10};
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> size(0.97, 1.03);
    std::uniform_int_distribution<int> image(-1, 1);
    RevState state = make_state(std::vector<Vector>(counts[0] * counts[1] * counts[2], Vector::Zero()), 1.);
    state.cell.edges << 1., 0.1, -0.1, 0., std::sqrt(0.99), 0.1, 0., 0., std::sqrt(0.98);
    for (int k = 0; k < 3; ++k)
      state.cell.edges.col(k) *= 2. * radius * counts[k];
    const Matrix to_fraction = state.cell.edges.inverse();
    std::vector<std::size_t> order(state.grains.size());
    std::iota(order.begin(), order.end(), 0);
    if (storage == Storage::shuffled)
      std::shuffle(order.begin(), order.end(), random);
    std::size_t n = 0;
    for (int x = 0; x < counts[0]; ++x)
      for (int y = 0; y < counts[1]; ++y)
        for (int z = 0; z < counts[2]; ++z, ++n)
          {
            const std::size_t i = order[n];
            const Vector shaken = to_fraction * draw_vector(random, 1e-2 * radius);
            state.grains.place[i] = {(x + 0.5) / counts[0] + shaken.x() + image(random),
                                     (y + 0.5) / counts[1] + shaken.y(),
                                     (z + 0.5) / counts[2] + shaken.z() + image(random), size(random) * radius};
            state.grains.velocity[i] = draw_row(random, 3e-3 * radius);
            state.grains.spin[i] = draw_row(random, 3e-3);
          }
    return state;
  }

  /** Shear forces before the step, also of pairs that have opened since; a third of the pairs remember nothing. */
  void draw_memories(ContactNetwork &network, const ContactLaw &law, std::mt19937_64 &random)
  {
    const double size = 0.5 * law.friction * compute_normal_response(law, 1e-2 * radius, 0.5 * radius).force;
    for (std::size_t k = 0; k < network.size(); ++k)
      if (network.is_pair(k) && k % 3 != 0)
        network.set_shear(k, draw_vector(random, size), PairStatus::sticks);
  }

  /** One pair after the step. */
  struct PairAnswer
  {
    bool is_touching = false, is_sliding = false;
    Vector branch, normal, shear; ///< shear force on a [N]
    double arm_a = 0., arm_b = 0.;
    int stage = 0; ///< of the law: asperities, transition, Hertz
    NormalResponse response{0., 0.};
    double rounding = 0.;     ///< of normal force and stiffness, relative
    double shear_error = 0.;  ///< of the shear force by rounding [N]
    double share_of_cap = 0.; ///< of friction, before the cap
  };

  Vector flatten(const Vector &v, const Vector &normal)
  {
    return v - v.dot(normal) * normal;
  }

  /** Shear force of a pair that touches, docs/theory.md Eq. 12-13 as they are read. @param before  shear force so far
   */
  void add_shear(const ForceTask &task, const std::uint32_t a, const std::uint32_t b, Vector before, PairAnswer &pair)
  {
    const Grains &grains = task.state.grains;
    const Motion &motion = task.motion;
    Vector velocity = to_vector(grains.velocity[b]) - to_vector(grains.velocity[a]);
    if (motion.is_rotation_free)
      {
        const Vector spin_a = to_vector(grains.spin[a]), spin_b = to_vector(grains.spin[b]);
        velocity += pair.normal.cross(pair.arm_a * spin_a + pair.arm_b * spin_b);
        before += 0.5 * motion.time_step * (spin_a + spin_b).dot(pair.normal) * pair.normal.cross(before);
      }
    const Vector step = motion.strain_increment * pair.branch + motion.time_step * velocity;
    const double kt = task.law.shear_ratio * pair.response.stiffness, cap = task.law.friction * pair.response.force;
    const Vector flat = flatten(before, pair.normal);
    const double stretch = flat.norm() > 0. ? before.norm() / flat.norm() : 0.;
    pair.shear = stretch * flat + kt * flatten(step, pair.normal);
    pair.share_of_cap = pair.shear.norm() / cap;
    pair.is_sliding = pair.share_of_cap > 1.;
    if (pair.is_sliding)
      pair.shear /= pair.share_of_cap;
    // Of a memory that leans out of the contact plane only a small difference of squares counts.
    pair.shear_error = pair.rounding * (cap + kt * step.norm()) + 8. * epsilon * stretch * stretch * before.norm();
  }

  PairAnswer answer(const ForceTask &task, const std::uint32_t a, const std::uint32_t b, const Vector &before)
  {
    const Row &place_a = task.state.grains.place[a], &place_b = task.state.grains.place[b];
    PairAnswer pair;
    pair.branch = compute_branch(task.state.cell, place_a, place_b);
    const double distance = pair.branch.norm(), overlap = place_a.w + place_b.w - distance;
    pair.is_touching = overlap > 0.;
    if (!pair.is_touching)
      return pair;
    pair.normal = pair.branch / distance;
    pair.arm_a = place_a.w - 0.5 * overlap;
    pair.arm_b = place_b.w - 0.5 * overlap;
    pair.stage = int(overlap > task.law.dT1) + int(overlap > task.law.dT2);
    pair.response = compute_normal_response(task.law, overlap, compute_effective_radius(place_a.w, place_b.w));
    // The overlap is a small difference of lengths, and the law takes it to the third power at most.
    pair.rounding = 1e-13 + 12. * epsilon * distance / overlap;
    add_shear(task, a, b, before, pair);
    return pair;
  }

  /** What acts on the grains, and how far two ways of rounding may differ in it. */
  struct Reference
  {
    std::vector<Vector> force, torque;
    std::vector<double> stiffness, turning_stiffness;
    std::vector<double> force_error, stiffness_error;
    ContactSums sums;
    std::size_t n_sliding = 0, n_opened = 0;
    std::size_t n_in_stage[3] = {0, 0, 0}; ///< of the law

    explicit Reference(const std::size_t n)
        : force(n, Vector::Zero()), torque(n, Vector::Zero()), stiffness(n, 0.), turning_stiffness(n, 0.),
          force_error(n, 0.), stiffness_error(n, 0.)
    {}

    void add(std::uint32_t a, std::uint32_t b, const PairAnswer &pair);
  };

  void Reference::add(const std::uint32_t a, const std::uint32_t b, const PairAnswer &pair)
  {
    const double kn = pair.response.stiffness, mean_arm = 0.5 * (pair.arm_a + pair.arm_b);
    const Vector on_a = pair.shear - pair.response.force * pair.normal, moment = pair.normal.cross(pair.shear);
    for (const auto &[i, sign, arm] : {std::tuple{a, 1., pair.arm_a}, {b, -1., pair.arm_b}})
      {
        force[i] += sign * on_a;
        torque[i] += arm * moment;
        stiffness[i] += kn;
        turning_stiffness[i] += kn * arm * mean_arm;
        force_error[i] += pair.rounding * pair.response.force + pair.shear_error;
        stiffness_error[i] += pair.rounding * kn;
      }
    sums.force_times_branch += on_a * pair.branch.transpose();
    sums.normal_force += pair.response.force;
    sums.stiffness += 2. * kn;
    sums.turning_stiffness += 2. * kn * mean_arm * mean_arm;
    sums.stiffness_moment += kn * pair.branch.squaredNorm();
    ++sums.n_touching;
    n_sliding += pair.is_sliding;
    ++n_in_stage[pair.stage];
  }

  /** A lattice with memories, and how it moves. */
  struct StepCase
  {
    ContactLaw law;
    RevState state;
    ContactNetwork network; ///< before the step
    Motion motion;

    StepCase(const double roughness, const bool is_rotation_free, const Storage storage)
    {
      GrainMaterial material;
      material.roughness = roughness;
      law = make_contact_law(material);
      state = make_lattice(storage, 11);
      network = build_contact_network(state, 0.1 * radius);
      std::mt19937_64 random(12);
      draw_memories(network, law, random);
      motion.time_step = 0.7;
      motion.strain_increment << 1e-3, -2e-3, 0.5e-3, 2e-3, -1e-3, 0.3e-3, 0.7e-3, -0.4e-3, 2e-3;
      motion.is_rotation_free = is_rotation_free;
      motion.has_contact_stress = true;
    }

    ForceTask get_task() const { return {state, law, motion}; }
  };

  /** All pairs one after the other; compares what the pairs themselves keep. @param after  network after the step */
  Reference walk(const StepCase &step, const ContactNetwork &after)
  {
    Reference reference(step.state.grains.size());
    for (std::size_t k = 0; k < after.size(); ++k)
      if (after.is_pair(k))
        {
          const std::uint32_t a = after.a[k], b = after.b[k];
          const PairAnswer pair = answer(step.get_task(), a, b, step.network.get_shear(k));
          reference.n_opened += !pair.is_touching && step.network.status[k] != PairStatus::is_apart;
          if (!pair.is_touching)
            {
              EXPECT_EQ(after.status[k], PairStatus::is_apart);
              EXPECT_EQ(after.get_shear(k), Vector::Zero());
              continue;
            }
          reference.add(a, b, pair);
          EXPECT_LT((after.get_shear(k) - pair.shear).norm(), pair.shear_error);
          if (std::abs(pair.share_of_cap - 1.) > 1e-9) // nearer, the last bits decide
            {
              EXPECT_EQ(after.status[k], pair.is_sliding ? PairStatus::slides : PairStatus::sticks);
            }
        }
    return reference;
  }

  /** What the hot loop gives the grains, kept or passed on block by block. */
  struct Given
  {
    std::vector<Row> force, torque;
    ContactSums sums;
  };

  Given give(const StepCase &step, ContactNetwork &network, const std::size_t n_threads, const bool is_passed)
  {
    const std::size_t n_grains_of_case = step.state.grains.size();
    Forces forces;
    Given given{std::vector<Row>(n_grains_of_case), std::vector<Row>(n_grains_of_case), {}};
    const auto take_some = [&](const std::size_t begin, const std::size_t end, const ForceRows &rows) {
      for (std::size_t i = begin; i < end; ++i)
        {
          given.force[i] = rows.force(i);
          if (step.motion.is_rotation_free)
            given.torque[i] = rows.torque(i);
        }
    };
    const auto take = [&](const std::size_t k, const ForceRows &rows) {
      take_some(network.blocks[k].grain_begin, network.blocks[k].grain_end, rows);
    };
    Team team(n_threads);
    given.sums =
        compute_contact_forces(step.get_task(), network, forces, team, is_passed ? BlockHook(take) : BlockHook());
    if (!is_passed)
      take_some(0, n_grains_of_case, forces.on_grains.get_rows());
    return given;
  }

  void expect_equal(const Given &given, const Reference &reference, const bool is_rotation_free)
  {
    const double arm = 1.1 * radius; // longer than any
    for (std::size_t i = 0; i < given.force.size(); ++i)
      {
        const double force_error = reference.force_error[i], stiffness_error = reference.stiffness_error[i];
        ASSERT_LE((to_vector(given.force[i]) - reference.force[i]).norm(), force_error) << i;
        ASSERT_NEAR(given.force[i].w, reference.stiffness[i], stiffness_error) << i;
        if (!is_rotation_free)
          continue;
        ASSERT_LE((to_vector(given.torque[i]) - reference.torque[i]).norm(), arm * force_error) << i;
        ASSERT_NEAR(given.torque[i].w, reference.turning_stiffness[i], arm * arm * stiffness_error) << i;
      }
    const ContactSums &sums = given.sums, &expected = reference.sums;
    const double share = 1e-11; // a contact's overlap is 1/1000 of its branch and more, but for a few
    EXPECT_EQ(sums.n_touching, expected.n_touching);
    EXPECT_LT((sums.force_times_branch - expected.force_times_branch).norm(),
              share * expected.force_times_branch.norm());
    EXPECT_NEAR(sums.normal_force, expected.normal_force, share * expected.normal_force);
    EXPECT_NEAR(sums.stiffness, expected.stiffness, share * expected.stiffness);
    EXPECT_NEAR(sums.stiffness_moment, expected.stiffness_moment, share * expected.stiffness_moment);
    if (is_rotation_free)
      {
        EXPECT_NEAR(sums.turning_stiffness, expected.turning_stiffness, share * expected.turning_stiffness);
      }
  }

  TEST(PairLoop, GivesGrainsWhatAPlainWalkGives)
  {
    // Law: docs/theory.md Eq. 1-7 and 12-13, pair after pair: forces, torques, stiffnesses, memories and sums of one
    // step, in all stages of the law, near and far pairs, vectors that are full and not, grains blocked and free to
    // turn, rows kept and passed on, whoever computes. Tolerance: rounding, contact by contact, 1e-12 for most.
    for (const double roughness : {0.15e-6, 0.})
      for (const bool is_rotation_free : {false, true})
        for (const Storage storage : {Storage::in_rows, Storage::shuffled})
          {
            const StepCase step(roughness, is_rotation_free, storage);
            ASSERT_EQ(step.network.blocks.size(), 4u);
            for (const auto &[n_threads, is_passed] : {std::pair{1, false}, {3, false}, {1, true}, {3, true}})
              {
                ContactNetwork network = step.network;
                const Given given = give(step, network, static_cast<std::size_t>(n_threads), is_passed);
                const Reference reference = walk(step, network);
                expect_equal(given, reference, is_rotation_free);
                EXPECT_GT(reference.n_sliding, 100u);
                EXPECT_GT(reference.sums.n_touching - reference.n_sliding, 100u);
                EXPECT_GT(reference.n_opened, 100u);
                if (roughness > 0.)
                  {
                    EXPECT_GT(*std::ranges::min_element(reference.n_in_stage), 100u);
                  }
              }
          }
  }
} // namespace

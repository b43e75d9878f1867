#pragma once

#include "dem/contact_forces.h"
#include "dem/contact_lanes.h"

#include <algorithm>
#include <limits>

namespace dem
{
  [[gnu::always_inline]] inline LaneVector apply(const Matrix &m, const LaneVector &v)
  {
    return {m(0, 0) * v.x + m(0, 1) * v.y + m(0, 2) * v.z, m(1, 0) * v.x + m(1, 1) * v.y + m(1, 2) * v.z,
            m(2, 0) * v.x + m(2, 1) * v.y + m(2, 2) * v.z};
  }

  /**
   * The pairs of a block, some vectors at a time, in three stages with a small buffer between them: where pairs are
   * and how hard they press, what shears them, and what grains get from it. Each stage is short enough for the
   * processor to work on several vectors at once.
   */
  template <bool is_rough, bool is_rotation_free>
  class PairLoop
  {
  public:
    /** @param rows  of the grains of the block */
    PairLoop(const ForceTask &task, ContactNetwork &network, Forces &forces, const ForceRows &rows)
        : law_(task.law), grains_(task.state.grains), edges_(task.state.cell.edges),
          strain_(task.motion.strain_increment), time_step_(task.motion.time_step),
          has_contact_stress_(task.motion.has_contact_stress), network_(network), forces_(forces), rows_(rows)
    {}

    /** Near pairs: both grains get their force at once. */
    void run_near(const GrainBlock &block)
    {
      for (std::size_t k = block.near_begin; k < block.far_begin; k += pairs_at_once)
        {
          compute(k, block.far_begin);
          for (std::size_t i = 0; i < n_vectors_; ++i)
            give<false>(i, k + i * n_lanes, 0);
        }
    }

    /** Far pairs: what the second grain gets waits in `far_force` and `far_torque`. */
    void run_far(const GrainBlock &block)
    {
      for (std::size_t k = block.far_begin; k < block.far_end; k += pairs_at_once)
        {
          compute(k, block.far_end);
          for (std::size_t i = 0; i < n_vectors_; ++i)
            give<true>(i, k + i * n_lanes, block.first_far + (k + i * n_lanes - block.far_begin));
        }
    }

    ContactSums finish() const
    {
      ContactSums sums;
      for (int k = 0; k < 9; ++k)
        sums.force_times_branch(k / 3, k % 3) = sum_lanes(moment_[k]);
      sums.normal_force = sum_lanes(normal_force_);
      sums.stiffness_moment = sum_lanes(stiffness_moment_);
      for (int i = 0; i < n_lanes; ++i)
        sums.n_touching += static_cast<std::size_t>(n_touching_[i]);
      return sums;
    }

  private:
    static constexpr std::size_t buffer_size = 4; // vectors: measured, 2 to 16 differ by some 10 %
    static constexpr std::size_t pairs_at_once = buffer_size * n_lanes;
    static constexpr std::int64_t sign = std::numeric_limits<std::int64_t>::min();
    static constexpr RowMask opposite_force{sign, sign, sign, 0}; // b's stiffness adds up as a's does

    [[gnu::always_inline]] void compute(const std::size_t k, const std::size_t end)
    {
      n_vectors_ = std::min(buffer_size, (end - k) / n_lanes);
      for (std::size_t i = 0; i < n_vectors_; ++i)
        press(i, k + i * n_lanes);
      for (std::size_t i = 0; i < n_vectors_; ++i)
        shear(i, k + i * n_lanes);
    }

    /** Where pairs k to k + 7 are, which of them touch, and how hard they press. */
    [[gnu::always_inline]] void press(const std::size_t i, const std::size_t k)
    {
      const RowsOfLanes apart = load_differences(grains_.place.data(), &network_.a[k], &network_.b[k]);
      const LaneVector fraction{apart.x - round_lanes(apart.x), apart.y - round_lanes(apart.y),
                                apart.z - round_lanes(apart.z)};
      const LaneVector branch = apply(edges_, fraction);
      const Lanes square = dot(branch, branch), sum = load_lanes(&network_.radius_sum[k]);
      // A grain beside itself only fills a lane. Lanes that do not touch are computed too, where it does no harm.
      const LaneMask is_touching = (square < sum * sum) & (square > 0.);
      const Lanes harmless = select(is_touching, square, make_lanes(1.));
      const Lanes inverse = compute_inverse_root(harmless), distance = harmless * inverse;
      const Lanes overlap = keep(is_touching, compute_larger(sum - distance, Lanes{}));
      const Lanes root = load_lanes(&network_.root_radius[k]);
      const NormalLanes normal =
          is_rough ? compute_rough_law(law_, overlap, root) : compute_hertz_law(law_, overlap, root);
      is_touching_[i] = is_touching;
      unit_[i] = {branch.x * inverse, branch.y * inverse, branch.z * inverse};
      distance_[i] = distance;
      normal_[i] = {keep(is_touching, normal.force), keep(is_touching, normal.stiffness)};
      if constexpr (is_rotation_free)
        {
          arm_a_[i] = 0.5 * ((sum - apart.w) - overlap);
          arm_b_[i] = 0.5 * ((sum + apart.w) - overlap);
        }
      if (has_contact_stress_)
        {
          store_lanes(&forces_.normal_force[k], normal_[i].force);
          store_lanes(&forces_.overlap[k], overlap);
        }
    }

    /** Brings the shear forces of pairs k to k + 7 up to date. */
    [[gnu::always_inline]] void shear(const std::size_t i, const std::size_t k)
    {
      const LaneVector unit = unit_[i];
      const LaneVector branch{unit.x * distance_[i], unit.y * distance_[i], unit.z * distance_[i]};
      double *const x = &network_.shear_x[k], *const y = &network_.shear_y[k], *const z = &network_.shear_z[k];
      PairStatus *const pair_status = &network_.status[k];
      LaneVector before{load_lanes(x), load_lanes(y), load_lanes(z)};
      const RowsOfLanes faster = load_differences(grains_.velocity.data(), &network_.a[k], &network_.b[k]);
      LaneVector step = add(apply(strain_, branch), make_lanes(time_step_), {faster.x, faster.y, faster.z});
      if constexpr (is_rotation_free)
        follow_spins(i, k, before, step);
      const ShearLanes shear = compute_shear_law(law_, normal_[i], unit, before, step);
      const LaneMask is_touching = is_touching_[i];
      const LaneVector force{keep(is_touching, shear.force.x), keep(is_touching, shear.force.y),
                             keep(is_touching, shear.force.z)};
      shear_[i] = force;
      store_lanes(x, force.x);
      store_lanes(y, force.y);
      store_lanes(z, force.z);
      // apart 0, sticks 1, slides 2: masks are -1 or 0
      const LaneMask status = is_touching & (1 - shear.is_sliding);
      using Bytes = std::int8_t __attribute__((vector_size(n_lanes)));
      const Bytes bytes = __builtin_convertvector(status, Bytes);
      __builtin_memcpy(pair_status, &bytes, sizeof bytes);
    }

    /** Spins slide the surfaces at the contact, and turn the shear force about the normal by their mean. */
    [[gnu::always_inline]] void follow_spins(const std::size_t i, const std::size_t k, LaneVector &shear,
                                             LaneVector &step) const
    {
      const RowsOfLanes a = load_rows(grains_.spin.data(), &network_.a[k]);
      const RowsOfLanes b = load_rows(grains_.spin.data(), &network_.b[k]);
      const Lanes arm_a = arm_a_[i], arm_b = arm_b_[i];
      const LaneVector rolling{arm_a * a.x + arm_b * b.x, arm_a * a.y + arm_b * b.y, arm_a * a.z + arm_b * b.z};
      step = add(step, make_lanes(time_step_), cross(unit_[i], rolling));
      const LaneVector both{a.x + b.x, a.y + b.y, a.z + b.z};
      shear = add(shear, 0.5 * time_step_ * dot(both, unit_[i]), cross(unit_[i], shear));
    }

    /** Gives the grains of pairs k to k + 7 their forces, pair by pair. */
    template <bool is_far>
    [[gnu::always_inline]] void give(const std::size_t i, const std::size_t k, const std::size_t far)
    {
      const NormalLanes normal = normal_[i];
      const LaneVector force = add(shear_[i], -normal.force, unit_[i]);
      add_to_sums(i, force);
      const std::uint32_t *const a = &network_.a[k], *const b = &network_.b[k];
      Row *const forces = rows_.force, *const far_forces = forces_.far_force.data() + far;
      give_rows({force.x, force.y, force.z, normal.stiffness}, [=](const int j, const RowLanes row) {
        add_row(forces[a[j]], row);
        const RowLanes opposite = reinterpret_cast<RowLanes>(reinterpret_cast<RowMask>(row) ^ opposite_force);
        if constexpr (is_far)
          store_row(far_forces[j], opposite);
        else
          add_row(forces[b[j]], opposite);
      });
      if constexpr (is_rotation_free)
        give_torques<is_far>(i, k, far);
    }

    template <bool is_far>
    [[gnu::always_inline]] void give_torques(const std::size_t i, const std::size_t k, const std::size_t far)
    {
      const LaneVector moment = cross(unit_[i], shear_[i]); // over the lever arm
      const auto *const arm_a = reinterpret_cast<const LaneArray *>(&arm_a_[i]),
                        *const arm_b = reinterpret_cast<const LaneArray *>(&arm_b_[i]);
      const std::uint32_t *const a = &network_.a[k], *const b = &network_.b[k];
      Row *const torques = rows_.torque, *const far_torques = forces_.far_torque.data() + far;
      const Lanes stiffness = 0.5 * (arm_a_[i] + arm_b_[i]) * normal_[i].stiffness;
      give_rows({moment.x, moment.y, moment.z, stiffness}, [=](const int j, const RowLanes row) {
        add_row(torques[a[j]], (*arm_a)[j] * row);
        if constexpr (is_far)
          store_row(far_torques[j], (*arm_b)[j] * row);
        else
          add_row(torques[b[j]], (*arm_b)[j] * row);
      });
    }

    [[gnu::always_inline]] void add_to_sums(const std::size_t i, const LaneVector &force)
    {
      const Lanes distance = distance_[i];
      const LaneVector x{unit_[i].x * distance, unit_[i].y * distance, unit_[i].z * distance};
      moment_[0] += force.x * x.x, moment_[1] += force.x * x.y, moment_[2] += force.x * x.z;
      moment_[3] += force.y * x.x, moment_[4] += force.y * x.y, moment_[5] += force.y * x.z;
      moment_[6] += force.z * x.x, moment_[7] += force.z * x.y, moment_[8] += force.z * x.z;
      normal_force_ += normal_[i].force;
      stiffness_moment_ += normal_[i].stiffness * distance * distance;
      n_touching_ -= is_touching_[i];
    }

    using LaneArray [[gnu::may_alias]] = double[n_lanes];

    const ContactLaw law_;
    const Grains &grains_;
    const Matrix edges_, strain_;
    const double time_step_;
    const bool has_contact_stress_;
    ContactNetwork &network_;
    Forces &forces_;
    const ForceRows rows_;

    std::size_t n_vectors_ = 0; // in the buffer now
    LaneMask is_touching_[buffer_size];
    LaneVector unit_[buffer_size];                  // (x_b - x_a) / distance
    Lanes distance_[buffer_size];                   // [m]
    Lanes arm_a_[buffer_size], arm_b_[buffer_size]; // R - d/2 [m]
    NormalLanes normal_[buffer_size];
    LaneVector shear_[buffer_size]; // t on a [N]

    // Sums over contacts, one a lane until the end of a block.
    Lanes moment_[9] = {}, normal_force_ = {}, stiffness_moment_ = {};
    LaneMask n_touching_ = {};
  };
} // namespace dem

#pragma once

#include "dem/contact_forces.h"
#include "dem/contact_lanes.h"
#include "dem/fetch.h"
#include "dem/lane_rows.h"
#include "dem/lane_sums.h"

#include <algorithm>
#include <limits>

namespace dem
{
  [[gnu::always_inline]] inline LaneVector apply(const Matrix &m, const LaneVector &v)
  {
    return {m(0, 0) * v.x + m(0, 1) * v.y + m(0, 2) * v.z, m(1, 0) * v.x + m(1, 1) * v.y + m(1, 2) * v.z,
            m(2, 0) * v.x + m(2, 1) * v.y + m(2, 2) * v.z};
  }

  /** The same of a diagonal matrix. */
  [[gnu::always_inline]] inline LaneVector stretch(const Matrix &m, const LaneVector &v)
  {
    return {m(0, 0) * v.x, m(1, 1) * v.y, m(2, 2) * v.z};
  }

  /**
   * The pairs of a block, sixteen at a time: where they are and how hard they press, what shears them, and what grains
   * get from it.
   */
  template <bool is_rough, bool is_rotation_free>
  class PairLoop
  {
  public:
    /** @param rows  of the grains of the block */
    PairLoop(const ForceTask &task, ContactNetwork &network, Forces &forces, const ForceRows &rows)
        : law_(task.law), place_(task.state.grains.place.data()), velocity_(task.state.grains.velocity.data()),
          spin_(task.state.grains.spin.data()), edges_(task.state.cell.edges), strain_(task.motion.strain_increment),
          time_step_(task.motion.time_step), has_contact_stress_(task.motion.has_contact_stress),
          has_sums_(task.motion.has_sums), is_beyond_cache_(task.state.grains.size() > cached_grains),
          network_(network), forces_(forces), results_(rows.get<is_rotation_free>()),
          results_of_far_(forces.of_far.get_rows().get<is_rotation_free>())
    {}

    /** Near pairs: both grains get their force at once. The next block is called into the cache meanwhile. */
    void run_near(const GrainBlock &block)
    {
      std::size_t grain = block.grain_end, far = block.near_end;
      for (std::size_t k = block.near_begin; k < block.near_end; k += n_lanes)
        {
          if (is_beyond_cache_)
            {
              fetch_grains(grain);
              fetch_second_grains(far);
              grain += fetched_grains, far += fetched_far;
            }
          compute<false>(k, 0);
        }
    }

    /** Far pairs: what the second grain gets waits in `Forces::of_far`. */
    void run_far(const GrainBlock &block)
    {
      for (std::size_t k = block.far_begin; k < block.near_begin; k += n_lanes)
        compute<true>(k, block.first_far + (k - block.far_begin));
    }

    ContactSums finish() const { return has_sums_ ? sums_.add_up() : get_unknown_sums(); }

  private:
    using Result = ActionOf<is_rotation_free>;

    static constexpr std::size_t fetch_ahead = n_lanes; ///< pairs; their lists are called twice as far ahead
    static constexpr std::size_t fetched_grains = 6;    ///< with each vector of near pairs, of the next block
    static constexpr std::size_t fetched_far = 4;       ///< likewise, far pairs
    static constexpr double far_apart = 1e200;          ///< squared [m2]

    /** How grains move against each other. */
    struct Relative
    {
      LaneVector velocity;   ///< of b less that of a [m/s]
      LaneVector both, more; ///< spins of b and a, sum and difference [1/s]; free rotation only
    };

    /** How pairs touch. */
    struct Touch
    {
      LaneMask is_touching;
      LaneVector branch; ///< x_b - x_a [m]
      Lanes square;      ///< of the branch; where apart, more than any [m2]
      LaneVector unit;   ///< branch / distance
      Lanes distance;    ///< [m]
      Lanes mean_arm;    ///< of R - d/2 [m]; free rotation only
      Lanes more_arm;    ///< half of what b's has more than a's [m]
      Lanes overlap;     ///< [m]
      NormalLanes normal;
    };

    template <bool is_far>
    [[gnu::always_inline]] void compute(const std::size_t k, const std::size_t far)
    {
      if (is_beyond_cache_)
        fetch_pairs<is_far>(std::min(k + fetch_ahead, network_.size() - n_lanes), far + fetch_ahead);
      // Loads stand between the roots, whose results nobody can use at once.
      Touch touch = locate(k);
      if (!is_any(touch.is_touching))
        return leave_apart<is_far>(k, far);
      Relative relative;
      load_velocities(k, relative);
      measure(k, touch);
      if constexpr (is_rotation_free)
        load_spins(k, relative);
      press(k, touch);
      const LaneVector shear = update_shear(k, touch, relative);
      const LaneVector force = add(shear, -touch.normal.force, touch.unit);
      if (has_sums_) // not another function, in which the compiler would round in other places
        sums_.add(force, touch.branch, touch.normal, touch.distance, touch.is_touching);
      give<is_far>(k, far, touch, force, shear);
    }

    /**
     * Calls later pairs into the cache, and before them their second grains: these come in no order that the processor
     * could foresee, and at each page of memory it begins anew to see the order of the others.
     */
    template <bool is_far>
    [[gnu::always_inline]] void fetch_pairs(const std::size_t k, const std::size_t far) const
    {
      for (const double *const list : {&network_.radius_sum[k], &network_.root_radius[k], &network_.shear_x[k],
                                       &network_.shear_y[k], &network_.shear_z[k]})
        fetch(list + fetch_ahead, n_lanes);
      fetch(&network_.row_a[k] + 2 * fetch_ahead);
      fetch(&network_.row_b[k] + 2 * fetch_ahead);
      for (int j = 0; j < n_lanes; ++j)
        {
          const RowOffset b = network_.row_b[k + j];
          fetch(&get_row(place_, b));
          fetch(&get_row(velocity_, b));
          if constexpr (is_rotation_free)
            fetch(&get_row(spin_, b));
        }
      if constexpr (is_far)
        fetch_to_write(results_of_far_ + far, n_lanes);
    }

    /** Calls grains of the next block. */
    [[gnu::always_inline]] void fetch_grains(const std::size_t i) const
    {
      fetch_for_later(place_ + i, fetched_grains);
      fetch_for_later(velocity_ + i, fetched_grains);
      if constexpr (is_rotation_free)
        fetch_for_later(spin_ + i, fetched_grains);
    }

    /** Calls second grains of far pairs of the next block: they come from all over memory, and while near pairs are
     * computed memory has the time. */
    [[gnu::always_inline]] void fetch_second_grains(const std::size_t far) const
    {
      fetch(&network_.row_b[0] + far + fetch_ahead);
      for (std::size_t k = far; k < std::min(far + fetched_far, network_.size()); ++k)
        {
          const RowOffset b = network_.row_b[k];
          fetch_for_later(&get_row(place_, b));
          fetch_for_later(&get_row(velocity_, b));
          if constexpr (is_rotation_free)
            fetch_for_later(&get_row(spin_, b));
        }
    }

    /** Where pairs are, and which of them touch. */
    [[gnu::always_inline]] Touch locate(const std::size_t k) const
    {
      const RowsOfLanes apart = load_differences(place_, &network_.row_a[k], &network_.row_b[k]);
      Touch touch;
      const LaneVector rest{compute_remainder(apart.x), compute_remainder(apart.y), compute_remainder(apart.z)};
      touch.branch = is_upright_ ? stretch(edges_, rest) : apply(edges_, rest);
      const Lanes square = dot(touch.branch, touch.branch), sum = load_lanes(&network_.radius_sum[k]);
      touch.is_touching = (square < sum * sum) & (0. < square); // a grain beside itself only fills a lane
      touch.square = select(touch.is_touching, square, far_apart);
      touch.more_arm = 0.5 * apart.w;
      return touch;
    }

    /** Sixteen pairs none of which touches. */
    template <bool is_far>
    [[gnu::always_inline]] void leave_apart(const std::size_t k, const std::size_t far) const
    {
      for (double *const memory : {&network_.shear_x[k], &network_.shear_y[k], &network_.shear_z[k]})
        store_lanes(memory, 0.);
      std::fill_n(&network_.status[k], n_lanes, PairStatus::is_apart);
      if (has_contact_stress_)
        for (double *const known : {&forces_.normal_force[k], &forces_.overlap[k]})
          store_lanes(known, 0.);
      if constexpr (is_far)
        std::fill_n(results_of_far_ + far, n_lanes, Result{});
    }

    [[gnu::always_inline]] void load_velocities(const std::size_t k, Relative &relative) const
    {
      const RowsOfLanes faster = load_differences(velocity_, &network_.row_a[k], &network_.row_b[k]);
      relative.velocity = {faster.x, faster.y, faster.z};
    }

    [[gnu::always_inline]] void load_spins(const std::size_t k, Relative &relative) const
    {
      const auto [sum, difference] = load_sums_and_differences(spin_, &network_.row_a[k], &network_.row_b[k]);
      relative.both = {sum.x, sum.y, sum.z};
      relative.more = {difference.x, difference.y, difference.z};
    }

    /** Distance and overlap. All lanes are computed: apart, the overlap is zero, and so is all that follows from it. */
    [[gnu::always_inline]] void measure(const std::size_t k, Touch &touch) const
    {
      const Lanes inverse = compute_inverse_root(touch.square), sum = load_lanes(&network_.radius_sum[k]);
      touch.distance = touch.square * inverse;
      touch.unit = {touch.branch.x * inverse, touch.branch.y * inverse, touch.branch.z * inverse};
      touch.overlap = compute_larger(sum - touch.distance, 0.);
      touch.mean_arm = 0.5 * (sum - touch.overlap);
    }

    /** How hard pairs press. */
    [[gnu::always_inline]] void press(const std::size_t k, Touch &touch) const
    {
      const Lanes root = load_lanes(&network_.root_radius[k]);
      touch.normal =
          is_rough ? compute_rough_law(law_, touch.overlap, root) : compute_hertz_law(law_, touch.overlap, root);
      if constexpr (is_rough) // its power does not reach zero
        touch.normal = {keep(touch.is_touching, touch.normal.force), keep(touch.is_touching, touch.normal.stiffness)};
      if (has_contact_stress_)
        {
          store_lanes(&forces_.normal_force[k], touch.normal.force);
          store_lanes(&forces_.overlap[k], touch.overlap);
        }
    }

    /** Brings the shear forces of pairs up to date. @return them; zero where apart */
    [[gnu::always_inline]] LaneVector update_shear(const std::size_t k, const Touch &touch,
                                                   const Relative &relative) const
    {
      double *const x = &network_.shear_x[k], *const y = &network_.shear_y[k], *const z = &network_.shear_z[k];
      LaneVector before{load_lanes(x), load_lanes(y), load_lanes(z)}, velocity = relative.velocity;
      if constexpr (is_rotation_free)
        follow_spins(touch, relative, before, velocity);
      const LaneVector affine = is_upright_ ? stretch(strain_, touch.branch) : apply(strain_, touch.branch);
      const LaneVector step = add(affine, time_step_, velocity);
      const ShearLanes shear = compute_shear_law(law_, touch.normal, touch.unit, before, step);
      store_lanes(x, shear.force.x);
      store_lanes(y, shear.force.y);
      store_lanes(z, shear.force.z);
      store_sorts(&network_.status[k], touch.is_touching, shear.is_sliding);
      return shear.force;
    }

    /** Spins slide the surfaces at the contact, and turn the shear force about the normal by their mean. */
    [[gnu::always_inline]] void follow_spins(const Touch &touch, const Relative &relative, LaneVector &shear,
                                             LaneVector &velocity) const
    {
      // Arm a times spin a plus arm b times spin b, by the mean and the half difference of either.
      const Lanes mean = touch.mean_arm, half = touch.more_arm;
      const LaneVector &both = relative.both, &more = relative.more;
      velocity =
          add_cross(velocity, touch.unit,
                    {mean * both.x + half * more.x, mean * both.y + half * more.y, mean * both.z + half * more.z});
      const Lanes twist = 0.5 * time_step_ * dot(both, touch.unit);
      shear = add_cross(shear, {twist * touch.unit.x, twist * touch.unit.y, twist * touch.unit.z}, shear);
    }

    /** Gives the grains of pairs their forces, and torques where they can turn, pair by pair. */
    template <bool is_far>
    [[gnu::always_inline]] void give(const std::size_t k, const std::size_t far, const Touch &touch,
                                     const LaneVector &force, const LaneVector &shear) const
    {
      const RowOffset *const a = &network_.row_a[k], *const b = &network_.row_b[k];
      Result *const results = results_, *const far_results = results_of_far_ + far;
      const RowsOfLanes forces{force.x, force.y, force.z, touch.normal.stiffness};
      if constexpr (is_rotation_free)
        {
          const LaneVector moment = cross(touch.unit, shear); // over the lever arm
          alignas(64) double arm_a[n_lanes], arm_b[n_lanes];
          store_lanes(arm_a, touch.mean_arm - touch.more_arm);
          store_lanes(arm_b, touch.mean_arm + touch.more_arm);
          const RowsOfLanes torques{moment.x, moment.y, moment.z, touch.mean_arm * touch.normal.stiffness};
          const RowLanes same{1., 1., 1., 1.}, opposite{-1., -1., -1., 1.}; // b's stiffness adds up as a's does
          give_actions(forces, torques, [&](const int j, const ActionLanes action) {
            Result &of_a = get_row(results, a[j]);
            store_row(of_a, join(same, arm_a[j]) * action + load_row(of_a));
            const ActionLanes share = join(opposite, arm_b[j]);
            if constexpr (is_far)
              store_row(far_results[j], share * action);
            else
              {
                Result &of_b = get_row(results, b[j]);
                store_row(of_b, share * action + load_row(of_b));
              }
          });
        }
      else
        {
          constexpr std::int64_t sign = std::numeric_limits<std::int64_t>::min();
          constexpr RowMask opposite{sign, sign, sign, 0}; // likewise
          give_rows(forces, [=](const int j, const RowLanes row) {
            add_row(get_row(results, a[j]), row);
            const RowLanes on_b = reinterpret_cast<RowLanes>(reinterpret_cast<RowMask>(row) ^ opposite);
            if constexpr (is_far)
              store_row(far_results[j], on_b);
            else
              add_row(get_row(results, b[j]), on_b);
          });
        }
    }

    const ContactLaw law_;
    const Row *const place_, *const velocity_, *const spin_;
    const Matrix edges_, strain_;
    const double time_step_;
    const bool has_contact_stress_, has_sums_, is_beyond_cache_;
    const bool is_upright_ = edges_.isDiagonal(0.) && strain_.isDiagonal(0.);
    ContactNetwork &network_;
    Forces &forces_;
    Result *const results_, *const results_of_far_; // on grains; of far pairs
    LaneSums<Lanes> sums_;
  };
} // namespace dem

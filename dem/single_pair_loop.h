#pragma once

#include "dem/contact_forces.h"
#include "dem/fetch.h"
#include "dem/lane_sums.h"
#include "dem/single_grains.h"
#include "dem/single_twins.h"

#include <algorithm>

namespace dem
{
  /** Where results of the loop that are not kept in packs go. */
  struct SinglePairResults
  {
    TwinRow *forces;      ///< of the grains of the block
    TwinRow *far_forces;  ///< of all far pairs
    PairStatus *status;   ///< of all pairs
    double *normal_force; ///< of all pairs [N]; filled when contact stress is asked for
    double *overlap;      ///< likewise [m]
  };

  /**
   * The pairs of a block in single precision, as many at a time as L has lanes: PairLoop's work by the same law.
   * Overlap and branch are those when the network was built plus their change since (docs/theory.md Eq. 6.14).
   */
  template <bool is_rough, bool is_rotation_free, bool is_upright>
  class SinglePairLoop
  {
  public:
    SinglePairLoop(const SingleTask &task, const SingleGrains &grains, std::vector<SinglePack> &packs,
                   const SinglePairResults &results)
        : task_(task), counts_(grains.counts.data()), motion_(grains.motion.data()), packs_(packs.data()),
          n_packs_(packs.size()), is_beyond_cache_(grains.counts.size() > cached_grains), results_(results)
    {}

    /** Near pairs: both grains get their force at once. The next block is called into the cache meanwhile. */
    void run_near(const GrainBlock &block)
    {
      next_grain_ = block.grain_end;
      next_far_ = block.near_end;
      run<false>(block.near_begin, block.near_end, 0);
    }

    /** Far pairs: what the second grain gets waits in `far_forces`. */
    void run_far(const GrainBlock &block) { run<true>(block.far_begin, block.near_begin, block.first_far); }

    ContactSums finish() const { return task_.has_sums ? sums_.add_up() : get_unknown_sums(); }

  private:
    /** How pairs touch, and how their grains move. */
    template <typename L>
    struct Touch
    {
      decltype(L() < L()) is_touching;
      LaneVectorOf<L> branch;   ///< x_b - x_a [m]
      LaneVectorOf<L> unit;     ///< branch / distance
      L distance;               ///< [m]
      L overlap;                ///< [m]; zero where apart
      L mean_arm;               ///< of R - d/2 [m]; free rotation only
      L more_arm;               ///< half of what b's has more than a's [m]
      LaneVectorOf<L> velocity; ///< of b less that of a, at the contact [m/s]
      LaneVectorOf<L> both;     ///< sum of the spins [1/s]
      NormalLanesOf<L> normal;
    };

    template <bool is_far>
    void run(const std::size_t begin, const std::size_t end, const std::size_t far)
    {
      const std::size_t rest = run_in<is_far, Twins>(begin, end, far);
      run_in<is_far, Singles>(rest, end, far + (rest - begin));
    }

    /**
     * As many pairs as there are whole L of. How the next ones have moved is found before forces are given: giving
     * waits for roots and divisions, which this has no part in. Flattened: called pieces of it would pass vectors
     * through memory. @return the first pair that is left
     */
    template <bool is_far, typename L>
    [[gnu::flatten]] std::size_t run_in(std::size_t k, const std::size_t end, std::size_t far)
    {
      constexpr std::size_t width = n_parts<L> * n_singles;
      if (k + width > end)
        return k;
      LaneVectorOf<L> moves = load_moves<L>(packs_ + k / n_singles);
      for (; k + width <= end; k += width, far += width)
        {
          const std::size_t next = k + 2 * width <= end ? k + width : k;
          compute<is_far, L>(k, far, packs_ + next / n_singles, moves);
        }
      return k;
    }

    /** @param moves  of these pairs; afterwards those of the next [counts] */
    template <bool is_far, typename L>
    [[gnu::always_inline]] void compute(const std::size_t k, const std::size_t far, const SinglePack *const next,
                                        LaneVectorOf<L> &moves)
    {
      SinglePack *const packs = packs_ + k / n_singles;
      if (is_beyond_cache_)
        fetch_pairs<is_far, n_parts<L>>(k / n_singles, far);
      Touch<L> touch;
      measure(packs, moves, touch);
      if (!is_any(touch.is_touching))
        {
          moves = load_moves<L>(next);
          return leave_apart<is_far, n_parts<L> * n_singles>(k, packs, far);
        }
      load_motion(packs, touch);
      press(k, packs, touch);
      const LaneVectorOf<L> shear = update_shear(k, packs, touch);
      const LaneVectorOf<L> force = add(shear, -touch.normal.force, touch.unit);
      if (task_.has_sums) // not another function, in which the compiler would round in other places
        sums_.add(force, touch.branch, touch.normal, touch.distance, touch.is_touching);
      moves = load_moves<L>(next);
      for_each_part<L>([&](const int part) {
        give<is_far>(*forget(packs + part), far + part * n_singles, part, touch, force, shear);
      });
    }

    /** Calls into the cache what later pairs need, as PairLoop does. */
    template <bool is_far, int n>
    [[gnu::always_inline]] void fetch_pairs(const std::size_t first, const std::size_t far)
    {
      for (std::size_t p = first + fetch_ahead; p < std::min(first + fetch_ahead + n, n_packs_); ++p)
        {
          fetch(packs_ + p + fetch_ahead);
          for (int j = 0; j < n_singles; ++j)
            {
              fetch(&get_row(counts_, packs_[p].row_b[j]));
              fetch(&get_row(motion_, packs_[p].row_b[j]));
            }
        }
      if constexpr (is_far)
        fetch_to_write(results_.far_forces + far + fetch_ahead * n_singles, n * n_singles);
      else
        fetch_next_block<n>();
    }

    /** Calls some grains of the next block and second grains of its far pairs. */
    template <int n>
    [[gnu::always_inline]] void fetch_next_block()
    {
      fetch_for_later(motion_ + next_grain_, n * fetched_grains);
      fetch_for_later(counts_ + next_grain_, n * fetched_grains);
      next_grain_ += n * fetched_grains;
      fetch(packs_[next_far_ / n_singles + 1].row_b);
      const std::size_t end = std::min(next_far_ + n * fetched_far, n_packs_ * n_singles);
      for (; next_far_ < end; ++next_far_)
        {
          const SingleOffset b = packs_[next_far_ / n_singles].row_b[next_far_ % n_singles];
          fetch_for_later(&get_row(counts_, b));
          fetch_for_later(&get_row(motion_, b));
        }
    }

    /** Some pairs none of which touches. */
    template <bool is_far, std::size_t n>
    [[gnu::always_inline]] void leave_apart(const std::size_t k, SinglePack *const packs, const std::size_t far) const
    {
      for (SinglePack *pack = packs; pack != packs + n / n_singles; ++pack)
        for (float *const shear : {pack->shear_x, pack->shear_y, pack->shear_z})
          std::fill_n(shear, n_singles, 0.f);
      std::fill_n(results_.status + k, n, PairStatus::is_apart);
      if (task_.has_contact_stress)
        for (double *const known : {results_.normal_force + k, results_.overlap + k})
          std::fill_n(known, n, 0.);
      if constexpr (is_far)
        std::fill_n(results_.far_forces + far, n, TwinRow{});
    }

    template <typename L>
    [[gnu::always_inline]] static L load(const SinglePack *const packs, float const (SinglePack::*array)[n_singles])
    {
      return make_lanes<L>([=](const int part) { return load_singles(packs[part].*array); });
    }

    /** How far grains have moved against each other since the network was built [counts]. */
    template <typename L>
    [[gnu::always_inline]] LaneVectorOf<L> load_moves(const SinglePack *const packs) const
    {
      FourSingles moved[n_parts<L>];
      for_each_part<L>([&](const int part) {
        moved[part] = load_quads([&pack = *forget(packs + part), this](const int i) {
          return reinterpret_cast<Quad>(load_row(get_row(counts_, pack.row_b[i])) -
                                        load_row(get_row(counts_, pack.row_a[i])));
        });
      });
      const auto take = [&moved](Single FourSingles::*column) {
        return make_lanes<L>([&](const int part) { return convert(get_bits(Singles(moved[part].*column))); });
      };
      return {take(&FourSingles::a), take(&FourSingles::b), take(&FourSingles::c)};
    }

    template <typename L>
    [[gnu::always_inline]] static LaneVectorOf<L> transform(const SingleMatrix &m, const LaneVectorOf<L> &v)
    {
      if constexpr (is_upright)
        return {m.xx * v.x, m.yy * v.y, m.zz * v.z};
      else
        return {m.xx * v.x + m.xy * v.y + m.xz * v.z, m.yx * v.x + m.yy * v.y + m.yz * v.z,
                m.zx * v.x + m.zy * v.y + m.zz * v.z};
    }

    template <typename L>
    [[gnu::always_inline]] void measure(const SinglePack *const packs, const LaneVectorOf<L> &moves,
                                        Touch<L> &touch) const
    {
      const LaneVectorOf<L> then{load<L>(packs, &SinglePack::branch_x), load<L>(packs, &SinglePack::branch_y),
                                 load<L>(packs, &SinglePack::branch_z)};
      const LaneVectorOf<L> change = add(transform(task_.edges, moves), 1.f, transform(task_.growth, then));
      touch.branch = add(then, 1.f, change);
      const L overlap_then = load<L>(packs, &SinglePack::overlap), sum = load<L>(packs, &SinglePack::radius_sum);
      const L square = dot(touch.branch, touch.branch), inverse = compute_inverse_root(square);
      touch.distance = square * inverse;
      const L longer = dot(add(then, 1.f, touch.branch), change) / (touch.distance + (sum - overlap_then));
      touch.overlap = compute_larger(overlap_then - longer, 0.f);
      touch.is_touching = L(0.f) < touch.overlap;
      touch.unit = {touch.branch.x * inverse, touch.branch.y * inverse, touch.branch.z * inverse};
      touch.mean_arm = 0.5f * (sum - touch.overlap);
    }

    /** Relative velocity at the contact, and what turns the shear force about the normal. */
    template <typename L>
    [[gnu::always_inline]] void load_motion(const SinglePack *const packs, Touch<L> &touch) const
    {
      if constexpr (!is_rotation_free)
        {
          FourSingles faster[n_parts<L>];
          for_each_part<L>([&](const int part) {
            faster[part] = load_quads([&pack = *forget(packs + part), this](const int i) {
              return load_row(get_row(motion_, pack.row_b[i]).linear) -
                     load_row(get_row(motion_, pack.row_a[i]).linear);
            });
          });
          const auto take = [&faster](Single FourSingles::*column) {
            return make_lanes<L>([&](const int part) { return Singles(faster[part].*column); });
          };
          touch.velocity = {take(&FourSingles::a), take(&FourSingles::b), take(&FourSingles::c)};
        }
      else
        load_turning_motion(packs, touch);
    }

    template <typename L>
    [[gnu::always_inline]] void load_turning_motion(const SinglePack *const packs, Touch<L> &touch) const
    {
      TwinSingles faster[n_parts<L>];
      FourSingles sums[n_parts<L>];
      for_each_part<L>([&](const int part) {
        faster[part] = load_octets([&pack = *forget(packs + part), this](const int i) {
          return load_row(get_row(motion_, pack.row_b[i])) - load_row(get_row(motion_, pack.row_a[i]));
        });
        sums[part] = load_quads([&pack = *forget(packs + part), this](const int i) {
          return load_row(get_row(motion_, pack.row_b[i]).angular) + load_row(get_row(motion_, pack.row_a[i]).angular);
        });
      });
      const auto both = [&sums](Single FourSingles::*column) {
        return make_lanes<L>([&](const int part) { return Singles(sums[part].*column); });
      };
      const auto more = [&faster](RowLanesOf<Singles> TwinSingles::*row, Singles RowLanesOf<Singles>::*column) {
        return make_lanes<L>([&](const int part) { return faster[part].*row.*column; });
      };
      using Row4 = RowLanesOf<Singles>;
      const auto linear = &TwinSingles::linear, angular = &TwinSingles::angular;
      touch.both = {both(&FourSingles::a), both(&FourSingles::b), both(&FourSingles::c)};
      touch.more_arm = 0.5f * more(linear, &Row4::w);
      // Arm a times spin a plus arm b times spin b, by the mean and the half difference of either.
      const L mean = touch.mean_arm, half = touch.more_arm;
      const LaneVectorOf<L> velocity{more(linear, &Row4::x), more(linear, &Row4::y), more(linear, &Row4::z)};
      touch.velocity = add_cross(velocity, touch.unit,
                                 {mean * touch.both.x + half * more(angular, &Row4::x),
                                  mean * touch.both.y + half * more(angular, &Row4::y),
                                  mean * touch.both.z + half * more(angular, &Row4::z)});
    }

    /** How hard pairs press. */
    template <typename L>
    [[gnu::always_inline]] void press(const std::size_t k, const SinglePack *const packs, Touch<L> &touch) const
    {
      const L root = load<L>(packs, &SinglePack::root_radius);
      touch.normal = is_rough ? compute_rough_law(task_.law, touch.overlap, root)
                              : compute_hertz_law(task_.law, touch.overlap, root);
      if constexpr (is_rough) // its power does not reach zero
        touch.normal = {select(touch.is_touching, touch.normal.force, L(0.f)),
                        select(touch.is_touching, touch.normal.stiffness, L(0.f))};
      if (task_.has_contact_stress)
        for_each_part<L>([&](const int part) {
          store_doubles(results_.normal_force + k + part * n_singles, get_part(touch.normal.force, part));
          store_doubles(results_.overlap + k + part * n_singles, get_part(touch.overlap, part));
        });
    }

    /** Brings the shear forces of pairs up to date. @return them; zero where apart */
    template <typename L>
    [[gnu::always_inline]] LaneVectorOf<L> update_shear(const std::size_t k, SinglePack *const packs,
                                                        const Touch<L> &touch) const
    {
      LaneVectorOf<L> before{load<L>(packs, &SinglePack::shear_x), load<L>(packs, &SinglePack::shear_y),
                             load<L>(packs, &SinglePack::shear_z)};
      if constexpr (is_rotation_free)
        {
          const L twist = 0.5f * task_.time_step * dot(touch.both, touch.unit);
          const LaneVectorOf<L> &unit = touch.unit;
          before = add_cross(before, {twist * unit.x, twist * unit.y, twist * unit.z}, before);
        }
      const LaneVectorOf<L> step = add(transform(task_.strain, touch.branch), task_.time_step, touch.velocity);
      const auto shear = compute_shear_law(task_.law, touch.normal, touch.unit, before, step);
      for_each_part<L>([&](const int part) {
        store_singles(packs[part].shear_x, get_part(shear.force.x, part));
        store_singles(packs[part].shear_y, get_part(shear.force.y, part));
        store_singles(packs[part].shear_z, get_part(shear.force.z, part));
        store_sorts(results_.status + k + part * n_singles, get_part(touch.is_touching, part),
                    get_part(shear.is_sliding, part));
      });
      return shear.force;
    }

    /** Gives the grains of sixteen pairs their forces and torques, pair by pair. */
    template <bool is_far, typename L>
    [[gnu::always_inline]] void give(const SinglePack &pack, const std::size_t far, const int part,
                                     const Touch<L> &touch, const LaneVectorOf<L> &force,
                                     const LaneVectorOf<L> &shear) const
    {
      const RowLanesOf<Singles> linear{get_part(force.x, part), get_part(force.y, part), get_part(force.z, part),
                                       get_part(touch.normal.stiffness, part)};
      if constexpr (is_rotation_free)
        {
          const LaneVectorOf<Singles> moment =
              cross(LaneVectorOf<Singles>{get_part(touch.unit.x, part), get_part(touch.unit.y, part),
                                          get_part(touch.unit.z, part)},
                    LaneVectorOf<Singles>{get_part(shear.x, part), get_part(shear.y, part), get_part(shear.z, part)});
          const Singles mean = get_part(touch.mean_arm, part), more = get_part(touch.more_arm, part);
          const Singles arm_a = mean - more, stiffness = mean * linear.w;
          give_twins<is_far>(pack, far,
                             {linear, {arm_a * moment.x, arm_a * moment.y, arm_a * moment.z, arm_a * stiffness}},
                             (mean + more) / compute_larger(arm_a, 1e-36f));
        }
      else
        give_forces<is_far>(pack, far, linear);
    }

    template <bool is_far>
    [[gnu::always_inline]] void give_forces(const SinglePack &pack, const std::size_t far,
                                            const RowLanesOf<Singles> &linear) const
    {
      constexpr Quad opposite{-1.f, -1.f, -1.f, 1.f}; // b's stiffness adds up as a's does
      TwinRow *const forces = results_.forces, *const far_forces = results_.far_forces + far;
      give_quads(linear, [=, &pack](const int j, const Quad row) {
        SingleRow &of_a = get_row(forces, pack.row_a[j]).linear;
        store_row(of_a, load_row(of_a) + row);
        if constexpr (is_far)
          store_row(far_forces[j].linear, opposite * row);
        else
          {
            SingleRow &of_b = get_row(forces, pack.row_b[j]).linear;
            store_row(of_b, load_row(of_b) + opposite * row);
          }
      });
    }

    /** @param rows  forces and torques on a; how much longer b's lever arm is than a's follows [-] */
    template <bool is_far>
    [[gnu::always_inline]] void give_twins(const SinglePack &pack, const std::size_t far, const TwinSingles &rows,
                                           const Singles ratio) const
    {
      alignas(64) float ratios[n_singles];
      store_singles(ratios, ratio);
      TwinRow *const forces = results_.forces, *const far_forces = results_.far_forces + far;
      give_octets(rows, [&](const int j, const Octet row) {
        TwinRow &of_a = get_row(forces, pack.row_a[j]);
        store_row(of_a, load_row(of_a) + row);
        const Octet on_b = join(Quad{-1.f, -1.f, -1.f, 1.f}, ratios[j]) * row; // stiffness adds up as a's does
        if constexpr (is_far)
          store_row(far_forces[j], on_b);
        else
          {
            TwinRow &of_b = get_row(forces, pack.row_b[j]);
            store_row(of_b, load_row(of_b) + on_b);
          }
      });
    }

    static constexpr std::size_t fetch_ahead = 2;    ///< packs; they are called twice as far ahead as their grains
    static constexpr std::size_t fetched_grains = 6; ///< with each pack of near pairs, as in PairLoop
    static constexpr std::size_t fetched_far = 4;    ///< likewise, far pairs

    const SingleTask task_;
    const CountRow *const counts_;
    const TwinRow *const motion_;
    SinglePack *const packs_;
    const std::size_t n_packs_;
    const bool is_beyond_cache_;
    std::size_t next_grain_ = 0, next_far_ = 0; // to be called into the cache
    const SinglePairResults results_;

    LaneSums<Singles> sums_;
  };
} // namespace dem

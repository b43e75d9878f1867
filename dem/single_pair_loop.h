#pragma once

#include "dem/contact_forces.h"
#include "dem/single_grains.h"
#include "dem/single_twins.h"

#include <algorithm>

namespace dem
{
  template <typename L>
  [[gnu::always_inline]] inline LaneVectorOf<L> apply(const SingleMatrix &m, const LaneVectorOf<L> &v)
  {
    return {m.xx * v.x + m.xy * v.y + m.xz * v.z, m.yx * v.x + m.yy * v.y + m.yz * v.z,
            m.zx * v.x + m.zy * v.y + m.zz * v.z};
  }

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
  template <bool is_rough, bool is_rotation_free>
  class SinglePairLoop
  {
  public:
    SinglePairLoop(const SingleTask &task, const SingleGrains &grains, std::vector<SinglePack> &packs,
                   const SinglePairResults &results)
        : task_(task), counts_(grains.counts.data()), motion_(grains.motion.data()), packs_(packs.data()),
          n_packs_(packs.size()), is_beyond_cache_(grains.counts.size() > cached_grains), results_(results)
    {}

    /** Near pairs: both grains get their force at once. */
    void run_near(const GrainBlock &block)
    {
      next_ = block.grain_end;
      run<false>(block.near_begin, block.near_end, 0);
    }

    /** Far pairs: what the second grain gets waits in `far_forces`. */
    void run_far(const GrainBlock &block) { run<true>(block.far_begin, block.near_begin, block.first_far); }

    ContactSums finish() const
    {
      if (!task_.has_sums)
        return get_unknown_sums();
      ContactSums sums;
      for (int k = 0; k < 9; ++k)
        sums.force_times_branch(k / 3, k % 3) = sum_lanes(moment_[k]);
      sums.normal_force = sum_lanes(normal_force_);
      sums.stiffness_moment = sum_lanes(stiffness_moment_);
      sums.n_touching = n_touching_;
      return sums;
    }

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

    /** Flattened: called pieces of it would pass vectors through memory. */
    template <bool is_far>
    [[gnu::flatten]] void run(const std::size_t begin, const std::size_t end, std::size_t far)
    {
      std::size_t k = begin;
      if constexpr (width > n_singles)
        for (; k + width <= end; k += width, far += width)
          compute<is_far, Twins>(k, far);
      for (; k < end; k += n_singles, far += n_singles)
        compute<is_far, Singles>(k, far);
    }

    template <bool is_far, typename L>
    [[gnu::always_inline]] void compute(const std::size_t k, const std::size_t far)
    {
      SinglePack *const packs = packs_ + k / n_singles;
      if (is_beyond_cache_)
        fetch<is_far, n_parts<L>>(k / n_singles, far);
      Touch<L> touch;
      measure(packs, touch);
      if (!is_any(touch.is_touching))
        return leave_apart<is_far, n_parts<L> * n_singles>(k, packs, far);
      load_motion(packs, touch);
      press(k, packs, touch);
      const LaneVectorOf<L> shear = update_shear(k, packs, touch);
      const LaneVectorOf<L> force = add(shear, -touch.normal.force, touch.unit);
      if (task_.has_sums) // not another function, in which the compiler would round in other places
        add_to_sums(touch, force);
      for_each_part<L>(
          [&](const int part) { give<is_far>(packs[part], far + part * n_singles, part, touch, force, shear); });
    }

    /** Calls into the cache what later pairs need, as PairLoop does. */
    template <bool is_far, int n>
    [[gnu::always_inline]] void fetch(const std::size_t first, const std::size_t far)
    {
      for (std::size_t p = first + fetch_ahead; p < std::min(first + fetch_ahead + n, n_packs_); ++p)
        {
          __builtin_prefetch(packs_[p].row_b + fetch_ahead * (sizeof(SinglePack) / sizeof(SingleOffset)));
          for (int j = 0; j < n_singles; ++j)
            {
              __builtin_prefetch(&get_row(counts_, packs_[p].row_b[j]));
              __builtin_prefetch(&get_row(motion_, packs_[p].row_b[j]));
            }
        }
      if constexpr (is_far)
        for (std::size_t row = 0; row < n * n_singles; row += line / sizeof(TwinRow))
          __builtin_prefetch(results_.far_forces + far + fetch_ahead * n_singles + row, 1);
      else // the grains of the next block, while this one is computed
        {
          for (std::size_t i = next_; i < next_ + n * fetched_grains; i += line / sizeof(TwinRow))
            __builtin_prefetch(motion_ + i, 0, 2);
          for (std::size_t i = next_; i < next_ + n * fetched_grains; i += line / sizeof(CountRow))
            __builtin_prefetch(counts_ + i, 0, 2);
          next_ += n * fetched_grains;
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
        moved[part] = load_quads([&pack = packs[part], this](const int i) {
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
    [[gnu::always_inline]] void measure(const SinglePack *const packs, Touch<L> &touch) const
    {
      const LaneVectorOf<L> then{load<L>(packs, &SinglePack::branch_x), load<L>(packs, &SinglePack::branch_y),
                                 load<L>(packs, &SinglePack::branch_z)};
      const LaneVectorOf<L> change = add(apply(task_.edges, load_moves<L>(packs)), 1.f, apply(task_.growth, then));
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
            faster[part] = load_quads([&pack = packs[part], this](const int i) {
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
        const SinglePack &pack = packs[part];
        faster[part] = load_octets([&pack, this](const int i) {
          return load_row(get_row(motion_, pack.row_b[i])) - load_row(get_row(motion_, pack.row_a[i]));
        });
        sums[part] = load_quads([&pack, this](const int i) {
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
      const LaneVectorOf<L> step = add(apply(task_.strain, touch.branch), task_.time_step, touch.velocity);
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
          give_twins<is_far>(pack, far, {linear, {moment.x, moment.y, moment.z, mean * linear.w}}, mean - more,
                             mean + more);
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

    /** @param rows  forces on a; moments over the lever arms, which follow [m] */
    template <bool is_far>
    [[gnu::always_inline]] void give_twins(const SinglePack &pack, const std::size_t far, const TwinSingles &rows,
                                           const Singles arm_a, const Singles arm_b) const
    {
      alignas(64) float arms_a[n_singles], arms_b[n_singles];
      store_singles(arms_a, arm_a);
      store_singles(arms_b, arm_b);
      TwinRow *const forces = results_.forces, *const far_forces = results_.far_forces + far;
      give_octets(rows, [&](const int j, const Octet row) {
        TwinRow &of_a = get_row(forces, pack.row_a[j]);
        store_row(of_a, load_row(of_a) + join(Quad{1.f, 1.f, 1.f, 1.f}, arms_a[j]) * row);
        const Octet on_b = join(Quad{-1.f, -1.f, -1.f, 1.f}, arms_b[j]) * row; // stiffness adds up as a's does
        if constexpr (is_far)
          store_row(far_forces[j], on_b);
        else
          {
            TwinRow &of_b = get_row(forces, pack.row_b[j]);
            store_row(of_b, load_row(of_b) + on_b);
          }
      });
    }

    template <typename L>
    [[gnu::always_inline]] void add_to_sums(const Touch<L> &touch, const LaneVectorOf<L> &force)
    {
      const LaneVectorOf<L> &x = touch.branch;
      add_to(moment_[0], force.x * x.x), add_to(moment_[1], force.x * x.y), add_to(moment_[2], force.x * x.z);
      add_to(moment_[3], force.y * x.x), add_to(moment_[4], force.y * x.y), add_to(moment_[5], force.y * x.z);
      add_to(moment_[6], force.z * x.x), add_to(moment_[7], force.z * x.y), add_to(moment_[8], force.z * x.z);
      add_to(normal_force_, touch.normal.force);
      add_to(stiffness_moment_, touch.normal.stiffness * (touch.distance * touch.distance));
      n_touching_ += static_cast<std::size_t>(count(touch.is_touching));
    }

    template <typename L>
    [[gnu::always_inline]] static void add_to(Singles &sum, const L &value)
    {
      for_each_part<L>([&](const int part) { sum += get_part(value, part); });
    }

    static constexpr std::size_t line = 64;             ///< of the cache [bytes]
    static constexpr std::size_t fetch_ahead = 4;       ///< packs; their lists are called twice as far ahead
    static constexpr std::size_t fetched_grains = 6;    ///< with each pack: those of a block with its near pairs
    static constexpr std::size_t width = 2 * n_singles; // lanes taken at a time while there are as many

    const SingleTask task_;
    const CountRow *const counts_;
    const TwinRow *const motion_;
    SinglePack *const packs_;
    const std::size_t n_packs_;
    const bool is_beyond_cache_;
    std::size_t next_ = 0; // grain to be called into the cache
    const SinglePairResults results_;

    // Sums over contacts, one a lane until the end of a block.
    Singles moment_[9] = {0.f, 0.f, 0.f, 0.f, 0.f, 0.f, 0.f, 0.f, 0.f}, normal_force_ = 0.f, stiffness_moment_ = 0.f;
    std::size_t n_touching_ = 0;
  };
} // namespace dem

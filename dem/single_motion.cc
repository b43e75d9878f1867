#include "dem/single_motion.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace dem
{
  namespace
  {
    constexpr std::int32_t sign = std::numeric_limits<std::int32_t>::min();
    constexpr SingleBits is_component{-1, -1, -1, 0, -1, -1, -1, 0, -1, -1, -1, 0, -1, -1, -1, 0}; // not what is beside

    /** What local damping leaves of a force: F - alpha |F| sign(v). */
    [[gnu::always_inline]] inline Single damp(const Single force, const Single velocity, const float alpha)
    {
      const SingleBits size = reinterpret_cast<SingleBits>(force) & ~sign;
      const SingleBits brake = (size | (reinterpret_cast<SingleBits>(velocity) & sign)) & SingleBits(velocity != 0.f);
      return force - alpha * reinterpret_cast<Single>(brake);
    }

    /** The number k of each quad in all of it. */
    template <int k>
    [[gnu::always_inline]] inline Single spread(const Single v)
    {
      return __builtin_shufflevector(v, v, k, k, k, k, 4 + k, 4 + k, 4 + k, 4 + k, 8 + k, 8 + k, 8 + k, 8 + k, 12 + k,
                                     12 + k, 12 + k, 12 + k);
    }

    /** Two twin rows, one behind the other. */
    [[gnu::always_inline]] inline Single load_two(const TwinRow *const rows)
    {
      return join(load_row(rows[0]), load_row(rows[1]));
    }

    [[gnu::always_inline]] inline void store_two(TwinRow *const rows, const Single v)
    {
      store_row(rows[0], __builtin_shufflevector(v, v, 0, 1, 2, 3, 4, 5, 6, 7));
      store_row(rows[1], __builtin_shufflevector(v, v, 8, 9, 10, 11, 12, 13, 14, 15));
    }

    /** The same three numbers in each quad. */
    Single repeat(const float x, const float y, const float z)
    {
      return Single{x, y, z, 0.f, x, y, z, 0.f, x, y, z, 0.f, x, y, z, 0.f};
    }

    /** Moves grains, four at a time. */
    template <bool has_true_masses, bool is_upright>
    class Advance
    {
    public:
      Advance(const SingleMatrix &to_counts, const SingleMotionTask &task)
          : x_(repeat(to_counts.xx, to_counts.yx, to_counts.zx)), y_(repeat(to_counts.xy, to_counts.yy, to_counts.zy)),
            z_(repeat(to_counts.xz, to_counts.yz, to_counts.zz)),
            diagonal_(repeat(to_counts.xx, to_counts.yy, to_counts.zz)),
            time_step_(static_cast<float>(task.kinetics.time_step)), alpha_(static_cast<float>(task.rule.local_damping))
      {
        const float m = static_cast<float>(task.kinetics.smallest_mass);
        const float i = static_cast<float>(task.kinetics.smallest_inertia);
        bound_ = Single{m, m, m, m, i, i, i, i, m, m, m, m, i, i, i, i};
      }

      [[gnu::always_inline]] void operator()(const TwinRow *const forces, TwinRow *const motion, CountRow *const counts)
      {
        const Single first = advance_two(forces, motion, counts),
                     second = advance_two(forces + 2, motion + 2, counts + 2);
        const SingleBits steps = round_singles(
            __builtin_shufflevector(first, second, 0, 1, 2, 3, 8, 9, 10, 11, 16, 17, 18, 19, 24, 25, 26, 27));
        using Four = std::int32_t __attribute__((vector_size(64), may_alias, aligned(16)));
        Four &four = *reinterpret_cast<Four *>(counts);
        four = four + steps;
      }

      /** Squares of the largest components of velocities. */
      double sum_largest_square() const
      {
        double sum = 0.;
        for (int k = 0; k < 3; ++k)
          sum += static_cast<double>(std::max(largest_square_.v[k], largest_square_.v[8 + k]));
        return sum;
      }

    private:
      /** @return the steps of two grains in counts, not rounded, each in the first quad of its eight numbers */
      [[gnu::always_inline]] Single advance_two(const TwinRow *const forces, TwinRow *const motion,
                                                const CountRow *const counts)
      {
        const Single before = load_two(motion), force = load_two(forces);
        const Singles mass =
            has_true_masses ? get_true_masses(counts, before) : compute_larger(spread<3>(force), bound_);
        const Single change = (time_step_ * compute_inverse(mass).v) * damp(force, before, alpha_);
        const Single now = before + reinterpret_cast<Single>(reinterpret_cast<SingleBits>(change) & is_component);
        store_two(motion, now);
        largest_square_ = compute_larger(now * now, largest_square_);
        return is_upright ? now * diagonal_ : spread<0>(now) * x_ + spread<1>(now) * y_ + spread<2>(now) * z_;
      }

      /** Masses and moments of inertia, each four times. */
      [[gnu::always_inline]] static Single get_true_masses(const CountRow *const counts, const Single motion)
      {
        const Quad first = reinterpret_cast<Quad>(load_row(counts[0])),
                   second = reinterpret_cast<Quad>(load_row(counts[1]));
        const Octet both = join(first, second);
        const Single inertia = spread<3>(motion);
        const Single masses =
            __builtin_shufflevector(both, both, 3, 3, 3, 3, -1, -1, -1, -1, 7, 7, 7, 7, -1, -1, -1, -1);
        return __builtin_shufflevector(masses, inertia, 0, 1, 2, 3, 20, 21, 22, 23, 8, 9, 10, 11, 28, 29, 30, 31);
      }

      Single x_, y_, z_, diagonal_;
      float time_step_, alpha_;
      Single bound_;
      Singles largest_square_ = 0.f;
    };

    template <bool has_true_masses, bool is_upright>
    double advance(SingleGrains &grains, const std::size_t begin, const std::size_t end, const SingleMatrix &to_counts,
                   const SingleMotionTask &task)
    {
      Advance<has_true_masses, is_upright> advance(to_counts, task);
      CountRow *const counts = grains.counts.data();
      TwinRow *const motion = grains.motion.data();
      std::size_t i = begin;
      for (; i + 4 <= end; i += 4)
        advance(task.forces + i, motion + i, counts + i);
      if (i < end)
        {
          TwinRow last_forces[4], last_motion[4];
          CountRow last_counts[4];
          for (std::size_t k = 0; k < 4; ++k)
            {
              const std::size_t from = std::min(i + k, end - 1);
              last_forces[k] = task.forces[from], last_motion[k] = motion[from], last_counts[k] = counts[from];
            }
          advance(last_forces, last_motion, last_counts);
          std::copy_n(last_motion, end - i, motion + i);
          std::copy_n(last_counts, end - i, counts + i);
        }
      return std::sqrt(advance.sum_largest_square()) * task.kinetics.time_step;
    }
  } // namespace

  double advance_singles(SingleGrains &grains, const std::size_t begin, const std::size_t end,
                         const SingleMotionTask &task)
  {
    const Matrix to_counts = 0x1p32 * task.kinetics.time_step * task.cell.edges.inverse();
    const bool is_upright = to_counts.isDiagonal(0.);
    const auto choose = [&]<bool has_true_masses>(std::bool_constant<has_true_masses>) {
      return is_upright ? advance<has_true_masses, true>(grains, begin, end, SingleMatrix(to_counts), task)
                        : advance<has_true_masses, false>(grains, begin, end, SingleMatrix(to_counts), task);
    };
    return task.rule.has_true_masses ? choose(std::true_type()) : choose(std::false_type());
  }
} // namespace dem

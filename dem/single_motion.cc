#include "dem/single_motion.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace dem
{
  namespace
  {
    using OctetBits = std::int32_t __attribute__((vector_size(32), may_alias));

    constexpr std::int32_t sign = std::numeric_limits<std::int32_t>::min();
    constexpr OctetBits is_component{-1, -1, -1, 0, -1, -1, -1, 0}; // not the radius and the inertia beside them

    /** What local damping leaves of a force: F - alpha |F| sign(v). */
    [[gnu::always_inline]] inline Octet damp(const Octet force, const Octet velocity, const float alpha)
    {
      const OctetBits size = reinterpret_cast<OctetBits>(force) & ~sign;
      const OctetBits brake = (size | (reinterpret_cast<OctetBits>(velocity) & sign)) & OctetBits(velocity != 0.f);
      return force - alpha * reinterpret_cast<Octet>(brake);
    }

    [[gnu::always_inline]] inline Quad spread(const float x)
    {
      return Quad{x, x, x, x};
    }

    /** The nearest whole numbers. */
    [[gnu::always_inline]] inline Counts round(const Quad step)
    {
#ifdef __AVX__
      return reinterpret_cast<Counts>(_mm_cvtps_epi32(reinterpret_cast<__m128>(step)));
#else
      Counts counts;
      for (int i = 0; i < 4; ++i)
        counts[i] = static_cast<std::int32_t>(std::lrint(step[i]));
      return counts;
#endif
    }

    /** Columns of a matrix as rows of four. */
    struct Columns
    {
      Quad x, y, z;

      explicit Columns(const SingleMatrix &m)
          : x{m.xx, m.yx, m.zx, 0.f}, y{m.xy, m.yy, m.zy, 0.f}, z{m.xz, m.yz, m.zz, 0.f}
      {}
    };
  } // namespace

  double advance_singles(SingleGrains &grains, const std::size_t begin, const std::size_t end,
                         const SingleMotionTask &task)
  {
    const Kinetics &kinetics = task.kinetics;
    const float dt = static_cast<float>(kinetics.time_step), alpha = static_cast<float>(task.rule.local_damping);
    const float mass_bound = static_cast<float>(kinetics.smallest_mass);
    const float inertia_bound = static_cast<float>(kinetics.smallest_inertia);
    const bool is_true = task.rule.has_true_masses;
    const Columns to_counts(SingleMatrix(0x1p32 * kinetics.time_step * task.cell.edges.inverse()));
    const TwinRow *const forces = task.forces;
    CountRow *const counts = grains.counts.data();
    TwinRow *const motion = grains.motion.data();
    const auto get_mass = [=](const std::size_t i) {
      return is_true ? counts[i].mass : std::max(forces[i].linear.w, mass_bound);
    };
    const auto get_inertia = [=](const std::size_t i) {
      return is_true ? motion[i].angular.w : std::max(forces[i].angular.w, inertia_bound);
    };
    Quad largest_square{};
    const auto advance = [&](const std::size_t i, const float over_mass, const float over_inertia) {
      const Octet before = load_row(motion[i]);
      const Octet change = join(spread(over_mass), spread(over_inertia)) * damp(load_row(forces[i]), before, alpha);
      const Octet now = before + reinterpret_cast<Octet>(reinterpret_cast<OctetBits>(change) & is_component);
      store_row(motion[i], now);
      const Quad v = __builtin_shufflevector(now, now, 0, 1, 2, 3);
      const Counts step = round(v[0] * to_counts.x + v[1] * to_counts.y + v[2] * to_counts.z);
      store_row(counts[i], load_row(counts[i]) + step);
      const Quad square = v * v;
      largest_square = square > largest_square ? square : largest_square;
    };
    std::size_t i = begin;
    for (; i + 4 <= end; i += 4) // all divisions at once: one takes as long as half of what else is done to a grain
      {
        const Octet over = dt / Octet{get_mass(i),     get_inertia(i),     get_mass(i + 1), get_inertia(i + 1),
                                      get_mass(i + 2), get_inertia(i + 2), get_mass(i + 3), get_inertia(i + 3)};
        advance(i, over[0], over[1]);
        advance(i + 1, over[2], over[3]);
        advance(i + 2, over[4], over[5]);
        advance(i + 3, over[6], over[7]);
      }
    for (; i < end; ++i)
      advance(i, dt / get_mass(i), dt / get_inertia(i));
    const double square = static_cast<double>(largest_square[0]) + largest_square[1] + largest_square[2];
    return std::sqrt(square) * kinetics.time_step;
  }
} // namespace dem

#include "dem/motion.h"

#include "dem/lane_rows.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <numbers>

namespace dem
{
  namespace
  {
    void update_time_step(Kinetics &kinetics, const MotionRule &rule, const Grains &grains, const Forces &forces)
    {
      double smallest_square = std::numeric_limits<double>::infinity();
      for (std::size_t i = 0; i < grains.size(); ++i)
        {
          const double stiffness = forces.on_grains.force(i).w;
          if (stiffness > 0.)
            smallest_square = std::min(smallest_square, 2. * grains.velocity[i].w / stiffness);
          if (rule.is_rotation_free && forces.on_grains.torque(i).w > 0.)
            smallest_square = std::min(smallest_square, 2. * grains.spin[i].w / forces.on_grains.torque(i).w);
        }
      if (std::isfinite(smallest_square))
        kinetics.time_step = rule.time_step_share * std::sqrt(smallest_square);
    }

    constexpr RowMask is_component{-1, -1, -1, 0}; // not the mass beside them

    /** What local damping leaves of a force: F - alpha |F| sign(v). */
    [[gnu::always_inline]] inline RowLanes damp(const RowLanes force, const RowLanes velocity, const double alpha)
    {
      constexpr std::int64_t sign = std::numeric_limits<std::int64_t>::min();
      const RowMask size = reinterpret_cast<RowMask>(force) & ~sign;
      const RowMask brake = (size | (reinterpret_cast<RowMask>(velocity) & sign)) & (velocity != 0.);
      return force - alpha * reinterpret_cast<RowLanes>(brake);
    }

    /** @return the new velocity or spin; its mass or inertia stays */
    [[gnu::always_inline]] inline RowLanes accelerate(const RowLanes velocity, const RowLanes force,
                                                      const double step_over_mass, const double alpha)
    {
      const RowLanes change = step_over_mass * damp(force, velocity, alpha);
      return velocity + reinterpret_cast<RowLanes>(reinterpret_cast<RowMask>(change) & is_component);
    }

    /** Columns of a matrix as rows of four. */
    struct Columns
    {
      RowLanes x, y, z;

      explicit Columns(const Matrix &m)
          : x{m(0, 0), m(1, 0), m(2, 0), 0.}, y{m(0, 1), m(1, 1), m(2, 1), 0.}, z{m(0, 2), m(1, 2), m(2, 2), 0.}
      {}
    };

    /** Displacements as changes of fractions of the cell. */
    class ToFractions
    {
    public:
      explicit ToFractions(const Matrix &m)
          : columns_(m), diagonal_{m(0, 0), m(1, 1), m(2, 2), 0.}, is_upright_(m.isDiagonal(0.))
      {}

      [[gnu::always_inline]] RowLanes operator()(const RowLanes v) const
      {
        return is_upright_ ? v * diagonal_ : v[0] * columns_.x + v[1] * columns_.y + v[2] * columns_.z;
      }

    private:
      Columns columns_;
      RowLanes diagonal_;
      bool is_upright_;
    };

    /** Calls advance(i, quotient) for grains i from `begin` to `end` with dividend / get_divisor(i); four of them are
     * divided at once, since one division takes as long as all else that is done to a grain. */
    template <typename GetDivisor, typename Advance>
    [[gnu::always_inline]] inline void divide_by_fours(const std::size_t begin, const std::size_t end,
                                                       const double dividend, const GetDivisor &get_divisor,
                                                       const Advance &advance)
    {
      std::size_t i = begin;
      for (; i + 4 <= end; i += 4)
        {
          const RowLanes quotients =
              dividend / RowLanes{get_divisor(i), get_divisor(i + 1), get_divisor(i + 2), get_divisor(i + 3)};
          advance(i, quotients[0]);
          advance(i + 1, quotients[1]);
          advance(i + 2, quotients[2]);
          advance(i + 3, quotients[3]);
        }
      for (; i < end; ++i)
        advance(i, dividend / get_divisor(i));
    }

    const Row &get_force(const Row &force)
    {
      return force;
    }
    const Row &get_force(const Action &action)
    {
      return action.force;
    }

    /** advance_grains, with spins or without. */
    template <bool is_rotation_free>
    double advance_some(Grains &grains, const std::size_t begin, const std::size_t end, const MotionTask &task)
    {
      const double dt = task.kinetics.time_step, alpha = task.rule.local_damping;
      const double smallest = task.kinetics.smallest_mass, smallest_inertia = task.kinetics.smallest_inertia;
      const bool is_true = task.rule.has_true_masses;
      const ToFractions to_fractions(task.cell.edges.inverse() * dt);
      const auto *const actions = task.rows.get<is_rotation_free>();
      Row *const velocities = grains.velocity.data(), *const places = grains.place.data();
      RowLanes largest_square{};
      divide_by_fours(
          begin, end, dt,
          [=](const std::size_t i) { return is_true ? velocities[i].w : std::max(get_force(actions[i]).w, smallest); },
          [&](const std::size_t i, const double step_over_mass) {
            const RowLanes v =
                accelerate(load_row(velocities[i]), load_row(get_force(actions[i])), step_over_mass, alpha);
            store_row(velocities[i], v);
            store_row(places[i], load_row(places[i]) + to_fractions(v));
            const RowLanes square = v * v;
            largest_square = square > largest_square ? square : largest_square;
          });
      if constexpr (is_rotation_free)
        {
          Row *const spins = grains.spin.data();
          divide_by_fours(
              begin, end, dt,
              [=](const std::size_t i) {
                return is_true ? spins[i].w : std::max(actions[i].torque.w, smallest_inertia);
              },
              [=](const std::size_t i, const double step_over_inertia) {
                const RowLanes torque = load_row(actions[i].torque);
                store_row(spins[i], accelerate(load_row(spins[i]), torque, step_over_inertia, alpha));
              });
        }
      return std::sqrt(largest_square[0] + largest_square[1] + largest_square[2]) * dt;
    }
  } // namespace

  void update_true_masses(Grains &grains, const double density)
  {
    for (std::size_t i = 0; i < grains.size(); ++i)
      {
        const double radius = grains.place[i].w;
        grains.velocity[i].w = 4. / 3. * std::numbers::pi * density * radius * radius * radius;
        grains.spin[i].w = 0.4 * grains.velocity[i].w * radius * radius;
      }
  }

  void update_kinetics(Kinetics &kinetics, const MotionRule &rule, const Grains &grains, const Forces &forces,
                       const ContactSums &sums)
  {
    if (rule.has_true_masses)
      return update_time_step(kinetics, rule, grains, forces);
    const double n = static_cast<double>(std::max<std::size_t>(1, grains.size()));
    kinetics.time_step = 1.;
    kinetics.smallest_mass = sums.stiffness > 0. ? 0.2 * (sums.stiffness / n) : 1.;
    kinetics.smallest_inertia = sums.turning_stiffness > 0. ? 0.2 * (sums.turning_stiffness / n) : 1.;
  }

  double advance_grains(Grains &grains, const std::size_t begin, const std::size_t end, const MotionTask &task)
  {
    assert(task.rows.n_rows == (task.rule.is_rotation_free ? 2 : 1));
    return task.rule.is_rotation_free ? advance_some<true>(grains, begin, end, task)
                                      : advance_some<false>(grains, begin, end, task);
  }

  double compute_mean_resultant(const Forces &forces)
  {
    double sum = 0.;
    for (std::size_t i = 0; i < forces.on_grains.size(); ++i)
      {
        const Row &force = forces.on_grains.force(i);
        sum += std::sqrt(force.x * force.x + force.y * force.y + force.z * force.z);
      }
    return sum / static_cast<double>(std::max<std::size_t>(1, forces.on_grains.size()));
  }
} // namespace dem

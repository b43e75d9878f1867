#include "dem/equilibrium.h"

#include "dem/homogenisation.h"
#include "dem/stopwatch.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <optional>

namespace dem
{
  namespace
  {
    constexpr std::size_t cycles_between_checks = 10;

    double compute_largest_target(const CellControl &control, const Matrix &stress)
    {
      double largest = control.follows_volume ? std::abs(stress.trace() / 3.) : 0.;
      for (int m = 0; m < 6; ++m)
        if (control.is_stress_controlled[m])
          largest = std::max(largest, std::abs(control.target_stress(tangent_index[m][0], tangent_index[m][1])));
      return largest;
    }

    /** Strain increments cycle by cycle: the prescribed part in equal shares, the servo's from the stress error. */
    class CellDriver
    {
    public:
      CellDriver(const CellControl &control, const EquilibriumRule &rule)
          : control_(control), rule_(rule), stretch_(control.stretch)
      {
        const double side = control.follows_volume ? std::cbrt(control.stretch.determinant()) : 1.;
        for (int m = 0; m < 6; ++m)
          if (control.is_stress_controlled[m])
            set(stretch_, m, m < 3 ? side : 0.);
        const double size = (stretch_ - Matrix::Identity()).cwiseAbs().maxCoeff();
        n_straining_ = static_cast<std::size_t>(std::ceil(size / rule.strain_per_cycle));
      }

      std::size_t get_n_straining() const { return n_straining_; }

      /** L dt of this cycle. Without a servo the shares multiply up to the stretch to the last bit but rounding. */
      Matrix compute_increment(const std::size_t cycle, const Matrix &stress, const double stiffness) const
      {
        Matrix increment = Matrix::Zero();
        if (cycle < n_straining_)
          {
            const Matrix share = (stretch_ - Matrix::Identity()) / static_cast<double>(n_straining_);
            const Matrix so_far = Matrix::Identity() + static_cast<double>(cycle) * share;
            increment = share * so_far.inverse();
          }
        const double side = 1. + increment(0, 0);
        for (int m = 0; m < 6; ++m)
          if (control_.is_stress_controlled[m])
            set(increment, m, compute_servo_strain(m, stress, stiffness));
        if (control_.follows_volume)
          restore_volume(side, increment);
        return increment;
      }

      double compute_deviation(const int m, const Matrix &stress) const
      {
        const int i = tangent_index[m][0], j = tangent_index[m][1];
        const bool is_equalised = control_.follows_volume && m < 3;
        return 0.5 * (stress(i, j) + stress(j, i)) -
               (is_equalised ? stress.trace() / 3. : control_.target_stress(i, j));
      }

    private:
      static void set(Matrix &matrix, const int m, const double value)
      {
        matrix(tangent_index[m][0], tangent_index[m][1]) = value;
        matrix(tangent_index[m][1], tangent_index[m][0]) = value;
      }

      /** The servo changes the shape alone: the volume is that of a cube stretched to `side` [-], to rounding. */
      static void restore_volume(const double side, Matrix &increment)
      {
        const Vector shape = Vector::Ones() + increment.diagonal();
        increment.diagonal() = shape * (side / std::cbrt(shape.prod())) - Vector::Ones();
      }

      double compute_servo_strain(const int m, const Matrix &stress, const double stiffness) const
      {
        const double error = -compute_deviation(m, stress);
        const double bound = rule_.strain_per_cycle;
        // Before the first contact there is no stiffness: close in at the largest rate.
        const double strain = stiffness > 0. ? rule_.servo_gain * error / stiffness : std::copysign(bound, error);
        return std::clamp(strain, -bound, bound);
      }

      const CellControl &control_;
      const EquilibriumRule &rule_;
      Matrix stretch_;
      std::size_t n_straining_ = 0;
    };

    bool is_at_rest(const CellDriver &driver, const CellControl &control, const EquilibriumRule &rule,
                    const Dynamics &dynamics, const std::size_t cycle)
    {
      if (cycle < driver.get_n_straining() || dynamics.compute_unbalanced_ratio() >= rule.unbalanced_ratio)
        return false;
      const Matrix stress = dynamics.compute_servo_stress();
      const double tolerance = rule.stress_tolerance * compute_largest_target(control, stress);
      for (int m = 0; m < 6; ++m)
        if (control.is_stress_controlled[m] && !(std::abs(driver.compute_deviation(m, stress)) <= tolerance))
          return false;
      return true;
    }

    void record_deviations(const CellDriver &driver, const CellControl &control, const Matrix &stress,
                           RestReport &report)
    {
      for (int m = 0; m < 6; ++m)
        if (control.is_stress_controlled[m])
          {
            const double deviation = driver.compute_deviation(m, stress);
            report.largest_deviation[m] = std::max(report.largest_deviation[m], deviation);
            report.smallest_deviation[m] = std::min(report.smallest_deviation[m], deviation);
          }
    }

    /** The cycles of one run: which is the last, and which of them somebody looks at. */
    struct Schedule
    {
      std::size_t last;
      bool is_fixed, is_always_watched;

      Schedule(const EquilibriumRule &rule, const CellDriver &driver, const CycleHook &hook)
          : last(std::max(rule.fixed_cycles > 0 ? rule.fixed_cycles : rule.cycle_cap, driver.get_n_straining())),
            is_fixed(rule.fixed_cycles > 0), is_always_watched(hook != nullptr)
      {}

      bool is_checked(const std::size_t cycle) const { return cycle % cycles_between_checks == 0 || cycle == last; }

      /** The run may end there, or grains be replaced: they must not have moved on. */
      bool is_watched(const std::size_t cycle) const { return is_always_watched || is_checked(cycle); }
    };

    /** How the run ends with this cycle, whose forces are known; nothing: it goes on. */
    std::optional<RestStatus> find_end(const Schedule &schedule, const CellDriver &driver, const CellControl &control,
                                       const EquilibriumRule &rule, const Dynamics &dynamics, const std::size_t cycle)
    {
      if (!schedule.is_checked(cycle))
        return std::nullopt;
      if (!(dynamics.is_finite() && std::isfinite(dynamics.compute_unbalanced_ratio())))
        return RestStatus::not_finite;
      if (schedule.is_fixed)
        return cycle == schedule.last ? std::optional(RestStatus::at_rest) : std::nullopt;
      if (is_at_rest(driver, control, rule, dynamics, cycle))
        return RestStatus::at_rest;
      return cycle == schedule.last ? std::optional(RestStatus::cap_reached) : std::nullopt;
    }

    /** Shares the time of a run among its parts: most cycles walk through the grains once, for forces and motion. */
    void fill_profile(const Profile &sampled, const double seconds, Profile &profile)
    {
      profile[Part::search] = sampled[Part::search];
      const double rest = seconds - profile[Part::search] - profile[Part::servo];
      const double forces = sampled[Part::forces], motion = sampled[Part::motion], both = forces + motion;
      profile[Part::forces] = both > 0. ? rest * forces / both : rest;
      profile[Part::motion] = rest - profile[Part::forces];
    }

    RestStatus run_cycles(Dynamics &dynamics, const EquilibriumRule &rule, const CellControl &control,
                          const CycleHook &hook, RestReport &report)
    {
      const CellDriver driver(control, rule);
      Schedule schedule(rule, driver, hook);
      const bool has_servo = control.has_servo();
      const auto look = [&](const std::size_t cycle) {
        const Stopwatch watch(report.profile[Part::servo]);
        return find_end(schedule, driver, control, rule, dynamics, cycle);
      };
      for (std::size_t cycle = 0;; ++cycle)
        {
          const bool is_watched = schedule.is_watched(cycle);
          if (is_watched)
            dynamics.compute_forces();
          else
            dynamics.compute_forces_and_move(has_servo);
          const CycleVerdict verdict = hook && dynamics.is_wide_enough() ? hook(dynamics) : CycleVerdict::may_rest;
          if (verdict == CycleVerdict::goes_on)
            ++schedule.last;
          if (!dynamics.is_wide_enough())
            return RestStatus::cell_too_narrow;
          report.n_cycles = cycle;
          const Matrix stress = has_servo ? dynamics.compute_servo_stress() : Matrix::Zero();
          if (has_servo)
            record_deviations(driver, control, stress, report);
          if (is_watched)
            {
              const auto end = look(cycle);
              if (end && (*end != RestStatus::at_rest || verdict != CycleVerdict::goes_on))
                return *end;
              if (verdict == CycleVerdict::ends)
                return dynamics.is_finite() ? RestStatus::at_rest : RestStatus::not_finite;
              dynamics.refresh_masses();
              dynamics.move();
            }
          dynamics.strain(driver.compute_increment(cycle, stress, has_servo ? dynamics.compute_stiffness() : 0.));
        }
    }
  } // namespace

  bool CellControl::has_servo() const
  {
    return std::any_of(is_stress_controlled.begin(), is_stress_controlled.end(), [](const bool is) { return is; });
  }

  bool CellControl::is_along_axes() const
  {
    return stretch.isDiagonal(0.) &&
           std::none_of(is_stress_controlled.begin() + 3, is_stress_controlled.end(), [](const bool is) { return is; });
  }

  RestReport &RestReport::operator+=(const RestReport &next)
  {
    status = next.status;
    n_cycles += next.n_cycles;
    duration += next.duration;
    unbalanced_ratio = next.unbalanced_ratio;
    for (int m = 0; m < 6; ++m)
      {
        largest_deviation[m] = std::max(largest_deviation[m], next.largest_deviation[m]);
        smallest_deviation[m] = std::min(smallest_deviation[m], next.smallest_deviation[m]);
      }
    return *this;
  }

  const char *describe(const RestStatus status)
  {
    switch (status)
      {
      case RestStatus::at_rest:
        return "at rest";
      case RestStatus::cap_reached:
        return "still moving after the cap of cycles";
      case RestStatus::not_finite:
        return "a force is not a number";
      case RestStatus::cell_too_narrow:
        return "the cell is narrower than two largest diameters plus skin";
      }
    return "unknown";
  }

  RestReport bring_to_rest(RevState &state, const RestRule &rule, const CellControl &control, const CycleHook &hook)
  {
    assert(!state.cell.has_walls() || control.is_along_axes());
    const Clock::time_point start = Clock::now();
    Dynamics dynamics(state, rule.law, rule.dynamics);
    RestReport report;
    report.status = run_cycles(dynamics, rule.equilibrium, control, hook, report);
    if (report.status != RestStatus::cell_too_narrow)
      dynamics.store();
    fill_profile(dynamics.get_profile(), measure_seconds_since(start), report.profile);
    report.n_bytes = dynamics.count_bytes();
    report.unbalanced_ratio = state.unbalanced_ratio;
    return report;
  }
} // namespace dem

#include "dem/breakage_measures.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>

namespace dem
{
  namespace
  {
    /** Mean of max(0, ln(d/limit)) over fines spread log-uniformly over the decade that ends at `largest`. */
    double compute_mean_logarithm_of_fines(const double largest, const double limit)
    {
      const double decade = std::numbers::ln10;
      if (!(largest > limit))
        return 0.;
      const double reach = std::log(largest / limit);
      return reach < decade ? 0.5 * reach * reach / decade : reach - 0.5 * decade;
    }

    /** (M_0 - M)/(M_0 - M_end): the share of the way from the initial mean logarithm to that of the end. */
    double compute_share_of_way(const double initial, const double now, const double end)
    {
      return initial > end ? (initial - now) / (initial - end) : std::numeric_limits<double>::quiet_NaN();
    }

    /** Mean of ln(d/d_m) over the ultimate grading, whose passing is linear in x = (d/d_m)^p with p = 3 - alpha. */
    double compute_ultimate_mean_logarithm(const BreakageScale &scale, const double largest)
    {
      const double p = 3. - scale.fractal_dimension;
      const double x = std::pow(largest / scale.smallest_diameter, p);
      return (x * std::log(x) / (x - 1.) - 1.) / p;
    }

    double compute_einav_breakage(const InitialGrading &initial, const GrainMass &now, const BreakageScale &scale)
    {
      if (!(initial.largest_diameter > scale.smallest_diameter))
        return std::numeric_limits<double>::quiet_NaN();
      return compute_share_of_way(initial.einav_mean, compute_mean_logarithm(now, scale.smallest_diameter),
                                  compute_ultimate_mean_logarithm(scale, initial.largest_diameter));
    }

    GradingMeasures measure_grading(const InitialGrading &initial, const GrainMass &now, const BreakageScale &scale)
    {
      return {compute_share_of_way(initial.hardin_mean, compute_mean_logarithm(now, scale.silt_diameter), 0.),
              compute_einav_breakage(initial, now, scale), compute_diameter_at(now, 0.1), compute_diameter_at(now, 0.5),
              compute_diameter_at(now, 0.9)};
    }

    /** Volume that splitting has ground to fines [m3]. */
    double compute_fines(const RevState &state)
    {
      const double fines = std::max(0., state.initial_solid_volume - compute_solid_volume(state.grains));
      return fines < 1e-12 * state.initial_solid_volume ? 0. : fines; // rounding of the sums: nothing was lost
    }

    InitialGrading measure_initial_mass(const GrainMass &mass, const BreakageScale &scale)
    {
      return {compute_mean_logarithm(mass, scale.silt_diameter), compute_mean_logarithm(mass, scale.smallest_diameter),
              *std::max_element(mass.diameters.begin(), mass.diameters.end())};
    }
  } // namespace

  double compute_mean_logarithm(const GrainMass &mass, const double limit)
  {
    assert(limit > 0.);
    double sum = 0., volume = 0.;
    for (const double diameter : mass.diameters)
      {
        sum += compute_grain_volume(diameter) * std::max(0., std::log(diameter / limit));
        volume += compute_grain_volume(diameter);
      }
    sum += mass.fines * compute_mean_logarithm_of_fines(mass.largest_fine, limit);
    return sum / (volume + mass.fines);
  }

  double compute_hardin_breakage(const GrainMass &initial, const GrainMass &now, const BreakageScale &scale)
  {
    return compute_share_of_way(compute_mean_logarithm(initial, scale.silt_diameter),
                                compute_mean_logarithm(now, scale.silt_diameter), 0.);
  }

  double compute_einav_breakage(const GrainMass &initial, const GrainMass &now, const BreakageScale &scale)
  {
    assert(scale.fractal_dimension < 3. && !initial.diameters.empty());
    return compute_einav_breakage(measure_initial_mass(initial, scale), now, scale);
  }

  InitialGrading measure_initial_grading(const std::span<const double> diameters, const BreakageScale &scale)
  {
    assert(!diameters.empty());
    return measure_initial_mass({.diameters = diameters}, scale);
  }

  GradingMeasures measure_grading_with_fines(const RevState &state, const InitialGrading &initial,
                                             const FractureRule &rule, const BreakageScale &scale)
  {
    const std::vector<double> diameters = list_diameters(state.grains);
    return measure_grading(
        initial, {.diameters = diameters, .fines = compute_fines(state), .largest_fine = rule.comminution_diameter},
        scale);
  }

  std::vector<double> list_diameters(const Grains &grains)
  {
    std::vector<double> diameters;
    diameters.reserve(grains.size());
    for (const Row &place : grains.place)
      diameters.push_back(2. * place.w);
    return diameters;
  }

  StrengthStatistics compute_strength_statistics(const Grains &grains, const FractureRule &rule)
  {
    std::vector<double> factors;
    for (std::size_t i = 0; i < grains.size(); ++i)
      {
        const double diameter = 2. * grains.place[i].w;
        if (grains.generation[i] == 0 && diameter >= rule.comminution_diameter)
          factors.push_back(grains.strength[i] / compute_strength(rule.strength, diameter, 1.));
      }
    StrengthStatistics statistics;
    statistics.n = factors.size();
    if (factors.empty())
      return statistics;
    const double n = static_cast<double>(factors.size());
    double sum = 0., squares = 0.;
    for (const double factor : factors)
      sum += factor;
    statistics.mean = sum / n;
    for (const double factor : factors)
      squares += (factor - statistics.mean) * (factor - statistics.mean);
    statistics.standard_deviation = std::sqrt(squares / n);
    statistics.smallest = *std::min_element(factors.begin(), factors.end());
    return statistics;
  }

  BreakageMeasures measure_breakage(const RevState &state, const std::span<const double> initial_diameters,
                                    const FractureRule &rule, const BreakageScale &scale)
  {
    const std::vector<double> diameters = list_diameters(state.grains);
    const double fines = compute_fines(state);
    const InitialGrading initial = measure_initial_grading(initial_diameters, scale);
    return {measure_grading(initial, {.diameters = diameters}, scale),
            measure_grading_with_fines(state, initial, rule, scale), fines / state.initial_solid_volume,
            compute_strength_statistics(state.grains, rule)};
  }
} // namespace dem

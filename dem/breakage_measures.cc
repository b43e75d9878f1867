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

    GradingMeasures measure_grading(const GrainMass &initial, const GrainMass &now, const BreakageScale &scale)
    {
      return {compute_hardin_breakage(initial, now, scale), compute_einav_breakage(initial, now, scale),
              compute_diameter_at(now, 0.1), compute_diameter_at(now, 0.5), compute_diameter_at(now, 0.9)};
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
    const double largest = *std::max_element(initial.diameters.begin(), initial.diameters.end());
    if (!(largest > scale.smallest_diameter))
      return std::numeric_limits<double>::quiet_NaN();
    return compute_share_of_way(compute_mean_logarithm(initial, scale.smallest_diameter),
                                compute_mean_logarithm(now, scale.smallest_diameter),
                                compute_ultimate_mean_logarithm(scale, largest));
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
    double fines = std::max(0., state.initial_solid_volume - compute_solid_volume(state.grains));
    if (fines < 1e-12 * state.initial_solid_volume) // rounding of the sums: nothing was lost
      fines = 0.;
    const GrainMass initial{.diameters = initial_diameters}, grains{.diameters = diameters};
    const GrainMass all{.diameters = diameters, .fines = fines, .largest_fine = rule.comminution_diameter};
    return {measure_grading(initial, grains, scale), measure_grading(initial, all, scale),
            fines / state.initial_solid_volume, compute_strength_statistics(state.grains, rule)};
  }
} // namespace dem

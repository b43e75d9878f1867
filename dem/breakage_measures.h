#pragma once

#include "dem/breakage.h"
#include "dem/grading.h"

#include <limits>

namespace dem
{
  /** What relative breakage is measured against. */
  struct BreakageScale
  {
    double silt_diameter = 0.074e-3;       ///< Hardin: finer mass has no potential to break [m]
    double fractal_dimension = 2.6;        ///< Einav: alpha of the ultimate grading [-], below 3
    double smallest_diameter = 0.01155e-3; ///< Einav: d_m of the ultimate grading [m]; finer mass counts as d_m
  };

  /** Mean over the mass of ln(d/limit), 0 where d is finer than the limit (docs/theory.md, Eq. 7.10). @param limit [m]
   */
  double compute_mean_logarithm(const GrainMass &mass, double limit);

  /**
   * Hardin's relative breakage B_r = B_t/B_p (1985; docs/theory.md, Eq. 7.12).
   *
   * @return 0 for the initial grading, 1 when all mass is silt; NaN when the initial grading has no potential
   */
  double compute_hardin_breakage(const GrainMass &initial, const GrainMass &now, const BreakageScale &scale);

  /**
   * Einav's breakage (2007; docs/theory.md, Eq. 7.13): how far the grading has gone from the initial to the ultimate
   * one, F_u = (d^(3-alpha) - d_m^(3-alpha)) / (d_M^(3-alpha) - d_m^(3-alpha)), d_M the largest initial grain.
   *
   * @return 0 for the initial grading, 1 for the ultimate; NaN when the initial grading is no coarser than that
   */
  double compute_einav_breakage(const GrainMass &initial, const GrainMass &now, const BreakageScale &scale);

  /** What the two measures need to know of a grading before anything broke. */
  struct InitialGrading
  {
    double hardin_mean = std::numeric_limits<double>::quiet_NaN();      ///< mean logarithm over the silt's diameter [-]
    double einav_mean = std::numeric_limits<double>::quiet_NaN();       ///< mean logarithm over d_m [-]
    double largest_diameter = std::numeric_limits<double>::quiet_NaN(); ///< d_M [m]
  };

  InitialGrading measure_initial_grading(std::span<const double> diameters, const BreakageScale &scale);

  /** Numbers of one grading. */
  struct GradingMeasures
  {
    double hardin, einav; ///< relative breakage [-]
    double d10, d50, d90; ///< diameter that the share of the mass passes [m]
  };

  /** Strength over the mean strength of grains of that size, of some grains [-]: f of docs/theory.md, Eq. 15. */
  struct StrengthStatistics
  {
    std::size_t n = 0;
    double mean = std::numeric_limits<double>::quiet_NaN();
    double standard_deviation = std::numeric_limits<double>::quiet_NaN(); ///< of these grains: divided by n
    double smallest = std::numeric_limits<double>::quiet_NaN();
  };

  /** How far a REV has been crushed. */
  struct BreakageMeasures
  {
    GradingMeasures without_fines, with_fines;
    double fines_share = 0.; ///< of the initial volume of solids [-]
    StrengthStatistics whole;
  };

  /** The grading of a REV with its fines, beside the initial one; breakage is NaN where that is not known. Fines lie in
   * [d_c/10, d_c] of the rule. */
  GradingMeasures measure_grading_with_fines(const RevState &state, const InitialGrading &initial,
                                             const FractureRule &rule, const BreakageScale &scale);

  /** Diameters of the grains [m], in the order in which they are stored. */
  std::vector<double> list_diameters(const Grains &grains);

  /** Of the grains of the packing that may break and have not. */
  StrengthStatistics compute_strength_statistics(const Grains &grains, const FractureRule &rule);

  /** @param initial_diameters  of the packing [m]; fines lie in [d_c/10, d_c] of the rule */
  BreakageMeasures measure_breakage(const RevState &state, std::span<const double> initial_diameters,
                                    const FractureRule &rule, const BreakageScale &scale);
} // namespace dem

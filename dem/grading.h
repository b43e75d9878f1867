#pragma once

#include "dem/random.h"

#include <span>
#include <vector>

namespace dem
{
  /** A point of a grading curve. */
  struct GradingPoint
  {
    double diameter; ///< [m]
    double passing;  ///< share of the mass that is finer [-], 0 to 1
  };

  /** A grading: points of increasing diameter and passing, from 0 to 1; passing is linear in diameter between them. */
  using Grading = std::vector<GradingPoint>;

  /** Fontainebleau NE34 sand of the time-to-fracture paper: d50 = 0.21 mm, d_max = 0.27 mm (dem/grading.cc tells how it
   *  was reconstructed). */
  Grading make_ne34_grading();

  /** Throws std::invalid_argument naming the first point that is out of order. */
  void check_grading(const Grading &grading);

  /**
   * Diameters of n grains [m], decreasing. Stratified in the distribution by number, so that even a small sample keeps
   * close to the grading: grain i is drawn in the i-th of n shares.
   */
  std::vector<double> sample_diameters(const Grading &grading, std::size_t n, const StreamKey &key);

  /** Volume of a grain [m3]. @param diameter [m] */
  double compute_grain_volume(double diameter);

  /** Grains as large as they are, plus the fines that splitting has made. */
  struct GrainMass
  {
    std::span<const double> diameters; ///< [m]
    double fines = 0.;                 ///< volume of fines [m3]
    double largest_fine = 0.;          ///< d_c [m]; fines are spread log-uniformly over [d_c/10, d_c]
  };

  /** Share of the mass finer than each of the given diameters [-], fines included if any. */
  std::vector<double> compute_passing(const GrainMass &mass, std::span<const double> at_diameters);

  /** Diameter that the given share of the mass passes [m]. @pre 0 < share < 1 */
  double compute_diameter_at(const GrainMass &mass, double share);
} // namespace dem

#include "dem/grading.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <string>

namespace dem
{
  namespace
  {
    [[noreturn]] void refuse_point(const Grading &grading, std::size_t i, const std::string &why)
    {
      throw std::invalid_argument("grading point " + std::to_string(i + 1) + " (diameter " +
                                  std::to_string(grading[i].diameter * 1e3) + " mm, passing " +
                                  std::to_string(grading[i].passing) + "): " + why);
    }

    /** Grains between two points by number, per unit volume of solids and up to the factor 6/pi [1/m3]: the integral of
     *  dM/d^3 with dM uniform in d, written without the difference of 1/d^2 that cancels in narrow pieces. */
    double compute_number(const GradingPoint &fine, const GradingPoint &coarse)
    {
      const double product = fine.diameter * coarse.diameter;
      return (coarse.passing - fine.passing) * 0.5 * (fine.diameter + coarse.diameter) / (product * product);
    }

    /** Diameter below which lies the given share of a piece's grains: 1/d^2 is linear in the number. */
    double invert_number(const GradingPoint &fine, const GradingPoint &coarse, double share)
    {
      const double ratio = fine.diameter / coarse.diameter;
      const double diameter = fine.diameter / std::sqrt(1. - share * (1. - ratio * ratio));
      return std::clamp(diameter, fine.diameter, coarse.diameter);
    }

    /** Volume of the fines below a diameter [m3], log-uniform over the decade that ends at largest_fine. */
    double compute_fines_below(const GrainMass &mass, double diameter)
    {
      if (!(mass.fines > 0.))
        return 0.;
      return mass.fines * std::clamp(1. + std::log10(diameter / mass.largest_fine), 0., 1.);
    }

    /** Grains in order of size and the volume of each with all finer ones. */
    struct SortedGrains
    {
      explicit SortedGrains(const GrainMass &mass) : diameters(mass.diameters.begin(), mass.diameters.end())
      {
        std::sort(diameters.begin(), diameters.end());
        volume_up_to.reserve(diameters.size() + 1);
        volume_up_to.push_back(0.);
        for (const double diameter : diameters)
          volume_up_to.push_back(volume_up_to.back() + compute_grain_volume(diameter));
        total = volume_up_to.back() + mass.fines;
      }

      std::vector<double> diameters;    ///< [m]
      std::vector<double> volume_up_to; ///< of the i finest grains [m3]
      double total = 0.;                ///< grains and fines [m3]
    };
  } // namespace

  double compute_grain_volume(const double diameter)
  {
    return std::numbers::pi / 6. * diameter * diameter * diameter;
  }

  Grading make_ne34_grading()
  {
    // Reconstructed, not measured. It honours what the time-to-fracture paper gives: d50 = 0.21 mm (comminution limit
    // 0.1155 mm = 0.55 d50), d_max = 0.27 mm, and the count of grains, 11,497 in a 4 mm cube at e = 0.65: 38.79 mm3 of
    // solids are about 11,600 of these. D10 is about 0.15 mm. The paper's Table 1 prints d_min = 0.01 mm, which
    // contradicts that count by orders of magnitude; 0.10 mm is used.
    return {{0.10e-3, 0.},   {0.15e-3, 0.09}, {0.18e-3, 0.24}, {0.21e-3, 0.50},
            {0.23e-3, 0.65}, {0.25e-3, 0.85}, {0.27e-3, 1.}};
  }

  void check_grading(const Grading &grading)
  {
    if (grading.size() < 2)
      throw std::invalid_argument("a grading needs at least 2 points, not " + std::to_string(grading.size()));
    for (std::size_t i = 0; i < grading.size(); ++i)
      {
        if (!(grading[i].diameter > 0. && std::isfinite(grading[i].diameter)))
          refuse_point(grading, i, "the diameter must be positive");
        if (!(grading[i].passing >= 0. && grading[i].passing <= 1.))
          refuse_point(grading, i, "passing must lie in [0, 1]");
        if (i > 0 && !(grading[i].diameter > grading[i - 1].diameter))
          refuse_point(grading, i, "the diameter must exceed that of the point before");
        if (i > 0 && !(grading[i].passing >= grading[i - 1].passing))
          refuse_point(grading, i, "passing must not fall below that of the point before");
      }
    if (grading.front().passing != 0.)
      refuse_point(grading, 0, "passing must begin at 0");
    if (grading.back().passing != 1.)
      refuse_point(grading, grading.size() - 1, "passing must end at 1");
  }

  std::vector<double> sample_diameters(const Grading &grading, std::size_t n, const StreamKey &key)
  {
    check_grading(grading);
    std::vector<double> number_up_to(grading.size(), 0.);
    for (std::size_t i = 1; i < grading.size(); ++i)
      number_up_to[i] = number_up_to[i - 1] + compute_number(grading[i - 1], grading[i]);

    RandomStream stream(key);
    std::vector<double> diameters(n);
    for (std::size_t i = 0; i < n; ++i)
      {
        // Shares are counted from the coarse end. The least number above zero keeps out of pieces without grains.
        const double share = 1. - (static_cast<double>(i) + stream.draw_uniform()) / static_cast<double>(n);
        const double number = std::max(share * number_up_to.back(), std::numeric_limits<double>::min());
        const auto above = std::lower_bound(number_up_to.begin(), number_up_to.end(), number);
        const std::size_t coarse = static_cast<std::size_t>(above - number_up_to.begin());
        const double in_piece = number_up_to[coarse] - number_up_to[coarse - 1];
        diameters[i] = invert_number(grading[coarse - 1], grading[coarse],
                                     std::clamp((number - number_up_to[coarse - 1]) / in_piece, 0., 1.));
      }
    return diameters;
  }

  std::vector<double> compute_passing(const GrainMass &mass, std::span<const double> at_diameters)
  {
    const SortedGrains grains(mass);
    std::vector<double> passing;
    passing.reserve(at_diameters.size());
    for (const double diameter : at_diameters)
      {
        const auto above = std::upper_bound(grains.diameters.begin(), grains.diameters.end(), diameter);
        const std::size_t n_finer = static_cast<std::size_t>(above - grains.diameters.begin());
        passing.push_back((grains.volume_up_to[n_finer] + compute_fines_below(mass, diameter)) / grains.total);
      }
    return passing;
  }

  double compute_diameter_at(const GrainMass &mass, double share)
  {
    assert(share > 0. && share < 1.);
    const SortedGrains grains(mass);
    if (!(grains.total > 0.))
      return std::numeric_limits<double>::quiet_NaN();
    const double target = share * grains.total;

    // The passing curve jumps at each grain and, among the fines, climbs between grains: find the first grain that
    // reaches the target, then ask whether fines had reached it before.
    std::size_t next = 0;
    while (next < grains.diameters.size() &&
           grains.volume_up_to[next + 1] + compute_fines_below(mass, grains.diameters[next]) < target)
      ++next;
    const double wanted_fines = target - grains.volume_up_to[next];
    const bool is_past_the_grains = next == grains.diameters.size();
    if (is_past_the_grains || compute_fines_below(mass, grains.diameters[next]) >= wanted_fines)
      return mass.largest_fine * std::pow(10., std::min(wanted_fines / mass.fines, 1.) - 1.);
    return grains.diameters[next];
  }
} // namespace dem

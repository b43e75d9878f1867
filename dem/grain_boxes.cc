#include "dem/grain_boxes.h"

#include "dem/fraction.h"
#include "dem/memory.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace dem
{
  namespace
  {
    constexpr std::size_t levels_cap = 24;      ///< a size ratio of ten millions
    constexpr double boxes_per_grain = 0.25;    ///< at most: what a box does once should serve some grains together
    constexpr double octaves_per_level = 1.5;   ///< fewer levels to search, though more grains below its reach in each
    constexpr double rounding_room = 1. + 1e-9; ///< in fractions of the cell, so that no box is missed by a last bit
  }                                             // namespace

  void Spheres::resize(const std::size_t n)
  {
    for (auto *values : {&x, &y, &z, &radius})
      values->resize(n);
    grain.resize(n);
  }

  std::size_t Spheres::count_bytes() const
  {
    return dem::count_bytes(x, y, z, radius, grain);
  }

  std::size_t GrainBoxes::count_bytes() const
  {
    return dem::count_bytes(levels_, smallest_, box_, start_) + sorted_.count_bytes();
  }

  void GrainBoxes::sort(const Cell &cell, const std::span<const Row> place, const double skin)
  {
    cell_ = cell;
    skin_ = skin;
    const Matrix inverse = cell.edges.inverse();
    for (int k = 0; k < 3; ++k)
      per_length_[k] = inverse.row(k).norm() * rounding_room;
    // A coordinate is rounded as position, as shifted position and as difference, each by half a last bit of numbers no
    // larger than three cells: below 8 bits of the cell in all, and the square roots of three of them.
    margin_ = 16. * std::numeric_limits<float>::epsilon() * cell.edges.colwise().norm().sum();
    for (int image = 0; image < 27; ++image)
      {
        const Vector shift = cell.edges * Vector(image % 3 - 1, image / 3 % 3 - 1, image / 9 - 1);
        shifts_[image] = {static_cast<float>(shift.x()), static_cast<float>(shift.y()), static_cast<float>(shift.z())};
      }
    update_levels(place);
    update_boxes();
    sort_into_boxes(place);
  }

  void GrainBoxes::update_levels(const std::span<const Row> place)
  {
    double largest = 0., smallest = std::numeric_limits<double>::infinity();
    for (const Row &row : place)
      {
        largest = std::max(largest, row.w);
        smallest = std::min(smallest, row.w);
      }
    const double octaves = largest > 0. && smallest > 0. ? std::log2(largest / smallest) : double(levels_cap);
    const double n_levels = std::clamp(std::rint(octaves / octaves_per_level), 1., double(levels_cap));
    const double ratio = std::exp2(-std::min(octaves, double(levels_cap)) / n_levels);
    levels_.assign(static_cast<std::size_t>(n_levels), Level());
    smallest_.clear();
    for (Level &level : levels_)
      {
        level.largest_radius = largest;
        smallest_.push_back(largest *= ratio);
      }
    smallest_.pop_back(); // the last level takes all that is smaller
    for (const Row &row : place)
      ++levels_[find_level(row.w)].n_grains;
  }

  std::size_t GrainBoxes::find_level(const double radius) const
  {
    std::size_t level = 0;
    for (const double smallest : smallest_)
      level += radius < smallest;
    return level;
  }

  void GrainBoxes::update_boxes()
  {
    const double volume = 1. / (per_length_[0] * per_length_[1] * per_length_[2]);
    std::uint32_t first_box = 0;
    for (Level &level : levels_)
      {
        const double reach = 2. * level.largest_radius + skin_;
        const double width = std::max(reach, std::cbrt(volume / (boxes_per_grain * (level.n_grains + 1.))));
        for (int k = 0; k < 3; ++k)
          level.n[k] = static_cast<int>(std::max(1., std::min(1. / (per_length_[k] * width), 1e6)));
        level.first_box = first_box;
        first_box += level.get_n_boxes();
      }
    start_.assign(first_box + 1, 0);
  }

  double GrainBoxes::wrap(const double fraction) const
  {
    // A grain pressed beyond a wall is looked for in the last box before it: nothing there is farther than from itself.
    return cell_.has_walls() ? fraction : wrap_fraction(fraction);
  }

  std::uint32_t GrainBoxes::find_box(const Row &place) const
  {
    const Level &level = levels_[find_level(place.w)];
    const int i = locate_fraction(wrap(place.x), level.n[0]), j = locate_fraction(wrap(place.y), level.n[1]),
              k = locate_fraction(wrap(place.z), level.n[2]);
    return level.first_box + static_cast<std::uint32_t>((k * level.n[1] + j) * level.n[0] + i);
  }

  void GrainBoxes::sort_into_boxes(const std::span<const Row> place)
  {
    const std::size_t n_grains = place.size();
    box_.resize(n_grains);
    sorted_.resize(n_grains + lanes);
    for (std::size_t i = 0; i < n_grains; ++i)
      {
        box_[i] = find_box(place[i]);
        ++start_[box_[i]];
      }
    std::partial_sum(start_.begin(), start_.end(), start_.begin());
    for (std::size_t i = n_grains; i-- > 0;) // backwards, as each box is filled from its end
      {
        const Row &row = place[i];
        const Vector position = cell_.edges * Vector(wrap(row.x), wrap(row.y), wrap(row.z));
        const std::uint32_t to = --start_[box_[i]];
        sorted_.x[to] = static_cast<float>(position.x());
        sorted_.y[to] = static_cast<float>(position.y());
        sorted_.z[to] = static_cast<float>(position.z());
        sorted_.radius[to] = static_cast<float>(row.w);
        sorted_.grain[to] = static_cast<std::uint32_t>(i);
      }
  }
} // namespace dem

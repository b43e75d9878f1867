#pragma once

#include "dem/cell.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace dem
{
  /** From the cell to one of its images [m]. */
  struct Shift
  {
    float x = 0.f, y = 0.f, z = 0.f;
  };

  /** Positions of grains, array by array: [m] from the cell's corner, in single precision. */
  struct Spheres
  {
    std::vector<float> x, y, z, radius;
    std::vector<std::uint32_t> grain;

    void resize(std::size_t n);
    std::size_t count_bytes() const; ///< memory that it holds
  };

  /**
   * Grains sorted into levels by size, and in each level into the boxes of a grid made for its own largest grain.
   *
   * Keeps its memory from one call to the next.
   */
  class GrainBoxes
  {
  public:
    /** The grains of one class of size, as boxes numbered from first_box on, x fastest. */
    struct Level
    {
      double largest_radius = 0.; ///< [m]
      std::uint32_t n_grains = 0, first_box = 0;
      std::array<int, 3> n = {1, 1, 1}; ///< boxes along each edge

      std::uint32_t get_n_boxes() const { return static_cast<std::uint32_t>(n[0]) * n[1] * n[2]; }
    };

    /** Grains looked at together; the arrays of spheres are longer by as many. */
    static constexpr std::size_t lanes = 16;

    /** @param place  as ContactSearch has it  @param skin  that is looked for around grains [m] */
    void sort(const Cell &cell, std::span<const Row> place, double skin);

    const Cell &get_cell() const { return cell_; }
    double get_skin() const { return skin_; }
    double get_margin() const { return margin_; }
    double get_per_length(const int k) const { return per_length_[k]; }
    const std::vector<Level> &get_levels() const { return levels_; }
    const std::vector<std::uint32_t> &get_start() const { return start_; }
    const Spheres &get_spheres() const { return sorted_; }
    const Shift &get_shift(const int i, const int j, const int k) const { return shifts_[13 + i + 3 * j + 9 * k]; }

    std::size_t count_bytes() const; ///< memory that it holds

  private:
    void update_levels(std::span<const Row> place);
    void update_boxes();
    void sort_into_boxes(std::span<const Row> place);
    std::size_t find_level(double radius) const;
    std::uint32_t find_box(const Row &place) const;
    double wrap(double fraction) const;

    Cell cell_;
    std::array<double, 3> per_length_ = {0., 0., 0.}; ///< fractions that a sphere of unit radius spans [1/m]
    double skin_ = 0.;
    double margin_ = 0.; ///< that covers the rounding of distances in single precision [m]

    std::vector<Level> levels_;              ///< largest grains first
    std::vector<double> smallest_;           ///< radius [m] below which a grain belongs to a later level
    std::vector<std::uint32_t> box_, start_; ///< of each grain; where each box begins in sorted_
    Spheres sorted_;
    std::array<Shift, 27> shifts_;
  };
} // namespace dem

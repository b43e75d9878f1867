#pragma once

#include <array>
#include <cstddef>

namespace dem
{
  /** On what a REV spends its time. */
  enum class Part : std::size_t
  {
    forces,
    search,  ///< of near pairs, and the order of the grains
    motion,  ///< of the grains
    servo,   ///< strain of the cell, its stress, and whether it is at rest
    ageing,  ///< cracks, times to fracture, splits
    tangent, ///< of the contact network
    copy,    ///< of states
    count
  };

  inline constexpr std::array<const char *, static_cast<std::size_t>(Part::count)> part_names = {
      "forces", "search", "motion", "servo", "ageing", "tangent", "copy"};

  /** Wall time by part [s]. A measurement: no result depends on it. */
  struct Profile
  {
    std::array<double, part_names.size()> seconds{};

    double &operator[](const Part part) { return seconds[static_cast<std::size_t>(part)]; }
    double operator[](const Part part) const { return seconds[static_cast<std::size_t>(part)]; }

    Profile &operator+=(const Profile &other)
    {
      for (std::size_t i = 0; i < seconds.size(); ++i)
        seconds[i] += other.seconds[i];
      return *this;
    }
  };
} // namespace dem

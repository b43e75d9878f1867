#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

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

  /** Wall time by part [s], and the work behind it. A measurement: no result depends on it. */
  struct Profile
  {
    std::array<double, part_names.size()> seconds{};
    std::uint64_t n_cycles = 0; ///< of all runs to rest, also of those that were dropped again
    std::uint64_t n_rests = 0;  ///< those runs

    double &operator[](const Part part) { return seconds[static_cast<std::size_t>(part)]; }
    double operator[](const Part part) const { return seconds[static_cast<std::size_t>(part)]; }

    Profile &operator+=(const Profile &other)
    {
      for (std::size_t i = 0; i < seconds.size(); ++i)
        seconds[i] += other.seconds[i];
      n_cycles += other.n_cycles;
      n_rests += other.n_rests;
      return *this;
    }

    /** What moves grains [s]: the rest is what the cycles cost beside them. */
    double compute_cycle_time() const
    {
      return (*this)[Part::forces] + (*this)[Part::search] + (*this)[Part::motion] + (*this)[Part::servo];
    }
  };

  /** What was added between two moments of one profile. */
  inline Profile compute_difference(Profile later, const Profile &earlier)
  {
    for (std::size_t i = 0; i < later.seconds.size(); ++i)
      later.seconds[i] -= earlier.seconds[i];
    later.n_cycles -= earlier.n_cycles;
    later.n_rests -= earlier.n_rests;
    return later;
  }
} // namespace dem

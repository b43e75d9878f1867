#include "dem/grains.h"

#include "dem/memory.h"

#include <numbers>

namespace dem
{
  namespace
  {
    // The one list of arrays: whatever is done to all of them is done here.
    template <typename Operation, typename First, typename... Others>
    void for_each_array(const Operation &operation, First &grains, Others &...others)
    {
      operation(grains.place, others.place...);
      operation(grains.velocity, others.velocity...);
      operation(grains.spin, others.spin...);
      operation(grains.id, others.id...);
      operation(grains.parent, others.parent...);
      operation(grains.generation, others.generation...);
      operation(grains.strength, others.strength...);
      operation(grains.crack_half_length, others.crack_half_length...);
      operation(grains.crack_velocity, others.crack_velocity...);
      operation(grains.largest_contact_stress, others.largest_contact_stress...);
    }
  } // namespace

  std::size_t Grains::count_bytes() const
  {
    std::size_t n_bytes = 0;
    for_each_array([&n_bytes](const auto &array) { n_bytes += dem::count_bytes(array); }, *this);
    return n_bytes;
  }

  void Grains::resize(const std::size_t n)
  {
    for_each_array([n](auto &array) { array.resize(n); }, *this);
  }

  void Grains::assign(const std::size_t to, const Grains &source, const std::size_t from)
  {
    for_each_array([to, from](auto &array, const auto &other) { array[to] = other[from]; }, *this, source);
  }

  void Grains::permute(const std::vector<std::uint32_t> &order)
  {
    const auto permute = [&order](auto &array) {
      auto permuted = array;
      for (std::size_t i = 0; i < order.size(); ++i)
        permuted[i] = array[order[i]];
      array.swap(permuted);
    };
    for_each_array(permute, *this);
  }

  void Grains::keep(const std::vector<bool> &is_kept)
  {
    const auto compact = [&is_kept](auto &array) {
      std::size_t n_kept = 0;
      for (std::size_t i = 0; i < is_kept.size(); ++i)
        if (is_kept[i])
          array[n_kept++] = array[i];
      array.resize(n_kept);
    };
    for_each_array(compact, *this);
  }

  double compute_solid_volume(const Grains &grains)
  {
    double volume = 0.;
    for (const Row &place : grains.place)
      volume += place.w * place.w * place.w;
    return 4. / 3. * std::numbers::pi * volume;
  }
} // namespace dem

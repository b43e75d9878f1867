#include "dem/grains.h"

#include <numbers>

namespace dem
{
  void Grains::assign(const std::size_t to, const Grains &source, const std::size_t from)
  {
    for_each_array([to, from](auto &array, const auto &other) { array[to] = other[from]; }, *this, source);
  }

  void Grains::permute(const std::vector<std::uint32_t> &order)
  {
    const auto permute = [&order](auto &array) {
      const std::vector before(array.begin(), array.end());
      for (std::size_t i = 0; i < order.size(); ++i)
        array[i] = before[order[i]];
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
      array.shrink(n_kept);
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

#include "dem/spatial_order.h"

#include "dem/fraction.h"

#include <algorithm>
#include <array>
#include <utility>

namespace dem
{
  namespace
  {
    constexpr int hilbert_side = 1024; ///< steps along the longest edge; three times ten bits make a key

    /** How far along Hilbert's curve a cube lies (Skilling, AIP Conf. Proc. 707, 2004: axes to transpose). */
    std::uint32_t compute_hilbert_key(std::array<int, 3> at)
    {
      for (int bit = hilbert_side / 2; bit > 1; bit /= 2) // undo the turns of the finer curves
        for (int &coordinate : at)
          if (coordinate & bit)
            at[0] ^= bit - 1;
          else
            {
              const int swapped = (at[0] ^ coordinate) & (bit - 1);
              at[0] ^= swapped;
              coordinate ^= swapped;
            }
      at[1] ^= at[0]; // Gray code
      at[2] ^= at[1];
      int flips = 0;
      for (int bit = hilbert_side / 2; bit > 1; bit /= 2)
        if (at[2] & bit)
          flips ^= bit - 1;
      std::uint32_t key = 0;
      for (int bit = hilbert_side / 2; bit > 0; bit /= 2)
        for (const int coordinate : at)
          key = 2 * key + (((coordinate ^ flips) & bit) ? 1 : 0);
      return key;
    }
  } // namespace

  std::vector<std::uint32_t> compute_spatial_order(const Cell &cell, const std::vector<Row> &place)
  {
    std::array<double, 3> n_steps; // of equal length along each edge, so that the curve is as fine in every direction
    for (int k = 0; k < 3; ++k)
      n_steps[k] = hilbert_side * cell.edges.col(k).norm() / cell.edges.colwise().norm().maxCoeff();
    std::vector<std::pair<std::uint32_t, std::uint32_t>> keyed(place.size());
    for (std::uint32_t i = 0; i < place.size(); ++i)
      {
        const Row &row = place[i];
        keyed[i] = {compute_hilbert_key({locate_fraction(wrap_fraction(row.x), n_steps[0]),
                                         locate_fraction(wrap_fraction(row.y), n_steps[1]),
                                         locate_fraction(wrap_fraction(row.z), n_steps[2])}),
                    i};
      }
    std::sort(keyed.begin(), keyed.end());
    std::vector<std::uint32_t> order(place.size());
    std::transform(keyed.begin(), keyed.end(), order.begin(), [](const auto &entry) { return entry.second; });
    return order;
  }
} // namespace dem

#include "dem/spatial_order.h"

#include "dem/fraction.h"

#include <algorithm>
#include <array>
#include <numeric>

namespace dem
{
  namespace
  {
    constexpr std::uint32_t hilbert_side = 1024; ///< steps along the longest edge; three times ten bits make a key
    constexpr int bits_per_pass = 10;            ///< of a key: its thirty are sorted in three passes

    constexpr std::size_t cubes_at_once = 64; ///< loops over so many are done in vectors
    using Numbers = std::array<std::uint32_t, cubes_at_once>;

    /** Where a coordinate has the bit, flips the finer bits of x; elsewhere exchanges those of the two. Without
     * branches, which no vector can take. */
    void undo_turn(const std::uint32_t bit, Numbers &__restrict__ x, Numbers &__restrict__ other)
    {
      for (std::size_t i = 0; i < cubes_at_once; ++i)
        {
          const std::uint32_t is_flipped = other[i] & bit ? ~0u : 0u;
          const std::uint32_t swapped = (x[i] ^ other[i]) & (bit - 1) & ~is_flipped;
          other[i] ^= swapped;
          x[i] ^= swapped | (is_flipped & (bit - 1));
        }
    }

    /** Writes how far along Hilbert's curve some cubes lie (Skilling, AIP Conf. Proc. 707, 2004: axes to transpose).
     * @param at  their coordinates, which are lost */
    void write_hilbert_keys(std::array<Numbers, 3> &at, Numbers &keys)
    {
      auto &[x, y, z] = at;
      for (std::uint32_t bit = hilbert_side / 2; bit > 1; bit /= 2)
        {
          for (std::size_t i = 0; i < cubes_at_once; ++i)
            x[i] ^= x[i] & bit ? bit - 1 : 0u;
          undo_turn(bit, x, y);
          undo_turn(bit, x, z);
        }
      Numbers flips{};
      for (std::size_t i = 0; i < cubes_at_once; ++i) // Gray code
        {
          y[i] ^= x[i];
          z[i] ^= y[i];
        }
      for (std::uint32_t bit = hilbert_side / 2; bit > 1; bit /= 2)
        for (std::size_t i = 0; i < cubes_at_once; ++i)
          flips[i] ^= z[i] & bit ? bit - 1 : 0u;
      keys.fill(0u);
      for (std::uint32_t bit = hilbert_side / 2; bit > 0; bit /= 2)
        for (const Numbers &axis : at)
          for (std::size_t i = 0; i < cubes_at_once; ++i)
            keys[i] = 2 * keys[i] + ((axis[i] ^ flips[i]) & bit ? 1u : 0u);
    }

    std::vector<std::uint32_t> compute_keys(const Cell &cell, const std::span<const Row> place)
    {
      std::array<double, 3> n_steps; // of equal length along each edge, so that the curve is as fine in every direction
      for (int k = 0; k < 3; ++k)
        n_steps[k] = hilbert_side * cell.edges.col(k).norm() / cell.edges.colwise().norm().maxCoeff();
      const auto locate = [&n_steps](const double fraction, const int k) {
        return static_cast<std::uint32_t>(locate_fraction(wrap_fraction(fraction), n_steps[k]));
      };
      std::vector<std::uint32_t> keys(place.size());
      std::array<Numbers, 3> at{};
      Numbers some;
      for (std::size_t first = 0; first < place.size(); first += cubes_at_once)
        {
          const std::size_t n = std::min(cubes_at_once, place.size() - first);
          for (std::size_t i = 0; i < n; ++i)
            {
              const Row &row = place[first + i];
              at[0][i] = locate(row.x, 0);
              at[1][i] = locate(row.y, 1);
              at[2][i] = locate(row.z, 2);
            }
          write_hilbert_keys(at, some);
          std::copy_n(some.begin(), n, keys.begin() + static_cast<std::ptrdiff_t>(first));
        }
      return keys;
    }
  } // namespace

  std::vector<std::uint32_t> compute_spatial_order(const Cell &cell, const std::span<const Row> place)
  {
    const std::vector<std::uint32_t> keys = compute_keys(cell, place);
    std::vector<std::uint32_t> order(place.size()), sorted(place.size());
    std::iota(order.begin(), order.end(), 0u);
    for (int shift = 0; shift < 3 * bits_per_pass; shift += bits_per_pass) // each pass keeps the order of those before
      {
        const auto get_digit = [&](const std::uint32_t i) { return (keys[i] >> shift) % (1u << bits_per_pass); };
        std::array<std::uint32_t, (1u << bits_per_pass) + 1> next{};
        for (const std::uint32_t i : order)
          ++next[get_digit(i) + 1];
        std::partial_sum(next.begin(), next.end(), next.begin());
        for (const std::uint32_t i : order)
          sorted[next[get_digit(i)]++] = i;
        order.swap(sorted);
      }
    return order;
  }
} // namespace dem

#include "dem/contact_search.h"

#include "dem/contact_network.h"
#include "dem/fraction.h"
#include "dem/memory.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <numeric>

#ifdef __AVX512F__
#include <immintrin.h>
#endif

namespace dem
{
  namespace
  {
    constexpr std::size_t levels_cap = 24;      ///< a size ratio of ten millions
    constexpr double boxes_per_grain = 0.25;    ///< at most: what a box does once should serve some grains together
    constexpr double octaves_per_level = 1.5;   ///< fewer levels to search, though more grains below its reach in each
    constexpr std::size_t block = 16;           ///< candidates looked at together
    constexpr double rounding_room = 1. + 1e-9; ///< in fractions of the cell, so that no box is missed by a last bit

    /** std::sort's own set-out costs more than the few partners of most grains. */
    void sort_few(std::uint32_t *const values, const std::size_t n)
    {
      if (n > 16)
        return std::sort(values, values + n);
      for (std::size_t i = 1; i < n; ++i)
        {
          const std::uint32_t value = values[i];
          std::size_t to = i;
          for (; to > 0 && values[to - 1] > value; --to)
            values[to] = values[to - 1];
          values[to] = value;
        }
    }

    /** Which image of the cell box i of n lies in, for -n <= i < 2 n. */
    int find_image(const int i, const int n)
    {
      return (i >= n) - (i < 0);
    }

    /** to[i] = from[i] + shift in whole blocks: writes and reads up to a block too far, without a tail to wind up. */
    template <typename Number>
    void append(const Number *__restrict__ const from, const std::size_t n, const Number shift,
                Number *__restrict__ const to)
    {
      for (std::size_t i = 0; i < n; i += block)
        for (std::size_t lane = 0; lane < block; ++lane)
          to[i + lane] = from[i + lane] + shift;
    }

    /**
     * Writes which of n lanes are below zero, as candidates from q on, and by how much; up to a block is written over.
     *
     * @return how many
     */
    std::size_t append_hits(const float *const excess, const std::size_t q, const std::size_t n,
                            std::uint32_t *const hits, float *const kept)
    {
#ifdef __AVX512F__
      const __m512 values = _mm512_load_ps(excess);
      const __mmask16 mask = static_cast<__mmask16>(_mm512_cmp_ps_mask(values, _mm512_setzero_ps(), _CMP_LT_OQ) &
                                                    (0xffffu >> (block - n)));
      const __m512i lanes = _mm512_set_epi32(15, 14, 13, 12, 11, 10, 9, 8, 7, 6, 5, 4, 3, 2, 1, 0);
      const __m512i numbers = _mm512_add_epi32(_mm512_set1_epi32(static_cast<int>(q)), lanes);
      _mm512_storeu_si512(hits, _mm512_maskz_compress_epi32(mask, numbers));
      _mm512_storeu_ps(kept, _mm512_maskz_compress_ps(mask, values));
      return static_cast<std::size_t>(__builtin_popcount(mask));
#else
      std::size_t n_hits = 0;
      for (std::size_t lane = 0; lane < n; ++lane)
        {
          hits[n_hits] = static_cast<std::uint32_t>(q + lane);
          kept[n_hits] = excess[lane];
          n_hits += excess[lane] < 0.f;
        }
      return n_hits;
#endif
    }
  } // namespace

  void ContactSearch::Spheres::resize(const std::size_t n)
  {
    for (auto *values : {&x, &y, &z, &radius})
      values->resize(n);
    grain.resize(n);
  }

  std::size_t ContactSearch::count_bytes() const
  {
    std::size_t n_bytes =
        dem::count_bytes(levels_, smallest_, box_, start_, excess_, hits_, first_, later_, found_, pairs_);
    for (const Spheres *spheres : {&sorted_, &candidates_})
      n_bytes += dem::count_bytes(spheres->x, spheres->y, spheres->z, spheres->radius, spheres->grain);
    return n_bytes;
  }

  const std::vector<NearPair> &ContactSearch::list_near_pairs(const Cell &cell, const std::vector<Row> &place,
                                                              const double skin)
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
    assert(is_wide_enough(cell, 2. * levels_[0].largest_radius + skin));
    update_boxes();
    sort_into_boxes(place);
    n_found_ = 0;
    for (std::size_t level = 0; level < levels_.size(); ++level)
      search_from_level(level, place);
    sort_pairs(place.size());
    return pairs_;
  }

  void ContactSearch::update_levels(const std::vector<Row> &place)
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

  std::size_t ContactSearch::find_level(const double radius) const
  {
    std::size_t level = 0;
    for (const double smallest : smallest_)
      level += radius < smallest;
    return level;
  }

  void ContactSearch::update_boxes()
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

  double ContactSearch::wrap(const double fraction) const
  {
    // A grain pressed beyond a wall is looked for in the last box before it: nothing there is farther than from itself.
    return cell_.has_walls() ? fraction : wrap_fraction(fraction);
  }

  std::uint32_t ContactSearch::find_box(const Row &place) const
  {
    const Level &level = levels_[find_level(place.w)];
    const int i = locate_fraction(wrap(place.x), level.n[0]), j = locate_fraction(wrap(place.y), level.n[1]),
              k = locate_fraction(wrap(place.z), level.n[2]);
    return level.first_box + static_cast<std::uint32_t>((k * level.n[1] + j) * level.n[0] + i);
  }

  void ContactSearch::sort_into_boxes(const std::vector<Row> &place)
  {
    const std::size_t n_grains = place.size();
    box_.resize(n_grains);
    sorted_.resize(n_grains + block);
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

  void ContactSearch::search_from_level(const std::size_t level, const std::vector<Row> &place)
  {
    const auto &n = levels_[level].n;
    std::uint32_t number = levels_[level].first_box;
    Box box;
    box.level = level;
    for (box.at[2] = 0; box.at[2] < n[2]; ++box.at[2])
      for (box.at[1] = 0; box.at[1] < n[1]; ++box.at[1])
        for (box.at[0] = 0; box.at[0] < n[0]; ++box.at[0], ++number)
          {
            box.begin = start_[number];
            box.end = start_[number + 1];
            if (box.begin == box.end)
              continue;
            for (std::size_t larger = 0; larger <= level; ++larger)
              if (levels_[larger].n_grains > 0)
                {
                  collect_candidates(box, larger);
                  test_candidates(box, larger == level, place);
                }
          }
  }

  void ContactSearch::collect_candidates(const Box &box, const std::size_t level)
  {
    const Level &from = levels_[box.level], &in = levels_[level];
    const bool is_own_level = level == box.level;
    const double reach = from.largest_radius + in.largest_radius + skin_;
    std::array<int, 3> low, high; // boxes, any image
    for (int k = 0; k < 3; ++k)
      {
        const double span = std::min(0.5, reach * per_length_[k]); // all of the cell, once, should the reach be absurd
        low[k] = static_cast<int>(std::floor((double(box.at[k]) / from.n[k] - span) * in.n[k]));
        high[k] = static_cast<int>(std::floor((double(box.at[k] + 1) / from.n[k] + span) * in.n[k]));
        if (cell_.has_walls())
          {
            low[k] = std::max(low[k], 0);
            high[k] = std::min(high[k], in.n[k] - 1);
          }
      }
    n_candidates_ = 0;
    // In its own level a box looks forward only, itself first: the boxes behind it have already looked.
    for (int k = is_own_level ? box.at[2] : low[2]; k <= high[2]; ++k)
      for (int j = is_own_level && k == box.at[2] ? box.at[1] : low[1]; j <= high[1]; ++j)
        {
          const bool is_own_row = is_own_level && k == box.at[2] && j == box.at[1];
          const int image_z = find_image(k, in.n[2]), image_y = find_image(j, in.n[1]);
          const std::uint32_t row =
              in.first_box +
              static_cast<std::uint32_t>(((k - image_z * in.n[2]) * in.n[1] + j - image_y * in.n[1]) * in.n[0]);
          for (int i = is_own_row ? box.at[0] : low[0]; i <= high[0];)
            {
              const int image_x = find_image(i, in.n[0]), zero = image_x * in.n[0];
              const int last = std::min(high[0], zero + in.n[0] - 1);
              append_candidates(start_[row + (i - zero)], start_[row + (last - zero) + 1],
                                shifts_[13 + image_x + 3 * image_y + 9 * image_z]);
              i = last + 1;
            }
        }
  }

  void ContactSearch::append_candidates(const std::uint32_t begin, const std::uint32_t end, const Shift &shift)
  {
    const std::size_t n = end - begin, needed = n_candidates_ + n;
    if (needed + block > candidates_.grain.size())
      {
        candidates_.resize(2 * needed + block);
        excess_.resize(2 * needed + block);
        hits_.resize(2 * needed + block);
      }
    append(sorted_.x.data() + begin, n, shift.x, candidates_.x.data() + n_candidates_);
    append(sorted_.y.data() + begin, n, shift.y, candidates_.y.data() + n_candidates_);
    append(sorted_.z.data() + begin, n, shift.z, candidates_.z.data() + n_candidates_);
    append(sorted_.radius.data() + begin, n, 0.f, candidates_.radius.data() + n_candidates_);
    append(sorted_.grain.data() + begin, n, 0u, candidates_.grain.data() + n_candidates_);
    n_candidates_ = needed;
  }

  std::size_t ContactSearch::find_hits(const std::uint32_t p, const std::size_t begin)
  {
    const float *const x = candidates_.x.data(), *const y = candidates_.y.data(), *const z = candidates_.z.data();
    const float *const radius = candidates_.radius.data();
    const float x0 = sorted_.x[p], y0 = sorted_.y[p], z0 = sorted_.z[p];
    const float reach = sorted_.radius[p] + static_cast<float>(skin_ + margin_);
    std::size_t n_hits = 0;
    for (std::size_t q = begin; q < n_candidates_; q += block)
      {
        alignas(64) float excess[block];
        for (std::size_t lane = 0; lane < block; ++lane)
          {
            const float dx = x[q + lane] - x0, dy = y[q + lane] - y0, dz = z[q + lane] - z0;
            const float sum = radius[q + lane] + reach;
            excess[lane] = dx * dx + dy * dy + dz * dz - sum * sum;
          }
        n_hits +=
            append_hits(excess, q, std::min(block, n_candidates_ - q), hits_.data() + n_hits, excess_.data() + n_hits);
      }
    return n_hits;
  }

  void ContactSearch::test_candidates(const Box &box, const bool is_own_level, const std::vector<Row> &place)
  {
    const float skin = static_cast<float>(skin_ + margin_), certain_share = static_cast<float>(-4.001 * margin_);
    for (std::uint32_t p = box.begin; p < box.end; ++p)
      {
        const std::size_t n_hits = find_hits(p, is_own_level ? p - box.begin + 1 : 0);
        if (found_.size() < n_found_ + n_hits)
          found_.resize(2 * (n_found_ + n_hits));
        const std::uint32_t here = sorted_.grain[p];
        for (std::size_t hit = 0; hit < n_hits; ++hit)
          {
            const std::uint32_t q = hits_[hit], there = candidates_.grain[q];
            const float sum = sorted_.radius[p] + candidates_.radius[q] + skin; // with a margin: less two to be certain
            found_[n_found_] = {std::min(here, there), std::max(here, there)};
            n_found_ += excess_[hit] < certain_share * sum || is_near(place[here], place[there]);
          }
      }
  }

  bool ContactSearch::is_near(const Row &a, const Row &b) const
  {
    const double sum = a.w + b.w + skin_;
    return compute_branch(cell_, a, b).squaredNorm() < sum * sum;
  }

  void ContactSearch::sort_pairs(const std::size_t n_grains)
  {
    first_.assign(n_grains + 1, 0);
    later_.resize(n_found_);
    for (std::size_t i = 0; i < n_found_; ++i)
      ++first_[found_[i].a];
    std::partial_sum(first_.begin(), first_.end(), first_.begin());
    for (std::size_t i = 0; i < n_found_; ++i)
      later_[--first_[found_[i].a]] = found_[i].b;
    pairs_.resize(n_found_);
    std::size_t n_pairs = 0;
    for (std::uint32_t a = 0; a < n_grains; ++a)
      {
        const std::size_t begin = first_[a], end = first_[a + 1];
        sort_few(later_.data() + begin, end - begin);
        // Two images of one pair can both lie within the margin when the cell is barely wide enough: once is enough.
        for (std::size_t i = begin; i < end; ++i)
          if (i == begin || later_[i] != later_[i - 1])
            pairs_[n_pairs++] = {a, later_[i]};
      }
    pairs_.resize(n_pairs);
  }

  std::vector<NearPair> list_near_pairs(const Cell &cell, const std::vector<Row> &place, const double skin)
  {
    ContactSearch search;
    return search.list_near_pairs(cell, place, skin);
  }
} // namespace dem

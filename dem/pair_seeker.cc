#include "dem/pair_seeker.h"

#include "dem/contact_network.h"
#include "dem/memory.h"

#include <algorithm>
#include <cmath>

#ifdef __AVX512F__
#include <immintrin.h>
#endif

namespace dem
{
  namespace
  {
    constexpr std::size_t lanes = GrainBoxes::lanes;

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
      for (std::size_t i = 0; i < n; i += lanes)
        for (std::size_t lane = 0; lane < lanes; ++lane)
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
                                                    (0xffffu >> (lanes - n)));
      const __m512i numbers_of = _mm512_set_epi32(15, 14, 13, 12, 11, 10, 9, 8, 7, 6, 5, 4, 3, 2, 1, 0);
      const __m512i numbers = _mm512_add_epi32(_mm512_set1_epi32(static_cast<int>(q)), numbers_of);
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

  std::size_t PairSeeker::count_bytes() const
  {
    std::size_t n_bytes = candidates_.count_bytes() + dem::count_bytes(excess_, hits_, lists_);
    for (const List &list : lists_)
      n_bytes += dem::count_bytes(list.pairs);
    return n_bytes;
  }

  void PairSeeker::seek(const GrainBoxes &boxes, const std::span<const Row> place, const std::uint32_t begin,
                        const std::uint32_t end, const std::span<const std::uint32_t> owners)
  {
    boxes_ = &boxes;
    place_ = place.data();
    owners_ = owners;
    lists_.resize(owners.size());
    for (List &list : lists_)
      list.n = 0;
    const auto &levels = boxes.get_levels();
    Box box;
    for (box.level = 0; box.level < levels.size(); ++box.level)
      {
        const GrainBoxes::Level &level = levels[box.level];
        const std::uint32_t first = std::max(begin, level.first_box);
        const std::uint32_t last = std::min(end, level.first_box + level.get_n_boxes());
        for (std::uint32_t number = first; number < last; ++number)
          {
            box.begin = boxes.get_start()[number];
            box.end = boxes.get_start()[number + 1];
            if (box.begin == box.end)
              continue;
            const int at = static_cast<int>(number - level.first_box), row = at / level.n[0];
            box.at = {at % level.n[0], row % level.n[1], row / level.n[1]};
            seek_from(box);
          }
      }
  }

  void PairSeeker::seek_from(const Box &box)
  {
    for (std::size_t larger = 0; larger <= box.level; ++larger)
      if (boxes_->get_levels()[larger].n_grains > 0)
        {
          collect_candidates(box, larger);
          test_candidates(box, larger == box.level);
        }
  }

  std::size_t PairSeeker::find_owner(const std::uint32_t grain) const
  {
    std::size_t owner = 0;
    while (owner + 1 < owners_.size() && grain >= owners_[owner])
      ++owner;
    return owner;
  }

  void PairSeeker::collect_candidates(const Box &box, const std::size_t level)
  {
    const GrainBoxes::Level &from = boxes_->get_levels()[box.level], &in = boxes_->get_levels()[level];
    const bool is_own_level = level == box.level;
    const double reach = from.largest_radius + in.largest_radius + boxes_->get_skin();
    std::array<int, 3> low, high; // boxes, any image
    for (int k = 0; k < 3; ++k)
      {
        const double span =
            std::min(0.5, reach * boxes_->get_per_length(k)); // all of the cell, once, should the reach be absurd
        low[k] = static_cast<int>(std::floor((double(box.at[k]) / from.n[k] - span) * in.n[k]));
        high[k] = static_cast<int>(std::floor((double(box.at[k] + 1) / from.n[k] + span) * in.n[k]));
        if (boxes_->get_cell().has_walls())
          {
            low[k] = std::max(low[k], 0);
            high[k] = std::min(high[k], in.n[k] - 1);
          }
      }
    const std::uint32_t *const start = boxes_->get_start().data();
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
              append_candidates(start[row + (i - zero)], start[row + (last - zero) + 1],
                                boxes_->get_shift(image_x, image_y, image_z));
              i = last + 1;
            }
        }
  }

  void PairSeeker::append_candidates(const std::uint32_t begin, const std::uint32_t end, const Shift &shift)
  {
    const std::size_t n = end - begin, needed = n_candidates_ + n;
    if (needed + lanes > candidates_.grain.size())
      {
        candidates_.resize(2 * needed + lanes);
        excess_.resize(2 * needed + lanes);
        hits_.resize(2 * needed + lanes);
      }
    const Spheres &sorted = boxes_->get_spheres();
    append(sorted.x.data() + begin, n, shift.x, candidates_.x.data() + n_candidates_);
    append(sorted.y.data() + begin, n, shift.y, candidates_.y.data() + n_candidates_);
    append(sorted.z.data() + begin, n, shift.z, candidates_.z.data() + n_candidates_);
    append(sorted.radius.data() + begin, n, 0.f, candidates_.radius.data() + n_candidates_);
    append(sorted.grain.data() + begin, n, 0u, candidates_.grain.data() + n_candidates_);
    n_candidates_ = needed;
  }

  std::size_t PairSeeker::find_hits(const std::uint32_t p, const std::size_t begin)
  {
    const float *const x = candidates_.x.data(), *const y = candidates_.y.data(), *const z = candidates_.z.data();
    const float *const radius = candidates_.radius.data();
    const Spheres &sorted = boxes_->get_spheres();
    const float x0 = sorted.x[p], y0 = sorted.y[p], z0 = sorted.z[p];
    const float reach = sorted.radius[p] + static_cast<float>(boxes_->get_skin() + boxes_->get_margin());
    std::size_t n_hits = 0;
    for (std::size_t q = begin; q < n_candidates_; q += lanes)
      {
        alignas(64) float excess[lanes];
        for (std::size_t lane = 0; lane < lanes; ++lane)
          {
            const float dx = x[q + lane] - x0, dy = y[q + lane] - y0, dz = z[q + lane] - z0;
            const float sum = radius[q + lane] + reach;
            excess[lane] = dx * dx + dy * dy + dz * dz - sum * sum;
          }
        n_hits +=
            append_hits(excess, q, std::min(lanes, n_candidates_ - q), hits_.data() + n_hits, excess_.data() + n_hits);
      }
    return n_hits;
  }

  void PairSeeker::test_candidates(const Box &box, const bool is_own_level)
  {
    const float skin = static_cast<float>(boxes_->get_skin() + boxes_->get_margin()),
                certain_share = static_cast<float>(-4.001 * boxes_->get_margin());
    const Spheres &sorted = boxes_->get_spheres();
    for (std::uint32_t p = box.begin; p < box.end; ++p)
      {
        const std::size_t n_hits = find_hits(p, is_own_level ? p - box.begin + 1 : 0);
        const std::uint32_t here = sorted.grain[p];
        for (std::size_t hit = 0; hit < n_hits; ++hit)
          {
            const std::uint32_t q = hits_[hit], there = candidates_.grain[q], a = std::min(here, there);
            const float sum = sorted.radius[p] + candidates_.radius[q] + skin; // with a margin: less two to be certain
            List &list = lists_[find_owner(a)];
            if (list.n == list.pairs.size())
              list.pairs.resize(2 * list.n + lanes);
            list.pairs[list.n] = {a, std::max(here, there)};
            list.n += excess_[hit] < certain_share * sum || is_near(place_[here], place_[there]);
          }
      }
  }

  bool PairSeeker::is_near(const Row &a, const Row &b) const
  {
    const double sum = a.w + b.w + boxes_->get_skin();
    return compute_branch(boxes_->get_cell(), a, b).squaredNorm() < sum * sum;
  }
} // namespace dem

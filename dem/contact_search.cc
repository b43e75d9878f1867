#include "dem/contact_search.h"

#include "dem/contact_network.h"
#include "dem/memory.h"

#include <algorithm>
#include <cassert>

namespace dem
{
  namespace
  {
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
  } // namespace

  std::size_t ContactSearch::count_bytes() const
  {
    std::size_t n_bytes = boxes_.count_bytes() + dem::count_bytes(owners_, owner_ends_, first_, count_, later_, pairs_);
    for (const PairSeeker &seeker : seekers_)
      n_bytes += seeker.count_bytes();
    return n_bytes;
  }

  const std::vector<NearPair> &ContactSearch::list_near_pairs(const Cell &cell, const std::span<const Row> place,
                                                              const double skin, Team &team)
  {
    boxes_.sort(cell, place, skin);
    assert(is_wide_enough(cell, 2. * boxes_.get_levels()[0].largest_radius + skin));
    share_grains(place.size(), team.size());
    seek(place, team);
    std::size_t room = 0;
    for (std::size_t number = 0; number < owners_.size(); ++number)
      {
        owners_[number].room = room;
        for (const PairSeeker &seeker : seekers_)
          room += seeker.get_found(number).size();
      }
    first_.resize(place.size() + 1);
    count_.resize(place.size());
    later_.resize(room);
    team.run(owners_.size(), [this](const std::size_t number) { sort_pairs(number); });
    std::size_t n_pairs = 0;
    for (Owner &owner : owners_)
      {
        owner.first = n_pairs;
        n_pairs += owner.n;
      }
    pairs_.resize(n_pairs);
    first_.back() = static_cast<std::uint32_t>(n_pairs);
    team.run(owners_.size(), [this](const std::size_t number) { write_pairs(owners_[number]); });
    return pairs_;
  }

  const std::vector<NearPair> &ContactSearch::list_near_pairs(const Cell &cell, const std::span<const Row> place,
                                                              const double skin)
  {
    Team alone(1);
    return list_near_pairs(cell, place, skin, alone);
  }

  void ContactSearch::share_grains(const std::size_t n_grains, const std::size_t n_owners)
  {
    owners_.resize(n_owners);
    owner_ends_.resize(n_owners);
    for (std::size_t number = 0; number < n_owners; ++number)
      {
        owners_[number].begin = static_cast<std::uint32_t>(n_grains * number / n_owners);
        owners_[number].end = owner_ends_[number] = static_cast<std::uint32_t>(n_grains * (number + 1) / n_owners);
      }
  }

  void ContactSearch::seek(const std::span<const Row> place, Team &team)
  {
    const std::vector<std::uint32_t> &start = boxes_.get_start();
    const auto find_box = [&](const std::size_t share) { // boxes with about as many grains for each thread
      if (share == team.size())
        return static_cast<std::uint32_t>(start.size() - 1);
      const std::size_t grain = place.size() * share / team.size();
      return static_cast<std::uint32_t>(std::lower_bound(start.begin(), start.end() - 1, grain) - start.begin());
    };
    seekers_.resize(team.size());
    team.run(team.size(), [&](const std::size_t number) {
      const std::uint32_t begin = number == 0 ? 0 : find_box(number);
      seekers_[number].seek(boxes_, place, begin, find_box(number + 1), owner_ends_);
    });
  }

  /** Sorts what all threads have found for the grains of one owner. */
  void ContactSearch::sort_pairs(const std::size_t number)
  {
    Owner &owner = owners_[number];
    std::uint32_t *const later = later_.data() + owner.room;
    std::fill(count_.begin() + owner.begin, count_.begin() + owner.end, 0u);
    for (const PairSeeker &seeker : seekers_)
      for (const NearPair &pair : seeker.get_found(number))
        ++count_[pair.a];
    std::uint32_t end = 0;
    for (std::uint32_t a = owner.begin; a < owner.end; ++a)
      first_[a] = end += count_[a]; // filled from its end
    for (const PairSeeker &seeker : seekers_)
      for (const NearPair &pair : seeker.get_found(number))
        later[--first_[pair.a]] = pair.b;
    owner.n = 0;
    for (std::uint32_t a = owner.begin; a < owner.end; ++a)
      {
        std::uint32_t *const mine = later + first_[a];
        sort_few(mine, count_[a]);
        // Two images of one pair can both lie within the margin when the cell is barely wide enough: once is enough.
        count_[a] = static_cast<std::uint32_t>(std::unique(mine, mine + count_[a]) - mine);
        owner.n += count_[a];
      }
  }

  void ContactSearch::write_pairs(const Owner &owner)
  {
    const std::uint32_t *const later = later_.data() + owner.room;
    std::size_t n = owner.first;
    for (std::uint32_t a = owner.begin; a < owner.end; ++a)
      {
        const std::uint32_t *const mine = later + first_[a];
        first_[a] = static_cast<std::uint32_t>(n);
        for (std::uint32_t i = 0; i < count_[a]; ++i)
          pairs_[n++] = {a, mine[i]};
      }
  }

  std::vector<NearPair> list_near_pairs(const Cell &cell, const std::span<const Row> place, const double skin)
  {
    ContactSearch search;
    return search.list_near_pairs(cell, place, skin);
  }
} // namespace dem

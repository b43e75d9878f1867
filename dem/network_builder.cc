#include "dem/network_builder.h"

#include "dem/contact_creep.h"
#include "dem/memory.h"
#include "dem/wall_contacts.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>

namespace dem
{
  namespace
  {
    /** Blocks of nearly equal size. A power of two of them are cubes on Hilbert's curve, or halves or quarters of
     * cubes, which have the fewest far pairs; four at least, for as many threads. */
    void make_blocks(ContactNetwork &network, const std::size_t n_grains)
    {
      const std::size_t n_full = (n_grains + grains_per_block - 1) / grains_per_block;
      const std::size_t n_blocks = n_grains <= undivided_grains ? 1 : std::max<std::size_t>(4, std::bit_ceil(n_full));
      network.blocks.resize(n_blocks);
      for (std::size_t k = 0; k < n_blocks; ++k)
        {
          network.blocks[k].grain_begin = n_grains * k / n_blocks;
          network.blocks[k].grain_end = n_grains * (k + 1) / n_blocks;
        }
    }

    /** Far pairs go round the end of storage where that is shorter in networks of no more blocks. In both halves of
     * storage blocks then have as many of them. Larger networks lose more by it: a thread alone comes twice to blocks
     * that reach back, and they have left its cache meanwhile. */
    constexpr std::size_t most_blocks_in_a_ring = 16;

    /** Grains from which on a far pair belongs to the block of its second grain. */
    std::size_t find_end_of_reach(const ContactNetwork &network, const std::size_t k)
    {
      const std::size_t n_blocks = network.blocks.size(), next = k + n_blocks / 2 + 1;
      return n_blocks <= most_blocks_in_a_ring && next < n_blocks ? network.blocks[next].grain_begin
                                                                  : network.blocks.back().grain_end;
    }

    /** Of the skins of two grains: what may part them and yet let them touch before the network is built anew. Of 0 to
     * 0.4 this gives the fewest vectors with a pair that touches (docs/performance.md). */
    constexpr double close_share = 0.07;

    /** Squared distance between the nearest images [m2], as compute_branch has it, within a loop. */
    double compute_square(const Matrix &edges, const Row &a, const Row &b)
    {
      const auto reduce = [](const double fraction) { return fraction - __builtin_rint(fraction); };
      const double x = reduce(b.x - a.x), y = reduce(b.y - a.y), z = reduce(b.z - a.z);
      double square = 0.;
      for (int k = 0; k < 3; ++k)
        {
          const double way = edges(k, 0) * x + edges(k, 1) * y + edges(k, 2) * z;
          square += way * way;
        }
      return square;
    }

    void set_places(ContactNetwork &network, const std::size_t k, const std::uint32_t a, const std::uint32_t b)
    {
      network.a[k] = a;
      network.b[k] = b;
      network.row_a[k] = static_cast<RowOffset>(a * sizeof(Row));
      network.row_b[k] = static_cast<RowOffset>(b * sizeof(Row));
      network.set_shear(k, Vector::Zero(), PairStatus::is_apart);
    }

    void set_pair(ContactNetwork &network, const std::size_t k, const std::uint32_t a, const std::uint32_t b,
                  const Row &place_a, const Row &place_b)
    {
      set_places(network, k, a, b);
      network.radius_sum[k] = place_a.w + place_b.w;
      network.root_radius[k] = std::sqrt(compute_effective_radius(place_a.w, place_b.w));
    }

    /** Fills the last vector of a list. */
    void fill_up(ContactNetwork &network, const std::size_t begin, const std::size_t end, const std::size_t grain)
    {
      for (std::size_t k = begin; k < end; ++k)
        {
          set_places(network, k, static_cast<std::uint32_t>(grain), static_cast<std::uint32_t>(grain));
          network.radius_sum[k] = network.root_radius[k] = 0.;
        }
    }

    std::size_t round_up(const std::size_t n)
    {
      return (n + n_lanes - 1) / n_lanes * n_lanes;
    }

    void resize(ContactNetwork &network, const std::size_t n)
    {
      for (auto *numbers : {&network.a, &network.b})
        numbers->resize(n);
      for (auto *rows : {&network.row_a, &network.row_b})
        rows->resize(n);
      for (auto *values :
           {&network.radius_sum, &network.root_radius, &network.shear_x, &network.shear_y, &network.shear_z})
        values->resize(n);
      network.status.resize(n);
    }

    /** Where contacts have crept, grains touch later: their springs and lever arms see radii that are less by that. */
    void take_creep_off(ContactNetwork &network, const RevState &state)
    {
      if (state.crept_contacts.empty())
        return;
      for (std::size_t k = 0; k < network.size(); ++k)
        if (network.is_pair(k))
          network.radius_sum[k] -= find_crept_overlap(state, network.a[k], network.b[k]);
    }
  } // namespace

  std::size_t NetworkBuilder::count_bytes() const
  {
    std::size_t n_bytes = search_.count_bytes() + dem::count_bytes(sorts_, place_of_pair_, layouts_, incoming_);
    for (const Layout &layout : layouts_)
      n_bytes += dem::count_bytes(layout.left);
    return n_bytes;
  }

  void NetworkBuilder::build(const RevState &state, const std::span<const double> skins, Team &team,
                             ContactNetwork &network)
  {
    set_reaches(state, skins, network);
    network.edges_when_built = state.cell.edges;
    make_blocks(network, state.grains.size());
    pairs_ = &search_.list_near_pairs(state.cell, network.place_when_built, 0., team);
    sorts_.resize(pairs_->size());
    place_of_pair_.resize(pairs_->size());
    const std::size_t n_blocks = network.blocks.size();
    layouts_.resize(n_blocks);
    team.run(n_blocks, [&](const std::size_t k) { sort_block(state, network, k); });
    lay_out_blocks(network);
    team.run(n_blocks, [&](const std::size_t k) { fill_block(state, k, network); });
    list_incoming(state, team, network);
    find_neighbours(network);
    restore_memories(state, team, network);
    take_creep_off(network, state);
    network.wall_pairs = list_wall_pairs(state, network.place_when_built);
  }

  void NetworkBuilder::set_reaches(const RevState &state, const std::span<const double> skins, ContactNetwork &network)
  {
    network.place_when_built.assign(state.grains.place.begin(), state.grains.place.end());
    double largest = 0.;
    for (std::size_t i = 0; i < skins.size(); ++i)
      largest = std::max(largest, network.place_when_built[i].w += skins[i]);
    network.reach = 2. * largest;
  }

  std::size_t NetworkBuilder::Layout::count(const Sort first, const Sort last) const
  {
    return std::accumulate(n.begin() + first, n.begin() + last + 1, std::size_t(0));
  }

  /** Vectors of pairs that are apart are done with once that is seen: those that may touch soon stand together. */
  void NetworkBuilder::sort_block(const RevState &state, const ContactNetwork &network, const std::size_t k)
  {
    const GrainBlock &block = network.blocks[k];
    const std::vector<std::uint32_t> &first = search_.get_first_pairs();
    const std::size_t begin = first[block.grain_begin], end = first[block.grain_end];
    const NearPair *const pairs = pairs_->data();
    const Row *const place = state.grains.place.data(), *const with_skin = network.place_when_built.data();
    const Matrix edges = state.cell.edges;
    const std::size_t end_of_reach = find_end_of_reach(network, k);
    for (std::size_t i = begin; i < end; ++i) // without branches, whose outcome nobody could foresee
      {
        const auto [a, b] = pairs[i];
        const double square = compute_square(edges, place[a], place[b]);
        const double sum = place[a].w + place[b].w, skins = with_skin[a].w + with_skin[b].w - sum;
        const double close = sum + close_share * skins;
        const int sort = !(square < sum * sum) + !(square < close * close);
        const Sort touching = b < end_of_reach ? far_touching : left_touching;
        sorts_[i] = static_cast<Sort>(sort + (b < block.grain_end ? near_touching : touching));
      }
    layouts_[k].left.clear();
    if (end_of_reach < state.grains.size())
      for (std::size_t i = begin; i < end; ++i)
        if (sorts_[i] >= left_touching)
          layouts_[k].left.push_back(static_cast<std::uint32_t>(i));
    for (int sort = 0; sort < n_sorts; ++sort)
      layouts_[k].n[sort] = static_cast<std::size_t>(std::count(sorts_.data() + begin, sorts_.data() + end, sort));
  }

  /** Calls take_pair(i) for the pairs that earlier blocks have left to block k. */
  template <typename Take>
  void NetworkBuilder::for_each_taken(const ContactNetwork &network, const std::size_t k, const Take &take_pair) const
  {
    const GrainBlock &block = network.blocks[k];
    for (std::size_t from = 0; from < k; ++from)
      for (const std::uint32_t i : layouts_[from].left)
        if ((*pairs_)[i].b >= block.grain_begin && (*pairs_)[i].b < block.grain_end)
          take_pair(i);
  }

  void NetworkBuilder::lay_out_blocks(ContactNetwork &network)
  {
    for (std::size_t k = 0; k < network.blocks.size(); ++k)
      for_each_taken(network, k, [&](const std::size_t i) { ++layouts_[k].n[take(sorts_[i])]; });
    std::size_t n = 0;
    network.n_far = 0;
    for (std::size_t k = 0; k < network.blocks.size(); ++k)
      {
        GrainBlock &block = network.blocks[k];
        const Layout &layout = layouts_[k];
        block.first_far = network.n_far;
        block.far_begin = n;
        block.near_begin = n += round_up(layout.count(far_touching, far_apart));
        block.near_end = n += round_up(layout.count(near_touching, near_apart));
        network.n_far += block.near_begin - block.far_begin;
      }
    resize(network, n);
  }

  void NetworkBuilder::fill_block(const RevState &state, const std::size_t k, ContactNetwork &network)
  {
    const GrainBlock &block = network.blocks[k];
    const std::vector<std::uint32_t> &first = search_.get_first_pairs();
    const Layout &layout = layouts_[k];
    std::array<std::size_t, n_sorts> next; // place in the network, for a pair of each sort
    std::exclusive_scan(&layout.n[far_touching], &layout.n[near_touching], &next[far_touching], block.far_begin);
    std::exclusive_scan(&layout.n[near_touching], layout.n.data() + n_sorts, &next[near_touching], block.near_begin);
    const auto place = [&](const std::size_t i) {
      const bool is_taken = sorts_[i] >= left_touching;
      const auto [a, b] = is_taken ? NearPair{(*pairs_)[i].b, (*pairs_)[i].a} : (*pairs_)[i];
      const std::size_t to = next[is_taken ? take(sorts_[i]) : sorts_[i]]++;
      place_of_pair_[i] = static_cast<std::uint32_t>(to);
      set_pair(network, to, a, b, state.grains.place[a], state.grains.place[b]);
    };
    std::vector<std::pair<std::uint32_t, std::uint32_t>> far; // second grain, pair
    far.reserve(layout.count(far_touching, far_apart));
    for (std::size_t i = first[block.grain_begin]; i < first[block.grain_end]; ++i)
      if (sorts_[i] <= far_apart)
        far.emplace_back((*pairs_)[i].b, static_cast<std::uint32_t>(i));
      else if (sorts_[i] < n_sorts)
        place(i);
    for_each_taken(network, k, [&](const std::uint32_t i) { far.emplace_back((*pairs_)[i].a, i); });
    // First grains lie in the cache with their block; second ones come from afar, and come faster in their own order.
    std::sort(far.begin(), far.end());
    for (const auto &[b, i] : far)
      place(i);
    fill_up(network, next[far_apart], block.near_begin, block.grain_begin);
    fill_up(network, next[near_apart], block.near_end, block.grain_begin);
  }

  /** Far pairs sorted by their second grain, those of one grain in their own order. */
  void NetworkBuilder::list_incoming(const RevState &state, Team &team, ContactNetwork &network)
  {
    const std::size_t n_grains = state.grains.size(), n_threads = team.size();
    incoming_.resize(n_grains + 1);
    const auto get_bound = [=](const std::size_t number) { return n_grains * number / n_threads; };
    team.run(n_threads, [&](const std::size_t t) { count_incoming(network, get_bound(t), get_bound(t + 1)); });
    std::uint32_t n = 0;
    for (std::size_t i = 0; i < n_grains; ++i)
      {
        const std::uint32_t here = incoming_[i];
        incoming_[i] = n;
        n += here;
      }
    incoming_[n_grains] = n;
    for (GrainBlock &block : network.blocks)
      {
        block.incoming_begin = incoming_[block.grain_begin];
        block.incoming_end = incoming_[block.grain_end];
      }
    network.incoming_far.resize(n);
    network.incoming_grain.resize(n);
    team.run(n_threads, [&](const std::size_t t) { fill_incoming(get_bound(t), get_bound(t + 1), network); });
  }

  /** Counts far pairs whose second grain is one from `begin` to `end`. */
  void NetworkBuilder::count_incoming(const ContactNetwork &network, const std::size_t begin, const std::size_t end)
  {
    std::fill(incoming_.begin() + static_cast<std::ptrdiff_t>(begin),
              incoming_.begin() + static_cast<std::ptrdiff_t>(end), 0u);
    for (const GrainBlock &block : network.blocks)
      for (std::size_t k = block.far_begin; k < block.near_begin; ++k)
        if (network.b[k] >= begin && network.b[k] < end && network.is_pair(k))
          ++incoming_[network.b[k]];
  }

  void NetworkBuilder::fill_incoming(const std::size_t begin, const std::size_t end, ContactNetwork &network)
  {
    for (const GrainBlock &block : network.blocks) // in rising order: what a grain gets is added in that order
      for (std::size_t k = block.far_begin; k < block.near_begin; ++k)
        if (network.b[k] >= begin && network.b[k] < end && network.is_pair(k))
          {
            const std::uint32_t place = incoming_[network.b[k]]++;
            network.incoming_far[place] = static_cast<std::uint32_t>(block.first_far + (k - block.far_begin));
            network.incoming_grain[place] = network.b[k];
          }
  }

  /** Which blocks reach into which. @pre list_incoming */
  void NetworkBuilder::find_neighbours(ContactNetwork &network) const
  {
    std::vector<GrainBlock> &blocks = network.blocks;
    for (std::size_t k = 0; k < blocks.size(); ++k)
      blocks[k].first_source = blocks[k].last_source = blocks[k].first_target = blocks[k].last_target = k;
    for (std::size_t k = 0; k < blocks.size(); ++k)
      for (std::size_t i = blocks[k].incoming_begin; i < blocks[k].incoming_end; ++i)
        {
          const std::size_t source = find_source(network, network.incoming_far[i]);
          blocks[k].first_source = std::min(blocks[k].first_source, source);
          blocks[k].last_source = std::max(blocks[k].last_source, source);
          blocks[source].first_target = std::min(blocks[source].first_target, k);
          blocks[source].last_target = std::max(blocks[source].last_target, k);
        }
  }

  void NetworkBuilder::restore_memories(const RevState &state, Team &team, ContactNetwork &network) const
  {
    const std::size_t n = state.contacts.size();
    team.run(team.size(), [&](const std::size_t t) {
      for (std::size_t i = n * t / team.size(); i < n * (t + 1) / team.size(); ++i)
        restore_memory(state.contacts[i], network);
    });
  }

  /** Hands the shear force of a touching pair over to the new network. */
  void NetworkBuilder::restore_memory(const ContactMemory &memory, ContactNetwork &network) const
  {
    if (is_wall(memory.b))
      return;
    const std::vector<std::uint32_t> &first = search_.get_first_pairs();
    const auto [a, b] = std::minmax(memory.a, memory.b);
    for (std::uint32_t i = first[a]; i < first[a + 1]; ++i)
      if ((*pairs_)[i].b == b)
        {
          const std::size_t k = place_of_pair_[i];
          network.set_shear(k, memory.a == network.a[k] ? memory.shear_force : Vector(-memory.shear_force),
                            memory.is_sliding ? PairStatus::slides : PairStatus::sticks);
        }
  }
} // namespace dem

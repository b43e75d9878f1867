#include "dem/contact_network.h"

#include "dem/contact_creep.h"
#include "dem/memory.h"
#include "dem/wall_contacts.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace dem
{
  namespace
  {

    /** Blocks of nearly equal size, an even number of them once there are two. */
    void make_blocks(ContactNetwork &network, const std::size_t n_grains)
    {
      // Beyond the cache fewer far pairs, whose forces pass through memory, outweigh blocks that lie near at hand.
      const std::size_t size = n_grains > cached_grains ? 4 * grains_per_block : grains_per_block;
      const std::size_t n_full = (n_grains + size - 1) / size;
      const std::size_t n_blocks = n_full <= 2 ? 1 : n_full + n_full % 2;
      network.blocks.resize(n_blocks);
      for (std::size_t k = 0; k < n_blocks; ++k)
        {
          network.blocks[k].grain_begin = n_grains * k / n_blocks;
          network.blocks[k].grain_end = n_grains * (k + 1) / n_blocks;
        }
    }

    void append_places(ContactNetwork &network, const std::uint32_t a, const std::uint32_t b)
    {
      network.a.push_back(a);
      network.b.push_back(b);
      network.row_a.push_back(static_cast<RowOffset>(a * sizeof(Row)));
      network.row_b.push_back(static_cast<RowOffset>(b * sizeof(Row)));
    }

    void append(ContactNetwork &network, const NearPair &pair, const std::vector<Row> &place)
    {
      append_places(network, pair.a, pair.b);
      network.radius_sum.push_back(place[pair.a].w + place[pair.b].w);
      network.root_radius.push_back(std::sqrt(compute_effective_radius(place[pair.a].w, place[pair.b].w)));
    }

    /** Fills the last vector of a list. */
    void fill_up(ContactNetwork &network, const std::size_t grain)
    {
      while (network.a.size() % n_lanes != 0)
        {
          append_places(network, static_cast<std::uint32_t>(grain), static_cast<std::uint32_t>(grain));
          network.radius_sum.push_back(0.);
          network.root_radius.push_back(0.);
        }
    }

    /** Which pairs touch. */
    std::vector<bool> find_touching(const std::vector<NearPair> &pairs, const RevState &state)
    {
      std::vector<bool> is_touching;
      is_touching.reserve(pairs.size());
      for (const NearPair &pair : pairs)
        {
          const Row &a = state.grains.place[pair.a], &b = state.grains.place[pair.b];
          const double sum = a.w + b.w;
          is_touching.push_back(compute_branch(state.cell, a, b).squaredNorm() < sum * sum);
        }
      return is_touching;
    }

    /** Pairs block by block, near ones first, and of either sort first those that touch: vectors of pairs that are
     * apart are done with once that is seen. @return place of each pair of `pairs` in the network */
    std::vector<std::uint32_t> lay_out_pairs(ContactNetwork &network, const std::vector<NearPair> &pairs,
                                             const RevState &state)
    {
      const std::vector<bool> touches = find_touching(pairs, state);
      std::vector<std::uint32_t> place_of_pair(pairs.size());
      std::size_t begin = 0, end = 0;
      for (GrainBlock &block : network.blocks)
        {
          while (end < pairs.size() && pairs[end].a < block.grain_end)
            ++end;
          const auto append_all = [&](const bool is_far) {
            for (const bool touching : {true, false})
              for (std::size_t k = begin; k < end; ++k)
                if ((pairs[k].b >= block.grain_end) == is_far && touches[k] == touching)
                  {
                    place_of_pair[k] = static_cast<std::uint32_t>(network.a.size());
                    append(network, pairs[k], state.grains.place);
                  }
            fill_up(network, block.grain_begin);
          };
          block.near_begin = network.a.size();
          append_all(false);
          block.far_begin = network.a.size();
          block.first_far = network.n_far;
          append_all(true);
          block.far_end = network.a.size();
          network.n_far += block.far_end - block.far_begin;
          begin = end;
        }
      return place_of_pair;
    }

    /** Far pairs sorted by their second grain, those of one grain in their own order. */
    void list_incoming(ContactNetwork &network, const std::size_t n_grains)
    {
      std::vector<std::uint32_t> start(n_grains + 1, 0);
      for (const GrainBlock &block : network.blocks)
        for (std::size_t k = block.far_begin; k < block.far_end; ++k)
          if (network.is_pair(k))
            ++start[network.b[k] + 1];
      std::partial_sum(start.begin(), start.end(), start.begin());
      for (GrainBlock &block : network.blocks)
        {
          block.incoming_begin = start[block.grain_begin];
          block.incoming_end = start[block.grain_end];
        }
      network.incoming_far.resize(start.back());
      network.incoming_grain.resize(start.back());
      for (const GrainBlock &block : network.blocks) // in rising order: what a grain gets is added in that order
        for (std::size_t k = block.far_begin; k < block.far_end; ++k)
          if (network.is_pair(k))
            {
              const std::uint32_t place = start[network.b[k]]++;
              network.incoming_far[place] = static_cast<std::uint32_t>(block.first_far + (k - block.far_begin));
              network.incoming_grain[place] = network.b[k];
            }
    }

    /** For each block the lowest one whose pairs reach into it. @pre list_incoming */
    void find_sources(ContactNetwork &network)
    {
      for (std::size_t k = 0; k < network.blocks.size(); ++k)
        {
          GrainBlock &block = network.blocks[k];
          block.first_source = k;
          for (std::size_t i = block.incoming_begin; i < block.incoming_end; ++i)
            while (network.incoming_far[i] < network.blocks[block.first_source].first_far)
              --block.first_source;
        }
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

    /** Hands the shear forces of touching pairs over to the pairs of a new network. */
    void restore_memories(ContactNetwork &network, const std::vector<NearPair> &pairs,
                          const std::vector<std::uint32_t> &place_of_pair, const RevState &state)
    {
      std::vector<std::uint32_t> start(state.grains.size() + 1, 0); // of the pairs of each first grain
      for (const NearPair &pair : pairs)
        ++start[pair.a + 1];
      std::partial_sum(start.begin(), start.end(), start.begin());
      for (const ContactMemory &memory : state.contacts)
        {
          if (is_wall(memory.b))
            continue;
          const auto [a, b] = std::minmax(memory.a, memory.b);
          for (std::uint32_t k = start[a]; k < start[a + 1]; ++k)
            if (pairs[k].b == b)
              network.set_shear(place_of_pair[k],
                                memory.a < memory.b ? memory.shear_force : Vector(-memory.shear_force),
                                memory.is_sliding ? PairStatus::slides : PairStatus::sticks);
        }
    }
  } // namespace

  std::size_t ContactNetwork::count_bytes() const
  {
    return dem::count_bytes(a, b, row_a, row_b, radius_sum, root_radius, shear_x, shear_y, shear_z, status, blocks,
                            incoming_far, incoming_grain, wall_pairs, place_when_built);
  }

  void ContactNetwork::set_shear(const std::size_t k, const Vector &force, const PairStatus now)
  {
    shear_x[k] = force.x();
    shear_y[k] = force.y();
    shear_z[k] = force.z();
    status[k] = now;
  }

  Vector compute_branch(const Cell &cell, const Row &place_a, const Row &place_b)
  {
    Vector fraction = to_vector(place_b) - to_vector(place_a);
    for (int k = 0; k < 3; ++k)
      fraction[k] -= __builtin_rint(fraction[k]);
    return cell.edges * fraction;
  }

  double compute_reach(const Grains &grains, const double skin)
  {
    double largest = 0.;
    for (const Row &place : grains.place)
      largest = std::max(largest, place.w);
    return 2. * largest + skin;
  }

  bool is_wide_enough(const Cell &cell, const double reach)
  {
    return compute_narrowest_width(cell) > 2. * reach;
  }

  ContactNetwork build_contact_network(const RevState &state, const double skin, ContactSearch &search)
  {
    ContactNetwork network;
    network.skin = skin;
    network.reach = compute_reach(state.grains, skin);
    network.place_when_built = state.grains.place;
    network.edges_when_built = state.cell.edges;
    make_blocks(network, state.grains.size());
    const std::vector<NearPair> &pairs = search.list_near_pairs(state.cell, state.grains.place, skin);
    const auto place_of_pair = lay_out_pairs(network, pairs, state);
    list_incoming(network, state.grains.size());
    find_sources(network);

    for (auto *shear : {&network.shear_x, &network.shear_y, &network.shear_z})
      shear->assign(network.size(), 0.);
    network.status.assign(network.size(), PairStatus::is_apart);
    restore_memories(network, pairs, place_of_pair, state);
    take_creep_off(network, state);
    network.wall_pairs = list_wall_pairs(state, skin);
    return network;
  }

  ContactNetwork build_contact_network(const RevState &state, const double skin)
  {
    ContactSearch search;
    return build_contact_network(state, skin, search);
  }

  double compute_used_skin(const ContactNetwork &network, const Cell &cell, const Grains &grains)
  {
    double farthest = 0.;
    for (std::size_t i = 0; i < grains.size(); ++i)
      {
        const Vector step = to_vector(grains.place[i]) - to_vector(network.place_when_built[i]);
        farthest = std::max(farthest, (cell.edges * step).squaredNorm());
      }
    const Matrix strain = cell.edges * network.edges_when_built.inverse() - Matrix::Identity();
    return 2. * std::sqrt(farthest) + strain.norm() * network.reach;
  }

  std::vector<ContactMemory> collect_memories(const ContactNetwork &network)
  {
    std::vector<ContactMemory> memories;
    for (std::size_t i = 0; i < network.size(); ++i)
      if (network.status[i] != PairStatus::is_apart)
        memories.push_back({network.a[i], network.b[i], network.get_shear(i), network.status[i] == PairStatus::slides});
    for (const WallPair &pair : network.wall_pairs)
      if (pair.status != PairStatus::is_apart)
        memories.push_back({pair.grain, to_partner(pair.wall), pair.shear_force, pair.status == PairStatus::slides});
    return memories;
  }

  std::vector<Contact> list_contacts(const RevState &state, const ContactLaw &law)
  {
    std::vector<Contact> contacts;
    contacts.reserve(state.contacts.size());
    for (const ContactMemory &memory : state.contacts)
      {
        if (is_wall(memory.b))
          {
            contacts.push_back(make_wall_contact(state, memory, law));
            continue;
          }
        const Row &a = state.grains.place[memory.a], &b = state.grains.place[memory.b];
        Contact contact;
        contact.a = memory.a;
        contact.b = memory.b;
        contact.branch = compute_branch(state.cell, a, b);
        const double distance = contact.branch.norm();
        contact.normal = contact.branch / distance;
        contact.crept_overlap = find_crept_overlap(state, memory.a, memory.b);
        contact.overlap = a.w + b.w - contact.crept_overlap - distance;
        contact.effective_radius = compute_effective_radius(a.w, b.w);
        const NormalResponse normal = compute_normal_response(law, contact.overlap, contact.effective_radius);
        contact.normal_force = normal.force;
        contact.normal_stiffness = normal.stiffness;
        contact.shear_stiffness = law.shear_ratio * normal.stiffness;
        contact.shear_force = memory.shear_force;
        contact.is_sliding = memory.is_sliding;
        contacts.push_back(contact);
      }
    return contacts;
  }
} // namespace dem

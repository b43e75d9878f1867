#include "dem/contact_network.h"

#include "dem/contact_creep.h"
#include "dem/memory.h"
#include "dem/network_builder.h"
#include "dem/wall_contacts.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace dem
{
  namespace
  {
    Contact make_contact(const RevState &state, const ContactMemory &memory, const ContactLaw &law)
    {
      if (is_wall(memory.b))
        return make_wall_contact(state, memory, law);
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
      return contact;
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

  std::size_t find_source(const ContactNetwork &network, const std::size_t far)
  {
    const auto is_after = [](const std::size_t number, const GrainBlock &block) { return number < block.first_far; };
    const auto after = std::upper_bound(network.blocks.begin(), network.blocks.end(), far, is_after);
    return static_cast<std::size_t>(after - network.blocks.begin()) - 1;
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

  ContactNetwork build_contact_network(const RevState &state, const double skin)
  {
    Team alone(1);
    ContactNetwork network;
    NetworkBuilder().build(state, std::vector<double>(state.grains.size(), 0.5 * skin), alone, network);
    return network;
  }

  std::vector<ContactMemory> collect_memories(const ContactNetwork &network)
  {
    Team alone(1);
    RevArrays arrays;
    store_memories(network, alone, arrays);
    return {arrays.contacts.begin(), arrays.contacts.end()};
  }

  void store_memories(const ContactNetwork &network, Team &team, RevArrays &state)
  {
    const std::size_t n_shares = team.size();
    const auto get_bound = [&](const std::size_t share) { return network.size() * share / n_shares; };
    const auto is_touching = [&](const std::size_t k) { return network.status[k] != PairStatus::is_apart; };
    std::vector<std::size_t> first(n_shares + 1, 0); // of the memories of each share of the pairs
    team.run(n_shares, [&](const std::size_t share) {
      std::size_t n = 0;
      for (std::size_t k = get_bound(share); k < get_bound(share + 1); ++k)
        n += is_touching(k);
      first[share + 1] = n;
    });
    std::partial_sum(first.begin(), first.end(), first.begin());
    const auto is_pushed = [](const WallPair &pair) { return pair.status != PairStatus::is_apart; };
    const auto n_pushed = std::count_if(network.wall_pairs.begin(), network.wall_pairs.end(), is_pushed);
    state.resize_contacts(first.back() + static_cast<std::size_t>(n_pushed));
    team.run(n_shares, [&](const std::size_t share) {
      std::size_t to = first[share];
      for (std::size_t k = get_bound(share); k < get_bound(share + 1); ++k)
        if (is_touching(k))
          state.contacts[to++] = {network.a[k], network.b[k], network.get_shear(k),
                                  network.status[k] == PairStatus::slides};
    });
    std::size_t to = first.back();
    for (const WallPair &pair : network.wall_pairs)
      if (is_pushed(pair))
        state.contacts[to++] = {pair.grain, to_partner(pair.wall), pair.shear_force, pair.status == PairStatus::slides};
  }

  std::vector<Contact> list_contacts(const RevState &state, const ContactLaw &law)
  {
    std::vector<Contact> contacts;
    contacts.reserve(state.contacts.size());
    for (const ContactMemory &memory : state.contacts)
      contacts.push_back(make_contact(state, memory, law));
    return contacts;
  }

  std::vector<Contact> list_contacts_of(const RevState &state, const std::span<const std::size_t> places,
                                        const ContactLaw &law)
  {
    std::vector<bool> is_one(state.grains.size(), false);
    for (const std::size_t place : places)
      is_one[place] = true;
    std::vector<Contact> contacts;
    for (const ContactMemory &memory : state.contacts)
      if (is_one[memory.a] || (!is_wall(memory.b) && is_one[memory.b]))
        contacts.push_back(make_contact(state, memory, law));
    return contacts;
  }
} // namespace dem

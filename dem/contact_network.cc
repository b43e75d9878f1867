#include "dem/contact_network.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace dem
{
  namespace
  {
    using Pair = std::pair<std::uint32_t, std::uint32_t>;

    /** Grains sorted into boxes at least one reach wide, for pairs between neighbouring boxes. */
    struct BoxGrid
    {
      std::array<int, 3> n;
      std::vector<std::uint32_t> start, grain;

      BoxGrid(const RevState &state, const double reach)
      {
        const Matrix inverse = state.cell.edges.inverse();
        for (int k = 0; k < 3; ++k)
          n[k] = std::max(1, static_cast<int>(1. / (inverse.row(k).norm() * reach)));
        const std::size_t n_grains = state.grains.size();
        std::vector<std::uint32_t> box(n_grains);
        start.assign(static_cast<std::size_t>(n[0]) * n[1] * n[2] + 1, 0);
        for (std::size_t i = 0; i < n_grains; ++i)
          {
            const Row &place = state.grains.place[i];
            box[i] = index(locate(place.x, n[0]), locate(place.y, n[1]), locate(place.z, n[2]));
            ++start[box[i] + 1];
          }
        std::partial_sum(start.begin(), start.end(), start.begin());
        std::vector<std::uint32_t> next(start.begin(), start.end() - 1);
        grain.resize(n_grains);
        for (std::size_t i = 0; i < n_grains; ++i)
          grain[next[box[i]]++] = static_cast<std::uint32_t>(i);
      }

      static int locate(const double fraction, const int n_boxes)
      {
        // Below zero only for a place that is not a number: the run will say so, the arrays must hold until then.
        return std::clamp(static_cast<int>((fraction - std::floor(fraction)) * n_boxes), 0, n_boxes - 1);
      }

      std::uint32_t index(const int i, const int j, const int k) const
      {
        const auto wrap = [](const int value, const int n_boxes) { return (value + n_boxes) % n_boxes; };
        return (wrap(k, n[2]) * n[1] + wrap(j, n[1])) * n[0] + wrap(i, n[0]);
      }
    };

    /** Calls pair(i, j), i != j, once for each pair of grains in the same or neighbouring boxes. */
    template <typename Visitor>
    void for_each_neighbour_pair(const RevState &state, const double reach, const Visitor &pair)
    {
      const BoxGrid grid(state, reach);
      const bool is_small = std::min({grid.n[0], grid.n[1], grid.n[2]}) < 3; // a box would be its own neighbour twice
      if (is_small)
        {
          for (std::uint32_t i = 0; i < state.grains.size(); ++i)
            for (std::uint32_t j = i + 1; j < state.grains.size(); ++j)
              pair(i, j);
          return;
        }
      for (int k = 0; k < grid.n[2]; ++k)
        for (int j = 0; j < grid.n[1]; ++j)
          for (int i = 0; i < grid.n[0]; ++i)
            for (int neighbour = 13; neighbour < 27; ++neighbour) // itself and one of each two opposite ones
              {
                const std::uint32_t here = grid.index(i, j, k);
                const std::uint32_t there =
                    grid.index(i + neighbour % 3 - 1, j + neighbour / 3 % 3 - 1, k + neighbour / 9 - 1);
                for (std::uint32_t p = grid.start[here]; p < grid.start[here + 1]; ++p)
                  for (std::uint32_t q = here == there ? p + 1 : grid.start[there]; q < grid.start[there + 1]; ++q)
                    pair(std::min(grid.grain[p], grid.grain[q]), std::max(grid.grain[p], grid.grain[q]));
              }
    }

    /** Hands the shear forces of touching pairs over to the pairs of a new network. */
    void restore_memories(ContactNetwork &network, const std::vector<ContactMemory> &memories)
    {
      const auto key = [](std::uint32_t a, std::uint32_t b) {
        return std::uint64_t(std::min(a, b)) << 32 | std::max(a, b);
      };
      std::vector<std::pair<std::uint64_t, std::size_t>> sorted(memories.size());
      for (std::size_t i = 0; i < memories.size(); ++i)
        sorted[i] = {key(memories[i].a, memories[i].b), i};
      std::sort(sorted.begin(), sorted.end());
      auto next = sorted.begin();
      for (std::size_t i = 0; i < network.size(); ++i)
        {
          const std::uint64_t wanted = key(network.a[i], network.b[i]);
          while (next != sorted.end() && next->first < wanted)
            ++next;
          if (next == sorted.end() || next->first != wanted)
            continue;
          const ContactMemory &memory = memories[next->second];
          const Vector t = memory.a < memory.b ? memory.shear_force : Vector(-memory.shear_force);
          network.shear[i] = {t.x(), t.y(), t.z(), memory.is_sliding ? pair_slides : pair_sticks};
        }
    }
  } // namespace

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
    ContactNetwork network;
    network.skin = skin;
    network.reach = compute_reach(state.grains, skin);
    network.place_when_built = state.grains.place;
    network.edges_when_built = state.cell.edges;
    std::vector<Pair> pairs;
    pairs.reserve(8 * state.grains.size());
    const auto &place = state.grains.place;
    for_each_neighbour_pair(state, compute_reach(state.grains, skin),
                            [&](const std::uint32_t i, const std::uint32_t j) {
                              const double reach = place[i].w + place[j].w + skin;
                              if (compute_branch(state.cell, place[i], place[j]).squaredNorm() < reach * reach)
                                pairs.emplace_back(i, j);
                            });
    std::sort(pairs.begin(), pairs.end());

    network.a.reserve(pairs.size());
    network.b.reserve(pairs.size());
    for (const auto &[a, b] : pairs)
      {
        network.a.push_back(a);
        network.b.push_back(b);
      }
    network.shear.assign(pairs.size(), Row{0., 0., 0., pair_is_apart});
    restore_memories(network, state.contacts);
    return network;
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
      if (const Row &shear = network.shear[i]; shear.w != pair_is_apart)
        memories.push_back({network.a[i], network.b[i], to_vector(shear), shear.w == pair_slides});
    return memories;
  }

  std::vector<Contact> list_contacts(const RevState &state, const ContactLaw &law)
  {
    std::vector<Contact> contacts;
    contacts.reserve(state.contacts.size());
    for (const ContactMemory &memory : state.contacts)
      {
        const Row &a = state.grains.place[memory.a], &b = state.grains.place[memory.b];
        Contact contact;
        contact.a = memory.a;
        contact.b = memory.b;
        contact.branch = compute_branch(state.cell, a, b);
        const double distance = contact.branch.norm();
        contact.normal = contact.branch / distance;
        contact.overlap = a.w + b.w - distance;
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

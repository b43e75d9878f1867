#include "dem/breakage.h"

#include "dem/splitting.h"
#include "dem/walls.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace dem
{
  namespace
  {
    void draw_strength(Grains &grains, const std::size_t i, const FractureRule &rule, const RevIdentity &identity)
    {
      const double diameter = 2. * grains.place[i].w;
      RandomStream strength({identity.seed, identity.rev, grains.id[i], Purpose::strength});
      RandomStream crack({identity.seed, identity.rev, grains.id[i], Purpose::crack});
      grains.strength[i] = compute_strength(rule.strength, diameter, draw_strength_factor(rule.strength, strength));
      grains.crack_half_length[i] = draw_initial_crack(rule.crack, diameter, crack);
    }

    /** Direction from each grain to its largest contact force; z for a grain without contacts. */
    std::vector<Vector> find_largest_forces(const std::size_t n_grains, std::span<const Contact> contacts)
    {
      std::vector<Vector> direction(n_grains, Vector::UnitZ());
      std::vector<double> largest(n_grains, 0.);
      const auto consider = [&](const std::size_t grain, const double force, const Vector &normal) {
        if (force > largest[grain])
          {
            largest[grain] = force;
            direction[grain] = normal;
          }
      };
      for (const Contact &contact : contacts)
        {
          consider(contact.a, contact.normal_force, contact.normal);
          if (!is_wall(contact.b))
            consider(contact.b, contact.normal_force, -contact.normal);
        }
      return direction;
    }

    void add_siblings(RevState &state, const std::size_t parent, const Vector &direction, const FractureRule &rule,
                      const RevIdentity &identity)
    {
      Grains &grains = state.grains;
      const std::size_t first = grains.size();
      RandomStream stream({identity.seed, identity.rev, grains.id[parent], Purpose::sibling_spin});
      const auto siblings = compute_siblings(direction, 2. * std::numbers::pi * stream.draw_uniform());
      const Matrix to_fraction = state.cell.edges.inverse();
      const double radius = grains.place[parent].w;
      state.resize_grains(first + n_siblings);
      for (std::size_t k = 0; k < n_siblings; ++k)
        {
          const std::size_t i = first + k;
          grains.assign(i, grains, parent);
          const Vector place = to_vector(grains.place[parent]) + to_fraction * (radius * siblings[k].centre);
          const double share = siblings[k].radius;
          grains.place[i] = {place.x(), place.y(), place.z(), radius * share};
          grains.velocity[i].w *= share * share * share;
          grains.spin[i].w *= std::pow(share, 5);
          grains.id[i] = state.counters.next_id++;
          grains.parent[i] = grains.id[parent];
          grains.generation[i] = grains.generation[parent] + 1;
          grains.crack_velocity[i] = grains.largest_contact_stress[i] = 0.;
          draw_strength(grains, i, rule, identity);
        }
    }

    /** Takes grains out; contacts of those that stay follow them to their new places. */
    void remove_grains(RevState &state, const std::vector<bool> &is_kept)
    {
      std::vector<std::uint32_t> new_place(is_kept.size());
      std::uint32_t n_kept = 0;
      for (std::size_t i = 0; i < is_kept.size(); ++i)
        {
          new_place[i] = n_kept;
          n_kept += is_kept[i] ? 1 : 0;
        }
      const auto is_there = [&](const std::uint32_t partner) { return is_wall(partner) || is_kept[partner]; };
      state.contacts.erase_if([&](const ContactMemory &memory) { return !is_there(memory.a) || !is_there(memory.b); });
      for (ContactMemory &memory : state.contacts)
        {
          memory.a = new_place[memory.a];
          if (!is_wall(memory.b))
            memory.b = new_place[memory.b];
        }
      state.grains.keep(is_kept);
    }
  } // namespace

  std::size_t compute_batch_limit(const FractureRule &rule, const std::size_t n_grains, const unsigned int n_cuts)
  {
    const std::size_t whole = rule.batch_limit > 0
                                  ? rule.batch_limit
                                  : static_cast<std::size_t>(rule.batch_share * static_cast<double>(n_grains));
    return std::max<std::size_t>(1, n_cuts < 64 ? whole >> n_cuts : 0);
  }

  void draw_strengths(Grains &grains, const FractureRule &rule, const RevIdentity &identity)
  {
    for (std::size_t i = 0; i < grains.size(); ++i)
      draw_strength(grains, i, rule, identity);
  }

  void update_crack_velocities(Grains &grains, std::span<const Contact> contacts, const FractureRule &rule)
  {
    std::fill(grains.largest_contact_stress.begin(), grains.largest_contact_stress.end(), 0.);
    for (const Contact &contact : contacts)
      {
        const double stress = compute_contact_stress(contact.normal_force, contact.effective_radius, contact.overlap);
        for (const std::uint32_t partner : {contact.a, contact.b})
          if (!is_wall(partner))
            grains.largest_contact_stress[partner] = std::max(grains.largest_contact_stress[partner], stress);
      }
    for (std::size_t i = 0; i < grains.size(); ++i)
      {
        const bool may_break = rule.is_active && 2. * grains.place[i].w >= rule.comminution_diameter;
        grains.crack_velocity[i] =
            may_break ? compute_crack_velocity(rule.crack, grains.largest_contact_stress[i], grains.strength[i]) : 0.;
      }
  }

  std::vector<std::size_t> list_overstressed(const Grains &grains, const FractureRule &rule)
  {
    std::vector<std::size_t> places;
    if (!rule.is_active)
      return places;
    for (std::size_t i = 0; i < grains.size(); ++i)
      if (2. * grains.place[i].w >= rule.comminution_diameter && grains.largest_contact_stress[i] > grains.strength[i])
        places.push_back(i);
    const auto ratio = [&](const std::size_t i) { return grains.largest_contact_stress[i] / grains.strength[i]; };
    std::sort(places.begin(), places.end(), [&](const std::size_t i, const std::size_t j) {
      return ratio(i) != ratio(j) ? ratio(i) > ratio(j) : grains.id[i] < grains.id[j];
    });
    return places;
  }

  void record_fracture(RevState &state, const std::size_t place, const BreakageCause cause)
  {
    const Grains &grains = state.grains;
    state.fractures.push_back({state.time, grains.id[place], grains.generation[place], 2. * grains.place[place].w,
                               grains.strength[place], cause});
    ++(cause == BreakageCause::instant ? state.counters.broken_instant : state.counters.broken_delayed);
  }

  const char *describe(const BreakageCause cause)
  {
    return cause == BreakageCause::instant ? "instant" : "delayed";
  }

  void split_grains(RevState &state, std::vector<std::size_t> places, std::span<const Contact> contacts,
                    const FractureRule &rule, const RevIdentity &identity)
  {
    const std::vector<Vector> direction = find_largest_forces(state.grains.size(), contacts);
    std::vector<bool> is_kept(state.grains.size() + n_siblings * places.size(), true);
    // Ids of siblings follow the parents' ids, not the order in which somebody listed them.
    std::sort(places.begin(), places.end(),
              [&](const std::size_t i, const std::size_t j) { return state.grains.id[i] < state.grains.id[j]; });
    for (const std::size_t parent : places)
      {
        add_siblings(state, parent, direction[parent], rule, identity);
        is_kept[parent] = false;
      }
    remove_grains(state, is_kept);
  }
} // namespace dem

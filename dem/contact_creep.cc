#include "dem/contact_creep.h"

#include "dem/walls.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

namespace dem
{
  namespace
  {
    // Steps are sought between these [s]: what the first bound disturbs is not disturbed by time.
    constexpr double shortest_exponent = -12., longest_exponent = 18.;
    constexpr int n_halvings = 50; // of the exponent: down to its rounding

    /** Names of the two at a contact, the lower first; walls come last, the numbers of files below zero. */
    struct ContactName
    {
      GrainId a, b;
      bool is_turned; ///< the contact's own first grain is the second here
    };

    ContactName name_contact(const RevState &state, const std::uint32_t a, const std::uint32_t b)
    {
      const GrainId first = state.grains.id[a];
      const GrainId second = is_wall(b) ? static_cast<GrainId>(to_number(b)) : state.grains.id[b];
      return {std::min(first, second), std::max(first, second), second < first};
    }

    const CreptContact *find_crept(const RevState &state, const ContactName &name)
    {
      const auto &all = state.crept_contacts;
      const auto found =
          std::lower_bound(all.begin(), all.end(), name, [](const CreptContact &contact, const ContactName &sought) {
            return contact.a != sought.a ? contact.a < sought.a : contact.b < sought.b;
          });
      return found != all.end() && found->a == name.a && found->b == name.b ? &*found : nullptr;
    }

    /** In the contact's own direction, turned into its present plane with its size kept, as its shear force is. */
    Vector get_retarded_slip(const CreptContact &crept, const ContactName &name, const Vector &normal)
    {
      const Vector slip = name.is_turned ? Vector(-crept.shear_retarded) : crept.shear_retarded;
      const Vector flat = slip - slip.dot(normal) * normal;
      const double size = flat.norm();
      return size > 0. ? Vector(flat * (slip.norm() / size)) : Vector(Vector::Zero());
    }

    CreptContact start_creep(const ContactName &name)
    {
      return {name.a, name.b, 0., 0., Vector::Zero()};
    }

    /** What creeps at a contact in dt. */
    struct Creep
    {
      double shear_share = 1.;                    ///< rate process: of the shear force that is left [-]
      BurgersDisplacement<double> normal{0., 0.}; ///< growth [m]
      BurgersDisplacement<Vector> shear{Vector::Zero(), Vector::Zero()};
    };

    double compute_shear_share(const RateProcessLaw &law, const Contact &contact, const double dt)
    {
      const double size = contact.shear_force.norm();
      if (size == 0.)
        return 1.;
      return compute_relaxed_shear_force(law, {contact.normal_force, contact.shear_stiffness}, size, dt) / size;
    }

    Creep compute_contact_creep(const Contact &contact, const CreptContact &so_far, const Vector &retarded_slip,
                                const CreepLaw &law, const double dt)
    {
      Creep creep;
      if (law.kind == CreepKind::rate_process)
        creep.shear_share = compute_shear_share(law.rate_process, contact, dt);
      else if (law.kind == CreepKind::burgers)
        {
          creep.normal = compute_creep(law.burgers.normal, contact.normal_force, so_far.normal_retarded, dt);
          creep.shear = compute_creep(law.burgers.shear, contact.shear_force, retarded_slip, dt);
        }
      return creep;
    }

    /** Upper bound of the change of the contact's force at held grains [N]; its two parts do not cancel, so that it
     *  rises with time. */
    double compute_force_change(const Contact &contact, const Creep &creep)
    {
      return (1. - creep.shear_share) * contact.shear_force.norm() +
             contact.normal_stiffness * (std::abs(creep.normal.viscous) + std::abs(creep.normal.retarded)) +
             contact.shear_stiffness * (creep.shear.viscous.norm() + creep.shear.retarded.norm());
    }
  } // namespace

  double compute_creep_disturbance(const RevState &state, const std::span<const Contact> contacts, const CreepLaw &law,
                                   const double dt)
  {
    double change = 0., normal_force = 0.;
    for (const Contact &contact : contacts)
      {
        const ContactName name = name_contact(state, contact.a, contact.b);
        const CreptContact *const found = find_crept(state, name);
        const CreptContact so_far = found != nullptr ? *found : start_creep(name);
        const Vector slip = get_retarded_slip(so_far, name, contact.normal);
        change += compute_force_change(contact, compute_contact_creep(contact, so_far, slip, law, dt));
        normal_force += contact.normal_force;
      }
    return normal_force > 0. ? change / normal_force : 0.;
  }

  double compute_longest_creep_step(const RevState &state, const std::span<const Contact> contacts, const CreepLaw &law)
  {
    const auto is_within = [&](const double exponent) {
      return compute_creep_disturbance(state, contacts, law, std::pow(10., exponent)) <= law.step_share;
    };
    if (!law.has_contact_creep() || is_within(longest_exponent))
      return std::numeric_limits<double>::infinity();
    double within = shortest_exponent, beyond = longest_exponent;
    for (int i = 0; i < n_halvings; ++i)
      {
        const double middle = 0.5 * (within + beyond);
        (is_within(middle) ? within : beyond) = middle;
      }
    return std::pow(10., within);
  }

  void advance_contact_creep(RevState &state, const std::span<const Contact> contacts, const CreepLaw &law,
                             const double dt)
  {
    assert(contacts.size() == state.contacts.size());
    std::vector<CreptContact> crept;
    for (std::size_t i = 0; i < contacts.size(); ++i)
      {
        const Contact &contact = contacts[i];
        const ContactName name = name_contact(state, contact.a, contact.b);
        const CreptContact *const found = find_crept(state, name);
        CreptContact now = found != nullptr ? *found : start_creep(name);
        const Vector slip = get_retarded_slip(now, name, contact.normal);
        const Creep creep = compute_contact_creep(contact, now, slip, law, dt);
        state.contacts[i].shear_force = creep.shear_share * contact.shear_force -
                                        contact.shear_stiffness * (creep.shear.viscous + creep.shear.retarded);
        if (law.kind != CreepKind::burgers)
          continue;
        now.normal_viscous += creep.normal.viscous;
        now.normal_retarded += creep.normal.retarded;
        now.shear_retarded = (name.is_turned ? -1. : 1.) * (slip + creep.shear.retarded);
        crept.push_back(now);
      }
    if (law.kind != CreepKind::burgers)
      return; // a shear force is all the memory that a rate process has
    std::sort(crept.begin(), crept.end(), [](const CreptContact &first, const CreptContact &second) {
      return first.a != second.a ? first.a < second.a : first.b < second.b;
    });
    state.set_crept_contacts(crept);
  }

  void forget_open_contacts(RevState &state)
  {
    if (state.crept_contacts.empty())
      return;
    std::vector<bool> is_kept(state.crept_contacts.size(), false);
    for (const ContactMemory &memory : state.contacts)
      if (const CreptContact *const found = find_crept(state, name_contact(state, memory.a, memory.b)))
        is_kept[found - state.crept_contacts.data()] = true;
    std::size_t i = 0;
    state.crept_contacts.erase_if([&](const CreptContact &) { return !is_kept[i++]; });
  }

  double find_crept_overlap(const RevState &state, const std::uint32_t a, const std::uint32_t b)
  {
    if (state.crept_contacts.empty())
      return 0.;
    const CreptContact *const found = find_crept(state, name_contact(state, a, b));
    return found != nullptr ? found->normal_viscous + found->normal_retarded : 0.;
  }
} // namespace dem

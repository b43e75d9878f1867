#include "dem/wall_contacts.h"

#include "dem/contact_creep.h"
#include "dem/fracture.h"

#include <algorithm>
#include <limits>

namespace dem
{
  namespace
  {
    /** A grain against a wall, where both are now. */
    struct Touch
    {
      Vector normal;   ///< out of the cell
      double distance; ///< of the centre from the wall, the lever arm [m]
      double overlap;  ///< [m]
      NormalResponse response;
    };

    Touch find_touch(const Cell &cell, const Row &place, const WallPair &pair, const ContactLaw &law)
    {
      Touch touch;
      touch.normal = get_outward_normal(pair.wall);
      touch.distance = compute_distance_to_wall(cell, place, pair.wall);
      touch.overlap = place.w - pair.crept_overlap - touch.distance;
      touch.response = compute_normal_response(law, touch.overlap, place.w); // R* = R
      return touch;
    }

    /** Brings the shear force of a touching pair up to date (docs/theory.md Eq. 12); the plane never turns. */
    void update_shear(WallPair &pair, const Touch &touch, const ForceTask &task, const ContactLaw &law)
    {
      const Grains &grains = task.state.grains;
      const double dt = task.motion.time_step;
      Vector step = -dt * to_vector(grains.velocity[pair.grain]);
      if (task.motion.is_rotation_free)
        {
          const Vector spin = to_vector(grains.spin[pair.grain]);
          step += dt * touch.distance * touch.normal.cross(spin);
          pair.shear_force += 0.5 * dt * spin.dot(touch.normal) * touch.normal.cross(pair.shear_force);
        }
      step -= step.dot(touch.normal) * touch.normal;
      pair.shear_force += law.shear_ratio * touch.response.stiffness * step;
      const double cap = law.friction * touch.response.force, size = pair.shear_force.norm();
      pair.status = size > cap ? PairStatus::slides : PairStatus::sticks;
      if (size > cap)
        pair.shear_force *= cap / size;
    }

    void add_to_row(Row &row, const Vector &vector, const double stiffness)
    {
      row.x += vector.x();
      row.y += vector.y();
      row.z += vector.z();
      row.w += stiffness;
    }

    void add_to_sums(const Touch &touch, const Vector &force, ContactSums &sums)
    {
      const double stiffness = touch.response.stiffness;
      sums.force_times_branch += force * (touch.distance * touch.normal).transpose();
      sums.wall_force += force.cwiseProduct(touch.normal);
      sums.normal_force += touch.response.force;
      sums.stiffness += stiffness;
      sums.stiffness_moment += stiffness * touch.distance * touch.distance;
      ++sums.n_touching;
    }

    void add_force(const WallPair &pair, const Touch &touch, const Motion &motion, Forces &forces, ContactSums &sums)
    {
      const double stiffness = touch.response.stiffness;
      const Vector force = pair.shear_force - touch.response.force * touch.normal;
      add_to_row(forces.on_grains.force(pair.grain), force, stiffness);
      add_to_sums(touch, force, sums);
      if (motion.is_rotation_free)
        {
          const double turning_stiffness = stiffness * touch.distance * touch.distance;
          add_to_row(forces.on_grains.torque(pair.grain), touch.distance * touch.normal.cross(pair.shear_force),
                     turning_stiffness);
          sums.turning_stiffness += turning_stiffness;
        }
    }

    void update_largest_stress(const WallPair &pair, const Touch &touch, const double radius, Forces &forces)
    {
      double &largest = forces.largest_stress[pair.grain];
      largest = std::max(largest, compute_contact_stress(touch.response.force, radius, touch.overlap));
    }
  } // namespace

  std::vector<WallPair> list_wall_pairs(const RevState &state, const std::span<const Row> reaches)
  {
    std::vector<WallPair> pairs;
    if (!state.cell.has_walls())
      return pairs;
    const std::size_t n_grains = state.grains.size();
    std::vector<std::size_t> first(n_grains + 1, 0);
    for (std::uint32_t i = 0; i < n_grains; ++i)
      {
        first[i] = pairs.size();
        const Row &place = state.grains.place[i];
        for (std::uint32_t wall = 0; wall < n_walls; ++wall)
          if (compute_distance_to_wall(state.cell, place, wall) < 2. * reaches[i].w - place.w)
            pairs.push_back(
                {i, wall, Vector::Zero(), PairStatus::is_apart, find_crept_overlap(state, i, to_partner(wall))});
      }
    first[n_grains] = pairs.size();
    for (const ContactMemory &memory : state.contacts)
      if (is_wall(memory.b))
        for (std::size_t k = first[memory.a]; k < first[memory.a + 1]; ++k)
          if (pairs[k].wall == to_wall(memory.b))
            {
              pairs[k].shear_force = memory.shear_force;
              pairs[k].status = memory.is_sliding ? PairStatus::slides : PairStatus::sticks;
            }
    return pairs;
  }

  Contact make_wall_contact(const RevState &state, const ContactMemory &memory, const ContactLaw &law)
  {
    const Row &place = state.grains.place[memory.a];
    const ContactLaw wall_law = make_wall_law(law);
    WallPair pair{memory.a, to_wall(memory.b), memory.shear_force, PairStatus::sticks};
    pair.crept_overlap = find_crept_overlap(state, memory.a, memory.b);
    const Touch touch = find_touch(state.cell, place, pair, wall_law);
    Contact contact;
    contact.a = memory.a;
    contact.b = memory.b;
    contact.branch = touch.distance * touch.normal;
    contact.normal = touch.normal;
    contact.overlap = touch.overlap;
    contact.crept_overlap = pair.crept_overlap;
    contact.effective_radius = place.w;
    contact.normal_force = touch.response.force;
    contact.normal_stiffness = touch.response.stiffness;
    contact.shear_stiffness = wall_law.shear_ratio * touch.response.stiffness;
    contact.shear_force = memory.shear_force;
    contact.is_sliding = memory.is_sliding;
    return contact;
  }

  void add_wall_forces(const ForceTask &task, ContactNetwork &network, Forces &forces, ContactSums &sums)
  {
    const ContactLaw law = make_wall_law(task.law);
    const Grains &grains = task.state.grains;
    for (WallPair &pair : network.wall_pairs)
      {
        const Row &place = grains.place[pair.grain];
        const Touch touch = find_touch(task.state.cell, place, pair, law);
        if (!(touch.overlap > 0.))
          {
            pair.shear_force.setZero();
            pair.status = PairStatus::is_apart;
            continue;
          }
        update_shear(pair, touch, task, law);
        add_force(pair, touch, task.motion, forces, sums);
        if (task.motion.has_contact_stress)
          update_largest_stress(pair, touch, place.w, forces);
      }
  }

  Vector compute_wall_stress(const Cell &cell, const Vector &force)
  {
    return 0.5 * force.cwiseProduct(cell.edges.diagonal()) / cell.compute_volume();
  }

  Vector compute_wall_stress(const Cell &cell, const std::span<const Contact> contacts)
  {
    if (!cell.has_walls())
      return Vector::Constant(std::numeric_limits<double>::quiet_NaN());
    Vector sum = Vector::Zero();
    for (const Contact &contact : contacts)
      if (is_wall(contact.b))
        sum += compute_force_on_a(contact).cwiseProduct(contact.normal);
    return compute_wall_stress(cell, sum);
  }
} // namespace dem

#pragma once

#include "dem/contact_forces.h"
#include "dem/walls.h"

namespace dem
{
  /** Grains that may touch a wall, in their order, with what those that touch remember. Empty where there is no wall.
   *  Valid as long as the contact network with those skins. @param reaches  w: radius plus skin of each grain [m] */
  std::vector<WallPair> list_wall_pairs(const RevState &state, std::span<const Row> reaches);

  /** All that is known of a grain and a wall that touch: the branch goes to the foot of the centre on the wall. */
  Contact make_wall_contact(const RevState &state, const ContactMemory &memory, const ContactLaw &law);

  /**
   * The walls' share of the forces (docs/theory.md, section 2.1), added to those that the pairs of grains have left;
   * shear history of the walls is brought up to date. One thread, in the order of the list.
   *
   * A wall stretches with the cell: along it a grain slides by its velocity beside that of the cell. Sums and the
   * largest contact stress of each grain are brought up to date as well.
   *
   * @pre compute_contact_forces for the same task, with forces kept
   */
  void add_wall_forces(const ForceTask &task, ContactNetwork &network, Forces &forces, ContactSums &sums);

  /** Force on each wall over its area, the mean of two opposite walls [Pa], tension-positive: xx, yy, zz.
   *  @param force  ContactSums::wall_force */
  Vector compute_wall_stress(const Cell &cell, const Vector &force);

  /** The same from the contacts of a state. NaN without walls. */
  Vector compute_wall_stress(const Cell &cell, std::span<const Contact> contacts);
} // namespace dem

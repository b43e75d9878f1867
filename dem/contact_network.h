#pragma once

#include "dem/contact.h"
#include "dem/contact_law.h"
#include "dem/rev_state.h"

#include <span>
#include <vector>

namespace dem
{
  /** What a candidate pair is at the moment; stored in the w of its shear row. */
  inline constexpr double pair_is_apart = 0., pair_sticks = 1., pair_slides = 2.;

  /**
   * The pairs that may touch, grain a before grain b, and what touching pairs remember. Valid until a grain has moved
   * half the skin. Built from a state alone, by a fixed rule: the order of pairs is the order in which forces are
   * summed, and a restart must find the same.
   */
  struct ContactNetwork
  {
    std::vector<std::uint32_t> a, b;
    std::vector<Row> shear; ///< x, y, z: shear force on a [N]; w: pair_is_apart, pair_sticks or pair_slides

    double skin = 0., reach = 0.; ///< [m]
    std::vector<Row> place_when_built;
    Matrix edges_when_built = Matrix::Identity();

    std::size_t size() const { return a.size(); }
  };

  /** Largest reach of a pair: twice the largest radius plus the skin [m]. */
  double compute_reach(const Grains &grains, double skin);

  /** True when the cell is wide enough for each pair to touch through one image only. */
  bool is_wide_enough(const Cell &cell, double reach);

  /** @pre is_wide_enough(state.cell, compute_reach(state.grains, skin)) */
  ContactNetwork build_contact_network(const RevState &state, double skin);

  /** How much of the skin has been used up [m]; a pair outside the network may touch once this exceeds the skin. */
  double compute_used_skin(const ContactNetwork &network, const Cell &cell, const Grains &grains);

  /** What its touching pairs remember, in the network's order. */
  std::vector<ContactMemory> collect_memories(const ContactNetwork &network);

  /** The touching pairs of a state with all that is known of them, in the order of state.contacts; forces by the
   *  reference law. */
  std::vector<Contact> list_contacts(const RevState &state, const ContactLaw &law);

  /** x_b - x_a between the nearest images [m]. */
  Vector compute_branch(const Cell &cell, const Row &place_a, const Row &place_b);
} // namespace dem

#pragma once

#include "dem/contact_law.h"
#include "dem/contact_network.h"

namespace dem
{
  /**
   * Some touching pairs as arrays of equal length: what is the same arithmetic for each pair is done for all of them in
   * vectors, what goes to and from the grains pair by pair.
   */
  struct ContactBlock
  {
    static constexpr std::size_t capacity = 256;

    std::size_t n = 0;
    std::uint32_t pair[capacity]; ///< places in the network

    alignas(64) double branch_x[capacity], branch_y[capacity], branch_z[capacity]; ///< x_b - x_a [m]
    alignas(64) double distance[capacity];                                   ///< [m]; its square until the normal law
    alignas(64) double overlap[capacity];                                    ///< [m]; Ra + Rb until the normal law
    alignas(64) double radius_product[capacity];                             ///< Ra Rb [m2]
    alignas(64) double force[capacity];                                      ///< N [N]
    alignas(64) double stiffness[capacity];                                  ///< kn [N/m]
    alignas(64) double step_x[capacity], step_y[capacity], step_z[capacity]; ///< relative displacement [m]
    alignas(64) double shear_x[capacity], shear_y[capacity], shear_z[capacity]; ///< t on a [N]
    alignas(64) double status[capacity];                                        ///< pair_sticks or pair_slides
  };

  /** Collects the touching pairs of [begin, end) of the network and forgets the shear of those apart. */
  void gather_touching(const RevState &state, ContactNetwork &network, std::size_t begin, std::size_t end,
                       ContactBlock &block);

  /** N and kn of every pair (reference: compute_normal_response). */
  void apply_normal_law(const ContactLaw &law, ContactBlock &block);

  /** The shear force of every pair: turned into the new contact plane with its size kept, grown by kt du_t, capped at
   *  mu N. */
  void apply_shear_law(const ContactLaw &law, ContactBlock &block);
} // namespace dem

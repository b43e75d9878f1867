#pragma once

#include "dem/contact.h"
#include "dem/creep_law.h"
#include "dem/rev_state.h"

#include <span>

/** Creep of the contacts of a whole REV between equilibria: forces are frozen, then grains find their rest again. */
namespace dem
{
  /**
   * Mean change of a contact's force at held grains, were dt to pass, over the mean normal force [-]: what an
   * equilibrium after it has to redistribute. Rises with dt. 0 where contacts do not creep.
   *
   * @param contacts  of the state, in its order
   */
  double compute_creep_disturbance(const RevState &state, std::span<const Contact> contacts, const CreepLaw &law,
                                   double dt);

  /** Longest dt whose disturbance stays within law.step_share [s]; infinity where none exceeds it. */
  double compute_longest_creep_step(const RevState &state, std::span<const Contact> contacts, const CreepLaw &law);

  /**
   * Lets contacts creep for dt at frozen normal forces (rate process) or at frozen forces (Burgers), grains held: shear
   * forces fall, and Burgers contacts have crept. The state is not at rest afterwards.
   *
   * @param contacts  of the state, in its order, as they were before
   */
  void advance_contact_creep(RevState &state, std::span<const Contact> contacts, const CreepLaw &law, double dt);

  /** Forgets what has crept at contacts that are open now. */
  void forget_open_contacts(RevState &state);

  /** By how much the overlap of two grains has crept [m]: the spring feels so much less. 0 where nothing has.
   *  @param b  place of the second grain, or a wall (dem/walls.h) */
  double find_crept_overlap(const RevState &state, std::uint32_t a, std::uint32_t b);
} // namespace dem

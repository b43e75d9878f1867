#pragma once

#include "dem/contact.h"
#include "dem/fracture.h"
#include "dem/rev_state.h"

namespace dem
{
  /** When and how grains break. */
  struct FractureRule
  {
    bool is_active = true;
    double comminution_diameter = 0.1155e-3; ///< d_c [m]: smaller grains never break
    std::size_t batch_limit = 0;             ///< N_max, grains that break at once at most; 0: by share
    double batch_share = 0.0026;             ///< N_max over the number of grains [-]: 30 of 11497
    StrengthLaw strength;
    CharlesLaw crack;
  };

  /** Whose random numbers a REV draws. */
  struct RevIdentity
  {
    std::uint64_t seed = 1;
    std::uint64_t rev = 0;
  };

  /** N_max: grains that may break at once in a REV of n grains; a batch cut n_cuts times is 2^-n_cuts as large, never
   *  below one grain. */
  std::size_t compute_batch_limit(const FractureRule &rule, std::size_t n_grains, unsigned int n_cuts = 0);

  /** Draws strength and initial crack of every grain anew from its own streams. */
  void draw_strengths(Grains &grains, const FractureRule &rule, const RevIdentity &identity);

  /** Sets each grain's largest contact stress and, from it, its crack velocity; 0 for grains that never break. */
  void update_crack_velocities(Grains &grains, std::span<const Contact> contacts, const FractureRule &rule);

  /** Places of the grains whose largest contact stress exceeds their strength, the most overstressed first (ties by
   *  id). */
  std::vector<std::size_t> list_overstressed(const Grains &grains, const FractureRule &rule);

  /** Notes and counts in the state that a grain is about to split, at the state's time. @param place  of the grain */
  void record_fracture(RevState &state, std::size_t place, BreakageCause cause);

  const char *describe(BreakageCause cause);

  /**
   * Replaces grains by their fourteen siblings, sibling 0 turned onto the largest contact force; they take the parent's
   * velocity and draw their own strength and crack. Contacts of the parents are forgotten; fines are what volume is
   * lost.
   *
   * @param places    of the grains to split, each once
   * @param contacts  of the state, in its order: those of the grains to split at least
   */
  void split_grains(RevState &state, std::vector<std::size_t> places, std::span<const Contact> contacts,
                    const FractureRule &rule, const RevIdentity &identity);
} // namespace dem

#pragma once

#include "coupling/rev_pool.h"

#include "dem/packing.h"
#include "dem/rev.h"

#include <string>

namespace coupling
{
  /** Where the grains of the REVs come from. */
  struct PackingSource
  {
    dem::PackingRule rule;       ///< its seed with the packing's number makes each packing
    std::string file;            ///< a packing to use everywhere instead; empty: generate
    unsigned int n_packings = 1; ///< different ones, dealt out to the points in turn; 0: one a point
  };

  /** How a REV reaches its initial stress. */
  struct ConsolidationRule
  {
    double stress_ratio = 1.5;    ///< largest growth of the stress in one increment [-], > 1
    unsigned int round_cap = 200; ///< equilibria of one avalanche, beyond which consolidation has failed
  };

  /**
   * The packings of all points that live here, in the order of pool.get_local_points(). Each is generated once, by one
   * rank, and sent to those that need it. Collective. Throws std::runtime_error on all ranks if one cannot be made or
   * read.
   */
  std::vector<dem::RevState> distribute_packings(const RevPool &pool, const PackingSource &source,
                                                 const dem::RevModel &model);

  /**
   * Brings a REV to a stress: all six components held, in increments, grains that are overstressed splitting meanwhile.
   * The result is committed; its strain, time and rotation count from there.
   *
   * @param stress  [Pa], tension-positive, in the REV's axes
   * @pre stress is compressive in every direction
   * @return the REV at that stress. Throws std::runtime_error if it finds no equilibrium.
   */
  dem::Rev consolidate(dem::Rev rev, const dem::Matrix &stress, const ConsolidationRule &rule);
} // namespace coupling

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
    unsigned int n_levels = 0;   ///< stresses that each packing is brought to in advance, for n_packings > 0; 0: none
  };

  /** How a REV reaches its initial stress. */
  struct ConsolidationRule
  {
    double stress_ratio = 1.5;    ///< largest growth of the stress in one increment [-], > 1
    unsigned int round_cap = 200; ///< equilibria of one avalanche, beyond which consolidation has failed
    double stress_tolerance = 0.; ///< of the stress reached, over its largest component [-]; 0: the REV's own rule
  };

  /**
   * The packings of all points that live here, in the order of pool.get_local_points(). Each is generated once, by one
   * rank, and sent to those that need it. Collective. Throws std::runtime_error on all ranks if one cannot be made or
   * read.
   */
  std::vector<dem::RevState> distribute_packings(const RevPool &pool, const PackingSource &source,
                                                 const dem::RevModel &model);

  /**
   * Packings on the way to the points' stresses, so that each point has a short way left: every packing is brought,
   * with nothing broken, to n_levels of the points' stresses, which lie in equal ratios of mean stress; a point gets
   * its packing at the level that is nearest to its own stress. Its strengths are drawn afterwards, and what its stress
   * overstresses splits in consolidate(). Collective; throws as distribute_packings().
   *
   * @param stresses  of the points that live here, in the order of pool.get_local_points() [Pa], tension-positive
   */
  std::vector<dem::RevState> distribute_library(const RevPool &pool, const PackingSource &source,
                                                const dem::RevModel &model, const ConsolidationRule &rule,
                                                const std::vector<dem::Matrix> &stresses);

  /** Levels of a library: n of the given stresses, the smallest and the largest in mean stress and in equal ratios
   * between them, without doubles; ascending. @pre stresses is not empty, all compressive */
  std::vector<dem::Matrix> choose_levels(std::vector<dem::Matrix> stresses, unsigned int n);

  /** Place of the level that is nearest to a stress: smallest norm of the difference; the first of equals. */
  std::size_t find_nearest_level(const std::vector<dem::Matrix> &levels, const dem::Matrix &stress);

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

#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace coupling
{
  /** When REVs change their rank. No result depends on any of this. */
  struct BalanceRule
  {
    bool is_active = true;       ///< false: every REV stays where it was dealt to
    double smallest_cost = 1e-3; ///< a REV whose next answer is expected to cost less is not taken over [s], >= 0
    double tolerance = 0.05;     ///< share by which the busiest rank may exceed the mean before REVs migrate [-], >= 0
  };

  /** A REV that goes to another rank. */
  struct Move
  {
    std::size_t rev; ///< its place among all
    unsigned int from, to;
  };

  /** Sum of the costs of each rank's REVs. @param owners  rank of each REV @param costs  of each REV [s] */
  std::vector<double> compute_loads(std::span<const unsigned int> owners, std::span<const double> costs,
                                    unsigned int n_ranks);

  /** Largest load over the mean load, less one [-]; 0 for no load. */
  double compute_imbalance(std::span<const double> loads);

  /** Places in the order of falling costs, equal ones by their numbers. */
  std::vector<std::size_t> sort_by_cost(std::span<const double> costs);

  /**
   * Moves that bring the busiest rank within the tolerance of the mean: again and again one REV from the busiest rank
   * to the idlest, the one that comes nearest to half their difference, as long as the busier of the two gets less to
   * do.
   *
   * @param costs  expected of each REV [s]. The same arguments give the same moves on every rank.
   */
  std::vector<Move> plan_migration(std::span<const unsigned int> owners, std::span<const double> costs,
                                   unsigned int n_ranks, double tolerance);
} // namespace coupling

#include "coupling/balance.h"

#include <algorithm>
#include <map>
#include <numeric>
#include <set>

namespace coupling
{
  namespace
  {
    /** REVs of one rank with their costs, so that the one nearest to a cost is found in few steps. */
    using Holdings = std::set<std::pair<double, std::size_t>>;

    /** A REV that was moved more than once goes straight to its last place, in the order of the REVs. */
    std::vector<Move> shorten(const std::vector<Move> &moves, std::span<const unsigned int> owners)
    {
      std::map<std::size_t, unsigned int> ends;
      for (const Move &move : moves)
        ends[move.rev] = move.to;
      std::vector<Move> shortened;
      for (const auto &[rev, end] : ends)
        if (end != owners[rev])
          shortened.push_back({rev, owners[rev], end});
      return shortened;
    }

    Holdings::iterator find_nearest(Holdings &holdings, const double cost)
    {
      const auto above = holdings.lower_bound({cost, 0});
      if (above == holdings.begin())
        return above;
      const auto below = std::prev(above);
      return above == holdings.end() || cost - below->first <= above->first - cost ? below : above;
    }
  } // namespace

  std::vector<double> compute_loads(std::span<const unsigned int> owners, std::span<const double> costs,
                                    const unsigned int n_ranks)
  {
    std::vector<double> loads(n_ranks, 0.);
    for (std::size_t i = 0; i < owners.size(); ++i)
      loads[owners[i]] += costs[i];
    return loads;
  }

  double compute_imbalance(std::span<const double> loads)
  {
    const double mean = std::accumulate(loads.begin(), loads.end(), 0.) / static_cast<double>(loads.size());
    return mean > 0. ? *std::max_element(loads.begin(), loads.end()) / mean - 1. : 0.;
  }

  std::vector<std::size_t> sort_by_cost(std::span<const double> costs)
  {
    std::vector<std::size_t> order(costs.size());
    std::iota(order.begin(), order.end(), 0);
    std::stable_sort(order.begin(), order.end(),
                     [&](const std::size_t a, const std::size_t b) { return costs[a] > costs[b]; });
    return order;
  }

  std::vector<Move> plan_migration(std::span<const unsigned int> owners, std::span<const double> costs,
                                   const unsigned int n_ranks, const double tolerance)
  {
    std::vector<double> loads = compute_loads(owners, costs, n_ranks);
    const double mean = std::accumulate(loads.begin(), loads.end(), 0.) / n_ranks;
    std::vector<Holdings> holdings(n_ranks);
    for (std::size_t i = 0; i < owners.size(); ++i)
      holdings[owners[i]].insert({costs[i], i});
    std::set<std::pair<double, unsigned int>> by_load;
    for (unsigned int rank = 0; rank < n_ranks; ++rank)
      by_load.insert({loads[rank], rank});

    std::vector<Move> moves;
    while (moves.size() < owners.size()) // each move helps; the bound keeps rounding from making them endless
      {
        const auto [most, from] = *by_load.rbegin();
        const auto [least, to] = *by_load.begin();
        if (!(most > (1. + tolerance) * mean) || holdings[from].empty())
          break;
        const auto chosen = find_nearest(holdings[from], 0.5 * (most - least));
        const auto [cost, rev] = *chosen;
        if (!(cost > 0.) || !(least + cost < most))
          break;
        moves.push_back({rev, from, to});
        holdings[from].erase(chosen);
        holdings[to].insert({cost, rev});
        by_load.erase({most, from});
        by_load.erase({least, to});
        by_load.insert({most - cost, from});
        by_load.insert({least + cost, to});
      }
    return shorten(moves, owners);
  }
} // namespace coupling

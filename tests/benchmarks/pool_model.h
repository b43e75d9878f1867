#pragma once

#include "coupling/balance.h"

#include <cstdint>
#include <string>
#include <vector>

/** What moving REVs between many ranks would do: the pool's own rules, with recorded costs instead of REVs. */
namespace pool_model
{
  /** costs.csv of a run folder. */
  struct Recording
  {
    std::vector<std::vector<double>> costs; ///< of each step, of each point [s]
    std::vector<double> sizes;              ///< of each point, its largest [B]
  };

  /** Throws std::runtime_error with file and line. @param stage  only its steps; 0: those of all stages */
  Recording read_recording(const std::string &file, unsigned int stage);

  /** Which recorded point each of n_revs REVs is a copy of, drawn with the seed. */
  std::vector<std::size_t> resample(std::size_t n_points, std::size_t n_revs, std::uint64_t seed);

  struct Setup
  {
    unsigned int n_ranks = 16;
    unsigned int n_phases = 1; ///< questions a step; its costs are spread over them by exponential draws
    coupling::BalanceRule rule;
    std::size_t n_victims = 1000000; ///< others that an idle rank asks, those with the most expected work
    bool takes_over = true, migrates = true;
    double reply_s = 2e-4;  ///< from a request to its answer [s]: the clerk that answers sleeps for up to 3e-4 s
    double bandwidth = 1e9; ///< of each rank's link [B/s]
    std::uint64_t seed = 1;
  };

  struct Outcome
  {
    double work_s = 0.;     ///< of all REVs [s]
    double busiest_s = 0.;  ///< work of the busiest rank of each phase, summed [s]
    double clock_s = 0.;    ///< the phases by the clock, with messages and refusals, and migration between steps [s]
    double shortest_s = 0.; ///< what no sharing could beat: the mean, or the costliest REV, of each phase [s]
    std::uint64_t n_taken = 0, n_migrated = 0;
    double bytes_taken = 0., bytes_migrated = 0.; ///< [B]
  };

  Outcome simulate(const Recording &recording, const std::vector<std::size_t> &sources, const Setup &setup);
} // namespace pool_model

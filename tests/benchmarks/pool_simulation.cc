// Predicted efficiency of the pool of REVs on many ranks, from the costs.csv of a run (docs/performance.md, REVs on
// many ranks).

#include "tests/benchmarks/pool_model.h"

#include <CLI/CLI.hpp>

#include <cstdio>
#include <exception>

namespace
{
  struct Options
  {
    std::string file;
    unsigned int stage = 0;
    std::size_t n_revs = 10000;
    std::vector<unsigned int> ranks = {16, 32, 64, 128, 256, 512, 1024};
    pool_model::Setup setup;
  };

  void declare(CLI::App &app, Options &options)
  {
    app.add_option("costs", options.file, "costs.csv of a run with REVs/Write costs = true")->required();
    app.add_option("--stage", options.stage, "only the steps of this stage; 0: all");
    app.add_option("--revs", options.n_revs, "REVs, each a copy of a recorded one drawn at random")
        ->check(CLI::PositiveNumber);
    app.add_option("--ranks", options.ranks, "numbers of ranks")->delimiter(',')->check(CLI::PositiveNumber);
    app.add_option("--phases", options.setup.n_phases, "questions a step, over which its costs are spread at random")
        ->check(CLI::PositiveNumber);
    app.add_option("--tolerance", options.setup.rule.tolerance, "REVs/Balance tolerance [-]");
    app.add_option("--smallest-cost", options.setup.rule.smallest_cost, "REVs/Smallest cost to move [s]");
    app.add_option("--victims", options.setup.n_victims, "busiest ranks that an idle one asks");
    app.add_option("--reply", options.setup.reply_s, "from a request to its answer [s]");
    app.add_option("--bandwidth", options.setup.bandwidth, "of each rank's link [B/s]")->check(CLI::PositiveNumber);
    app.add_option("--seed", options.setup.seed, "of resampling and of spreading");
  }

  struct Mode
  {
    const char *name;
    bool takes_over, migrates;
  };

  void print_row(const Mode &mode, const pool_model::Outcome &outcome, const unsigned int n_ranks,
                 const std::size_t n_steps)
  {
    const double room = outcome.work_s / n_ranks;
    std::printf("%5u  %-20s %8.3f %8.3f %8.3f %12.1f %12.1f %14.3g\n", n_ranks, mode.name, room / outcome.busiest_s,
                room / outcome.clock_s, room / outcome.shortest_s, double(outcome.n_taken) / n_steps,
                double(outcome.n_migrated) / n_steps,
                (outcome.bytes_taken + outcome.bytes_migrated) / double(n_steps) / n_ranks);
  }
} // namespace

int main(int argc, char **argv)
{
  CLI::App app("Predicted efficiency of the pool of REVs on many ranks, from recorded costs.");
  Options options;
  declare(app, options);
  CLI11_PARSE(app, argc, argv);
  try
    {
      const auto recording = pool_model::read_recording(options.file, options.stage);
      const auto sources = pool_model::resample(recording.sizes.size(), options.n_revs, options.setup.seed);
      std::printf("%zu steps of %zu points, resampled to %zu REVs; %u question(s) a step\n", recording.costs.size(),
                  recording.sizes.size(), options.n_revs, options.setup.n_phases);
      std::printf("ranks  REVs                     work    clock    limit   taken/step   moved/step    B/rank&step\n");
      for (const unsigned int n_ranks : options.ranks)
        for (const Mode &mode : {Mode{"stay", false, false}, Mode{"migrate", false, true},
                                 Mode{"are taken over", true, false}, Mode{"do both", true, true}})
          {
            pool_model::Setup setup = options.setup;
            setup.n_ranks = n_ranks;
            setup.takes_over = mode.takes_over;
            setup.migrates = mode.migrates;
            print_row(mode, pool_model::simulate(recording, sources, setup), n_ranks, recording.costs.size());
          }
    }
  catch (const std::exception &error)
    {
      std::fprintf(stderr, "pool_simulation: %s\n", error.what());
      return 2;
    }
  return 0;
}

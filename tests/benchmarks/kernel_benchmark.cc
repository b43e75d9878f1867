// Times the parts of a cycle one by one: forces, network, motion; and copies of a state beside plain memcpy. Usage:
// kernel_benchmark [Google Benchmark's options]; SLOWSAND_PACKING=FILE names the packing, without it 2000 grains are
// made.

#include "tests/benchmarks/engine_protocol.h"

#include "dem/contact_forces.h"
#include "dem/network_builder.h"
#include "dem/packing.h"
#include "dem/packing_file.h"

#include <benchmark/benchmark.h>

#include <algorithm>
#include <cstdlib>
#include <cstring>

namespace
{
  using benchmarks::Protocol;

  const dem::RevState &get_packing()
  {
    static const dem::RevState state = []() {
      dem::RevState made;
      if (const char *file = std::getenv("SLOWSAND_PACKING"))
        made = dem::read_packing(file);
      else
        {
          dem::PackingRule rule;
          rule.n_grains = 2000;
          rule.pressure = 9.6e6;
          rule.friction = 0.275;
          made = dem::generate_packing(rule, benchmarks::make_material(false), dem::DynamicsRule{}).state;
        }
      dem::update_true_masses(made.grains, dem::MotionRule{}.density);
      return made;
    }();
    return state;
  }

  double compute_skin(const dem::RevState &state)
  {
    double sum = 0.;
    for (const dem::Row &place : state.grains.place)
      sum += place.w;
    return dem::DynamicsRule{}.skin_share * sum / static_cast<double>(state.grains.size());
  }

  void report_grains(benchmark::State &bench, const dem::RevState &state)
  {
    bench.SetItemsProcessed(bench.iterations() * static_cast<std::int64_t>(state.grains.size()));
  }

  /** Arguments: rough, rotation free. */
  void time_forces(benchmark::State &bench)
  {
    const dem::RevState &state = get_packing();
    const dem::ContactLaw law = dem::make_contact_law(benchmarks::make_material(bench.range(0) != 0));
    dem::ContactNetwork network = dem::build_contact_network(state, compute_skin(state));
    dem::Motion motion;
    motion.time_step = Protocol{}.time_step;
    motion.is_rotation_free = bench.range(1) != 0;
    dem::Forces forces;
    for (auto _ : bench)
      benchmark::DoNotOptimize(dem::compute_contact_forces(state, law, motion, network, forces).normal_force);
    report_grains(bench, state);
  }

  /** The first n grains of the packing, and their contacts. */
  dem::RevState take_grains(const std::size_t n)
  {
    dem::RevState state = get_packing();
    const dem::ContactLaw law = dem::make_contact_law(benchmarks::make_material(false));
    dem::Dynamics dynamics(state, law, benchmarks::make_rule(state, law, Protocol{}));
    dynamics.compute_forces();
    dynamics.store();
    const auto is_out = [n](const dem::ContactMemory &memory) { return memory.a >= n || memory.b >= n; };
    state.contacts.erase_if(is_out);
    state.resize_grains(std::min(n, state.grains.size()));
    dem::RevState packed = dem::deserialise(dem::serialise(state)); // without the room of those left out
    return packed;
  }

  /** Argument: threads. A network built again in memory that is there, as Dynamics does it. */
  void time_network(benchmark::State &bench)
  {
    const dem::RevState state = take_grains(get_packing().grains.size());
    const std::vector<double> skins(state.grains.size(), 0.5 * compute_skin(state));
    dem::Team team(static_cast<std::size_t>(bench.range(0)));
    dem::NetworkBuilder builder;
    dem::ContactNetwork network;
    for (auto _ : bench)
      {
        builder.build(state, skins, team, network);
        benchmark::DoNotOptimize(network.size());
      }
    report_grains(bench, state);
  }

  void report_bytes(benchmark::State &bench, const dem::RevState &state, const std::size_t n_copies)
  {
    const std::size_t n_bytes = dem::serialise(state).size();
    bench.SetItemsProcessed(bench.iterations() * static_cast<std::int64_t>(state.grains.size()));
    bench.SetBytesProcessed(bench.iterations() * static_cast<std::int64_t>(n_copies * n_bytes));
  }

  /** Snapshot and restore: there and back, into room that is there already. Argument: grains. */
  void time_copies(benchmark::State &bench)
  {
    dem::RevState state = take_grains(static_cast<std::size_t>(bench.range(0)));
    dem::RevState kept = state;
    for (auto _ : bench)
      {
        kept = state;
        benchmark::ClobberMemory();
        state = kept;
        benchmark::ClobberMemory();
      }
    report_bytes(bench, state, 2);
  }

  /** The same number of bytes, as one piece of memory each. */
  void time_memcpy(benchmark::State &bench)
  {
    const dem::RevState state = take_grains(static_cast<std::size_t>(bench.range(0)));
    std::vector<std::byte> bytes = dem::serialise(state), kept = bytes;
    for (auto _ : bench)
      {
        std::memcpy(kept.data(), bytes.data(), bytes.size());
        benchmark::ClobberMemory();
        std::memcpy(bytes.data(), kept.data(), bytes.size());
        benchmark::ClobberMemory();
      }
    report_bytes(bench, state, 2);
  }

  /** Arguments: rough, rotation free. */
  void time_cycle(benchmark::State &bench)
  {
    Protocol protocol;
    protocol.is_rough = bench.range(0) != 0;
    protocol.is_rotation_free = bench.range(1) != 0;
    dem::RevState state = get_packing();
    const dem::ContactLaw law = dem::make_contact_law(benchmarks::make_material(protocol.is_rough));
    dem::Dynamics dynamics(state, law, benchmarks::make_rule(state, law, protocol));
    dynamics.compute_forces(); // chooses the time step
    const dem::Matrix increment = benchmarks::compute_strain_increment(protocol, dynamics.get_time_step());
    for (auto _ : bench)
      {
        dynamics.compute_forces_and_move(false);
        dynamics.strain(increment);
      }
    report_grains(bench, state);
  }
} // namespace

BENCHMARK(time_forces)->ArgNames({"rough", "free"})->ArgsProduct({{0, 1}, {0, 1}})->Unit(benchmark::kMicrosecond);
BENCHMARK(time_network)->ArgName("threads")->Arg(1)->Arg(2)->UseRealTime()->Unit(benchmark::kMicrosecond);
BENCHMARK(time_cycle)->ArgNames({"rough", "free"})->ArgsProduct({{0, 1}, {0, 1}})->Unit(benchmark::kMicrosecond);
BENCHMARK(time_copies)->ArgName("grains")->Arg(150)->Arg(1000)->Arg(11497)->Unit(benchmark::kMicrosecond);
BENCHMARK(time_memcpy)->ArgName("grains")->Arg(150)->Arg(1000)->Arg(11497)->Unit(benchmark::kMicrosecond);
BENCHMARK_MAIN();

// Makes packings for the comparison with other DEM codes, crushes them, and takes the time of ours.

#include "tests/benchmarks/engine_protocol.h"

#include "dem/breakage.h"
#include "dem/laboratory.h"
#include "dem/packing.h"
#include "dem/packing_file.h"
#include "dem/splitting.h"

#include <CLI/CLI.hpp>

#include <algorithm>
#include <cstdio>
#include <iostream>
#include <numeric>
#include <random>

namespace
{
  using benchmarks::Protocol;

  constexpr double pressure = 9.6e6; // of the packings made here [Pa], compression-positive
  // While they are made. A packing made with the material's 0.275 leans on its shear forces; a text file does not keep
  // them, and half of its stress is gone within 2000 steps.
  constexpr double friction = 0.22;

  dem::DynamicsRule make_rest_rule()
  {
    dem::DynamicsRule rule;
    rule.motion.is_rotation_free = true;
    return rule;
  }

  int make_packing(const std::string &file, const std::size_t n_grains)
  {
    dem::PackingRule rule;
    rule.n_grains = n_grains;
    // By mass uniform between the diameters; the paper's sand reaches down to the same size.
    rule.grading = {{0.12e-3, 0.}, {0.27e-3, 1.}};
    rule.pressure = pressure;
    rule.friction = friction;
    const auto packing = dem::generate_packing(rule, benchmarks::make_material(false), make_rest_rule());
    std::cerr << n_grains << " grains, e = " << packing.report.void_ratio << ", " << packing.report.n_cycles
              << " cycles, " << dem::describe(packing.report.status) << '\n';
    dem::write_packing(file, packing.state);
    return packing.report.status == dem::RestStatus::at_rest ? 0 : 1;
  }

  /** A random share of the places that pass the test. */
  template <typename Test>
  std::vector<std::size_t> draw_places(const std::size_t n, const double share, const Test &test)
  {
    std::vector<std::size_t> places(n);
    std::iota(places.begin(), places.end(), 0);
    std::erase_if(places, [&](const std::size_t i) { return !test(i); });
    std::shuffle(places.begin(), places.end(), std::mt19937_64(1));
    places.resize(static_cast<std::size_t>(share * static_cast<double>(places.size())));
    return places;
  }

  dem::RestReport rest_at_pressure(dem::RevState &state, const dem::RestRule &rule)
  {
    dem::CellControl control;
    control.target_stress = -pressure * dem::Matrix::Identity();
    control.is_stress_controlled = {true, true, true, false, false, false};
    return dem::bring_to_rest(state, rule, control);
  }

  struct Crushing
  {
    double share = 0.2;        ///< of the grains, split into fourteen [-]
    double second_share = 0.;  ///< of their large siblings, split once more [-]
    double second_ratio = 20.; ///< largest over smallest grain after that, at most [-]
  };

  int crush(const std::string &from, const std::string &to, const Crushing &crushing)
  {
    const dem::ContactLaw law = dem::make_contact_law(benchmarks::make_material(false));
    dem::RevState state = dem::read_packing(from);
    const auto split = [&](const std::vector<std::size_t> &places) {
      dem::split_grains(state, places, dem::list_contacts(state, law), dem::FractureRule{}, dem::RevIdentity{});
      return rest_at_pressure(state, {law, make_rest_rule(), dem::EquilibriumRule{}});
    };
    dem::RestReport report = split(draw_places(state.grains.size(), crushing.share, [](std::size_t) { return true; }));
    if (crushing.second_share > 0.)
      {
        const auto [smallest, largest] = std::ranges::minmax(state.grains.place, {}, &dem::Row::w);
        const auto siblings = dem::compute_siblings(dem::Vector::UnitZ(), 0.);
        const double limit =
            largest.w / (crushing.second_ratio * std::ranges::min(siblings, {}, &dem::Sibling::radius).radius);
        report = split(draw_places(state.grains.size(), crushing.second_share, [&](const std::size_t i) {
          return state.grains.generation[i] == 1 && state.grains.place[i].w >= limit;
        }));
      }
    const auto [smallest, largest] = std::ranges::minmax(state.grains.place, {}, &dem::Row::w);
    std::cerr << state.grains.size() << " grains, size ratio " << largest.w / smallest.w << ", " << report.n_cycles
              << " cycles, " << dem::describe(report.status) << '\n';
    dem::write_packing(to, state);
    return report.status == dem::RestStatus::at_rest ? 0 : 1;
  }

  int run(const std::string &file, const Protocol &protocol)
  {
    const benchmarks::Timing timing = benchmarks::run_protocol(dem::read_packing(file), protocol);
    std::printf("{\"grains\": %zu, \"contacts\": %zu, \"seconds\": %.9g, \"cpu_seconds\": %.9g, \"time_step\": %.9g, "
                "\"stress_before\": %.9g, \"stress_after\": %.9g}\n",
                timing.n_grains, timing.n_contacts, timing.seconds, timing.cpu_seconds, timing.time_step,
                timing.stress_before, timing.stress_after);
    return 0;
  }

  /** An oedometer's creep at 21.7 MPa, grains of NE34: prints time [s] and axial strain since loading ended [%]. */
  int creep(const dem::PackingRule &packing, const dem::Precision precision)
  {
    dem::RevModel model;
    model.dynamics.precision = precision;
    model.identity.seed = packing.seed;
    dem::Rev rev = dem::make_rev(model, dem::generate_packing(packing, model.material, model.dynamics).state);
    dem::LaboratoryStage load, held;
    load.kind = dem::StageKind::oedometric;
    load.stress = 21.7e6;
    held.kind = dem::StageKind::creep;
    held.duration = 1e6;
    held.points_per_decade = 1;
    double start = 0.;
    dem::LaboratoryObserver observer;
    observer.observe = [&](const dem::Observation &now) {
      if (now.stage == 0)
        start = now.strain(2, 2);
      else
        std::printf("%g,%.4f\n", now.time, 100. * (start - now.strain(2, 2)));
    };
    dem::LaboratoryPosition position;
    const dem::LaboratoryOutcome outcome = dem::run_programme(rev, {load, held}, {}, observer, position);
    return outcome == dem::LaboratoryOutcome::finished ? 0 : 1;
  }
} // namespace

int main(int argc, char **argv)
{
  CLI::App app("Packings and timings for the comparison with other DEM codes", "engine_benchmark");
  app.require_subcommand(1);
  std::string from, to;
  std::size_t n_grains = 11497;
  Crushing crushing;
  Protocol protocol;
  bool is_blocked = false;

  CLI::App &make = *app.add_subcommand("make", "writes a packing at 9.6 MPa");
  make.add_option("PACKING", to)->required();
  make.add_option("--grains", n_grains);
  CLI::App &crush_command = *app.add_subcommand("crush", "splits grains at random and writes what comes to rest");
  crush_command.add_option("PACKING", from)->required()->check(CLI::ExistingFile);
  crush_command.add_option("CRUSHED", to)->required();
  crush_command.add_option("--share", crushing.share);
  crush_command.add_option("--second-share", crushing.second_share);
  CLI::App &run_command = *app.add_subcommand("run", "strains a packing by the protocol; prints one line of JSON");
  run_command.add_option("PACKING", from)->required()->check(CLI::ExistingFile);
  run_command.add_option("--steps", protocol.n_steps);
  run_command.add_option("--threads", protocol.n_threads);
  run_command.add_option("--warm-up", protocol.warm_up, "[s] of the same work before the time is taken");
  run_command.add_flag("--single", protocol.is_single, "single precision");
  run_command.add_flag("--rough", protocol.is_rough, "three-stage contacts");
  run_command.add_flag("--blocked", is_blocked, "grains cannot turn");
  dem::PackingRule packing;
  CLI::App &creep_command = *app.add_subcommand("creep", "creep in an oedometer; prints time [s], axial strain [%]");
  creep_command.add_option("--grains", packing.n_grains);
  creep_command.add_option("--seed", packing.seed);
  creep_command.add_flag("--single", protocol.is_single, "single precision");
  CLI11_PARSE(app, argc, argv);
  protocol.is_rotation_free = !is_blocked;
  try
    {
      if (creep_command)
        return creep(packing, protocol.is_single ? dem::Precision::single : dem::Precision::full);
      return make ? make_packing(to, n_grains) : crush_command ? crush(from, to, crushing) : run(from, protocol);
    }
  catch (const std::exception &error)
    {
      std::cerr << "engine_benchmark: " << error.what() << '\n';
      return 2;
    }
}

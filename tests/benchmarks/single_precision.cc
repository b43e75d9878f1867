// What single precision does to the grain cycle: stress, equilibrium, creep and energy with several representations of
// places beside double. Prints CSV: test,places,pressure_MPa,cycles,quantity,value.

#include "tests/benchmarks/engine_protocol.h"
#include "tests/benchmarks/grain_creep.h"

#include "dem/homogenisation.h"
#include "dem/packing_file.h"

#include <CLI/CLI.hpp>

#include <cstdio>
#include <iostream>
#include <map>
#include <numeric>

namespace
{
  using benchmarks::GrainLoop;

  constexpr double skin_share = 0.1;                         // of the mean radius: no run here moves grains that far
  constexpr double pressures[] = {0.1e6, 1e6, 10e6, 21.7e6}; // [Pa], compression-positive

  void print(const char *test, const std::string &places, const double pressure, const std::size_t cycles,
             const char *quantity, const double value)
  {
    std::printf("%s,%s,%g,%zu,%s,%.4g\n", test, places.c_str(), 1e-6 * pressure, cycles, quantity, value);
  }

  double compute_skin(const dem::RevState &state)
  {
    double sum = 0.;
    for (const dem::Row &place : state.grains.place)
      sum += place.w;
    return skin_share * sum / static_cast<double>(state.grains.size());
  }

  double compute_pressure(const dem::Matrix &stress)
  {
    return -stress.trace() / 3.;
  }

  double compare(const dem::Matrix &stress, const dem::Matrix &reference)
  {
    return (stress - reference).norm() / reference.norm();
  }

  /** The state with each place off by up to half a count of 32 bits: what chaos alone makes of a small difference. */
  dem::RevState disturb(dem::RevState state)
  {
    for (std::size_t i = 0; i < state.grains.size(); ++i)
      {
        dem::RandomStream stream({1, 0, i, dem::Purpose::position});
        dem::Row &place = state.grains.place[i];
        for (double *const x : {&place.x, &place.y, &place.z})
          *x += (stream.draw_uniform() - 0.5) / benchmarks::n_counts;
      }
    return state;
  }

  /** Calls run(name, state, places as a type) for double and for each way of single precision. */
  template <typename Run>
  void for_each_way(const dem::RevState &state, const Run &run)
  {
    using namespace benchmarks;
    run("double", state, std::type_identity<DoublePlaces<double>>{});
    run("double-disturbed", disturb(state), std::type_identity<DoublePlaces<double>>{});
    run("fractions", state, std::type_identity<FractionPlaces<false>>{});
    run("fractions-remainder", state, std::type_identity<FractionPlaces<true>>{});
    run("referred-fractions", state, std::type_identity<ReferredPlaces<false>>{});
    run("referred-remainder", state, std::type_identity<ReferredPlaces<true>>{});
    run("double-branch", state, std::type_identity<DoublePlaces<float>>{});
  }

  // --- the loop here against dem's own ---------------------------------------------------------------------------

  /** Undamped: local damping hangs on the sign of velocities near zero, and makes 1e-8 of 1e-14 within 500 cycles. */
  void check_loop(const dem::RevState &packing, const bool is_rough)
  {
    constexpr std::size_t n_cycles = 500;
    benchmarks::Protocol protocol;
    protocol.is_rough = is_rough;
    protocol.is_rotation_free = !is_rough;
    const dem::ContactLaw law = dem::make_contact_law(benchmarks::make_material(is_rough));
    dem::RevState state = packing;
    dem::update_true_masses(state.grains, dem::MotionRule{}.density);
    dem::DynamicsRule rule = benchmarks::make_rule(state, law, protocol);
    rule.motion.has_true_masses = !is_rough;
    dem::Dynamics dynamics(state, law, rule);
    dynamics.compute_forces();
    GrainLoop<benchmarks::DoublePlaces<double>> loop(state, law, rule.motion, compute_skin(state),
                                                     dynamics.get_time_step());
    loop.compute_forces();
    dem::Matrix increment = benchmarks::compute_strain_increment(protocol, 1.2e-8);
    for (std::size_t cycle = 1; cycle <= n_cycles; ++cycle)
      {
        dynamics.move();
        dynamics.strain(increment);
        dynamics.compute_forces();
        if (is_rough)
          dynamics.refresh_masses();
        loop.advance(increment);
        loop.compute_forces();
      }
    const double error = compare(loop.compute_stress(), dynamics.compute_stress());
    print(is_rough ? "loop-rough" : "loop-hertz", "double", compute_pressure(dynamics.compute_stress()), n_cycles,
          "stress_error", error);
    if (!(error < 1e-12)) // rounding alone, grown over the cycles; half a per mille would be another law
      throw std::runtime_error("the loop of this program is not dem's");
  }

  // --- a: the benchmark's protocol -------------------------------------------------------------------------------

  void compare_protocol(const dem::RevState &packing, const std::size_t n_cycles)
  {
    const benchmarks::Protocol protocol;
    const dem::ContactLaw law = dem::make_contact_law(benchmarks::make_material(false));
    dem::RevState state = packing;
    dem::update_true_masses(state.grains, dem::MotionRule{}.density);
    const dem::DynamicsRule rule = benchmarks::make_rule(state, law, protocol);
    const dem::Matrix increment = benchmarks::compute_strain_increment(protocol, protocol.time_step);
    std::map<std::size_t, dem::Matrix> reference;
    for_each_way(state, [&](const std::string &name, const dem::RevState &start, auto way) {
      GrainLoop<typename decltype(way)::type> loop(start, law, rule.motion, compute_skin(start), protocol.time_step);
      loop.compute_forces();
      for (std::size_t cycle = 1; cycle <= n_cycles; ++cycle)
        {
          loop.advance(increment);
          loop.compute_forces();
          if (cycle != 1000 && cycle != n_cycles)
            continue;
          const dem::Matrix stress = loop.compute_stress();
          reference.try_emplace(cycle, stress);
          if (name == "double")
            print("protocol", name, 9.6e6, cycle, "pressure_Pa", compute_pressure(stress));
          else
            print("protocol", name, 9.6e6, cycle, "stress_error", compare(stress, reference[cycle]));
        }
    });
  }

  // --- b: equilibrium and what ageing makes of it ----------------------------------------------------------------

  dem::RevState bring_to_pressure(dem::RevState state, const dem::ContactLaw &law, const double pressure)
  {
    dem::CellControl control;
    control.target_stress = -pressure * dem::Matrix::Identity();
    control.is_stress_controlled = {true, true, true, false, false, false};
    const dem::RestReport report = dem::bring_to_rest(state, {law, {}, {}}, control);
    if (report.status != dem::RestStatus::at_rest)
      throw std::runtime_error(std::string("packing: ") + dem::describe(report.status));
    return state;
  }

  struct Rest
  {
    dem::Matrix stress;
    std::map<std::pair<std::uint32_t, std::uint32_t>, double> normal_force;
    std::vector<double> crack_velocity;
    std::vector<dem::TimeToFracture> times; ///< sorted
    double time_to_batch;
  };

  template <typename Loop>
  Rest measure(const Loop &loop, dem::RevState state)
  {
    Rest rest;
    const std::vector<dem::Contact> contacts = loop.list_contacts();
    for (const dem::Contact &contact : contacts)
      rest.normal_force[{contact.a, contact.b}] = contact.normal_force;
    const dem::FractureRule rule;
    dem::draw_strengths(state.grains, rule, {});
    dem::update_crack_velocities(state.grains, contacts, rule);
    rest.stress = loop.compute_stress();
    rest.crack_velocity.assign(state.grains.crack_velocity.begin(), state.grains.crack_velocity.end());
    rest.times = dem::sort_times_to_fracture(state.grains);
    rest.time_to_batch = dem::compute_time_to_batch(state.grains, dem::compute_batch_limit(rule, state.grains.size()));
    return rest;
  }

  void print_differences(const std::string &name, const double pressure, const std::size_t cycles, const Rest &rest,
                         const Rest &reference)
  {
    double square = 0., sum = 0.;
    for (const auto &[pair, force] : reference.normal_force)
      {
        const auto found = rest.normal_force.find(pair);
        square += std::pow((found == rest.normal_force.end() ? 0. : found->second) - force, 2);
        sum += force;
      }
    const double n = static_cast<double>(reference.normal_force.size());
    // In the order in which the grains would break: the last ones hardly touch, and change a hundredfold with nothing.
    std::vector<double> velocity;
    for (const dem::TimeToFracture &next : reference.times)
      velocity.push_back(std::abs(rest.crack_velocity[next.place] / reference.crack_velocity[next.place] - 1.));
    if (velocity.empty())
      throw std::runtime_error("packing: no grain is large enough to break");
    const double first_tenth = *std::max_element(velocity.begin(), velocity.begin() + velocity.size() / 10);
    std::sort(velocity.begin(), velocity.end());
    print("rest", name, pressure, cycles, "stress_error", compare(rest.stress, reference.stress));
    print("rest", name, pressure, cycles, "normal_force_error", std::sqrt(square / n) / (sum / n));
    print("rest", name, pressure, cycles, "crack_velocity_error_median", velocity[velocity.size() / 2]);
    print("rest", name, pressure, cycles, "crack_velocity_error_first_tenth", first_tenth);
    print("rest", name, pressure, cycles, "crack_velocity_error_largest", velocity.back());
    print("rest", name, pressure, cycles, "time_to_batch_error", rest.time_to_batch / reference.time_to_batch - 1.);
  }

  /** Strains a REV that rests at a pressure until its stress has risen by about a tenth, and leaves it alone. */
  void compare_rest(const dem::RevState &state, const dem::ContactLaw &law, const double pressure,
                    const std::size_t n_cycles)
  {
    constexpr std::size_t n_straining = 100;
    dem::RevState copy = state;
    dem::Dynamics dynamics(copy, law, {});
    dynamics.compute_forces();
    dem::Matrix increment = dem::Matrix::Zero();
    increment(2, 2) = -0.1 * pressure / dynamics.compute_stiffness() / n_straining;
    Rest reference;
    for_each_way(state, [&](const std::string &name, const dem::RevState &start, auto way) {
      GrainLoop<typename decltype(way)::type> loop(start, law, dem::MotionRule{}, compute_skin(start), 1.);
      std::size_t n_to_rest = 0;
      double floor = 0.; // median of what the last hundred cycles show
      std::vector<double> last;
      for (std::size_t cycle = 0; cycle <= n_cycles; ++cycle)
        {
          loop.compute_forces();
          const double ratio = loop.compute_unbalanced_ratio();
          if (n_to_rest == 0 && cycle >= n_straining && ratio < dem::EquilibriumRule{}.unbalanced_ratio)
            n_to_rest = cycle;
          if (cycle + 100 >= n_cycles)
            last.push_back(ratio);
          if (cycle < n_cycles)
            loop.advance(cycle < n_straining ? increment : dem::Matrix(dem::Matrix::Zero()));
        }
      std::sort(last.begin(), last.end());
      floor = last[last.size() / 2];
      print("rest", name, pressure, n_cycles, "unbalanced_ratio", floor);
      print("rest", name, pressure, n_cycles, "cycles_to_1e-4", n_to_rest > 0 ? static_cast<double>(n_to_rest) : NAN);
      const Rest rest = measure(loop, loop.store());
      if (name == "double")
        reference = rest;
      else
        print_differences(name, pressure, n_cycles, rest, reference);
    });
  }

  // --- c: energy -------------------------------------------------------------------------------------------------

  void compare_energy(const dem::RevState &state, const std::size_t n_cycles)
  {
    dem::ContactLaw law = dem::make_contact_law(benchmarks::make_material(false));
    law.friction = 0.; // all that is left is conservative
    dem::MotionRule rule;
    rule.has_true_masses = true;
    rule.local_damping = 0.;
    std::map<std::size_t, double> reference;
    for_each_way(state, [&](const std::string &name, const dem::RevState &start, auto way) {
      GrainLoop<typename decltype(way)::type> loop(start, law, rule, compute_skin(start), 1.2e-8);
      loop.compute_forces();
      const double first = loop.compute_energy();
      for (std::size_t cycle = 1; cycle <= n_cycles; ++cycle)
        {
          loop.advance(dem::Matrix::Zero());
          loop.compute_forces();
          if (cycle == n_cycles / 10 || cycle == n_cycles)
            print("energy", name, 9.6e6, cycle, "drift", loop.compute_energy() / first - 1.);
        }
    });
  }

  // --- the creep curve -------------------------------------------------------------------------------------------

  void compare_creep(const dem::RevState &state, const dem::ContactLaw &law, const double duration)
  {
    const benchmarks::CreepRule rule{law, pressures[3], compute_skin(state), duration, {}};
    const auto report = [&](const std::string &name, const std::map<double, double> &strain) {
      print("creep", name, rule.pressure, 0, "batches", static_cast<double>(strain.size() - 1));
      for (double time = 1e-2 * duration; time <= duration; time *= 10.)
        print("creep", name, rule.pressure, 0, ("strain_at_" + std::to_string(std::lround(time)) + "_s").c_str(),
              std::prev(strain.upper_bound(time))->second);
    };
    for_each_way(state, [&](const std::string &name, const dem::RevState &start, auto way) {
      report(name, benchmarks::creep<typename decltype(way)::type>(start, rule, {}));
    });
    for (const std::uint64_t seed : {2, 3, 4})
      report("double-seed-" + std::to_string(seed),
             benchmarks::creep<benchmarks::DoublePlaces<double>>(state, rule, {seed, 0}));
  }

  // --- d: the arithmetic -----------------------------------------------------------------------------------------

  void print_quanta(const dem::RevState &state, const dem::ContactLaw &law, const double pressure)
  {
    std::vector<double> overlaps, branches;
    for (const dem::Contact &contact : dem::list_contacts(state, law))
      {
        overlaps.push_back(contact.overlap);
        branches.push_back(contact.branch.norm());
      }
    std::sort(overlaps.begin(), overlaps.end());
    std::sort(branches.begin(), branches.end());
    const double overlap = overlaps[overlaps.size() / 2], branch = branches[branches.size() / 2];
    const double edge = state.cell.edges.diagonal().maxCoeff();
    print("quanta", "-", pressure, 0, "median_overlap_m", overlap);
    print("quanta", "fractions", pressure, 0, "count_over_overlap", edge / benchmarks::n_counts / overlap);
    print("quanta", "fractions", pressure, 0, "rounding_of_branch_over_overlap", std::exp2(-24) * branch / overlap);
    print("quanta", "referred-fractions", pressure, 0, "rounding_of_overlap_over_overlap", std::exp2(-24));
  }

  void run(const std::string &file, const std::size_t n_protocol, const std::size_t n_rest, const std::size_t n_energy,
           const double creep_duration)
  {
    const dem::RevState packing = dem::read_packing(file);
    if (!dem::is_wide_enough(packing.cell, dem::compute_reach(packing.grains, compute_skin(packing))))
      throw std::runtime_error(file + ": the cell is narrower than two largest diameters plus skin");
    std::puts("test,places,pressure_MPa,cycles,quantity,value");
    check_loop(packing, false);
    compare_protocol(packing, n_protocol);
    compare_energy(packing, n_energy);
    const dem::ContactLaw law = dem::make_contact_law(benchmarks::make_material(true));
    dem::RevState state = bring_to_pressure(packing, law, 10e6);
    check_loop(state, true);
    for (const double pressure : pressures)
      {
        state = bring_to_pressure(state, law, pressure);
        print_quanta(state, law, pressure);
        compare_rest(state, law, pressure, n_rest);
      }
    if (creep_duration > 0.)
      compare_creep(state, law, creep_duration);
  }
} // namespace

int main(int argc, char **argv)
{
  CLI::App app("What single precision does to stress, equilibrium, creep and energy", "single_precision");
  std::string file;
  std::size_t n_protocol = 10000, n_rest = 3000, n_energy = 10000;
  double creep_duration = 1e6;
  app.add_option("PACKING", file, "a text file, smooth grains at 9.6 MPa")->required()->check(CLI::ExistingFile);
  app.add_option("--protocol-cycles", n_protocol);
  app.add_option("--rest-cycles", n_rest);
  app.add_option("--energy-cycles", n_energy);
  app.add_option("--creep-duration", creep_duration, "[s]; 0: no creep");
  CLI11_PARSE(app, argc, argv);
  try
    {
      run(file, n_protocol, n_rest, n_energy, creep_duration);
      return 0;
    }
  catch (const std::exception &error)
    {
      std::cerr << "single_precision: " << error.what() << '\n';
      return 2;
    }
}

#include "apps/load_test.h"

#include "apps/name_list.h"
#include "apps/point_tables.h"

#include "fem/checkpoint.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <stdexcept>

namespace apps
{
  namespace
  {
    constexpr double same = 1e-9; // ages and times of the clock that differ by less are one
    constexpr double clear_drop =
        0.05; // of a force from its largest, by which a test that ended early has had its peak: forces waver

    const std::string finished = "finished"; // outcome of a test whose head has gone all of its way

    const std::vector<std::string> capacity_columns = {
        "age_s",   "seed",    "shaft_capacity_N",       "base_capacity_N", "head_displacement_m",
        "outcome", "is_peak", "shaft_growth_per_decade"};

    fem::Target get_head(const LoadTestParameters &tests, const double value)
    {
      return {tests.head, fem::ConditionKind::displacement, "z", value};
    }

    /** The head is held, then pushed. */
    std::vector<fem::Stage> make_stages(const LoadTestParameters &tests)
    {
      fem::Stage hold, push;
      hold.name = "load test, beginning";
      hold.holds = {get_head(tests, 0.)};
      push.name = "load test";
      push.n_increments = tests.n_increments;
      push.duration = tests.rate > 0. ? tests.displacement / tests.rate : 0.;
      push.targets = {get_head(tests, -tests.displacement)};
      return {hold, push};
    }

    const fem::BoundaryResponse &find(const std::vector<fem::BoundaryResponse> &boundaries, const std::string &name)
    {
      for (const fem::BoundaryResponse &boundary : boundaries)
        if (boundary.name == name)
          return boundary;
      throw std::logic_error("no boundary " + name);
    }

    /** Force that a pile passes on downwards through all of the named interfaces [N]. */
    double sum_downwards(const std::vector<fem::BoundaryResponse> &boundaries, const std::string &names)
    {
      double force = 0.;
      for (const std::string &name : split_names(names))
        force -= find(boundaries, name).force[2];
      return force;
    }
  } // namespace

  void bind_load_tests(ParameterBinder &binder, LoadTestParameters &tests)
  {
    binder.enter("Load tests");
    binder.bind_list(
        "Ages", tests.ages, 0,
        "Times of the run, within creep stages or at their beginning, at which the pile is tested beside the "
        "run; empty: no test. Units: [s].");
    binder.bind("Head", tests.head, "Boundary that is pushed down. Units: none.");
    binder.bind("Shaft", tests.shaft, "Interfaces between pile and ground, comma-separated. Units: none.");
    binder.bind("Base", tests.base, "Interfaces between pile and ground, comma-separated. Units: none.");
    binder.bind("Displacement", tests.displacement, positive,
                "Of the head, usually 0.1 diameters: capacities are peaks up to there. Units: [m].");
    binder.bind("Rate", tests.rate, non_negative, "Of the head; 0: no time passes. Units: [m/s].");
    binder.bind("Increments", tests.n_increments, at_least_one, "Of the displacement. Units: [-].");
    binder.bind("Tolerance", tests.tolerance, {0., 1., false, true},
                "Of equilibrium within a test, as Newton/Tolerance; 0: that one. Units: [-].");
    binder.bind("Most evaluations", tests.max_evaluations, {0., 1e6},
                "In one equilibrium of a test, as Newton/Most evaluations; 0: that one. Units: [-].");
    binder.leave();
  }

  void complete_load_tests(const ParameterBinder &binder, LoadTestParameters &tests,
                           std::vector<fem::BoundaryCondition> &conditions, std::vector<fem::Stage> &stages)
  {
    tests.condition = conditions.size();
    if (tests.ages.empty())
      return;
    std::sort(tests.ages.begin(), tests.ages.end());
    fem::BoundaryCondition head{tests.head, fem::ConditionKind::displacement, "z"};
    head.is_held = false;
    conditions.push_back(head);
    for (const double age : tests.ages)
      {
        double start = 0.;
        bool is_reached = false;
        for (fem::Stage &stage : stages)
          {
            const bool is_inside = stage.kind == fem::StageKind::creep && age >= start * (1. - same) &&
                                   age <= (start + stage.duration) * (1. + same);
            if (is_inside && age > start * (1. + same))
              stage.more_outputs.push_back(age - start);
            is_reached |= is_inside;
            start += stage.duration;
          }
        if (!is_reached)
          binder.reject("Load tests/Ages", fmt::format("holds {:g} s, which is no time of a creep stage", age));
      }
  }

  Capacity compute_capacity(const std::vector<LoadTestPoint> &curve, const double way)
  {
    Capacity capacity;
    if (curve.empty())
      capacity.shaft = capacity.base = capacity.head_displacement = std::numeric_limits<double>::quiet_NaN();
    for (const LoadTestPoint &point : curve)
      {
        if (point.shaft_force > capacity.shaft)
          {
            capacity.shaft = point.shaft_force;
            capacity.head_displacement = point.head_displacement;
          }
        capacity.base = std::max(capacity.base, point.base_force);
      }
    capacity.is_whole = !curve.empty() && curve.back().head_displacement > way * (1. - same);
    const double drop = capacity.is_whole ? 0. : clear_drop;
    capacity.is_peak = !curve.empty() && curve.back().shaft_force < (1. - drop) * capacity.shaft;
    return capacity;
  }

  double compute_growth_per_decade(const AgedCapacity &early, const AgedCapacity &late)
  {
    if (!(early.age > 0. && late.age > early.age))
      return std::numeric_limits<double>::quiet_NaN();
    return (late.shaft / early.shaft - 1.) / std::log10(late.age / early.age);
  }

  template <int dim>
  LoadTests<dim>::LoadTests(const LoadTestParameters &parameters, const Run &run,
                            const fem::SteppingParameters &stepping)
      : parameters_(parameters), run_(run), stepping_(stepping)
  {
    const std::string file = run_.folder + "/capacity.csv";
    std::vector<double> ages;
    if (run_.is_first_rank && run_.is_resumed && std::filesystem::exists(file))
      file_ = std::make_unique<HistoryFile>(file, capacity_columns, [&](const std::vector<std::string> &row) {
        const double age = std::strtod(row[0].c_str(), nullptr);
        const bool is_history = age <= run_.time * (1. + same);
        if (is_history)
          {
            ages.push_back(age);
            const bool is_known = row[5] == finished || row[6] == "1"; // columns "outcome", "is_peak"
            capacities_.push_back(
                {age, is_known ? std::strtod(row[2].c_str(), nullptr) : std::numeric_limits<double>::quiet_NaN()});
          }
        return is_history;
      });
    else if (run_.is_first_rank)
      file_ = std::make_unique<HistoryFile>(file, capacity_columns);
    if (run_.is_first_rank)
      std::filesystem::create_directories(run_.folder + "/load_tests");
    for (const double age : dealii::Utilities::MPI::broadcast(MPI_COMM_WORLD, ages, 0))
      for (const double wanted : parameters_.ages) // a row has ten digits of the age
        if (std::abs(age - wanted) <= same * wanted)
          done_.insert(wanted);
  }

  template <int dim>
  void LoadTests<dim>::run_due(fem::QuasiStaticProblem<dim> &problem, const std::vector<fem::Stage> &stages,
                               const fem::Progress &progress)
  {
    if (progress.stage < stages.size() && stages[progress.stage].kind != fem::StageKind::creep)
      return;
    for (const double age : parameters_.ages)
      {
        if (age > progress.time * (1. + same) || done_.contains(age))
          continue;
        const std::string branch = run_.folder + "/load_tests/branch.h5";
        const fem::Phase phase = problem.get_phase();
        fem::write_checkpoint(branch, problem, progress);
        std::string outcome;
        const fem::NewtonParameters usual = problem.get_newton_parameters();
        problem.set_newton_effort(parameters_.tolerance > 0. ? parameters_.tolerance : usual.tolerance,
                                  parameters_.max_evaluations > 0 ? parameters_.max_evaluations
                                                                  : usual.max_evaluations);
        const auto curve = push(problem, age, progress.time, outcome);
        problem.set_newton_effort(usual.tolerance, usual.max_evaluations);
        fem::read_checkpoint(branch, problem);
        problem.set_phase(phase);
        write(age, curve, outcome);
        done_.insert(age);
      }
  }

  template <int dim>
  std::unique_ptr<HistoryFile> LoadTests<dim>::open_shaft_table(const fem::QuasiStaticProblem<dim> &problem,
                                                                const double age) const
  {
    if (!run_.is_first_rank)
      return nullptr;
    std::vector<std::string> columns = name_shaft_columns(problem.get_material());
    columns.insert(columns.begin(), "head_displacement_m");
    return std::make_unique<HistoryFile>(fmt::format("{}/load_tests/{:g}_s_shaft.csv", run_.folder, age), columns);
  }

  template <int dim>
  std::vector<LoadTestPoint> LoadTests<dim>::push(fem::QuasiStaticProblem<dim> &problem, const double age,
                                                  const double time, std::string &outcome) const
  {
    const auto shaft_table = open_shaft_table(problem, age);
    std::vector<LoadTestPoint> curve;
    double start = 0.; // of the head [m]
    fem::StepObserver observer;
    observer.on_commit = [&](const fem::StepReport &report) {
      const fem::BoundaryResponse &head = find(report.boundaries, parameters_.head);
      if (curve.empty())
        start = head.displacement[2];
      curve.push_back({start - head.displacement[2], -head.force[2],
                       sum_downwards(report.boundaries, parameters_.shaft),
                       sum_downwards(report.boundaries, parameters_.base)});
      for (const auto &values : compute_shaft_rows(problem, parameters_.shaft, run_.surface_level))
        if (shaft_table)
          {
            HistoryRow row;
            row.add(curve.back().head_displacement).add(static_cast<std::uint64_t>(values[0]));
            for (std::size_t i = 1; i < values.size(); ++i)
              row.add(values[i]);
            shaft_table->write(row);
          }
    };
    fem::LoadStepping<dim> stepping(problem, make_stages(parameters_), stepping_, observer);
    fem::Progress progress;
    progress.time = progress.stage_start = time;
    progress.stage_values = problem.get_values();
    stepping.set_progress(progress);
    const fem::RunResult result = stepping.run();
    outcome = result.status == fem::StepStatus::ok ? finished : fem::get_reason(result.status);
    std::replace(outcome.begin(), outcome.end(), ',', ';');
    return curve;
  }

  template <int dim>
  void LoadTests<dim>::write(const double age, const std::vector<LoadTestPoint> &curve, const std::string &outcome)
  {
    if (!run_.is_first_rank)
      return;
    std::filesystem::remove(run_.folder + "/load_tests/branch.h5");
    HistoryFile table(fmt::format("{}/load_tests/{:g}_s.csv", run_.folder, age),
                      {"head_displacement_m", "head_force_N", "shaft_force_N", "base_force_N"});
    for (const LoadTestPoint &point : curve)
      table.write(
          HistoryRow().add(point.head_displacement).add(point.head_force).add(point.shaft_force).add(point.base_force));
    const Capacity capacity = compute_capacity(curve, parameters_.displacement);
    HistoryRow row;
    const bool is_known = capacity.is_whole || capacity.is_peak;
    const AgedCapacity aged = {age, is_known ? capacity.shaft : std::numeric_limits<double>::quiet_NaN()};
    row.add(age).add(run_.seed).add(capacity.shaft).add(capacity.base).add(capacity.head_displacement).add(outcome);
    row.add(capacity.is_peak ? 1 : 0);
    row.add(capacities_.empty() ? std::numeric_limits<double>::quiet_NaN()
                                : compute_growth_per_decade(capacities_.back(), aged));
    file_->write(row);
    capacities_.push_back(aged);
  }

  template class LoadTests<2>;
  template class LoadTests<3>;
} // namespace apps

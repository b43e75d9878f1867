#include "apps/bvp_run.h"

#include "apps/pool_report.h"

#include "dem/stopwatch.h"

#include "fem/composite_material.h"

#include <fmt/format.h>

#include <cmath>
#include <iostream>

namespace apps
{
  namespace
  {
    bool is_first_rank()
    {
      return dealii::Utilities::MPI::this_mpi_process(MPI_COMM_WORLD) == 0;
    }
  } // namespace

  template <int dim>
  BvpRun<dim>::BvpRun(const BvpCase &bvp, const CommandLine &line)
      : bvp_(bvp), line_(line), folder_(line), checkpoints_(folder_), is_first_rank_(is_first_rank()),
        progress_(is_first_rank_ && !line.is_quiet)
  {
    folder_.check();
    MPI_Barrier(MPI_COMM_WORLD); // nobody writes before all have looked
    if (!line.is_resumed)
      prepare_folder();
    progress_.say(line.is_resumed ? "reading the checkpoint" : "preparing the Gauss points");
    make_problem();
    fem::StepObserver observer;
    observer.on_commit = [this](const fem::StepReport &report) { record(report); };
    observer.on_cut = [this](const fem::CutReport &report) { record_cut(report); };
    stepping_ = std::make_unique<fem::LoadStepping<dim>>(*problem_, bvp.stages, bvp.stepping, observer);
    if (line.is_resumed)
      resume();
    open_history();
    if (line.is_resumed)
      prepare_folder();
    open_load_tests();
    if (bvp.output.writes_points)
      tables_ = std::make_unique<PointTables<dim>>(
          typename PointTables<dim>::Run{folder_.get_path(), bvp.load_tests.shaft, bvp.ground.geostatic.surface_level,
                                         is_first_rank_, line.is_resumed, stepping_->get_progress().step},
          *problem_);
    if (bvp.output.writes_fields)
      fields_ = std::make_unique<fem::FieldOutput>(
          folder_.get_path(), "fields", line.is_resumed ? std::optional(stepping_->get_progress().step) : std::nullopt);
    if (rev_material_ && bvp.pool.writes_costs)
      costs_ = std::make_unique<CostFile>(folder_.get_file("costs.csv"), is_first_rank_,
                                          line.is_resumed ? static_cast<int>(stepping_->get_progress().step) : -1);
  }

  template <int dim>
  void BvpRun<dim>::prepare_folder() const
  {
    if (is_first_rank_)
      folder_.prepare(bvp_.parameters);
    MPI_Barrier(MPI_COMM_WORLD);
  }

  template <int dim>
  void BvpRun<dim>::make_problem()
  {
    MPI_Comm macro = bvp_.is_distributed ? MPI_COMM_WORLD : MPI_COMM_SELF;
    problem_ = as_bad_input([&]() {
      auto mesh = fem::create_mesh<dim>(bvp_.mesh, bvp_.problem.geometry, macro);
      make_material(mesh.region_ids);
      fem::ProblemParameters parameters = bvp_.problem;
      const auto pile = assign_regions(bvp_.ground, bvp_.pile, bvp_.interface, mesh.region_ids).pile;
      parameters.pile_regions = {pile.begin(), pile.end()};
      return std::make_unique<fem::QuasiStaticProblem<dim>>(
          std::move(mesh), bvp_.conditions, parameters, *material_,
          [this](const dealii::Point<3> &place) { return compute_initial_stress(bvp_, place); });
    });
  }

  template <int dim>
  void BvpRun<dim>::make_material(const Regions &region_ids)
  {
    const RegionMaterials regions = assign_regions(bvp_.ground, bvp_.pile, bvp_.interface, region_ids);
    if (!regions.has_several())
      {
        material_ = make_part(bvp_.material, "/material");
        return;
      }
    MPI_Comm macro = bvp_.is_distributed ? MPI_COMM_WORLD : MPI_COMM_SELF;
    auto composite = std::make_unique<fem::CompositeMaterial>(macro);
    auto pile = std::make_unique<fem::ElasticMaterial>(bvp_.pile.elastic, macro);
    pile->set_archive_group("/material/pile");
    composite->add(std::move(pile), regions.pile);
    if (!regions.frictional.empty())
      composite->add(std::make_unique<fem::FrictionalLayer>(bvp_.interface.layer, macro), regions.frictional);
    if (!regions.elastic.empty())
      composite->add(make_part(MaterialKind::elastic, "/material/elastic"), regions.elastic);
    if (!regions.viscoelastic.empty())
      composite->add(make_part(MaterialKind::viscoelastic, "/material/viscoelastic"), regions.viscoelastic);
    if (!regions.rest.empty())
      composite->add(make_part(bvp_.material, "/material"), regions.rest);
    material_ = std::move(composite);
  }

  template <int dim>
  std::unique_ptr<fem::ConstitutiveModel> BvpRun<dim>::make_part(const MaterialKind kind,
                                                                 const std::string &archive_group)
  {
    MPI_Comm macro = bvp_.is_distributed ? MPI_COMM_WORLD : MPI_COMM_SELF;
    std::unique_ptr<fem::CorotationalMaterial> closed_form;
    if (kind == MaterialKind::elastic)
      closed_form = std::make_unique<fem::ElasticMaterial>(bvp_.elastic, macro);
    else if (kind == MaterialKind::viscoelastic)
      closed_form = std::make_unique<fem::ViscoelasticMaterial>(bvp_.burgers, macro);
    if (closed_form)
      {
        closed_form->set_archive_group(archive_group);
        return closed_form;
      }
    coupling::RevMaterialParameters parameters = bvp_.rev_material;
    parameters.failure_folder = folder_.get_file("failures");
    parameters.is_resumed = line_.is_resumed;
    parameters.tell = [this](const std::string &what) { progress_.show(what, 0.); };
    auto material = std::make_unique<coupling::RevMaterial>(
        parameters, coupling::RevPool(MPI_COMM_WORLD, !bvp_.is_distributed, line_.n_threads, bvp_.pool.balance));
    rev_material_ = material.get();
    return material;
  }

  template <int dim>
  void BvpRun<dim>::open_load_tests()
  {
    if (!bvp_.load_tests.ages.empty())
      load_tests_ = std::make_unique<LoadTests<dim>>(
          bvp_.load_tests,
          typename LoadTests<dim>::Run{folder_.get_path(), bvp_.rev.seed, is_first_rank_, line_.is_resumed,
                                       stepping_->get_progress().time, bvp_.ground.geostatic.surface_level},
          bvp_.stepping);
  }

  template <int dim>
  void BvpRun<dim>::resume()
  {
    const fem::Progress progress = checkpoints_.read(*problem_);
    const std::string &file = checkpoints_.get_file();
    if (progress.stage_values.size() != bvp_.conditions.size())
      throw BadInput(fmt::format("{}: written with {} boundary conditions, the parameters name {}", file,
                                 progress.stage_values.size(), bvp_.conditions.size()));
    try
      {
        stepping_->set_progress(fem::prolong_creep(bvp_.stages, progress));
      }
    catch (const std::invalid_argument &error)
      {
        throw BadInput(fmt::format("{}: {}", file, std::string(error.what())));
      }
    MPI_Barrier(MPI_COMM_WORLD); // nobody writes before all have read
  }

  template <int dim>
  void BvpRun<dim>::open_history()
  {
    const auto probes = compute_probe_states(*problem_, bvp_.output);
    const auto columns = name_bvp_columns(problem_->compute_boundary_responses(), probes);
    if (!is_first_rank_)
      return;
    const std::string file = folder_.get_file("history.csv");
    const unsigned int last_step = stepping_->get_progress().step;
    if (line_.is_resumed)
      history_ = std::make_unique<HistoryFile>(file, columns, [&](const std::vector<std::string> &row) {
        return std::strtoul(row[2].c_str(), nullptr, 10) <= last_step; // the column "step"
      });
    else
      history_ = std::make_unique<HistoryFile>(file, columns);
  }

  template <int dim>
  int BvpRun<dim>::run()
  {
    if (load_tests_)
      load_tests_->run_due(*problem_, bvp_.stages, stepping_->get_progress());
    if (!line_.is_resumed)
      {
        unbalanced_share_ = problem_->compute_unbalanced_share();
        write_initial_row();
        write_stage_snapshots(0);
        checkpoints_.write(*problem_, stepping_->get_progress());
      }
    write_summary("running");
    if (rev_material_)
      step_work_ = StepWork([this]() { return rev_material_->compute_local_profile(); });
    step_work_.resume();
    const fem::RunResult result = stepping_->run();
    step_work_.pause();
    write_snapshots("end");
    const bool is_finished = result.status == fem::StepStatus::ok;
    write_summary(is_finished ? "finished" : result.message);
    if (rev_material_)
      progress_.say(describe_pool(rev_material_->get_pool().get_tally(), tally_.creep_work));
    if (load_tests_)
      say_capacities();
    progress_.say(checkpoints_.describe());
    if (is_finished)
      return 0;
    checkpoints_.write(*problem_, stepping_->get_progress());
    if (is_first_rank_)
      std::cerr << fmt::format("slowsand-bvp: {}, in {}; change a parameter with --set and go on with --resume {}\n",
                               result.message, checkpoints_.get_file(), folder_.get_path())
                << std::flush;
    return 1;
  }

  template <int dim>
  void BvpRun<dim>::say_capacities()
  {
    const std::vector<AgedCapacity> &tests = load_tests_->get_capacities();
    for (std::size_t i = 0; i < tests.size(); ++i)
      {
        const double growth = i > 0 ? compute_growth_per_decade(tests[i - 1], tests[i]) : std::nan("");
        progress_.say(fmt::format("shaft capacity at {:g} s: {:.4g} N{}", tests[i].age, tests[i].shaft,
                                  std::isnan(growth) ? "" : fmt::format(", {:+.3g} per tenfold age", growth)));
      }
  }

  template <int dim>
  void BvpRun<dim>::write_initial_row()
  {
    fem::StepReport report;
    report.stage = -1u; // shown as 0: before the first stage
    report.boundaries = problem_->compute_boundary_responses();
    for (fem::BoundaryResponse &boundary : report.boundaries) // unknown before the first equilibrium
      for (int axis = 0; axis < 3; ++axis)
        boundary.force[axis] = std::numeric_limits<double>::quiet_NaN();
    const auto probes = compute_probe_states(*problem_, bvp_.output);
    if (history_)
      history_->write(
          make_bvp_row(report, rev_material_ ? rev_material_->compute_totals() : coupling::RevTotals{}, probes));
    if (fields_)
      fields_->write(*problem_, 0, 0.);
    if (tables_)
      tables_->write(*problem_, 0, 0, 0.);
  }

  template <int dim>
  void BvpRun<dim>::write_step(const fem::StepReport &report, const coupling::RevTotals &totals)
  {
    const dem::Stopwatch watch(output_s_);
    const auto probes = compute_probe_states(*problem_, bvp_.output);
    if (history_)
      history_->write(make_bvp_row(report, totals, probes));
    if (fields_ && report.is_output)
      fields_->write(*problem_, report.step, report.time);
    if (tables_ && report.is_output)
      tables_->write(*problem_, report.stage + 1, report.step, report.time);
    if (report.is_stage_end)
      write_stage_snapshots(report.stage + 1);
    if (report.is_stage_end || report.step % bvp_.output.checkpoint_interval == 0)
      checkpoints_.write(*problem_, stepping_->get_progress());
  }

  template <int dim>
  void BvpRun<dim>::record(const fem::StepReport &report)
  {
    step_work_.pause();
    const coupling::RevTotals totals = rev_material_ ? rev_material_->compute_totals() : coupling::RevTotals{};
    write_step(report, totals);
    record_work(report);
    if (load_tests_)
      {
        load_tests_->run_due(*problem_, bvp_.stages, stepping_->get_progress());
        if (rev_material_)
          tally_.work_before = rev_material_->get_pool().get_tally(); // theirs is no creep's
      }
    if (bvp_.stages[report.stage].kind == fem::StageKind::creep)
      {
        ++tally_.creep_steps;
        tally_.creep_evaluations += report.evaluations;
      }
    tally_.avalanche_rounds += report.avalanche_rounds;
    tally_.avalanche_evaluations += report.avalanche_evaluations;
    tally_.largest_residual_share = std::max(tally_.largest_residual_share, report.residual / report.reaction_norm);
    if (report.unbalanced_ratio > tally_.largest_unbalanced_ratio)
      tally_.largest_unbalanced_ratio = report.unbalanced_ratio;
    progress_.show(fmt::format("{}, step {}, {:.3g} s, {} grains broken", report.stage_name, report.step, report.time,
                               totals.broken_instant + totals.broken_delayed),
                   compute_share_done(report));
    step_work_.resume();
  }

  template <int dim>
  void BvpRun<dim>::record_work(const fem::StepReport &report)
  {
    if (!rev_material_)
      return;
    const coupling::WorkTally &now = rev_material_->get_pool().get_tally();
    if (bvp_.stages[report.stage].kind == fem::StageKind::creep)
      tally_.creep_work = add(tally_.creep_work, compute_difference(now, tally_.work_before));
    tally_.work_before = now;
    if (costs_)
      costs_->write(report.step, report.stage + 1, report.time, *rev_material_);
  }

  template <int dim>
  void BvpRun<dim>::record_cut(const fem::CutReport &report)
  {
    ++tally_.cuts;
    tally_.lost_evaluations += report.evaluations;
  }

  // Stages count alike; a creep stage is done in proportion to the logarithm of its time.
  template <int dim>
  double BvpRun<dim>::compute_share_done(const fem::StepReport &report) const
  {
    const fem::Stage &stage = bvp_.stages[report.stage];
    const fem::Progress &at = stepping_->get_progress();
    const double position = report.is_stage_end ? fem::compute_stage_length(stage) : at.position;
    double share = position / fem::compute_stage_length(stage);
    if (stage.kind == fem::StageKind::creep)
      share = std::log1p(position / stage.first_output) / std::log1p(stage.duration / stage.first_output);
    return (report.stage + share) / static_cast<double>(bvp_.stages.size());
  }

  template <int dim>
  void BvpRun<dim>::write_stage_snapshots(const unsigned int stage) const
  {
    if (stage < bvp_.stages.size() && bvp_.stages[stage].kind == fem::StageKind::creep)
      write_snapshots("start");
  }

  template <int dim>
  void BvpRun<dim>::write_snapshots(const std::string &suffix) const
  {
    if (rev_material_ && bvp_.output.writes_snapshots)
      rev_material_->write_snapshots(folder_.get_file("snapshots/point"), suffix);
  }

  template <int dim>
  void BvpRun<dim>::write_summary(const std::string &status) const
  {
    if (!is_first_rank_)
      return;
    Summary summary;
    summary.status = status;
    summary.seed = bvp_.rev.seed;
    summary.n_ranks = dealii::Utilities::MPI::n_mpi_processes(MPI_COMM_WORLD);
    summary.n_threads = line_.n_threads;
    const double total = dem::measure_seconds_since(start_);
    summary.wall_s["total"] = total;
    summary.output_s = output_s_;
    if (rev_material_)
      {
        const coupling::RevTotals totals = rev_material_->compute_totals();
        const coupling::RevPool &pool = rev_material_->get_pool();
        summary.grains = totals.grains;
        summary.cycles = totals.cycles;
        summary.broken_instant = totals.broken_instant;
        summary.broken_delayed = totals.broken_delayed;
        summary.profile = rev_material_->compute_local_profile();
        summary.wall_s["inside REVs"] = pool.get_working_time();
        summary.wall_s["waiting for other ranks' REVs"] = pool.get_total_time() - pool.get_working_time();
        summary.wall_s["outside REVs"] = total - pool.get_total_time();
        add_pool_figures(pool.get_tally(), tally_.creep_work, summary);
        add_lazy_figures(totals.lazy, summary);
        summary.figures["share of wall time outside REVs [-]"] = 1. - pool.get_total_time() / total;
        summary.figures["largest unbalanced ratio at equilibrium [-]"] = tally_.largest_unbalanced_ratio;
        step_work_.add_figures(line_.n_threads, summary);
      }
    if (std::isfinite(unbalanced_share_))
      summary.figures["residual of the untouched ground over its weight [-]"] = unbalanced_share_;
    checkpoints_.add_figures(summary);
    summary.figures["creep steps"] = tally_.creep_steps;
    if (tally_.creep_steps > 0)
      summary.figures["REV evaluations a point and creep step"] =
          static_cast<double>(tally_.creep_evaluations) / tally_.creep_steps;
    summary.figures["avalanche rounds"] = tally_.avalanche_rounds;
    summary.figures["avalanche evaluations"] = tally_.avalanche_evaluations;
    summary.figures["matrices factorised after an iteration failed"] = problem_->count_rescued_tangents();
    summary.figures["steps taken back"] = tally_.cuts;
    summary.figures["evaluations lost with them"] = tally_.lost_evaluations;
    summary.figures["largest residual over reaction [-]"] = tally_.largest_residual_share;
    folder_.write_summary(summary);
  }

  template class BvpRun<2>;
  template class BvpRun<3>;
} // namespace apps

#include "apps/rev_run.h"

#include "apps/progress.h"
#include "apps/rev_checkpoint.h"
#include "apps/rev_history.h"

#include "dem/attempt_judgement.h"
#include "dem/packing_file.h"
#include "dem/rev_snapshot.h"
#include "dem/stage_path.h"
#include "dem/stopwatch.h"
#include "dem/wall_contacts.h"

#include <fmt/format.h>

#include <iostream>
#include <memory>

namespace apps
{
  namespace
  {
    /** The packing asked for, at the pressure asked for. */
    dem::RevState make_packing(const RevCase &rev_case, Progress &progress, Summary &summary)
    {
      const RevParameters &parameters = rev_case.rev;
      if (!parameters.packing_file.empty())
        return as_bad_input([&] { return dem::read_packing(parameters.packing_file, parameters.packing.cell_kind); });
      progress.say(fmt::format("packing of {} grains: looking for the friction that gives e = {}",
                               parameters.packing.n_grains, parameters.packing.void_ratio));
      const dem::Packing packing =
          dem::generate_packing(parameters.packing, parameters.model.material, parameters.model.dynamics);
      const dem::PackingReport &report = packing.report;
      progress.say(fmt::format("packing: e = {:.4f} at {:.4g} Pa with friction {:.4f}, {} tried, {} cycles",
                               report.void_ratio, parameters.packing.pressure, report.friction, report.n_tried,
                               report.n_cycles));
      summary.figures["packing void ratio [-]"] = report.void_ratio;
      summary.figures["packing friction [-]"] = report.friction;
      if (report.status != dem::RestStatus::at_rest)
        throw std::runtime_error(fmt::format("the packing found no equilibrium: {}", dem::describe(report.status)));
      if (!report.is_found && parameters.packing.friction < 0.)
        throw std::runtime_error(
            fmt::format("no friction gives a void ratio of {} within {}: the nearest found is {:.4f}; try more grains, "
                        "another Seed, or a wider Packing/Void ratio tolerance",
                        parameters.packing.void_ratio, parameters.packing.tolerance, report.void_ratio));
      return packing.state;
    }

    /**
     * Goes back into the creep or relaxation that has just ended if the programme now gives it more time. Throws
     * BadInput if it gives that to a load: its rate is history.
     */
    void prolong_held_stage(const std::vector<dem::LaboratoryStage> &stages, const std::string &file,
                            dem::LaboratoryPosition &position)
    {
      const bool is_between_stages = position.stage > 0 && position.stage <= stages.size() && position.share_step == 0.;
      if (!is_between_stages || !(stages[position.stage - 1].duration > position.time_in_stage))
        return;
      const dem::LaboratoryStage &last = stages[position.stage - 1];
      if (!dem::is_held(last))
        throw BadInput(fmt::format("{}: stage '{}' has ended: only a creep or a relaxation that has just ended can be "
                                   "given more time; add a stage instead",
                                   file, last.name));
      --position.stage;
      position.share_step = 1.; // the stage has begun
    }

    /** One run: what its observers write to. */
    class Run
    {
    public:
      Run(const RevCase &rev_case, const CommandLine &line)
          : case_(rev_case), folder_(line), progress_(!line.is_quiet), last_checkpoint_(dem::Clock::now())
      {
        folder_.check();
        summary_.seed = rev_case.rev.seed;
        summary_.n_threads = line.n_threads;
        line.is_resumed ? resume() : start();
      }

      int run()
      {
        const dem::Clock::time_point begin = dem::Clock::now();
        dem::LaboratoryObserver observer;
        observer.observe = [this](const dem::Observation &observation) { record(observation); };
        observer.disturbed = [this](const dem::DynamicRecord &dynamic) { record(dynamic); };
        observer.attempted = [this](const dem::AttemptEffort &effort) { count(effort); };
        observer.committed = [this](const dem::LaboratoryPosition &, const double fraction) {
          return advance(fraction);
        };
        observer.stage_edge = [this](const std::size_t stage, const bool is_end) { cross_edge(stage, is_end); };
        const dem::LaboratoryOutcome outcome =
            dem::run_programme(*rev_, case_.stages, case_.laboratory, observer, position_);
        summary_.wall_s["programme"] = dem::measure_seconds_since(begin);
        return finish(outcome);
      }

    private:
      void start()
      {
        const dem::Clock::time_point begin = dem::Clock::now();
        const dem::RevState packing = make_packing(case_, progress_, summary_);
        summary_.wall_s["packing"] = dem::measure_seconds_since(begin);
        rev_ = std::make_unique<dem::Rev>(dem::make_rev(case_.rev.model, packing));
        folder_.prepare(case_.parameters);
        initial_diameters_ = dem::list_diameters(rev_->get_committed().grains);
        history_ = std::make_unique<RevHistory>(folder_.get_path(), case_.rev.packing.cell_kind);
        write_breakage(0);
        committed_rows_ = history_->count_rows();
        write_snapshot("initial");
      }

      void resume()
      {
        const std::string file = folder_.get_file("checkpoint.h5");
        const RevCheckpoint checkpoint = as_bad_input([&] { return read_rev_checkpoint(file); });
        if (checkpoint.state.cell.kind != case_.rev.packing.cell_kind)
          throw BadInput(fmt::format("{}: Boundary/Kind is not that of the run: a REV keeps its boundary", file));
        position_ = checkpoint.position;
        prolong_held_stage(case_.stages, file, position_);
        committed_rows_ = checkpoint.n_rows;
        initial_diameters_ = checkpoint.initial_diameters;
        rev_ = std::make_unique<dem::Rev>(case_.rev.model, checkpoint.state);
        history_ = std::make_unique<RevHistory>(folder_.get_path(), checkpoint.state.cell.kind, checkpoint.n_rows);
        folder_.prepare(case_.parameters); // not before the folder has turned out to be one of these parameters
        progress_.say(fmt::format("resumed at {:.4g} s in stage {}", checkpoint.state.time, position_.stage + 1));
      }

      template <typename Row>
      void record(const Row &row)
      {
        const dem::Stopwatch watch(summary_.output_s);
        history_->write(row);
      }

      /** What is taken back is in no table: where a load's cycles go shows here. */
      void count(const dem::AttemptEffort &effort)
      {
        const std::string kept = effort.is_committed ? "" : " taken back";
        summary_.figures[fmt::format("stage {}: steps{} [-]", effort.stage + 1, kept)] += 1.;
        summary_.figures[fmt::format("stage {}: equilibria{} [-]", effort.stage + 1, kept)] +=
            static_cast<double>(effort.n_equilibria);
        summary_.figures[fmt::format("stage {}: cycles{} [-]", effort.stage + 1, kept)] +=
            static_cast<double>(effort.n_cycles);
      }

      /** @param stage  number that is written */
      void write_breakage(const std::size_t stage)
      {
        const dem::Stopwatch watch(summary_.output_s);
        const dem::RevState &state = rev_->get_committed();
        history_->write(dem::measure_breakage(state, initial_diameters_, case_.rev.model.fracture, case_.breakage),
                        state.counters, state.time, stage);
      }

      bool advance(const double fraction)
      {
        for (const dem::Fracture &fracture : rev_->get_last_fractures())
          history_->write(fracture, position_.stage);
        write_breakage(position_.stage + 1);
        committed_rows_ = history_->count_rows();
        const dem::RevState &state = rev_->get_committed();
        progress_.show(fmt::format("{}: {:.4g} s, axial stress {:.4g} MPa, {} grains broken",
                                   case_.stages[position_.stage].name, state.time, -state.stress(2, 2) / 1e6,
                                   state.counters.broken_instant + state.counters.broken_delayed),
                       fraction);
        if (dem::measure_seconds_since(last_checkpoint_) > case_.checkpoint_interval)
          write_checkpoint();
        return false;
      }

      void cross_edge(const std::size_t stage, const bool is_end)
      {
        if (!is_end)
          return progress_.say(
              fmt::format("stage {} of {}: {}", stage + 1, case_.stages.size(), case_.stages[stage].name));
        if (case_.stages[stage].kind == dem::StageKind::strength_search)
          progress_.say(fmt::format("q_max = {:.4g} MPa at an axial strain of {:.4g}", position_.strength / 1e6,
                                    -position_.strain_at_strength));
        if (rev_->get_committed().counters.cycles > 0)
          write_snapshot(fmt::format("stage_{}", stage + 1));
      }

      void write_snapshot(const std::string &name)
      {
        const dem::Stopwatch watch(summary_.output_s);
        const dem::RevState &state = rev_->get_committed();
        dem::write_snapshot(folder_.get_snapshot_file(name), state, dem::list_contacts(state, rev_->get_law()),
                            {case_.rev.seed, case_.rev.model.identity.rev});
      }

      void write_checkpoint()
      {
        const dem::Stopwatch watch(summary_.output_s);
        write_rev_checkpoint(folder_.get_file("checkpoint.h5"), *rev_,
                             {rev_->get_committed(), position_, committed_rows_, initial_diameters_});
        last_checkpoint_ = dem::Clock::now();
      }

      int finish(const dem::LaboratoryOutcome outcome)
      {
        const dem::RevState &state = rev_->get_committed();
        write_checkpoint();
        summary_.status = dem::describe(outcome);
        summary_.grains = state.grains.size();
        summary_.cycles = state.counters.cycles;
        summary_.broken_instant = state.counters.broken_instant;
        summary_.broken_delayed = state.counters.broken_delayed;
        summary_.profile = rev_->get_profile();
        summary_.figures["memory of the REV per grain [bytes]"] =
            static_cast<double>(rev_->count_bytes()) / static_cast<double>(state.grains.size());
        list_findings(outcome);
        folder_.write_summary(summary_);
        progress_.say(fmt::format("{}: {} grains, {} broken at once and {} with delay, {} cycles; {}", summary_.status,
                                  state.grains.size(), state.counters.broken_instant, state.counters.broken_delayed,
                                  state.counters.cycles, folder_.get_path()));
        if (outcome == dem::LaboratoryOutcome::finished)
          return 0;
        return is_result(outcome) ? tell_rupture() : tell_failure(outcome);
      }

      /** A creep test that ends in rupture has answered the question it was run for. */
      bool is_result(const dem::LaboratoryOutcome outcome) const
      {
        return outcome == dem::LaboratoryOutcome::ruptured &&
               case_.stages[position_.stage].kind == dem::StageKind::creep;
      }

      void list_findings(const dem::LaboratoryOutcome outcome)
      {
        if (position_.strength > 0.)
          {
            summary_.findings["q_max_Pa"] = position_.strength;
            summary_.findings["strain_at_q_max"] = -position_.strain_at_strength;
          }
        list_wall_stresses();
        if (outcome != dem::LaboratoryOutcome::ruptured)
          return;
        summary_.findings["rupture_time_s"] = position_.rupture_time;
        summary_.findings["rupture_criterion"] = std::string(dem::describe(position_.criterion));
      }

      /** Compression-positive, as in history.csv, beside those averaged over the grains. */
      void list_wall_stresses()
      {
        const dem::RevState &state = rev_->get_committed();
        if (!state.cell.has_walls())
          return;
        const dem::Vector stress = dem::compute_wall_stress(state.cell, dem::list_contacts(state, rev_->get_law()));
        for (int k = 0; k < 3; ++k)
          {
            const char axis = "xyz"[k];
            summary_.findings[fmt::format("wall_stress_{0}{0}_Pa", axis)] = -stress[k];
            summary_.findings[fmt::format("stress_{0}{0}_Pa", axis)] = -state.stress(k, k);
          }
      }

      int tell_rupture()
      {
        write_snapshot(fmt::format("stage_{}", position_.stage + 1));
        progress_.say(fmt::format("stage {} ({}) ruptured at {:.6g} s: {}; {} stages are left undone",
                                  position_.stage + 1, case_.stages[position_.stage].name, position_.rupture_time,
                                  dem::describe(position_.criterion), case_.stages.size() - position_.stage - 1));
        return 0;
      }

      int tell_failure(const dem::LaboratoryOutcome outcome) const
      {
        std::cerr << fmt::format(
            "slowsand-rev: stage {} ({}), {:.6g} s: {}{}; {}. The last state at rest is in {}; change a parameter with "
            "--set and go on with --resume {}\n",
            position_.stage + 1, case_.stages[position_.stage].name, rev_->get_committed().time, summary_.status,
            describe_cause(outcome), dem::suggest_remedy(outcome), folder_.get_file("checkpoint.h5"),
            folder_.get_path());
        return 1;
      }

      std::string describe_cause(const dem::LaboratoryOutcome outcome) const
      {
        if (outcome == dem::LaboratoryOutcome::ruptured)
          return fmt::format(" ({})", dem::describe(position_.criterion));
        return outcome == dem::LaboratoryOutcome::no_equilibrium
                   ? fmt::format(" ({})", dem::describe(position_.last_rest))
                   : "";
      }

      const RevCase &case_;
      RunFolder folder_;
      Progress progress_;
      Summary summary_;
      dem::LaboratoryPosition position_;
      std::unique_ptr<dem::Rev> rev_;
      std::unique_ptr<RevHistory> history_;
      RowCounts committed_rows_;              // those of a rupture are committed by no step
      std::vector<double> initial_diameters_; // of the packing [m]
      dem::Clock::time_point last_checkpoint_;
    };
  } // namespace

  int run_rev(const RevCase &rev_case, const CommandLine &line)
  {
    RevCase threaded = rev_case;
    threaded.rev.model.dynamics.n_threads = line.n_threads;
    return Run(threaded, line).run();
  }
} // namespace apps

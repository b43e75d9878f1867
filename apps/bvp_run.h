#pragma once

#include "apps/bvp_case.h"
#include "apps/bvp_history.h"
#include "apps/checkpoint_pair.h"
#include "apps/command_line.h"
#include "apps/cost_file.h"
#include "apps/point_tables.h"
#include "apps/progress.h"
#include "apps/run_folder.h"
#include "apps/step_work.h"

#include "fem/field_output.h"

#include <memory>

namespace apps
{
  /** A boundary-value problem from its first consolidation to its last file. */
  template <int dim>
  class BvpRun
  {
  public:
    /** Makes run folder, material, mesh and problem, and where the run is resumed brings them to its checkpoint. Throws
     * BadInput; a folder that cannot be resumed is left as it is. */
    BvpRun(const BvpCase &bvp, const CommandLine &line);

    /** Runs the loading programme. @return exit status */
    int run();

  private:
    /** What the summary tells of Newton's work. */
    struct Tally
    {
      unsigned int creep_steps = 0, creep_evaluations = 0;
      unsigned int avalanche_rounds = 0, avalanche_evaluations = 0;
      unsigned int cuts = 0, lost_evaluations = 0;
      double largest_residual_share = 0.;
      double largest_unbalanced_ratio = 0.;        ///< of a REV at an equilibrium that was committed [-]
      coupling::WorkTally work_before, creep_work; ///< of the REVs: until the last step; in creep steps
    };

    void prepare_folder() const;
    using Regions = std::map<std::string, dealii::types::material_id>;

    void make_material(const Regions &regions);
    std::unique_ptr<fem::ConstitutiveModel> make_part(MaterialKind kind, const std::string &archive_group);
    void make_problem();
    void open_load_tests();
    void resume();
    void open_history();
    void say_capacities();
    void record(const fem::StepReport &report);
    void write_step(const fem::StepReport &report, const coupling::RevTotals &totals);
    void record_work(const fem::StepReport &report);
    void record_cut(const fem::CutReport &report);
    void write_initial_row();
    void write_stage_snapshots(unsigned int stage) const;
    void write_snapshots(const std::string &suffix) const;
    void write_summary(const std::string &status) const;
    double compute_share_done(const fem::StepReport &report) const;

    const BvpCase &bvp_;
    const CommandLine &line_;
    const RunFolder folder_;
    CheckpointPair checkpoints_;
    const bool is_first_rank_;
    dem::Clock::time_point start_ = dem::Clock::now();
    Progress progress_;
    std::unique_ptr<fem::ConstitutiveModel> material_;
    coupling::RevMaterial *rev_material_ = nullptr; ///< the same, if its answers come from REVs
    std::unique_ptr<fem::QuasiStaticProblem<dim>> problem_;
    std::unique_ptr<fem::LoadStepping<dim>> stepping_;
    std::unique_ptr<HistoryFile> history_; ///< on the first rank
    std::unique_ptr<fem::FieldOutput> fields_;
    std::unique_ptr<PointTables<dim>> tables_;
    std::unique_ptr<LoadTests<dim>> load_tests_;                         ///< if there are any
    double unbalanced_share_ = std::numeric_limits<double>::quiet_NaN(); ///< of the untouched ground [-]
    std::unique_ptr<CostFile> costs_;
    Tally tally_;
    StepWork step_work_;
    double output_s_ = 0.; ///< wall time of writing [s]
  };
} // namespace apps

#pragma once

#include "coupling/initial_state.h"
#include "coupling/lazy_rev.h"

#include "dem/breakage_measures.h"

#include "fem/constitutive_model.h"

#include <functional>
#include <map>
#include <memory>
#include <mutex>

namespace coupling
{
  struct RevMaterialParameters
  {
    dem::RevModel model; ///< its identity.rev is replaced by the point's number
    PackingSource packing;
    ConsolidationRule consolidation;
    AgeingRule ageing;
    PointRule point;
    dem::BreakageScale breakage;
    std::string failure_folder;                        ///< where failed REVs are written; empty: nowhere
    unsigned int n_failure_files = 3;                  ///< of one REV at most
    bool is_resumed = false;                           ///< the REVs will come from load(): initialise() makes none
    std::function<void(const std::string &what)> tell; ///< how far initialise() is, on each rank; empty: nobody
  };

  /** Sums over all REVs of the committed state, the same on every rank. */
  struct RevTotals
  {
    std::uint64_t grains = 0, cycles = 0, broken_instant = 0, broken_delayed = 0;
    double void_ratio = 0., void_ratio_with_fines = 0.; ///< means over the points [-]
    std::uint64_t n_lazy = 0;                           ///< REVs whose present answer is their tangent's
    double largest_error_bound = 0.;                    ///< of those answers [Pa]
    LazyTally lazy;
  };

  inline constexpr auto cost_field = "REV cost [s]"; ///< processor time of a REV in the last step

  /**
   * A material whose answers come from REVs, one a Gauss point (coupling/README.md, docs/theory.md section 8).
   *
   * Each point has its own strengths and cracks, drawn by its number. What a REV cannot do is a status of its point and
   * a file that replays it.
   */
  class RevMaterial : public fem::ConstitutiveModel
  {
  public:
    RevMaterial(const RevMaterialParameters &parameters, const RevPool &pool);
    RevMaterial(const RevMaterial &) = delete; // the pool knows how to fetch this one's REVs
    RevMaterial &operator=(const RevMaterial &) = delete;

    /** Makes and consolidates the REVs. Throws std::invalid_argument for an initial stress that is not compressive,
     *  std::runtime_error for a REV that finds no equilibrium. */
    void initialise(std::span<const fem::PointSite> sites) override;

    double compute_time_to_next_event(unsigned int n_cuts) const override;
    bool can_cut_events(unsigned int n_cuts) const override;
    fem::Status begin_step(double dt) override;
    fem::EventCount count_events() const override { return {n_aged_, pool_.get_points().size()}; }
    void evaluate(std::span<const fem::PointRequest> requests, std::span<fem::PointResponse> responses,
                  bool with_tangent) override;
    fem::Settlement settle(bool accept_excess) override;
    void commit() override;
    void revert() override;
    std::vector<std::string> get_field_names() const override;
    std::vector<double> compute_fields(PointId id) const override;
    void save(const std::string &file) const override;
    void load(const std::string &file) override;

    RevTotals compute_totals() const;

    /** What the REVs of this rank have spent their time on, all threads added up. */
    dem::Profile compute_local_profile() const;

    /** Writes each committed REV as PREFIX_ID_SUFFIX.h5, on the rank where it lives. Collective. */
    void write_snapshots(const std::string &prefix, const std::string &suffix) const;

    /** Stresses [Pa] of the committed REVs in the solver's axes, for a macro problem that begins. Keyed by points,
     * known to all ranks; collective. */
    std::map<PointId, dealii::SymmetricTensor<2, 3>> collect_stresses() const;

    /** Questions to points so far. */
    std::uint64_t get_n_evaluations() const { return n_evaluations_; }
    const RevPool &get_pool() const { return pool_; }
    const dem::Rev &get_local_rev(PointId id) const { return points_.at(id).rev->get_rev(); }
    const LazyRev &get_local_lazy_rev(PointId id) const { return *points_.at(id).rev; }

  private:
    struct Point
    {
      std::unique_ptr<LazyRev> rev; ///< null while it lives on another rank
      unsigned int n_failures = 0;  ///< seen here
    };

    std::vector<std::byte> send_away(PointId id);
    void receive(PointId id, std::span<const std::byte> bytes);

    void tell(const std::string &what) const;
    dem::RevModel make_model(PointId id) const;
    std::vector<dem::Matrix> bring_home(const RevPool::Questions &stresses);
    void measure_initial_gradings();
    std::vector<double> collect_fields() const;
    void save_gradings(const std::string &file) const;
    void load_gradings(const std::string &file);
    void save_lazy_states(const std::string &file) const;
    void load_lazy_states(const std::string &file);
    void update_fields();
    fem::Status change_baselines(const RevQuestion &question, unsigned int &n_broken);
    void report_failure(PointId id, const dem::RevState &before, const RevQuestion &question,
                        const AgeingReport &report);

    RevMaterialParameters parameters_;
    RevPool pool_;
    std::map<PointId, Point> points_; ///< all, so that one REV can come while another one is worked on
    dem::Profile departed_profile_;   ///< of REVs that have left: their time was spent here
    std::vector<dem::InitialGrading> initial_gradings_; ///< of all points, known to all ranks
    std::vector<double> fields_;                        ///< of all points, by get_field_names(), after the last commit
    std::uint64_t n_evaluations_ = 0;
    unsigned int n_aged_ = 0; ///< grains that broke in the last begin_step()
    std::mutex mutex_;        // of failure files, since HDF5 is not thread-safe, and of what REVs leave behind
  };
} // namespace coupling

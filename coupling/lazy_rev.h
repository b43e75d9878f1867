#pragma once

#include "coupling/rev_point.h"
#include "coupling/tangent_forecast.h"

#include <optional>
#include <span>

namespace coupling
{
  /** How answers from tangents fared, over the steps that were kept. Sums of whole numbers and errors; no costs. */
  struct LazyTally
  {
    double n_questions = 0.;         ///< with a strain in them
    double n_forecasts = 0.;         ///< answered from the tangent
    double n_checks = 0.;            ///< forecasts that grains were compared with later
    double n_exceeded = 0.;          ///< of these, errors beyond their bound
    double largest_error = 0.;       ///< [Pa]
    double sum_of_errors = 0.;       ///< [Pa]
    double largest_error_share = 0.; ///< over the REV's stress [-]
    double sum_of_error_shares = 0.; ///< [-]
  };

  LazyTally add(const LazyTally &first, const LazyTally &second);

  /** What a REV's grains do not know yet. */
  struct LazyState
  {
    dem::Matrix pending = dem::Matrix::Identity(); ///< stretch since they were last at rest, in the REV's axes
    double deviation_share = 1.;                   ///< as last measured; before that: all may be wrong [-]
    double error_bound = 0.;                       ///< of the stress that was answered [Pa]

    bool is_pending() const { return pending != dem::Matrix::Identity(); }
  };

  /**
   * A REV behind a Gauss point that leaves its grains alone while what they would say is known well enough
   * (docs/theory.md, section 8, lazy answers).
   *
   * While the bound of the error of s + c : eps stays below the tolerance, eps being all strain since the grains were
   * last at rest, that is the answer; no cycle is run. Otherwise the grains follow all of eps at once. Cracks grow
   * meanwhile at the contact stresses that the grains were left with; before a step in which a grain's time comes, the
   * grains are brought up to date (needs_catching_up, catch_up), and only then age. A REV with overstressed grains is
   * never lazy. Both the strain that is pending and what is remembered of deviations have the three states of the REV.
   *
   * With tolerance 0 it is a dem::Rev, bit by bit.
   */
  class LazyRev
  {
  public:
    LazyRev(const dem::Rev &rev, const PointRule &rule) : rev_(rev), rule_(rule) {}

    /** As coupling::evaluate(). */
    PointAnswer evaluate(const dealii::Tensor<2, 3> &deformation_increment, bool with_tangent);

    /** The trial becomes the baseline. */
    void accept();

    /** True if a grain breaks within dt [s] while strain is pending: what breaks must have been strained before. */
    bool needs_catching_up(double dt) const;

    /** The question that catch_up() asks of the baseline. */
    RevQuestion describe_pending() const;

    /** The grains of the baseline follow what is pending, and the forecast is compared with them. Trial = baseline. */
    AgeingReport catch_up();

    /** Ages or splits the baseline, as coupling::ask(). @pre not needs_catching_up() */
    AgeingReport change_baseline(const RevQuestion &question, const AgeingRule &rule);

    void commit();
    void revert();

    /** Grains as they were last at rest: what is pending is missing in them. */
    const dem::Rev &get_rev() const { return rev_; }

    /** Committed Cauchy stress in the solver's axes [Pa], with what is pending. */
    dealii::SymmetricTensor<2, 3> compute_committed_stress() const;

    const LazyState &get_committed_state() const { return committed_; }
    static constexpr std::size_t n_tally_numbers = 8;
    void write_tally(std::span<double> numbers) const; ///< the committed one
    static LazyTally read_tally(std::span<const double> numbers);

    /** Numbers of a committed record: what a checkpoint keeps beside the grains. */
    static constexpr std::size_t n_committed_numbers = 11 + n_tally_numbers;
    void write_committed(std::span<double> numbers) const;
    void read_committed(std::span<const double> numbers); ///< @post committed = baseline = trial

    /** The REV between two questions, baseline included, as bytes (rev_travel.h). */
    std::vector<std::byte> pack() const;
    static LazyRev unpack(const dem::RevModel &model, const PointRule &rule, std::span<const std::byte> bytes);

  private:
    bool may_forecast(const Forecast &forecast, bool is_still) const;
    PointAnswer answer_from_tangent(const RevIncrement &increment, const Forecast &forecast, bool with_tangent);
    PointAnswer answer_from_grains(const RevIncrement &increment, const Forecast &forecast, bool with_tangent);
    Forecast compute_pending_forecast() const;
    const dealii::SymmetricTensor<4, 3> &get_tangent() const;
    void record_error(double error);

    dem::Rev rev_;
    PointRule rule_;
    LazyState committed_, baseline_, trial_;
    LazyTally committed_tally_, tally_;
    std::optional<dem::Matrix> forecast_rotation_; ///< Q of a trial that is a forecast; nothing: the trial is rev_'s
    std::optional<double> trial_error_;            ///< that a trial of the grains tells of the baseline's forecast [Pa]
    mutable std::optional<dealii::SymmetricTensor<4, 3>> tangent_; ///< of the baseline's grains, in the REV's axes
  };
} // namespace coupling

#include "coupling/lazy_rev.h"

#include "coupling/rev_travel.h"
#include "coupling/tensor_conversion.h"

#include "dem/ageing.h"
#include "dem/stopwatch.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <stdexcept>

namespace coupling
{
  namespace
  {
    /** Behind the grains of a REV on its way: committed and baseline state, committed and present tally. */
    using Tail = std::array<double, 2 * LazyRev::n_committed_numbers>;

    /** Shows every number of a state to `move`: writing and reading cannot differ. */
    template <typename State, typename Move>
    void visit_state(State &state, const Move &move)
    {
      for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
          move(state.pending(i, j));
      move(state.deviation_share);
      move(state.error_bound);
    }

    template <typename Tally, typename Move>
    void visit_tally(Tally &tally, const Move &move)
    {
      for (auto *number :
           {&tally.n_questions, &tally.n_forecasts, &tally.n_checks, &tally.n_exceeded, &tally.largest_error,
            &tally.sum_of_errors, &tally.largest_error_share, &tally.sum_of_error_shares})
        move(*number);
    }

    /** The first grain's, not a whole batch's [s]. */
    double compute_time_to_first_fracture(const dem::Grains &grains)
    {
      return dem::compute_time_to_batch(grains, 1);
    }
  } // namespace

  LazyTally add(const LazyTally &first, const LazyTally &second)
  {
    return {first.n_questions + second.n_questions,
            first.n_forecasts + second.n_forecasts,
            first.n_checks + second.n_checks,
            first.n_exceeded + second.n_exceeded,
            std::max(first.largest_error, second.largest_error),
            first.sum_of_errors + second.sum_of_errors,
            std::max(first.largest_error_share, second.largest_error_share),
            first.sum_of_error_shares + second.sum_of_error_shares};
  }

  PointAnswer LazyRev::evaluate(const dealii::Tensor<2, 3> &deformation_increment, const bool with_tangent)
  {
    if (!rule_.is_lazy() && !baseline_.is_pending())
      return coupling::evaluate(rev_, deformation_increment, with_tangent, rule_);
    const auto found = find_increment(deformation_increment, rev_.get_baseline().rotation, rule_);
    if (!found)
      {
        PointAnswer refusal;
        refusal.response.status = fem::Status::step_too_large;
        return refusal;
      }
    const bool is_still = found->stretch == dem::Matrix::Identity();
    const RevIncrement increment{found->stretch * baseline_.pending, found->rotation};
    const Forecast forecast = compute_forecast(rev_.get_baseline(), get_tangent(), increment.stretch);
    const bool is_forecast = may_forecast(forecast, is_still);
    tally_.n_questions += is_still ? 0. : 1.;
    tally_.n_forecasts += !is_still && is_forecast ? 1. : 0.;
    return is_forecast ? answer_from_tangent(increment, forecast, with_tangent)
                       : answer_from_grains(increment, forecast, with_tangent);
  }

  // What has been answered for a baseline stands: a question without a strain never wakes the grains.
  bool LazyRev::may_forecast(const Forecast &forecast, const bool is_still) const
  {
    if (is_still)
      return true;
    const double allowed = rule_.lazy_tolerance * to_symmetric_tensor(rev_.get_baseline().stress).norm();
    return compute_error_bound(forecast, baseline_.deviation_share) <= allowed && rev_.count_overstressed() == 0;
  }

  PointAnswer LazyRev::answer_from_tangent(const RevIncrement &increment, const Forecast &forecast,
                                           const bool with_tangent)
  {
    const dem::Clock::time_point start = dem::Clock::now();
    trial_ = {increment.stretch, baseline_.deviation_share, compute_error_bound(forecast, baseline_.deviation_share)};
    forecast_rotation_ = increment.rotation;
    PointAnswer answer;
    const dem::Matrix &q = increment.rotation;
    answer.response.stress = to_symmetric_tensor(q * to_matrix(forecast.stress) * q.transpose());
    if (with_tangent)
      answer.response.tangent = rotate(get_tangent(), q);
    answer.response.unbalanced_ratio = rev_.get_baseline().unbalanced_ratio;
    answer.response.cost_s = dem::measure_seconds_since(start);
    return answer;
  }

  PointAnswer LazyRev::answer_from_grains(const RevIncrement &increment, const Forecast &forecast,
                                          const bool with_tangent)
  {
    forecast_rotation_.reset();
    trial_error_.reset();
    trial_ = LazyState{};
    const PointAnswer answer = coupling::evaluate(rev_, increment, with_tangent, rule_);
    if (answer.response.status == fem::Status::ok)
      {
        trial_.deviation_share = compute_deviation_share(forecast, to_symmetric_tensor(rev_.peek_trial().stress));
        if (baseline_.is_pending())
          trial_error_ = trial_.deviation_share * compute_pending_forecast().change;
      }
    return answer;
  }

  Forecast LazyRev::compute_pending_forecast() const
  {
    return compute_forecast(rev_.get_baseline(), get_tangent(), baseline_.pending);
  }

  const dealii::SymmetricTensor<4, 3> &LazyRev::get_tangent() const
  {
    if (!tangent_)
      tangent_ = compute_tangent(rev_, rev_.get_baseline(), rule_.tangent);
    return *tangent_;
  }

  void LazyRev::record_error(const double error)
  {
    const double stress = to_symmetric_tensor(rev_.get_baseline().stress).norm();
    tally_.n_checks += 1.;
    tally_.n_exceeded += error > baseline_.error_bound ? 1. : 0.;
    tally_.largest_error = std::max(tally_.largest_error, error);
    tally_.sum_of_errors += error;
    tally_.largest_error_share = std::max(tally_.largest_error_share, error / stress);
    tally_.sum_of_error_shares += error / stress;
  }

  void LazyRev::accept()
  {
    if (trial_error_)
      record_error(*trial_error_);
    trial_error_.reset();
    if (forecast_rotation_)
      {
        rev_.deform(dem::Matrix::Identity()); // the grains stay, their axes turn
        rev_.set_trial_rotation(*forecast_rotation_);
        forecast_rotation_.reset();
      }
    else
      tangent_.reset();
    rev_.accept();
    baseline_ = trial_;
  }

  bool LazyRev::needs_catching_up(const double dt) const
  {
    if (!baseline_.is_pending())
      return false;
    const dem::RevState &baseline = rev_.get_baseline();
    return compute_time_to_first_fracture(baseline.grains) <= snap_to_fracture(baseline.grains, dt, baseline.time);
  }

  RevQuestion LazyRev::describe_pending() const
  {
    RevQuestion question;
    question.stretch = baseline_.pending;
    return question;
  }

  AgeingReport LazyRev::catch_up()
  {
    const Forecast forecast = compute_pending_forecast();
    AgeingReport report;
    report.rest = rev_.deform(baseline_.pending);
    if (report.has_failed())
      return report;
    const dealii::SymmetricTensor<2, 3> stress = to_symmetric_tensor(rev_.peek_trial().stress);
    record_error((stress - forecast.stress).norm());
    rev_.accept();
    tangent_.reset();
    baseline_ = trial_ = LazyState{.deviation_share = compute_deviation_share(forecast, stress)};
    return report;
  }

  AgeingReport LazyRev::change_baseline(const RevQuestion &question, const AgeingRule &rule)
  {
    const AgeingReport report = ask(rev_, question, rule);
    if (report.n_broken > 0)
      tangent_.reset();
    trial_ = baseline_;
    forecast_rotation_.reset();
    trial_error_.reset();
    return report;
  }

  void LazyRev::commit()
  {
    rev_.commit();
    committed_ = baseline_;
    committed_tally_ = tally_;
  }

  void LazyRev::revert()
  {
    rev_.revert();
    baseline_ = trial_ = committed_;
    tally_ = committed_tally_;
    forecast_rotation_.reset();
    trial_error_.reset();
    tangent_.reset();
  }

  dealii::SymmetricTensor<2, 3> LazyRev::compute_committed_stress() const
  {
    const dem::RevState &state = rev_.get_committed();
    dem::Matrix stress = state.stress;
    if (committed_.is_pending())
      stress =
          to_matrix(compute_forecast(state, compute_tangent(rev_, state, rule_.tangent), committed_.pending).stress);
    return to_symmetric_tensor(state.rotation * stress * state.rotation.transpose());
  }

  void LazyRev::write_tally(const std::span<double> numbers) const
  {
    std::size_t at = 0;
    visit_tally(committed_tally_, [&](const double number) { numbers[at++] = number; });
  }

  LazyTally LazyRev::read_tally(const std::span<const double> numbers)
  {
    LazyTally tally;
    std::size_t at = 0;
    visit_tally(tally, [&](double &number) { number = numbers[at++]; });
    return tally;
  }

  void LazyRev::write_committed(const std::span<double> numbers) const
  {
    std::size_t at = 0;
    const auto write = [&](const double number) { numbers[at++] = number; };
    visit_state(committed_, write);
    visit_tally(committed_tally_, write);
  }

  void LazyRev::read_committed(const std::span<const double> numbers)
  {
    std::size_t at = 0;
    const auto read = [&](double &number) { number = numbers[at++]; };
    visit_state(committed_, read);
    visit_tally(committed_tally_, read);
    baseline_ = trial_ = committed_;
    tally_ = committed_tally_;
  }

  std::vector<std::byte> LazyRev::pack() const
  {
    std::vector<std::byte> bytes = pack_rev(rev_);
    Tail tail;
    std::size_t at = 0;
    const auto write = [&](const double number) { tail[at++] = number; };
    visit_state(committed_, write);
    visit_tally(committed_tally_, write);
    visit_state(baseline_, write);
    visit_tally(tally_, write);
    const auto end = std::as_bytes(std::span(tail));
    bytes.insert(bytes.end(), end.begin(), end.end());
    return bytes;
  }

  LazyRev LazyRev::unpack(const dem::RevModel &model, const PointRule &rule, const std::span<const std::byte> bytes)
  {
    Tail tail;
    if (bytes.size() < sizeof(tail))
      throw std::runtime_error("a REV that changed its rank came without its end");
    const std::size_t length = bytes.size() - sizeof(tail);
    LazyRev rev(*unpack_rev(model, bytes.first(length)), rule);
    std::memcpy(tail.data(), bytes.data() + length, sizeof(tail));
    std::size_t at = 0;
    const auto read = [&](double &number) { number = tail[at++]; };
    visit_state(rev.committed_, read);
    visit_tally(rev.committed_tally_, read);
    visit_state(rev.baseline_, read);
    visit_tally(rev.tally_, read);
    rev.trial_ = rev.baseline_;
    return rev;
  }
} // namespace coupling

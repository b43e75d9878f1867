#include "coupling/rev_material.h"

#include "coupling/point_package.h"
#include "coupling/tensor_conversion.h"

#include <deal.II/base/mpi.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <limits>
#include <stdexcept>

namespace coupling
{
  using fem::Status;

  namespace
  {
    void require_compression(const fem::PointSite &site)
    {
      const auto principal = dealii::eigenvalues(site.initial_stress); // the largest first
      if (!(principal[0] < 0.))
        throw std::invalid_argument(fmt::format(
            "initial stress at point {}: grains hold no tension: its largest principal value is {:g} Pa (tension-"
            "positive); allowed: < 0",
            site.id, principal[0]));
    }
  } // namespace

  RevMaterial::RevMaterial(const RevMaterialParameters &parameters, const RevPool &pool)
      : parameters_(parameters), pool_(pool)
  {
    pool_.set_travel({[this](const PointId id) { return send_away(id); },
                      [this](const PointId id, std::span<const std::byte> bytes) { receive(id, bytes); }});
  }

  // Behind the REV goes the number of its failure files, which bear that number in their names.
  std::vector<std::byte> RevMaterial::send_away(const PointId id)
  {
    Point &point = points_.at(id);
    std::vector<std::byte> bytes = point.rev->pack();
    const auto number = std::as_bytes(std::span(&point.n_failures, 1));
    bytes.insert(bytes.end(), number.begin(), number.end());
    const std::lock_guard lock(mutex_);
    departed_profile_ += point.rev->get_rev().get_profile();
    point.rev.reset();
    return bytes;
  }

  void RevMaterial::receive(const PointId id, std::span<const std::byte> bytes)
  {
    Point &point = points_.at(id);
    if (bytes.size() < sizeof(point.n_failures))
      throw std::runtime_error("a REV that changed its rank came without its end");
    const std::size_t length = bytes.size() - sizeof(point.n_failures);
    point.rev = std::make_unique<LazyRev>(LazyRev::unpack(make_model(id), parameters_.point, bytes.first(length)));
    std::memcpy(&point.n_failures, bytes.data() + length, sizeof(point.n_failures));
  }

  dem::RevModel RevMaterial::make_model(const PointId id) const
  {
    dem::RevModel model = parameters_.model;
    model.identity.rev = id;
    return model;
  }

  /** Rows of a question to all points, as matrices of those that live here. */
  std::vector<dem::Matrix> RevMaterial::bring_home(const RevPool::Questions &stresses)
  {
    std::map<PointId, dem::Matrix> found;
    for (const PointId id : pool_.get_local_points())
      found[id] = dem::Matrix::Zero();
    pool_.ask(stresses, 0, [&](const PointId id, std::span<const double> stress, std::span<double>) {
      found.at(id) = to_matrix(take_tensor(stress));
    });
    std::vector<dem::Matrix> here;
    for (const auto &[id, stress] : found)
      here.push_back(stress);
    return here;
  }

  void RevMaterial::initialise(std::span<const fem::PointSite> sites)
  {
    std::vector<PointId> ids;
    RevPool::Questions stresses;
    stresses.n_columns = 9;
    for (const fem::PointSite &site : sites)
      {
        require_compression(site);
        ids.push_back(site.id);
        append(site.initial_stress, stresses.rows);
      }
    stresses.ids = ids;
    pool_.set_points(ids);
    points_.clear();
    for (const PointId id : pool_.get_points())
      points_[id];
    if (parameters_.is_resumed)
      return;
    tell(fmt::format("packing grains for {} REVs", points_.size()));
    std::vector<dem::RevState> packings;
    if (parameters_.packing.n_levels > 0 && parameters_.packing.n_packings > 0)
      packings = distribute_library(pool_, parameters_.packing, parameters_.model, parameters_.consolidation,
                                    bring_home(stresses));
    else
      packings = distribute_packings(pool_, parameters_.packing, parameters_.model);
    for (std::size_t i = 0; i < packings.size(); ++i)
      {
        const PointId id = pool_.get_local_points()[i];
        points_[id].rev = std::make_unique<LazyRev>(dem::make_rev(make_model(id), packings[i]), parameters_.point);
      }
    measure_initial_gradings();
    stresses.kind = WorkKind::prepare;
    std::size_t n_ready = 0;
    pool_.ask(stresses, 0, [&](const PointId id, std::span<const double> stress, std::span<double>) {
      LazyRev &rev = *points_.at(id).rev;
      rev = LazyRev(consolidate(rev.get_rev(), to_matrix(take_tensor(stress)), parameters_.consolidation),
                    parameters_.point);
      const std::lock_guard lock(mutex_);
      tell(fmt::format("{} of some {} REVs brought to their stress", ++n_ready, points_.size() / pool_.get_n_ranks()));
    });
    update_fields();
  }

  void RevMaterial::tell(const std::string &what) const
  {
    if (parameters_.tell)
      parameters_.tell(what);
  }

  double RevMaterial::compute_time_to_next_event(const unsigned int n_cuts) const
  {
    double earliest = std::numeric_limits<double>::infinity();
    for (const PointId id : pool_.get_local_points())
      earliest =
          std::min(earliest, coupling::compute_time_to_next_event(get_local_rev(id), parameters_.ageing, n_cuts));
    return dealii::Utilities::MPI::min(earliest, pool_.get_communicator());
  }

  bool RevMaterial::can_cut_events(const unsigned int n_cuts) const
  {
    const auto &here = pool_.get_local_points();
    const bool can_here = std::any_of(here.begin(), here.end(), [&](const PointId id) {
      return can_cut_batch(get_local_rev(id), parameters_.ageing, n_cuts);
    });
    return dealii::Utilities::MPI::max(can_here ? 1 : 0, pool_.get_communicator()) > 0;
  }

  Status RevMaterial::begin_step(const double dt)
  {
    RevQuestion question;
    question.kind = QuestionKind::age;
    question.dt = dt;
    return change_baselines(question, n_aged_);
  }

  // The rows that travel: nine numbers of dF, whether the tangent is wanted; back come what point_package.h packs.
  void RevMaterial::evaluate(std::span<const fem::PointRequest> requests, std::span<fem::PointResponse> responses,
                             const bool with_tangent)
  {
    std::vector<PointId> ids;
    RevPool::Questions questions;
    questions.n_columns = 9;
    questions.kind = WorkKind::evaluate;
    for (const fem::PointRequest &request : requests)
      {
        ids.push_back(request.id);
        append(request.deformation_increment, questions.rows);
      }
    questions.ids = ids;
    const std::size_t n_columns = get_response_length(with_tangent);
    const auto rows =
        pool_.ask(questions, n_columns, [&](const PointId id, std::span<const double> question, std::span<double> row) {
          LazyRev &rev = *points_.at(id).rev;
          const PointAnswer answer = rev.evaluate(take_tensor(question), with_tangent);
          pack(answer.response, with_tangent, row);
          if (answer.response.status == Status::failed)
            report_failure(id, rev.get_rev().get_baseline(), answer.question, answer.report);
        });
    for (std::size_t i = 0; i < responses.size(); ++i)
      responses[i] = unpack(std::span<const double>(rows).subspan(i * n_columns, n_columns), with_tangent);
    n_evaluations_ += dealii::Utilities::MPI::max(requests.size(), pool_.get_communicator());
  }

  fem::Settlement RevMaterial::settle(const bool accept_excess)
  {
    fem::Settlement settlement;
    bool is_excessive_here = false;
    for (const PointId id : pool_.get_local_points())
      {
        LazyRev &rev = *points_.at(id).rev;
        rev.accept();
        is_excessive_here |= is_excessive(rev.get_rev());
      }
    settlement.is_excessive = dealii::Utilities::MPI::max(is_excessive_here ? 1 : 0, pool_.get_communicator()) > 0;
    if (settlement.is_excessive && !accept_excess)
      return settlement;
    RevQuestion question;
    question.kind = QuestionKind::split;
    settlement.status = change_baselines(question, settlement.n_broken);
    return settlement;
  }

  // Asks all REVs something that moves their baselines on.
  Status RevMaterial::change_baselines(const RevQuestion &question, unsigned int &n_broken)
  {
    const WorkKind kind = question.kind == QuestionKind::age ? WorkKind::age : WorkKind::split;
    constexpr std::size_t n_columns = 2; // grains broken; whether it has failed
    const auto rows = pool_.ask_all(kind, n_columns, [&](const PointId id, std::span<double> row) {
      LazyRev &rev = *points_.at(id).rev;
      row[0] = row[1] = 0.;
      if (question.kind == QuestionKind::split && rev.get_rev().count_overstressed() == 0)
        return; // all stays as accept() left it, and nothing has to be remembered
      AgeingReport report;
      if (question.kind == QuestionKind::age && rev.needs_catching_up(question.dt))
        {
          report = rev.catch_up();
          if (report.has_failed())
            report_failure(id, rev.get_rev().get_baseline(), rev.describe_pending(), report);
        }
      if (!report.has_failed())
        {
          const dem::RevState before = rev.get_rev().get_baseline();
          report = rev.change_baseline(question, parameters_.ageing);
          if (report.has_failed())
            report_failure(id, before, question, report);
        }
      row[0] = static_cast<double>(report.n_broken);
      row[1] = report.has_failed() ? 1. : 0.;
    });
    Status status = Status::ok;
    n_broken = 0;
    for (std::size_t at = 0; at < rows.size(); at += n_columns)
      {
        n_broken += static_cast<unsigned int>(rows[at]);
        if (rows[at + 1] != 0.)
          status = Status::failed;
      }
    return status;
  }

  void RevMaterial::report_failure(const PointId id, const dem::RevState &before, const RevQuestion &question,
                                   const AgeingReport &report)
  {
    Point &point = points_.at(id);
    if (parameters_.failure_folder.empty() || point.n_failures >= parameters_.n_failure_files)
      return;
    const std::lock_guard lock(mutex_);
    std::filesystem::create_directories(parameters_.failure_folder);
    const std::string file = fmt::format("{}/point_{}_{}.h5", parameters_.failure_folder, id, ++point.n_failures);
    write_failure(file, {make_model(id), before, question, parameters_.ageing, describe(report)});
  }

  void RevMaterial::commit()
  {
    for (const PointId id : pool_.get_local_points())
      points_.at(id).rev->commit();
    pool_.close_step();
    update_fields();
  }

  void RevMaterial::revert()
  {
    for (const PointId id : pool_.get_local_points())
      points_.at(id).rev->revert();
  }
} // namespace coupling

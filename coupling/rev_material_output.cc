// What leaves a RevMaterial: fields, totals and snapshots.

#include "coupling/rev_material.h"
#include "coupling/tensor_conversion.h"

#include "dem/rev_snapshot.h"

#include <fmt/format.h>

#include <algorithm>

namespace coupling
{
  namespace
  {
    /** Order of the fields of a point. */
    enum Field : std::size_t
    {
      void_ratio,
      void_ratio_with_fines,
      fines_share,
      coordination,
      time_to_fracture,
      broken_instant,
      broken_delayed,
      grains,
      cycles,
      einav_breakage,
      hardin_breakage,
      d10,
      d50,
      d90,
      error_bound,
      cost,
      n_fields
    };

    /** Behind the fields of a point: what only sums tell of. */
    constexpr std::size_t n_columns = n_fields + LazyRev::n_tally_numbers;

    void fill_fields(const LazyRev &lazy, std::span<double> row)
    {
      const dem::Rev &rev = lazy.get_rev();
      const dem::RevState &state = rev.get_committed();
      const auto contacts = dem::list_contacts(state, rev.get_law());
      const double pending_volume = lazy.get_committed_state().pending.determinant(); // over that of the grains' cell
      row[void_ratio] = (1. + dem::compute_void_ratio(state)) * pending_volume - 1.;
      row[void_ratio_with_fines] = (1. + dem::compute_void_ratio_with_fines(state)) * pending_volume - 1.;
      row[fines_share] = 1. - dem::compute_solid_volume(state.grains) / state.initial_solid_volume;
      row[coordination] =
          dem::compute_coordination(contacts, state.grains.size(), rev.get_model().dynamics.motion.is_rotation_free)
              .without_rattlers;
      row[time_to_fracture] = rev.compute_time_to_next_batch();
      row[broken_instant] = static_cast<double>(state.counters.broken_instant);
      row[broken_delayed] = static_cast<double>(state.counters.broken_delayed);
      row[grains] = static_cast<double>(state.grains.size());
      row[cycles] = static_cast<double>(state.counters.cycles);
      row[error_bound] = lazy.get_committed_state().error_bound;
      lazy.write_tally(row.subspan(n_fields));
    }

    bool has_same_grading(std::span<const double> before, std::span<const double> now)
    {
      return before[broken_instant] == now[broken_instant] && before[broken_delayed] == now[broken_delayed];
    }

    void fill_grading(const dem::GradingMeasures &measures, std::span<double> row)
    {
      row[einav_breakage] = measures.einav;
      row[hardin_breakage] = measures.hardin;
      row[d10] = measures.d10;
      row[d50] = measures.d50;
      row[d90] = measures.d90;
    }
  } // namespace

  std::vector<std::string> RevMaterial::get_field_names() const
  {
    return {"void ratio [-]",
            "void ratio with fines [-]",
            "fines [-]",
            "coordination [-]",
            "time to fracture [s]",
            "broken at once [-]",
            "broken delayed [-]",
            "grains [-]",
            "cycles [-]",
            "relative breakage [-]",
            "relative breakage by Hardin [-]",
            "d10 [m]",
            "d50 [m]",
            "d90 [m]",
            "bound of error of stress [Pa]",
            cost_field};
  }

  void RevMaterial::measure_initial_gradings()
  {
    constexpr std::size_t n_numbers = 3;
    const auto rows = pool_.collect(n_numbers, [&](const PointId id, std::span<double> row) {
      const auto diameters = dem::list_diameters(get_local_rev(id).get_committed().grains);
      const dem::InitialGrading grading = dem::measure_initial_grading(diameters, parameters_.breakage);
      row[0] = grading.hardin_mean;
      row[1] = grading.einav_mean;
      row[2] = grading.largest_diameter;
    });
    initial_gradings_.clear();
    for (std::size_t at = 0; at < rows.size(); at += n_numbers)
      initial_gradings_.push_back({rows[at], rows[at + 1], rows[at + 2]});
  }

  void RevMaterial::update_fields()
  {
    std::vector<double> fields = collect_fields();
    for (std::size_t i = 0; i < pool_.get_points().size(); ++i)
      fields[i * n_columns + cost] = pool_.get_step_costs()[i];
    fields_ = std::move(fields);
  }

  // Sorting grains by size costs more than all else here: gradings are measured where something has broken since.
  std::vector<double> RevMaterial::collect_fields() const
  {
    return pool_.collect(n_columns, [&](const PointId id, std::span<double> row) {
      const std::size_t place = pool_.get_index(id);
      fill_fields(*points_.at(id).rev, row);
      const std::span<const double> before =
          fields_.empty() ? std::span<const double>() : std::span(fields_).subspan(place * n_columns, n_columns);
      if (!before.empty() && has_same_grading(before, row))
        for (const Field field : {einav_breakage, hardin_breakage, d10, d50, d90})
          row[field] = before[field];
      else
        fill_grading(dem::measure_grading_with_fines(get_local_rev(id).get_committed(), initial_gradings_[place],
                                                     parameters_.model.fracture, parameters_.breakage),
                     row);
    });
  }

  std::vector<double> RevMaterial::compute_fields(const PointId id) const
  {
    const auto row = fields_.begin() + static_cast<std::ptrdiff_t>(pool_.get_index(id) * n_columns);
    return {row, row + n_fields};
  }

  RevTotals RevMaterial::compute_totals() const
  {
    RevTotals totals;
    const std::size_t n_points = pool_.get_points().size();
    for (std::size_t i = 0; i < n_points; ++i)
      {
        const double *row = fields_.data() + i * n_columns;
        totals.grains += static_cast<std::uint64_t>(row[grains]);
        totals.cycles += static_cast<std::uint64_t>(row[cycles]);
        totals.broken_instant += static_cast<std::uint64_t>(row[broken_instant]);
        totals.broken_delayed += static_cast<std::uint64_t>(row[broken_delayed]);
        totals.void_ratio += row[void_ratio] / static_cast<double>(n_points);
        totals.void_ratio_with_fines += row[void_ratio_with_fines] / static_cast<double>(n_points);
        totals.n_lazy += row[error_bound] > 0. ? 1 : 0;
        totals.largest_error_bound = std::max(totals.largest_error_bound, row[error_bound]);
        totals.lazy = add(totals.lazy, LazyRev::read_tally({row + n_fields, LazyRev::n_tally_numbers}));
      }
    return totals;
  }

  dem::Profile RevMaterial::compute_local_profile() const
  {
    dem::Profile profile = departed_profile_;
    for (const PointId id : pool_.get_local_points())
      profile += get_local_rev(id).get_profile();
    return profile;
  }

  std::map<PointId, dealii::SymmetricTensor<2, 3>> RevMaterial::collect_stresses() const
  {
    constexpr std::size_t n_columns = dealii::SymmetricTensor<2, 3>::n_independent_components;
    const auto rows = pool_.collect(n_columns, [&](const PointId id, std::span<double> row) {
      const auto stress = points_.at(id).rev->compute_committed_stress();
      std::copy(stress.begin_raw(), stress.end_raw(), row.begin());
    });
    std::map<PointId, dealii::SymmetricTensor<2, 3>> stresses;
    for (std::size_t i = 0; i < pool_.get_points().size(); ++i)
      for (unsigned int m = 0; m < n_columns; ++m)
        stresses[pool_.get_points()[i]].access_raw_entry(m) = rows[i * n_columns + m];
    return stresses;
  }

  void RevMaterial::write_snapshots(const std::string &prefix, const std::string &suffix) const
  {
    pool_.agree([&]() {
      for (const PointId id : pool_.get_local_points())
        {
          const dem::Rev &rev = get_local_rev(id);
          const dem::RevState &state = rev.get_committed();
          dem::write_snapshot(fmt::format("{}_{}_{}.h5", prefix, id, suffix), state,
                              dem::list_contacts(state, rev.get_law()), {parameters_.model.identity.seed, id});
        }
    });
  }
} // namespace coupling

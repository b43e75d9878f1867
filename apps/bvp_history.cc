#include "apps/bvp_history.h"

#include <fmt/format.h>

#include <algorithm>

namespace apps
{
  namespace
  {
    void add_compression_positive(const dealii::SymmetricTensor<2, 3> &tensor, HistoryRow &row)
    {
      for (const auto &index : dem::tangent_index)
        row.add(-tensor[index[0]][index[1]]);
    }

    /** The fields of a point whose names speak of a void ratio. */
    std::vector<double> look_up_void_ratios(const fem::ConstitutiveModel &material, const fem::PointId id)
    {
      const std::vector<std::string> names = material.get_field_names();
      const std::vector<double> fields = material.compute_fields(id);
      std::vector<double> void_ratios;
      for (std::size_t i = 0; i < names.size(); ++i)
        if (names[i].starts_with("void ratio"))
          void_ratios.push_back(fields[i]);
      return void_ratios;
    }

    /** All Gauss points by their numbers, on every rank. */
    template <int dim>
    std::vector<ProbeState> collect_points(const fem::QuasiStaticProblem<dim> &problem)
    {
      constexpr unsigned int n_entries = 6;
      std::vector<double> rows;
      for (const fem::PointState &state : problem.compute_point_states())
        {
          rows.push_back(state.id);
          rows.insert(rows.end(), state.stress.begin_raw(), state.stress.end_raw());
          rows.insert(rows.end(), state.strain.begin_raw(), state.strain.end_raw());
        }
      rows = coupling::gather_rows(rows, problem.get_communicator());
      std::map<fem::PointId, ProbeState> states;
      for (std::size_t at = 0; at < rows.size(); at += 1 + 2 * n_entries)
        {
          const auto id = static_cast<fem::PointId>(rows[at]);
          states[id].name = fmt::format("point_{}", id);
          states[id].void_ratios = look_up_void_ratios(problem.get_material(), id);
          for (unsigned int m = 0; m < n_entries; ++m)
            {
              states[id].stress.access_raw_entry(m) = rows[at + 1 + m];
              states[id].strain.access_raw_entry(m) = rows[at + 1 + n_entries + m];
            }
        }
      std::vector<ProbeState> sorted;
      for (const auto &[id, state] : states)
        sorted.push_back(state);
      return sorted;
    }
  } // namespace

  template <int dim>
  std::vector<ProbeState> compute_probe_states(const fem::QuasiStaticProblem<dim> &problem, const BvpOutput &output)
  {
    std::vector<ProbeState> probes;
    for (const Probe &probe : output.probes)
      {
        const fem::PointState state = problem.compute_nearest_point_state(probe.position);
        probes.push_back(
            {probe.name, state.stress, state.strain, look_up_void_ratios(problem.get_material(), state.id)});
      }
    if (!probes.empty())
      return probes;
    const std::size_t n_points =
        problem.get_dof_handler().get_triangulation().n_global_active_cells() * problem.get_n_points_per_cell();
    return n_points <= largest_number_of_points_written ? collect_points(problem) : probes;
  }

  std::vector<std::string> name_bvp_columns(const std::vector<fem::BoundaryResponse> &boundaries,
                                            const std::vector<ProbeState> &probes)
  {
    std::vector<std::string> names = {"time_s",          "stage",          "step",          "newton_iterations",
                                      "rev_evaluations", "broken_instant", "broken_delayed"};
    const auto append = [&](const std::vector<std::string> &more) {
      names.insert(names.end(), more.begin(), more.end());
    };
    for (const fem::BoundaryResponse &boundary : boundaries)
      for (const char *column :
           {"force_x_N", "force_y_N", "force_z_N", "displacement_x_m", "displacement_y_m", "displacement_z_m"})
        names.push_back(boundary.name + "_" + column);
    for (const ProbeState &probe : probes)
      {
        append(name_tensor_columns(probe.name + "_stress", "_Pa"));
        append(name_tensor_columns(probe.name + "_strain", ""));
        if (!probe.void_ratios.empty())
          append({probe.name + "_void_ratio", probe.name + "_void_ratio_with_fines"});
      }
    append({"avalanche_rounds", "avalanche_evaluations", "residual_N", "reaction_N", "grains", "mean_void_ratio",
            "mean_void_ratio_with_fines", "lazy_revs", "largest_stress_error_bound_Pa", "rev_questions", "lazy_answers",
            "step_length_s", "step_bound", "step_fractures_a_rev", "step_largest_strain",
            "step_largest_stress_change"});
    return names;
  }

  HistoryRow make_bvp_row(const fem::StepReport &report, const coupling::RevTotals &totals,
                          const std::vector<ProbeState> &probes)
  {
    HistoryRow row;
    row.add(report.time).add(report.stage + 1).add(report.step).add(report.newton_iterations);
    row.add(report.evaluations + report.avalanche_evaluations);
    row.add(totals.broken_instant).add(totals.broken_delayed);
    for (const fem::BoundaryResponse &boundary : report.boundaries)
      {
        for (int axis = 0; axis < 3; ++axis)
          row.add(boundary.force[axis]);
        for (int axis = 0; axis < 3; ++axis)
          row.add(boundary.displacement[axis]);
      }
    for (const ProbeState &probe : probes)
      {
        add_compression_positive(probe.stress, row);
        add_compression_positive(probe.strain, row);
        for (const double void_ratio : probe.void_ratios)
          row.add(void_ratio);
      }
    row.add(report.avalanche_rounds).add(report.avalanche_evaluations).add(report.residual).add(report.reaction_norm);
    row.add(totals.grains).add(totals.void_ratio).add(totals.void_ratio_with_fines);
    row.add(totals.n_lazy).add(totals.largest_error_bound);
    row.add(totals.lazy.n_questions).add(totals.lazy.n_forecasts);
    row.add(report.length).add(static_cast<unsigned int>(report.bound)).add(report.effects.fractures);
    return row.add(report.effects.strain).add(report.effects.stress_change);
  }

  template std::vector<ProbeState> compute_probe_states(const fem::QuasiStaticProblem<2> &, const BvpOutput &);
  template std::vector<ProbeState> compute_probe_states(const fem::QuasiStaticProblem<3> &, const BvpOutput &);
} // namespace apps

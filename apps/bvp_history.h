#pragma once

#include "apps/bvp_case.h"
#include "apps/history_file.h"

#include "fem/step_report.h"

#include <string>
#include <vector>

namespace apps
{
  /** Stress, strain and void ratios of a place that is written at every step. */
  struct ProbeState
  {
    std::string name;
    dealii::SymmetricTensor<2, 3> stress; ///< [Pa], tension-positive
    dealii::SymmetricTensor<2, 3> strain; ///< [-], tension-positive
    std::vector<double> void_ratios;      ///< without and with fines [-]; empty for a material without grains
  };

  /** Gauss points up to this number are all written when nothing else is asked for. */
  inline constexpr std::size_t largest_number_of_points_written = 64;

  /** The places that a case asks for, as committed. Collective over the ranks of the mesh. */
  template <int dim>
  std::vector<ProbeState> compute_probe_states(const fem::QuasiStaticProblem<dim> &problem, const BvpOutput &output);

  /** Columns of history.csv of slowsand-bvp. @param first  boundaries and probes of any moment */
  std::vector<std::string> name_bvp_columns(const std::vector<fem::BoundaryResponse> &boundaries,
                                            const std::vector<ProbeState> &probes);

  /** A committed step as a row, compression-positive. */
  HistoryRow make_bvp_row(const fem::StepReport &report, const coupling::RevTotals &totals,
                          const std::vector<ProbeState> &probes);
} // namespace apps

#include "apps/pool_report.h"

#include <fmt/format.h>

namespace apps
{
  void add_pool_figures(const coupling::WorkTally &run, const coupling::WorkTally &creep, Summary &summary)
  {
    summary.figures["parallel efficiency of REV work [-]"] = run.compute_efficiency();
    summary.figures["parallel efficiency of REV work in creep [-]"] = creep.compute_efficiency();
    for (std::size_t rank = 0; rank < run.work_s.size(); ++rank)
      {
        summary.figures[fmt::format("REV work of rank {} [s of processor]", rank)] = run.work_s[rank];
        summary.figures[fmt::format("idle time of rank {} [s of processor]", rank)] = run.idle_s[rank];
        summary.figures[fmt::format("idle time of rank {} in creep [s of processor]", rank)] =
            creep.idle_s.empty() ? 0. : creep.idle_s[rank];
      }
    summary.figures["REVs that changed their rank"] = static_cast<double>(run.n_taken + run.n_migrated);
    summary.figures["REVs taken over by idle ranks"] = static_cast<double>(run.n_taken);
    summary.figures["sent with REVs [B]"] = static_cast<double>(run.bytes_migrated);
  }

  void add_lazy_figures(const coupling::LazyTally &tally, Summary &summary)
  {
    if (!(tally.n_questions > 0.))
      return;
    auto &figures = summary.figures;
    figures["questions to REVs, steps taken back not counted"] = tally.n_questions;
    figures["share of them answered from tangents [-]"] = tally.n_forecasts / tally.n_questions;
    figures["answers from tangents compared with grains"] = tally.n_checks;
    if (!(tally.n_checks > 0.))
      return;
    figures["share of these beyond the error's bound [-]"] = tally.n_exceeded / tally.n_checks;
    figures["largest error of an answer from a tangent [MPa]"] = 1e-6 * tally.largest_error;
    figures["mean error of answers from tangents [MPa]"] = 1e-6 * tally.sum_of_errors / tally.n_checks;
    figures["largest error of an answer from a tangent over the stress [-]"] = tally.largest_error_share;
    figures["mean error of answers from tangents over the stress [-]"] = tally.sum_of_error_shares / tally.n_checks;
  }

  std::string describe_pool(const coupling::WorkTally &run, const coupling::WorkTally &creep)
  {
    std::string text = fmt::format("REV work on {} ranks: efficiency {:.3f}, in creep {:.3f}; {} REVs changed their "
                                   "rank",
                                   run.work_s.size(), run.compute_efficiency(), creep.compute_efficiency(),
                                   run.n_taken + run.n_migrated);
    for (std::size_t rank = 0; rank < run.work_s.size(); ++rank)
      text += fmt::format("\n  rank {}: {:.2f} s of processor time in REVs, {:.2f} s idle", rank, run.work_s[rank],
                          run.idle_s[rank]);
    return text;
  }
} // namespace apps

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

#pragma once

#include "apps/run_folder.h"

#include "coupling/lazy_rev.h"
#include "coupling/work_tally.h"

#include <string>

namespace apps
{
  /** Figures of summary.json about how the ranks shared the REVs: whole run, and creep alone. */
  void add_pool_figures(const coupling::WorkTally &run, const coupling::WorkTally &creep, Summary &summary);

  /** Figures of how many answers came from tangents, and of what was wrong with them; none where no REV may be lazy. */
  void add_lazy_figures(const coupling::LazyTally &tally, Summary &summary);

  /** What add_pool_figures() adds as lines for people. */
  std::string describe_pool(const coupling::WorkTally &run, const coupling::WorkTally &creep);
} // namespace apps

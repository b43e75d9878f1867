#pragma once

#include "apps/run_folder.h"

#include "coupling/work_tally.h"

#include <string>

namespace apps
{
  /** Figures of summary.json about how the ranks shared the REVs: whole run, and creep alone. */
  void add_pool_figures(const coupling::WorkTally &run, const coupling::WorkTally &creep, Summary &summary);

  /** The same as lines for people. */
  std::string describe_pool(const coupling::WorkTally &run, const coupling::WorkTally &creep);
} // namespace apps

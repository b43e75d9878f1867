#pragma once

#include "apps/rev_history.h"

#include "dem/laboratory.h"

#include <string>

namespace apps
{
  /** All that a resumed run of slowsand-rev needs beside its parameters. */
  struct RevCheckpoint
  {
    dem::RevState state;
    dem::LaboratoryPosition position;
    RowCounts n_rows;                      ///< of the tables
    std::vector<double> initial_diameters; ///< of the packing, before anything broke [m]
  };

  /** Writes it as a snapshot with the position beside it, to a temporary name first, then renamed. Throws
   *  std::runtime_error with path and cause; the earlier checkpoint stays valid, and no temporary file is left. */
  void write_rev_checkpoint(const std::string &file, const dem::Rev &rev, const RevCheckpoint &checkpoint);

  /** Throws std::runtime_error naming file and dataset. */
  RevCheckpoint read_rev_checkpoint(const std::string &file);
} // namespace apps

#pragma once

#include "apps/rev_case.h"
#include "apps/run_folder.h"

namespace apps
{
  /**
   * Runs a programme of stages on one REV and writes its run folder; goes on from the checkpoint when the command line
   * says so.
   *
   * @return exit status: 0 finished, or ruptured in a creep; 1 the REV gave up (the state before is in checkpoint.h5)
   */
  int run_rev(const RevCase &rev_case, const CommandLine &line);
} // namespace apps

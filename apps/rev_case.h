#pragma once

#include "apps/rev_parameters.h"

#include "dem/breakage_measures.h"
#include "dem/laboratory.h"

#include <iosfwd>

namespace apps
{
  /** What a parameter file of slowsand-rev says. */
  struct RevCase
  {
    RevParameters rev;
    std::vector<dem::LaboratoryStage> stages;
    dem::LaboratoryRule laboratory;
    dem::BreakageScale breakage;
    double checkpoint_interval = 30.; ///< [s] of wall time

    std::string parameters; ///< all of them as used, a file that can be read again
  };

  /** Reads and checks a case. Throws BadInput. @param file  nothing given: all defaults, two stages */
  RevCase read_rev_case(const ParameterFile &file);
} // namespace apps

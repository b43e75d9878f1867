#pragma once

#include "apps/parameter_binder.h"

#include "dem/breakage_measures.h"
#include "dem/packing.h"
#include "dem/rev.h"

#include <string>

namespace apps
{
  /** What a parameter file says of a REV. */
  struct RevParameters
  {
    dem::RevModel model;
    dem::PackingRule packing;
    std::string packing_file;     ///< to start from; empty: generate one
    std::string grading = "NE34"; ///< as written: NE34, "d:passing, ...", or a CSV file
    std::uint64_t seed = 1;
  };

  /** Binds "Seed" and the sections Grains, Strength, Crack growth, Fracture, Motion, Equilibrium and Packing. */
  void bind_rev_parameters(ParameterBinder &binder, RevParameters &parameters);

  /** Binds "Breakage measures". */
  void bind_breakage(ParameterBinder &binder, dem::BreakageScale &scale);

  /**
   * What follows from the bound values: the grading, the seeds, and that values do not contradict one another. To be
   * called after ParameterBinder::read(). Throws BadInput.
   */
  void complete_rev_parameters(const ParameterBinder &binder, RevParameters &parameters);
} // namespace apps

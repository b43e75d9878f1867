#pragma once

#include "apps/parameter_binder.h"

#include "dem/laboratory.h"

#include <vector>

namespace apps
{
  /** Beside the law itself, what the file says of the growth of cracks. */
  struct CreepParameters
  {
    bool cracks_grow = true;
  };

  /** Binds "Creep law" with its sections "Rate process" and "Burgers". */
  void bind_creep_law(ParameterBinder &binder, dem::CreepLaw &law, CreepParameters &parameters);

  /** Cracks that do not grow are given no velocity. Throws BadInput where the law contradicts the rest of the case. */
  void complete_creep_law(const ParameterBinder &binder, const CreepParameters &parameters,
                          const std::vector<dem::LaboratoryStage> &stages, dem::RevModel &model);
} // namespace apps

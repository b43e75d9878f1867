#pragma once

#include "apps/parameter_binder.h"

#include "fem/loading_programme.h"

#include <string>
#include <vector>

namespace apps
{
  /** The targets of each stage as they are written: "top pressure: 21.7e6; outer displacement r: 0". */
  struct StageTexts
  {
    std::vector<std::string> targets;
    std::vector<std::string> releases, holds; ///< without values: "shaft displacement r; shaft displacement z"
  };

  /** Binds "Boundary conditions", as many as the file says there are. @param profiles  as they are written */
  void bind_conditions(const ParameterFile &file, ParameterBinder &binder,
                       std::vector<fem::BoundaryCondition> &conditions, std::vector<std::string> &profiles);

  /** Reads the profiles, and throws BadInput for one that is no function of position. */
  void complete_conditions(const ParameterBinder &binder, const std::vector<std::string> &profiles,
                           std::vector<fem::BoundaryCondition> &conditions);

  /** Binds "Loading", as many stages as the file says there are. */
  void bind_stages(const ParameterFile &file, ParameterBinder &binder, std::vector<fem::Stage> &stages,
                   StageTexts &texts);

  /** Reads the targets, and throws BadInput where stages and conditions contradict one another. */
  void complete_stages(const ParameterBinder &binder, const StageTexts &texts,
                       const std::vector<fem::BoundaryCondition> &conditions, std::vector<fem::Stage> &stages);
} // namespace apps

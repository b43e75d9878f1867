#pragma once

#include "dem/laboratory.h"

#include <stdexcept>

namespace dem
{
  /** A stage that contradicts itself or those before it; what() names the stage and says what is wrong. */
  struct StageContradiction : std::invalid_argument
  {
    StageContradiction(std::size_t number, std::string name_of_quantity, const std::string &message)
        : std::invalid_argument(message), stage(number), quantity(std::move(name_of_quantity))
    {}

    std::size_t stage;    ///< from 0
    std::string quantity; ///< of the stage, by the name that a parameter file gives it
  };

  /** Throws StageContradiction (a creep without duration, two targets, a share of a q_max that nobody looks for, shear
   * between rigid walls, ...); std::invalid_argument if there is no stage at all. */
  void check_programme(const std::vector<LaboratoryStage> &stages, CellKind kind = CellKind::periodic);
} // namespace dem

#pragma once

#include "dem/laboratory.h"

namespace dem
{
  /** What the cell is told to do once `position.share` of a stage's load is on. */
  CellControl compute_control(const LaboratoryStage &stage, const LaboratoryPosition &position, double share,
                              const RevState &baseline);

  /** Time left until the stage's next certain output or its end [s]. */
  double compute_time_to_output(const LaboratoryStage &stage, double time_in_stage);

  /** True for a stage whose load stays as it is. */
  bool is_held(const LaboratoryStage &stage);

  /** True for a search after which the REV stands where it stood before. */
  bool is_put_back(const LaboratoryStage &stage);

  /** Mean of the two lateral normal stresses [Pa], signed as the stress is. */
  double compute_lateral_stress(const Matrix &stress);

  /** q, axial less lateral stress in compression [Pa]: positive in triaxial compression. @param stress
   * tension-positive */
  double compute_deviator(const Matrix &stress);

  /** q at the end of a stage that goes to one [Pa]. */
  double compute_target_deviator(const LaboratoryStage &stage, const LaboratoryPosition &position);

  /** True for a triaxial stage, or one at constant p, that ends at a deviatoric stress and not at a strain. */
  bool is_to_deviator(const LaboratoryStage &stage);

  /** True for a load that ends at a stress. */
  bool is_to_stress(const LaboratoryStage &stage);

  /**
   * False where a stage strains axially at constant p and the mean stress is not yet what it was when the stage began:
   * the lateral stress has to be corrected by another equilibrium. @param tolerance  relative [-]
   */
  bool is_mean_stress_held(const LaboratoryStage &stage, const LaboratoryPosition &position, const RevState &state,
                           double tolerance);
} // namespace dem

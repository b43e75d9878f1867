#pragma once

#include "dem/laboratory.h"

#include <vector>

namespace dem::cases
{
  inline LaboratoryStage make_stage(const StageKind kind)
  {
    LaboratoryStage stage;
    stage.name = "test";
    stage.kind = kind;
    stage.n_increments = 6;
    return stage;
  }

  /** @param stress  [Pa] */
  inline LaboratoryStage make_isotropic(const double stress)
  {
    LaboratoryStage stage = make_stage(StageKind::isotropic);
    stage.stress = stress;
    return stage;
  }

  /** What came out of a programme, and where it stands. */
  struct ProgrammeRun
  {
    LaboratoryOutcome outcome = LaboratoryOutcome::finished;
    LaboratoryPosition position;
    std::vector<Observation> observations;
  };

  /** Goes on from a position for n committed steps (0: to the end). */
  inline void go_on(Rev &rev, const std::vector<LaboratoryStage> &stages, ProgrammeRun &run,
                    const std::size_t n_steps = 0, const LaboratoryRule &rule = {})
  {
    LaboratoryObserver observer;
    std::size_t n = 0;
    observer.observe = [&](const Observation &observation) { run.observations.push_back(observation); };
    observer.committed = [&](const LaboratoryPosition &, double) { return ++n == n_steps; };
    run.outcome = run_programme(rev, stages, rule, observer, run.position);
  }
} // namespace dem::cases

#pragma once

#include "dem/observation.h"
#include "dem/rev.h"

#include <array>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace dem
{
  /** What a stage does to the REV. Stresses that are not named are not controlled: the strain is held. */
  enum class StageKind
  {
    isotropic,       ///< three equal normal stresses to a pressure or a volumetric strain
    oedometric,      ///< axial stress or strain to a value, no lateral strain
    triaxial,        ///< axial strain or deviatoric stress to a value, lateral stresses held
    constant_p,      ///< the same with the mean stress held
    strength_search, ///< axial strain at held lateral stress until the deviatoric stress has passed its maximum
    creep,           ///< stresses held for a duration
    relaxation,      ///< strain held for a duration
    strain_path      ///< six strains to values
  };

  /** Which stresses a creep stage holds. */
  enum class HeldStress
  {
    axial,     ///< zz alone: oedometer
    all_normal ///< xx, yy and zz: triaxial
  };

  struct LaboratoryStage
  {
    std::string name;
    StageKind kind = StageKind::isotropic;
    double stress = 0.;             ///< pressure or axial stress at the end [Pa], compression-positive; 0: not given
    double axial_strain = 0.;       ///< at the end, logarithmic [-], compression-positive; 0: not given
    double volumetric_strain = 0.;  ///< isotropic: at the end, logarithmic [-], compression-positive; 0: not given
    double deviatoric_stress = 0.;  ///< triaxial, constant p: q at the end [Pa]; 0: not given
    double strength_share = 0.;     ///< or q at the end over q_max [-]; 0: not given
    double strength = 0.;           ///< q_max for that [Pa]; 0: that of the search before
    double strength_drop = 0.25;    ///< search: share of its maximum by which q has fallen at the end [-]
    bool goes_back = true;          ///< search: the REV is put back to where the search began
    Matrix strain = Matrix::Zero(); ///< strain path: at the end, logarithmic [-], compression-positive
    HeldStress held = HeldStress::axial;
    double duration = 0.;               ///< [s]; 0: a load without time
    unsigned int n_increments = 50;     ///< of a load
    bool is_geometric = true;           ///< stresses grow by equal factors instead of equal steps
    double first_output = 1.;           ///< creep, relaxation: first time written for certain [s]
    unsigned int points_per_decade = 4; ///< and how many after it
  };

  /** By which a rupture under held stress is known (docs/theory.md, section 6.3). */
  enum class RuptureCriterion
  {
    none,
    endless_avalanche, ///< an avalanche did not end within its rounds
    no_rest,           ///< strained without coming to rest
    large_strain,      ///< came to rest, but not before a strain that is no creep
    large_creep        ///< crept, bit by bit, further than a specimen that has not failed
  };

  /** Where a programme stands: with the REV's committed state all that a resumed run needs. */
  struct LaboratoryPosition
  {
    std::size_t stage = 0;
    double share = 0.;         ///< of the stage's load that is on
    double share_step = 0.;    ///< next one to try
    double time_in_stage = 0.; ///< [s]
    unsigned int n_cuts = 0;   ///< of the next batch
    Matrix stress_at_start = Matrix::Zero(), strain_at_start = Matrix::Zero();
    double strength = 0.;                  ///< q_max of the last search, so far [Pa]; 0: none
    double strain_at_strength = 0.;        ///< axial strain there, tension-positive [-]
    std::optional<RevState> before_search; ///< where a search that is under way goes back to

    // How the last attempt ended; a resumed run finds out anew.
    RestStatus last_rest = RestStatus::at_rest; ///< says why there was no equilibrium
    RuptureCriterion criterion = RuptureCriterion::none;
    double rupture_time = 0.; ///< [s]
  };

  struct LaboratoryRule
  {
    double smallest_share = 1. / 64.; ///< of an increment, below which it is not halved again
    std::size_t round_cap = 200;      ///< equilibria of one avalanche, beyond which it is a rupture
    double flow_strain = 0.05;        ///< of one dynamic computation, above which the REV flows [-]
    double rupture_strain = 0.15;     ///< of a triaxial creep, above which it has ruptured [-]
    double largest_strain = 0.5;      ///< of a stage that goes to a stress, above which it is not reached [-]
    double unstable_swing = 0.1;      ///< of a controlled stress to both sides, over its target: the servo's doing [-]
  };

  enum class LaboratoryOutcome
  {
    finished,
    no_equilibrium, ///< the smallest step found none
    ruptured,       ///< an avalanche did not end, or a REV under held stress flowed
    not_reached,    ///< the REV flows or has strained too far below the stress that is asked for
    collapsed,      ///< the cell has become too narrow for its grains
    servo_unstable, ///< a controlled stress swings about its target
    stopped         ///< the observer asked for it
  };

  /** What an attempt at a step cost, kept or taken back. */
  struct AttemptEffort
  {
    std::size_t stage = 0; ///< from 0
    bool is_committed = false;
    std::size_t n_equilibria = 0, n_cycles = 0;
  };

  struct LaboratoryObserver
  {
    std::function<void(const Observation &)> observe;     ///< committed observations, in order
    std::function<void(const DynamicRecord &)> disturbed; ///< committed dynamic computations, in order
    std::function<void(const AttemptEffort &)> attempted; ///< every attempt, those that are taken back as well
    /** After each committed step; true stops the programme. `fraction` is the share of the whole that is done. */
    std::function<bool(const LaboratoryPosition &, double fraction)> committed;
    std::function<void(std::size_t stage, bool is_end)> stage_edge;
  };

  /**
   * Runs a programme of stages on one REV: load in increments, each brought to equilibrium; off-DEM ageing between
   * fractures; avalanches as a sequence of equilibria; commit or roll back and halve (docs/theory.md, section 6).
   *
   * @param position  in: where to begin; out: where it ended, with the REV's committed state
   */
  LaboratoryOutcome run_programme(Rev &rev, const std::vector<LaboratoryStage> &stages, const LaboratoryRule &rule,
                                  const LaboratoryObserver &observer, LaboratoryPosition &position);
} // namespace dem

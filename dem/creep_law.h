#pragma once

#include "dem/burgers_contact.h"
#include "dem/rate_process.h"

namespace dem
{
  /** What makes a REV creep beside the growth of cracks, or in its stead. */
  enum class CreepKind
  {
    delayed_fracture, ///< cracks alone, in jumps between fractures (time-to-fracture paper)
    scaled_time,      ///< cracks alone, in every cycle of one long computation whose time is scaled
    rate_process,     ///< contacts slide as a rate process (Kuhn and Mitchell 1993)
    burgers           ///< contacts are Burgers bodies
  };

  /** How a REV creeps (docs/theory.md, section 6.4). */
  struct CreepLaw
  {
    CreepKind kind = CreepKind::delayed_fracture;
    double time_scale = 1.; ///< scaled time: of creep over that of the computation, [s] a cycle or [-]
    /** Contacts: bound on a step, the mean change of a contact's force at held grains over the mean normal force [-].
     */
    double step_share = 0.005;
    RateProcessLaw rate_process;
    BurgersLaw burgers;

    /** True where contacts creep between equilibria. */
    bool has_contact_creep() const { return kind == CreepKind::rate_process || kind == CreepKind::burgers; }
  };
} // namespace dem

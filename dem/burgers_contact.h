#pragma once

#include "dem/vector.h"

#include <cmath>

namespace dem
{
  /** Kelvin element and dashpot of one direction, in series with the contact's own spring (docs/theory.md Eq. 6.10). */
  struct BurgersElements
  {
    double viscosity = 1e12;         ///< Cm of the dashpot in series (Maxwell) [N s/m]
    double retarded_stiffness = 1e6; ///< Kk of the Kelvin element [N/m]
    double retarded_viscosity = 1e9; ///< Ck of the Kelvin element [N s/m]
  };

  /** A contact that creeps both ways (Burgers; contacts of Wang et al. 2014). All defaults are choices. */
  struct BurgersLaw
  {
    BurgersElements normal, shear;
  };

  /** What has crept in one direction: a number along the normal, a vector in the contact plane [m]. */
  template <typename Value>
  struct BurgersDisplacement
  {
    Value viscous;  ///< of the dashpot in series: never comes back
    Value retarded; ///< of the Kelvin element
  };

  /**
   * By how much both parts grow in dt at a held force, in closed form (docs/theory.md Eq. 6.11-6.12).
   *
   * @param force [N]   @param retarded  of the Kelvin element so far [m]   @param dt [s]
   */
  template <typename Value>
  BurgersDisplacement<Value> compute_creep(const BurgersElements &elements, const Value &force, const Value &retarded,
                                           const double dt)
  {
    const double share = -std::expm1(-dt * elements.retarded_stiffness / elements.retarded_viscosity);
    return {force * (dt / elements.viscosity), (force / elements.retarded_stiffness - retarded) * share};
  }
} // namespace dem

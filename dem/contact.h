#pragma once

#include "dem/vector.h"

#include <cstdint>

namespace dem
{
  /** A touching pair, grains or a grain and a wall (dem/walls.h), with all that is known of it: what measures and
   * writers read. */
  struct Contact
  {
    std::uint32_t a = 0, b = 0;   ///< places in the arrays of the grains; b may stand for a wall
    Vector branch;                ///< x_b - x_a of the touching images [m]; for a wall x_b is its point nearest to a
    Vector normal;                ///< branch / |branch|, from a to b
    Vector shear_force;           ///< t, acts on a [N]
    double overlap = 0.;          ///< d that the spring feels [m]
    double crept_overlap = 0.;    ///< of a Burgers contact, beside that [m]
    double effective_radius = 0.; ///< R* [m]
    double normal_force = 0.;     ///< N >= 0 [N]
    double normal_stiffness = 0.; ///< kn [N/m]
    double shear_stiffness = 0.;  ///< kt [N/m], also of a sliding contact
    bool is_sliding = false;
  };

  /** Force on grain a [N]: -N n + t. Grain b feels the opposite. */
  inline Vector compute_force_on_a(const Contact &contact)
  {
    return contact.shear_force - contact.normal_force * contact.normal;
  }
} // namespace dem

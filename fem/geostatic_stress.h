#pragma once

#include <deal.II/base/point.h>
#include <deal.II/base/symmetric_tensor.h>

namespace fem
{
  /** Ground at rest under its own weight and a load on its level surface (docs/theory.md, section 10). */
  struct GeostaticParameters
  {
    double unit_weight = 0.;   ///< [N/m^3], >= 0
    double lateral_ratio = 1.; ///< K0, horizontal over vertical stress [-], > 0
    double surcharge = 0.;     ///< pressure on the surface [Pa], >= 0
    double surface_level = 0.; ///< z of the surface [m]
  };

  /** Stress [Pa], tension-positive, at a place: sigma_zz = -(q + gamma (z_s - z)), sigma_xx = sigma_yy = K0 sigma_zz.
   */
  inline dealii::SymmetricTensor<2, 3> compute_geostatic_stress(const GeostaticParameters &ground,
                                                                const dealii::Point<3> &place)
  {
    dealii::SymmetricTensor<2, 3> stress;
    stress[2][2] = -(ground.surcharge + ground.unit_weight * (ground.surface_level - place[2]));
    stress[0][0] = stress[1][1] = ground.lateral_ratio * stress[2][2];
    return stress;
  }
} // namespace fem

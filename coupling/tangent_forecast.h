#pragma once

#include "dem/rev_state.h"

#include <deal.II/base/symmetric_tensor.h>

namespace coupling
{
  /** What a tangent says of a strain that its REV has not been asked about, in the REV's axes. */
  struct Forecast
  {
    dealii::SymmetricTensor<2, 3> stress; ///< s + c : eps [Pa], tension-positive
    double change = 0.;                   ///< norm of c : eps [Pa]
  };

  /**
   * The stress of a REV that is strained by a little more than its grains know of (docs/theory.md, Eq. 8.1).
   *
   * @param state    at rest
   * @param tangent  of that state, in the REV's axes [Pa]
   * @param stretch  since that state, close to one; eps = sym(stretch) - 1
   */
  Forecast compute_forecast(const dem::RevState &state, const dealii::SymmetricTensor<4, 3> &tangent,
                            const dem::Matrix &stretch);

  /** Bound of a forecast's error [Pa] (docs/theory.md, Eq. 8.3): its whole change, or what the last comparison with
   *  grains foresees of it if that is more. @param deviation_share  the last measured one [-] */
  double compute_error_bound(const Forecast &forecast, double deviation_share);

  /** Share of a forecast's change by which the grains' answer at the same stretch differs from it [-] (docs/theory.md,
   *  Eq. 8.2); 0 where nothing changes. @param stress  the grains' answer [Pa] */
  double compute_deviation_share(const Forecast &forecast, const dealii::SymmetricTensor<2, 3> &stress);
} // namespace coupling

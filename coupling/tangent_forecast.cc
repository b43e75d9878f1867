#include "coupling/tangent_forecast.h"

#include "coupling/tensor_conversion.h"

#include <algorithm>

namespace coupling
{
  Forecast compute_forecast(const dem::RevState &state, const dealii::SymmetricTensor<4, 3> &tangent,
                            const dem::Matrix &stretch)
  {
    const dealii::SymmetricTensor<2, 3> strain =
        to_symmetric_tensor(dem::Matrix(stretch - dem::Matrix::Identity())); // its symmetric part
    const dealii::SymmetricTensor<2, 3> change = tangent * strain;
    return {to_symmetric_tensor(state.stress) + change, change.norm()};
  }

  double compute_error_bound(const Forecast &forecast, const double deviation_share)
  {
    return std::max(1., deviation_share) * forecast.change;
  }

  double compute_deviation_share(const Forecast &forecast, const dealii::SymmetricTensor<2, 3> &stress)
  {
    return forecast.change > 0. ? (stress - forecast.stress).norm() / forecast.change : 0.;
  }
} // namespace coupling

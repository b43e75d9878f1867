#pragma once

#include "coupling/rev_failure.h"

#include "fem/constitutive_model.h"
#include "fem/kinematics.h"

#include <optional>

namespace coupling
{
  /** A Gauss point's deformation increment as its REV sees it. */
  struct RevIncrement
  {
    dem::Matrix stretch;  ///< symmetric, in the REV's axes [-]
    dem::Matrix rotation; ///< Q after the increment
  };

  /**
   * Splits an increment since the baseline: dF = dR dU, stretch Q0^T dU Q0, Q = dR Q0. Small kinematics: dU = sym(dF),
   * dR = 1.
   *
   * @param baseline_rotation  Q0. @pre det dF > 0
   */
  RevIncrement split_increment(const dealii::Tensor<2, 3> &deformation_increment, const dem::Matrix &baseline_rotation,
                               fem::Kinematics kinematics);

  /** How a Gauss point asks its REV. */
  struct PointRule
  {
    fem::Kinematics kinematics = fem::Kinematics::finite;
    dem::TangentKind tangent = dem::TangentKind::condensed;
    double largest_stretch = 0.05; ///< largest |dU - 1| that is tried [-]; beyond it: step_too_large, no cycle is run
    double lazy_tolerance = 0.; ///< bound of the error of an answer from the tangent, over the stress [-]; 0: no such
                                ///< answer (lazy_rev.h)

    bool is_lazy() const { return lazy_tolerance > 0.; }
  };

  /** The increment that a REV is asked about, or nothing where it is too large to be tried. @param baseline_rotation Q0
   */
  std::optional<RevIncrement> find_increment(const dealii::Tensor<2, 3> &deformation_increment,
                                             const dem::Matrix &baseline_rotation, const PointRule &rule);

  /** What a REV answered, in the solver's axes, and how it came to rest. */
  struct PointAnswer
  {
    fem::PointResponse response;
    RevQuestion question;
    AgeingReport report;
  };

  /**
   * Asks the REV of a point: its trial state is the answer, its baseline does not change.
   *
   * With the REV's stress s and tangent c in its own axes: stress = Q sym(s) Q^T, tangent = c turned by Q. Where the
   * network's tangent cannot be factorised, the affine one stands in.
   */
  PointAnswer evaluate(dem::Rev &rev, const dealii::Tensor<2, 3> &deformation_increment, bool with_tangent,
                       const PointRule &rule);

  /** The same for an increment in the REV's own axes. */
  PointAnswer evaluate(dem::Rev &rev, const RevIncrement &increment, bool with_tangent, const PointRule &rule);

  /** Tangent of one of a REV's states in its own axes [Pa]; the affine one where the network's cannot be factorised. */
  dealii::SymmetricTensor<4, 3> compute_tangent(const dem::Rev &rev, const dem::RevState &state, dem::TangentKind kind);
} // namespace coupling

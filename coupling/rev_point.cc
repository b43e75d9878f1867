#include "coupling/rev_point.h"

#include "coupling/tensor_conversion.h"

#include "dem/stopwatch.h"

namespace coupling
{
  namespace
  {
    bool is_too_large(const dealii::Tensor<2, 3> &deformation_increment)
    {
      return !(dealii::determinant(deformation_increment) > 0.);
    }
  } // namespace

  RevIncrement split_increment(const dealii::Tensor<2, 3> &deformation_increment, const dem::Matrix &baseline_rotation,
                               const fem::Kinematics kinematics)
  {
    const dem::Matrix increment = to_matrix(deformation_increment);
    dem::Matrix turn = dem::Matrix::Identity();
    if (kinematics == fem::Kinematics::finite)
      turn = to_matrix(fem::decompose_polar(deformation_increment).rotation);
    const dem::Matrix unrotated = turn.transpose() * increment;
    // The strain alone is turned, so that no strain stays none to the last bit.
    const dem::Matrix strain = 0.5 * (unrotated + unrotated.transpose()) - dem::Matrix::Identity();
    const dem::Matrix turned = baseline_rotation.transpose() * strain * baseline_rotation;
    return {dem::Matrix::Identity() + 0.5 * (turned + turned.transpose()), turn * baseline_rotation};
  }

  std::optional<RevIncrement> find_increment(const dealii::Tensor<2, 3> &deformation_increment,
                                             const dem::Matrix &baseline_rotation, const PointRule &rule)
  {
    if (is_too_large(deformation_increment))
      return {};
    const RevIncrement increment = split_increment(deformation_increment, baseline_rotation, rule.kinematics);
    if (!((increment.stretch - dem::Matrix::Identity()).cwiseAbs().maxCoeff() <= rule.largest_stretch))
      return {};
    return increment;
  }

  dealii::SymmetricTensor<4, 3> compute_tangent(const dem::Rev &rev, const dem::RevState &state,
                                                const dem::TangentKind kind)
  {
    dem::Tangent tangent = rev.compute_tangent(state, kind);
    if (!tangent.allFinite())
      tangent = rev.compute_tangent(state, dem::TangentKind::affine);
    return to_tensor(tangent);
  }

  PointAnswer evaluate(dem::Rev &rev, const dealii::Tensor<2, 3> &deformation_increment, const bool with_tangent,
                       const PointRule &rule)
  {
    const auto increment = find_increment(deformation_increment, rev.get_baseline().rotation, rule);
    if (increment)
      return evaluate(rev, *increment, with_tangent, rule);
    PointAnswer refusal;
    refusal.response.status = fem::Status::step_too_large;
    return refusal;
  }

  PointAnswer evaluate(dem::Rev &rev, const RevIncrement &increment, const bool with_tangent, const PointRule &rule)
  {
    const dem::Clock::time_point start = dem::Clock::now();
    PointAnswer answer;
    fem::PointResponse &response = answer.response;
    answer.question.stretch = increment.stretch;
    answer.report.rest = rev.deform(increment.stretch);
    rev.set_trial_rotation(increment.rotation);
    response.status = answer.report.has_failed() ? fem::Status::failed : fem::Status::ok;
    response.unbalanced_ratio = answer.report.rest.unbalanced_ratio;
    if (response.status == fem::Status::ok)
      {
        const dem::Matrix &q = increment.rotation;
        response.stress = to_symmetric_tensor(q * rev.peek_trial().stress * q.transpose());
        if (with_tangent)
          response.tangent = rotate(compute_tangent(rev, rev.peek_trial(), rule.tangent), q);
      }
    response.cost_s = dem::measure_seconds_since(start);
    return answer;
  }
} // namespace coupling

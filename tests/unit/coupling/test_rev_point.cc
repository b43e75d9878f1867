// Law: turning what is done to a point turns its answer and changes nothing else: evaluate(R dF) = R evaluate(dF) R^T.

#include "coupling/rev_point.h"
#include "coupling/tensor_conversion.h"

#include "tests/unit/coupling/rev_sample.h"

#include <gtest/gtest.h>

namespace
{
  /** A stretch whose axes are neither the cell's nor the rotation's. */
  dem::Matrix make_stretch()
  {
    dem::Matrix stretch;
    stretch << -3e-4, 1.1e-4, 0.7e-4, 1.1e-4, -1e-4, -0.6e-4, 0.7e-4, -0.6e-4, -5e-4;
    return dem::Matrix::Identity() + stretch;
  }

  dem::Matrix make_second_stretch()
  {
    dem::Matrix stretch;
    stretch << 1e-4, -0.4e-4, 1.2e-4, -0.4e-4, -2.5e-4, 0.9e-4, 1.2e-4, 0.9e-4, -0.7e-4;
    return dem::Matrix::Identity() + stretch;
  }

  dem::Matrix make_other_rotation()
  {
    return Eigen::AngleAxisd(0.4, dem::Vector(0.3, 0.1, 1.).normalized()).toRotationMatrix();
  }

  fem::PointResponse evaluate(dem::Rev &rev, const dem::Matrix &increment)
  {
    return coupling::evaluate(rev, coupling::to_tensor(increment), true, {}).response;
  }

  void expect_turned(const fem::PointResponse &turned, const fem::PointResponse &plain, const dem::Matrix &q,
                     const double tangent_tolerance)
  {
    const auto stress = coupling::to_symmetric_tensor(q * coupling::to_matrix(plain.stress) * q.transpose());
    // What is left in the stress is the rounding of some products of rotations.
    EXPECT_LT((turned.stress - stress).norm(), 1e-13 * stress.norm());
    const auto tangent = coupling::rotate(plain.tangent, q);
    EXPECT_LT((turned.tangent - tangent).norm(), tangent_tolerance * tangent.norm());
  }

  class Objectivity : public testing::TestWithParam<bool>
  {};
} // namespace

TEST_P(Objectivity, StressAndTangentTurnWithTheIncrement)
{
  dem::Rev rev = rev_sample::make_rev(rev_sample::make_model(GetParam()));
  // A baseline that is turned already, about another axis: the order of rotations shows only then.
  evaluate(rev, make_other_rotation() * make_stretch());
  rev.accept();
  const auto plain = evaluate(rev, make_stretch());
  ASSERT_EQ(plain.status, fem::Status::ok);
  for (const double degrees : {1., 17., 60.})
    expect_turned(evaluate(rev, rev_sample::make_rotation(degrees) * make_stretch()), plain,
                  rev_sample::make_rotation(degrees),
                  1e-13); // the REV is asked for the same bits: what is left is the rounding of products of rotations
}

// Everything turned: the first increment ends in turned axes, and the second is the same one seen from there.
TEST_P(Objectivity, HistoryTurnsAsAWhole)
{
  dem::Rev still = rev_sample::make_rev(rev_sample::make_model(GetParam()));
  evaluate(still, make_stretch());
  still.accept();
  const dem::Matrix second = make_other_rotation() * make_second_stretch();
  const auto plain = evaluate(still, second);
  ASSERT_EQ(plain.status, fem::Status::ok);
  for (const double degrees : {17., 60.})
    {
      const dem::Matrix q = rev_sample::make_rotation(degrees);
      dem::Rev turned = rev_sample::make_rev(rev_sample::make_model(GetParam()));
      evaluate(turned, q * make_stretch());
      turned.accept();
      // Increments that differ in their last bits: the stress does no more, but where grains turn freely the matrix of
      // the contacts is badly conditioned and makes up to 5e-11 of that in the tangent. A wrong rotation is worth 1e-2.
      expect_turned(evaluate(turned, q * second * q.transpose()), plain, q, 1e-9);
    }
}

INSTANTIATE_TEST_SUITE_P(RotationOfGrains, Objectivity, testing::Values(false, true));

TEST(RevPoint, NoIncrementRunsNoCycleAndKeepsEveryBit)
{
  dem::Rev rev = rev_sample::make_rev(rev_sample::make_model());
  const auto answer = coupling::evaluate(rev, coupling::to_tensor(dem::Matrix(dem::Matrix::Identity())), false, {});
  EXPECT_EQ(answer.report.rest.n_cycles, 0u);
  EXPECT_TRUE(answer.response.stress == coupling::to_symmetric_tensor(rev.get_baseline().stress));
  EXPECT_EQ(dem::serialise(rev.get_trial()), dem::serialise(rev.get_baseline()));
}

TEST(RevPoint, RotationAloneRunsNoCycle)
{
  dem::Rev rev = rev_sample::make_rev(rev_sample::make_model());
  const dem::Matrix q = rev_sample::make_rotation(33.);
  const auto answer = coupling::evaluate(rev, coupling::to_tensor(q), false, {});
  EXPECT_EQ(answer.report.rest.n_cycles, 0u);
  const auto expected = coupling::to_symmetric_tensor(q * rev.get_baseline().stress * q.transpose());
  EXPECT_LT((answer.response.stress - expected).norm(), 1e-14 * expected.norm()); // rounding of dR
}

TEST(RevPoint, TangentForetellsTheStressOfASmallIncrement)
{
  dem::RevModel model = rev_sample::make_model();
  model.equilibrium.unbalanced_ratio = 1e-8; // rest must be finer than what is compared
  model.material.friction = 5.;              // nothing slides: the answer is smooth
  dem::Rev rev = rev_sample::make_rev(model);
  rev.relax();
  const auto identity = coupling::to_tensor(dem::Matrix(dem::Matrix::Identity()));
  const auto start = coupling::evaluate(rev, identity, true, {}).response;
  const dem::Matrix strain = 1e-2 * (make_stretch() - dem::Matrix::Identity());
  const auto end =
      coupling::evaluate(rev, coupling::to_tensor(dem::Matrix(dem::Matrix::Identity() + strain)), false, {}).response;
  const auto foretold = start.tangent * coupling::to_symmetric_tensor(strain);
  // Strains of 5e-6 over contacts of overlap near 1e-3: stiffness changes by about 1 % on the way.
  EXPECT_LT((end.stress - start.stress - foretold).norm(), 0.02 * foretold.norm());
}

TEST(RevPoint, AbsurdIncrementIsRefusedWithoutACycle)
{
  dem::Rev rev = rev_sample::make_rev(rev_sample::make_model());
  dem::Matrix inverted = dem::Matrix::Identity();
  inverted(2, 2) = -0.1;
  const dem::Matrix large = 1.2 * dem::Matrix::Identity();
  for (const dem::Matrix &increment : {inverted, large})
    EXPECT_EQ(coupling::evaluate(rev, coupling::to_tensor(increment), false, {}).response.status,
              fem::Status::step_too_large);
}

// Law: a tensor is the same thing in both libraries, whatever order they keep its entries in.

#include "coupling/tensor_conversion.h"

#include "tests/unit/coupling/rev_sample.h"

#include <gtest/gtest.h>

namespace
{
  // Every entry its own number: a swapped pair cannot hide.
  dem::Tangent make_tangent()
  {
    dem::Tangent tangent;
    for (int m = 0; m < 6; ++m)
      for (int n = 0; n < 6; ++n)
        tangent(m, n) = 10. * (m + 1) + n;
    return tangent;
  }

  dealii::SymmetricTensor<2, 3> make_strain()
  {
    dealii::SymmetricTensor<2, 3> strain;
    for (int m = 0; m < 6; ++m)
      strain[dem::tangent_index[m][0]][dem::tangent_index[m][1]] = 0.3 + m * m;
    return strain;
  }
} // namespace

TEST(TensorConversion, MatrixAndBackIsTheSame)
{
  dem::Matrix matrix;
  matrix << 1., 2., 3., 4., 5., 6., 7., 8., 9.;
  EXPECT_EQ(coupling::to_tensor(matrix)[0][2], 3.);
  EXPECT_EQ(coupling::to_tensor(matrix)[2][0], 7.);
  EXPECT_TRUE(coupling::to_matrix(coupling::to_tensor(matrix)) == matrix);
  EXPECT_EQ(coupling::to_symmetric_tensor(matrix)[0][2], 5.);
}

// A strain of the tensor's kind meets each shear column twice, as eps_kl and eps_lk.
TEST(TensorConversion, TangentTimesStrainIsTheSameInBoth)
{
  const auto stress = coupling::to_tensor(make_tangent()) * make_strain();
  for (int m = 0; m < 6; ++m)
    {
      double expected = 0.;
      for (int n = 0; n < 6; ++n)
        expected += (n < 3 ? 1. : 2.) * make_tangent()(m, n) *
                    make_strain()[dem::tangent_index[n][0]][dem::tangent_index[n][1]];
      // Sums of six products near 1e3: rounding is below 1e-12 of them.
      EXPECT_NEAR(stress[dem::tangent_index[m][0]][dem::tangent_index[m][1]], expected, 1e-12 * std::abs(expected))
          << m;
    }
}

TEST(TensorConversion, TurnedTangentAnswersTurnedStrainWithTurnedStress)
{
  const dem::Matrix q = rev_sample::make_rotation(40.);
  const auto tangent = coupling::to_tensor(make_tangent());
  const auto turn = [&](const dealii::SymmetricTensor<2, 3> &tensor) {
    return coupling::to_symmetric_tensor(q * coupling::to_matrix(tensor) * q.transpose());
  };
  const auto left = coupling::rotate(tangent, q) * turn(make_strain());
  const auto right = turn(tangent * make_strain());
  EXPECT_LT((left - right).norm(), 1e-12 * right.norm()); // rounding of 3^4 products
}

#include "dem/cell.h"

#include <Eigen/Geometry>

#include <cmath>
#include <gtest/gtest.h>
#include <limits>
#include <random>

using dem::Cell;
using dem::Matrix;
using dem::Vector;

namespace
{
  Matrix make_rotation(const double angle, const Vector &axis)
  {
    return Eigen::AngleAxisd(angle, axis.normalized()).toRotationMatrix();
  }

  Matrix diagonal(const double x, const double y, const double z)
  {
    return Vector(x, y, z).asDiagonal();
  }

  double largest_lean(const Matrix &edges)
  {
    double lean = 0.;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j)
        if (i != j)
          lean = std::max(lean, std::abs(edges.col(i).dot(edges.col(j))) / edges.col(j).squaredNorm());
    return lean;
  }
} // namespace

// The width between opposite faces is volume over face area: simple shear leaves the sheared faces' distance, narrows
// the other by cos of the angle.
TEST(Cell, NarrowestWidthOfASheared)
{
  Cell cell;
  cell.edges = diagonal(2., 3., 4.);
  EXPECT_DOUBLE_EQ(compute_narrowest_width(cell), 2.);
  Matrix shear = Matrix::Identity();
  shear(0, 1) = 0.75; // the x faces now stand at atan 0.75 = acos 0.8
  cell.deform(shear);
  EXPECT_NEAR(compute_narrowest_width(cell), 2. * 0.8, 1e-15); // rounding of a few products
}

// ln U of F = R U does not see R, and is the logarithm of the principal stretches.
TEST(Cell, LogarithmicStrainOfARotatedStretch)
{
  const Matrix axes = make_rotation(0.7, {1., -2., 0.5});
  const Matrix stretch = axes * diagonal(0.6, 1.1, 1.7) * axes.transpose();
  const Matrix expected = axes * diagonal(std::log(0.6), std::log(1.1), std::log(1.7)) * axes.transpose();
  const Matrix strain = dem::compute_logarithmic_strain(make_rotation(1.2, {0.3, 1., 2.}) * stretch);
  EXPECT_LT((strain - expected).norm(), 1e-14); // rounding, condition number 3
}

// A strain of 1e-6 keeps nine digits, alone or on top of a finite rotation.
TEST(Cell, LogarithmicStrainOfTinyStretch)
{
  const double e = 1e-6;
  const Matrix strain = dem::compute_logarithmic_strain(diagonal(1. - e, 1. + 2. * e, 1.));
  // The stretch itself is only known to 2^-53, hence 1.1e-16 on 1e-6.
  EXPECT_NEAR(strain(0, 0), std::log1p(-e), 2e-16);
  EXPECT_NEAR(strain(1, 1), std::log1p(2. * e), 3e-16);
  EXPECT_NEAR(strain(2, 2), 0., 1e-22);
  const Matrix turned =
      dem::compute_logarithmic_strain(make_rotation(0.5, {1., 1., 0.}) * diagonal(1. - e, 1. + 2. * e, 1.));
  EXPECT_NEAR(turned(0, 0), std::log1p(-e), 1e-15); // nine digits of 1e-6
  EXPECT_NEAR(turned(1, 1), std::log1p(2. * e), 1e-15);
}

// A stretch of 1 + 2^-30 is exact in binary: its logarithm then has all its digits, not the eight that 1 + x leaves.
TEST(Cell, LogarithmicStrainLosesNoDigits)
{
  const double e = 0x1p-30;
  const Matrix strain = dem::compute_logarithmic_strain(diagonal(1. + e, 1. - e, 1.));
  EXPECT_NEAR(strain(0, 0), std::log1p(e), 1e-15 * e); // a few roundings
  EXPECT_NEAR(strain(1, 1), std::log1p(-e), 1e-15 * e);
}

// A cell that leans by no more than half an edge is left as it is, at exactly half as well.
TEST(Cell, ReductionIsIdentityWhereNoneIsNeeded)
{
  Cell cell;
  EXPECT_EQ(compute_reduction(cell), Matrix::Identity());
  cell.edges.col(1) = Vector(0.5, 1., 0.);
  cell.edges.col(2) = Vector(-0.3, 0.2, 1.4);
  EXPECT_EQ(compute_reduction(cell), Matrix::Identity());
  cell.edges(0, 1) = std::numeric_limits<double>::quiet_NaN(); // ends, though no edge is the longest
  EXPECT_EQ(compute_reduction(cell), Matrix::Identity());
}

// The reduced cell spans the same lattice (whole numbers, determinant 1) and leans by no more than half.
TEST(Cell, ReductionSpansTheSameLattice)
{
  std::mt19937 random(5);
  std::uniform_real_distribution<double> shear(-4., 4.);
  for (int trial = 0; trial < 200; ++trial)
    {
      Cell cell;
      cell.edges = diagonal(1., 1.5, 0.8);
      cell.edges(0, 1) = shear(random);
      cell.edges(0, 2) = shear(random);
      cell.edges(1, 2) = shear(random);
      const Matrix change = compute_reduction(cell);
      EXPECT_EQ(change, change.array().round().matrix());
      EXPECT_NEAR(change.determinant(), 1., 1e-9); // a whole number
      Cell reduced = cell;
      reduced.edges = cell.edges * change;
      EXPECT_LE(largest_lean(reduced.edges), 0.5 + 1e-8); // 1e-9 of hysteresis, and rounding
      EXPECT_GE(compute_narrowest_width(reduced), compute_narrowest_width(cell) * (1. - 1e-12));
    }
}

// Edges that lie nearly in one plane, each leaning by less than half, are still replaced: the flat cell has a wide
// twin.
TEST(Cell, ReductionSeesFlatCells)
{
  Cell cell;
  cell.edges.col(0) = Vector(1., 0., 0.);
  cell.edges.col(1) = Vector(-0.499, 0.87, 0.);
  cell.edges.col(2) = Vector(-0.499, -0.86, 0.1);
  ASSERT_LT(largest_lean(cell.edges), 0.5);
  Cell reduced = cell;
  reduced.edges = cell.edges * compute_reduction(cell);
  EXPECT_LT(reduced.edges.colwise().norm().minCoeff(), 0.11); // the short diagonal, about 0.1, became an edge
  EXPECT_LE(largest_lean(reduced.edges), 0.5 + 1e-8);
}

#include "dem/splitting.h"

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace
{
  using namespace dem;

  // Coordinates near 1 and a dozen operations: 1e-12 leaves rounding a factor of a thousand.
  constexpr double rounding = 1e-12;

  std::vector<Vector> make_normals()
  {
    return {Vector::UnitX(), Vector::UnitY(), -Vector::UnitZ(), Vector(1., 1., 1.).normalized(),
            Vector(-0.3, 0.5, -0.8).normalized()};
  }

  double compute_gap(const Sibling &a, const Sibling &b)
  {
    return (a.centre - b.centre).norm() - a.radius - b.radius;
  }

  TEST(Splitting, SiblingsTouchTheShellAndTheirNeighboursAndOverlapNowhere)
  {
    // Law: all 14 are tangent to the shell from within; each of the 6 touches 4 of the 6 and 4 of the 8; each of the 8
    // touches 3 of the 6 and no other of the 8.
    for (const Vector &normal : make_normals())
      for (const double spin : {0., 0.7, 3.})
        {
          const auto siblings = compute_siblings(normal, spin);
          for (int i = 0; i < n_siblings; ++i)
            {
              EXPECT_NEAR(siblings[i].centre.norm() + siblings[i].radius, 1., rounding);
              int n_large = 0, n_small = 0;
              for (int j = 0; j < n_siblings; ++j)
                if (j != i)
                  {
                    const double gap = compute_gap(siblings[i], siblings[j]);
                    EXPECT_GT(gap, -rounding);
                    if (gap < rounding)
                      ++(j < 6 ? n_large : n_small);
                  }
              EXPECT_EQ(n_large, i < 6 ? 4 : 3);
              EXPECT_EQ(n_small, i < 6 ? 4 : 0);
            }
        }
  }

  TEST(Splitting, SizesAndDistancesAreThePublishedOnes)
  {
    // Law: 6 of (sqrt2 - 1) R at (2 - sqrt2) R; 8 of 0.230093 R at 0.769907 R. Tolerance for printed figures: half the
    // last digit.
    const auto siblings = compute_siblings(Vector::UnitZ(), 0.4);
    for (int i = 0; i < n_siblings; ++i)
      {
        EXPECT_NEAR(siblings[i].radius, i < 6 ? std::sqrt(2.) - 1. : 0.230093, i < 6 ? rounding : 5e-7);
        EXPECT_NEAR(siblings[i].centre.norm(), i < 6 ? 2. - std::sqrt(2.) : 0.769907, i < 6 ? rounding : 5e-7);
      }
  }

  TEST(Splitting, KeptVolumeIsThatOfTheSiblings)
  {
    // Law: the sum of the cubes of the radii, 0.523861 (half the last printed digit).
    double volume = 0.;
    for (const Sibling &sibling : compute_siblings(Vector::UnitX(), 0.))
      volume += std::pow(sibling.radius, 3);
    EXPECT_NEAR(compute_kept_volume_share(), volume, rounding);
    EXPECT_NEAR(compute_kept_volume_share(), 0.523861, 5e-7);
  }

  TEST(Splitting, FirstSiblingLiesOnTheNormal)
  {
    // Law: one of the six is turned onto the normal of the largest contact force, whatever the spin, and the centre of
    // mass stays where it was.
    for (const Vector &normal : make_normals())
      for (const double spin : {0., 1.1, 5.})
        {
          const auto siblings = compute_siblings(normal, spin);
          EXPECT_LT((siblings[0].centre - siblings[0].centre.norm() * normal).norm(), rounding);
          Vector moment = Vector::Zero();
          for (const Sibling &sibling : siblings)
            moment += std::pow(sibling.radius, 3) * sibling.centre;
          EXPECT_LT(moment.norm(), rounding);
        }
  }

  TEST(Splitting, SpinTurnsAllAboutTheNormal)
  {
    // Law: siblings at spin s are those at spin 0 turned by s about the normal (right-handed).
    for (const Vector &normal : make_normals())
      {
        const double spin = 0.9;
        const Matrix turn = Eigen::AngleAxisd(spin, normal).toRotationMatrix();
        const auto before = compute_siblings(normal, 0.);
        const auto after = compute_siblings(normal, spin);
        for (int i = 0; i < n_siblings; ++i)
          EXPECT_LT((after[i].centre - turn * before[i].centre).norm(), rounding);
      }
  }
} // namespace

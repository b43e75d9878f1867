#include "dem/splitting.h"

#include <Eigen/Geometry>

#include <cassert>
#include <cmath>
#include <numbers>

namespace dem
{
  namespace
  {
    // The six: tangent to the shell, |c| = 1 - r, and neighbours at right angles tangent to each other,
    // sqrt2 (1 - r) = 2 r.
    constexpr double large_radius = std::numbers::sqrt2 - 1.;
    constexpr double large_distance = 2. - std::numbers::sqrt2;

    // The eight: tangent to the shell, |c| = 1 - s, and to the three large ones around their diagonal,
    // (1 - s)^2 - 2 (1 - s) D/sqrt3 + D^2 = (s + r)^2. The squares of s cancel; r = 1 - D does the rest.
    constexpr double projected_distance = large_distance * std::numbers::inv_sqrt3;
    constexpr double small_radius = (large_distance - projected_distance) / (std::numbers::sqrt2 - projected_distance);
    constexpr double small_distance = 1. - small_radius;
  } // namespace

  std::array<Sibling, n_siblings> compute_siblings(const Vector &normal, double spin_angle)
  {
    assert(std::fabs(normal.squaredNorm() - 1.) < 1e-9);
    const Vector across = normal.unitOrthogonal();
    const Vector turned = std::cos(spin_angle) * across + std::sin(spin_angle) * normal.cross(across);
    Matrix axes; // columns: of the octahedron, as a right-handed frame
    axes << normal, turned, normal.cross(turned);

    std::array<Sibling, n_siblings> siblings;
    std::size_t next = 0;
    for (int axis = 0; axis < 3; ++axis)
      for (const double side : {1., -1.})
        siblings[next++] = {side * large_distance * axes.col(axis), large_radius};

    const double corner = small_distance * std::numbers::inv_sqrt3;
    for (const double x : {1., -1.})
      for (const double y : {1., -1.})
        for (const double z : {1., -1.})
          siblings[next++] = {axes * Vector(x * corner, y * corner, z * corner), small_radius};
    return siblings;
  }

  double compute_kept_volume_share()
  {
    return 6. * std::pow(large_radius, 3) + 8. * std::pow(small_radius, 3);
  }
} // namespace dem

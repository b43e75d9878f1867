#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <Eigen/LU>

#include <cstddef>

namespace dem
{
  using Vector = Eigen::Vector3d;
  using Matrix = Eigen::Matrix3d;

  /** Four numbers that travel together through the hot loops: one aligned load instead of four. */
  struct alignas(32) Row
  {
    double x = 0., y = 0., z = 0., w = 0.;
  };

  inline Vector to_vector(const Row &row)
  {
    return {row.x, row.y, row.z};
  }
} // namespace dem

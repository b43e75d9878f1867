#include "dem/cell.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <Eigen/LU>

#include <algorithm>
#include <cmath>

namespace dem
{
  namespace
  {
    // An edge that leans by exactly half is left alone, whatever its last bit says.
    constexpr double lean_tolerance = 1e-9;

    /** Takes whole neighbours off every edge that leans over them too far; true if anything changed. */
    bool straighten_pairs(Matrix &edges, Matrix &change)
    {
      bool is_changed = false;
      for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
          {
            if (i == j)
              continue;
            const double lean = edges.col(i).dot(edges.col(j)) / edges.col(j).squaredNorm();
            if (std::abs(lean) <= 0.5 + lean_tolerance)
              continue;
            edges.col(i) -= std::round(lean) * edges.col(j);
            change.col(i) -= std::round(lean) * change.col(j);
            is_changed = true;
          }
      return is_changed;
    }

    /**
     * Three edges can each lean by no more than half and still nearly lie in one plane; then a body diagonal is shorter
     * than the longest edge and takes its place. True if it did.
     */
    bool replace_longest_by_diagonal(Matrix &edges, Matrix &change)
    {
      int longest = 0;
      edges.colwise().squaredNorm().maxCoeff(&longest);
      const int i = (longest + 1) % 3, j = (longest + 2) % 3;
      const double limit = (1. - lean_tolerance) * edges.col(longest).squaredNorm();
      for (const double s : {-1., 1.})
        for (const double t : {-1., 1.})
          {
            const Vector diagonal = edges.col(longest) + s * edges.col(i) + t * edges.col(j);
            if (diagonal.squaredNorm() >= limit)
              continue;
            edges.col(longest) = diagonal;
            change.col(longest) += s * change.col(i) + t * change.col(j);
            return true;
          }
      return false;
    }
  } // namespace

  double compute_narrowest_width(const Cell &cell)
  {
    const Matrix &e = cell.edges;
    const double largest_face =
        std::max({e.col(0).cross(e.col(1)).norm(), e.col(1).cross(e.col(2)).norm(), e.col(2).cross(e.col(0)).norm()});
    return std::abs(cell.compute_volume()) / largest_face;
  }

  Matrix compute_logarithmic_strain(const Matrix &deformation)
  {
    // F^T F - I from F - I: the ones never meet the small strains, which keep all their digits.
    const Matrix gradient = deformation - Matrix::Identity();
    const Matrix excess = gradient + gradient.transpose() + gradient.transpose() * gradient;
    const Eigen::SelfAdjointEigenSolver<Matrix> principal(excess);
    const Vector strains = 0.5 * principal.eigenvalues().unaryExpr([](double x) { return std::log1p(x); });
    return principal.eigenvectors() * strains.asDiagonal() * principal.eigenvectors().transpose();
  }

  Matrix compute_reduction(const Cell &cell)
  {
    Matrix edges = cell.edges;
    Matrix change = Matrix::Identity();
    if (!edges.allFinite())
      return change;
    // Every change shortens an edge, so this ends.
    while (straighten_pairs(edges, change) || replace_longest_by_diagonal(edges, change))
      ;
    return change;
  }
} // namespace dem

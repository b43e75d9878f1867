#pragma once

#include "dem/vector.h"

#include <Eigen/LU>

namespace dem
{
  /** What bounds the grains. */
  enum class CellKind
  {
    periodic, ///< a parallelepiped among its images
    rigid     ///< a box along the axes between six walls
  };

  /** The volume that the grains fill. */
  struct Cell
  {
    CellKind kind = CellKind::periodic;
    Matrix edges = Matrix::Identity();       ///< columns are the edges [m]
    Matrix deformation = Matrix::Identity(); ///< deformation gradient since the strain was last set to zero [-]

    bool has_walls() const { return kind == CellKind::rigid; }

    double compute_volume() const { return edges.determinant(); } ///< [m3]

    /** Strains the cell and what lies in it: F <- f F. @pre with walls f is diagonal */
    void deform(const Matrix &f)
    {
      edges = (f * edges).eval();
      deformation = (f * deformation).eval();
    }
  };

  /** Distance between opposite faces, smallest of the three [m]. */
  double compute_narrowest_width(const Cell &cell);

  /** Logarithm of the stretch U of F = R U, tension-positive [-]. */
  Matrix compute_logarithmic_strain(const Matrix &deformation);

  /**
   * The integer change of basis after which no edge leans over a neighbour by more than half its length; identity for a
   * cell that needs none. edges <- edges M, fractions <- M^-1 fractions.
   */
  Matrix compute_reduction(const Cell &cell);
} // namespace dem

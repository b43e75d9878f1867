#pragma once

#include "fem/geometry.h"

#include <deal.II/base/mpi.h>

#include <vector>

namespace fem
{
  /** A prescribed displacement component of a node: initial position [m] and space axis. */
  struct PrescribedComponent
  {
    dealii::Point<3> position;
    unsigned int axis;
  };

  /**
   * Number of independent rigid motions of a body that prescribed components leave free: of 1 (along the axis) in
   * axisymmetry, of 3 in plane strain, of 6 in space. Anything but 0 makes the tangent matrix singular. Collective.
   *
   * @param components  those of this rank's nodes
   */
  unsigned int count_free_rigid_motions(Geometry geometry, const std::vector<PrescribedComponent> &components,
                                        MPI_Comm communicator);
} // namespace fem

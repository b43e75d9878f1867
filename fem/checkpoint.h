#pragma once

#include "fem/load_stepping.h"

#include <string>

namespace fem
{
  /**
   * Writes all that the future depends on: programme, displacements, secant memory and stresses under the group
   * "/macro", then the material's state. Collective over MPI_COMM_WORLD.
   *
   * Written as FILE.tmp, flushed and renamed: FILE is always whole. Throws std::runtime_error naming path and cause
   * (full disk, permissions) on every rank, the previous FILE untouched and FILE.tmp removed.
   */
  template <int dim>
  void write_checkpoint(const std::string &file, const QuasiStaticProblem<dim> &problem, const Progress &progress);

  /** Reads what write_checkpoint() wrote into problem and material, and returns the programme's progress. Throws
   *  std::runtime_error naming file and dataset for an unreadable, truncated or foreign file, one of another mesh or,
   * where the problem is distributed, of another number of ranks. */
  template <int dim>
  Progress read_checkpoint(const std::string &file, QuasiStaticProblem<dim> &problem);
} // namespace fem

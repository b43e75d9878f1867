#pragma once

#include "fem/load_stepping.h"

#include <string>
#include <vector>

namespace fem
{
  /**
   * Writes all that the future depends on: programme, displacements, secant memory and stresses under the group
   * "/macro", then the material's state. Collective over MPI_COMM_WORLD.
   *
   * Written as FILE.tmp, sealed (file_seal.h), flushed and renamed: FILE is always whole. Throws std::runtime_error
   * naming path and cause (full disk, permissions) on every rank, the previous FILE untouched and FILE.tmp removed.
   *
   * @param previous  name that the FILE of before gets; empty: it is replaced
   */
  template <int dim>
  void write_checkpoint(const std::string &file, const QuasiStaticProblem<dim> &problem, const Progress &progress,
                        const std::string &previous = "");

  /** Which checkpoint can be gone on from, and what is wrong with those that are newer. */
  struct CheckpointChoice
  {
    std::string file;
    std::vector<std::string> complaints; ///< each begins with a file's name
  };

  /**
   * The first of some files that is whole by its seal; one of before there were seals is taken if its format says so.
   * Collective over MPI_COMM_WORLD. Throws std::runtime_error with all complaints if none is whole.
   *
   * @param files  the newest first
   */
  CheckpointChoice choose_checkpoint(const std::vector<std::string> &files);

  /** Reads what write_checkpoint() wrote into problem and material, and returns the programme's progress. Throws
   *  std::runtime_error naming file and dataset for an unreadable, truncated or foreign file, one of another mesh or,
   * where the problem is distributed, of another number of ranks. */
  template <int dim>
  Progress read_checkpoint(const std::string &file, QuasiStaticProblem<dim> &problem);
} // namespace fem

#pragma once

#include "fem/constitutive_model.h"

#include <map>
#include <mpi.h>

namespace fem
{
  /** Where the states of a material's points lie in an HDF5 file: GROUP/point_ids and GROUP/NAME. */
  struct StateArchive
  {
    std::string group, name, unit;
    std::size_t n_numbers; ///< of a state
    MPI_Comm communicator; ///< its ranks share the points
  };

  /** Appends the states of all ranks, n_numbers each, to an existing file; rank 0 of MPI_COMM_WORLD writes. */
  void write_states(const std::string &file, const StateArchive &archive,
                    const std::map<PointId, std::vector<double>> &states);

  /** Reads states by the numbers of their points, also of points that this rank does not have. */
  std::map<PointId, std::vector<double>> read_states(const std::string &file, const StateArchive &archive);

  /** Throws std::runtime_error naming file and dataset unless all points of the problem were found. */
  void check_n_states(const std::string &file, const StateArchive &archive, std::size_t n_found, std::size_t n_points);
} // namespace fem

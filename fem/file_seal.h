#pragma once

#include <string>

namespace fem
{
  /**
   * Appends a seal to a finished file: its length and a checksum over every byte before the seal. HDF5 reads a sealed
   * file as before, since what stands behind its own end is no concern of its. Throws std::runtime_error with path and
   * cause.
   *
   * @pre nobody writes to the file afterwards
   */
  void seal_file(const std::string &file);

  enum class SealState
  {
    whole,   ///< each byte is the one that was sealed
    damaged, ///< some byte is not
    missing  ///< no seal at the end: never sealed, or truncated
  };

  /** Reads a whole file and compares. Throws std::runtime_error with path and cause if it cannot be read. */
  SealState check_seal(const std::string &file);
} // namespace fem

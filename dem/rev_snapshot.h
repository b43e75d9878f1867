#pragma once

#include "dem/contact.h"
#include "dem/rev_state.h"

#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace dem
{
  /** What a snapshot says beside the state. */
  struct SnapshotInfo
  {
    std::uint64_t seed = 0;
    std::uint64_t rev = 0; ///< number of the REV in its problem
  };

  /**
   * Writes a whole REV as an HDF5 file of format "slowsand-rev" (docs/user-guide.md lists groups, datasets, units), to
   * a temporary name first, flushed, then renamed. `contacts` are those of the state, in its order.
   * Throws std::runtime_error with path and cause (no space, no permission).
   */
  void write_snapshot(const std::string &file, const RevState &state, std::span<const Contact> contacts,
                      const SnapshotInfo &info);

  struct Snapshot
  {
    RevState state;
    SnapshotInfo info;
  };

  /** Reads it back, the same bits. Throws std::runtime_error naming file and dataset when it is missing, truncated,
   *  foreign, of another version, or inconsistent (lengths, non-positive radius, unknown grain id). */
  Snapshot read_snapshot(const std::string &file);

  /** A named array of bytes inside an HDF5 file, its groups created as needed; replaces one of that name. */
  void write_bytes(const std::string &file, const std::string &dataset, std::span<const std::byte> bytes);

  /** Throws std::runtime_error naming file and dataset. */
  std::vector<std::byte> read_bytes(const std::string &file, const std::string &dataset);

  /** True if the file holds something of that name. Throws std::runtime_error naming it if it cannot be read. */
  bool has_bytes(const std::string &file, const std::string &dataset);

  /** A text entry inside an HDF5 file, for what is small and should be readable (progress, parameters). */
  void write_text(const std::string &file, const std::string &dataset, const std::string &text);
  std::string read_text(const std::string &file, const std::string &dataset);

  /** Creates an empty HDF5 file, replacing one of that name. */
  void create_file(const std::string &file);

  /** Flushes a finished file to disk and gives it its name: what stood there before stays valid until then. */
  void publish_file(const std::string &temporary, const std::string &file);
} // namespace dem

#pragma once

#include "apps/command_line.h"

#include "dem/profile.h"

#include <cstdint>
#include <map>
#include <string>
#include <variant>

namespace apps
{
  /** What summary.json tells of a run. */
  struct Summary
  {
    std::string status = "running"; ///< "running", "finished" or why it ended
    std::uint64_t seed = 0;
    std::uint64_t grains = 0; ///< at the end, over all REVs
    std::uint64_t cycles = 0; ///< of all REVs
    std::uint64_t broken_instant = 0, broken_delayed = 0;
    unsigned int n_ranks = 1, n_threads = 1;
    std::map<std::string, double> wall_s;  ///< by part of the program [s]
    dem::Profile profile;                  ///< of the REVs, on the first rank
    double output_s = 0.;                  ///< wall time of writing files [s]
    std::map<std::string, double> figures; ///< what else is worth knowing, names with units
    /** What a programme found out (q_max, a rupture), beside the entries above; names with units. */
    std::map<std::string, std::variant<double, std::string>> findings;
  };

  /**
   * The folder that a run writes: names of its files, and the promise that no earlier run is lost by accident.
   *
   * Several ranks: all check(), then a barrier, then one of them prepare()s.
   */
  class RunFolder
  {
  public:
    explicit RunFolder(const CommandLine &line);

    /** Throws BadInput if the folder holds a run that nobody allowed to touch, or holds none to resume. */
    void check() const;

    /** Makes the folder, removing an old run if that is allowed, and writes parameters.prm. Throws std::runtime_error
     *  with path and cause. @param parameters  all of them as used */
    void prepare(const std::string &parameters) const;

    /** Writes summary.json anew, whole at any moment. */
    void write_summary(const Summary &summary) const;

    std::string get_path() const { return path_; }
    std::string get_file(const std::string &name) const { return path_ + "/" + name; }

    /** snapshots/NAME.h5; the folder is there. */
    std::string get_snapshot_file(const std::string &name) const;

  private:
    std::string path_;
    bool is_resumed_;
    bool may_overwrite_;
  };

  /** Writes a text to FILE.tmp and renames it. Throws std::runtime_error with path and cause. */
  void write_text_file(const std::string &file, const std::string &text);

  /** Largest resident memory of this process so far [bytes]. */
  std::uint64_t measure_peak_memory();
} // namespace apps

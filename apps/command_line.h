#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

namespace apps
{
  /** What a program is asked to do. */
  struct CommandLine
  {
    std::string case_file;              ///< CASE.prm or CASE.json
    std::vector<std::string> overrides; ///< "Section/Name=value"
    std::string output;                 ///< run folder, as given or runs/CASE
    bool is_resumed = false;            ///< goes on with the run in `output`
    bool may_overwrite = false;         ///< an old run in `output` may be removed
    bool only_template = false;         ///< print all parameters and stop
    bool only_check = false;            ///< read the parameters and stop
    bool is_quiet = false;
    unsigned int n_threads = 1;

    bool is_done = false; ///< help or version has been printed: nothing is left to do
  };

  /**
   * Reads the options that all programs share. With --resume DIR and no case file, the case is DIR/parameters.prm.
   * Throws BadInput for anything that cannot be understood or goes together badly.
   *
   * @param description  one sentence for --help
   * @param prints       false on ranks above the first
   */
  CommandLine parse_command_line(int argc, char **argv, const std::string &description, bool prints);

  /** Version, git revision and -march of this program, in one line. */
  std::string describe_build();
  const char *get_version();
  const char *get_git_revision();
  const char *get_march();

  /**
   * Runs a program's body and turns what it throws into an exit status and one message on standard error: BadInput and
   * std::invalid_argument 2, any other std::exception 1.
   *
   * @param prints  false on ranks above the first: what all ranks find, one says
   */
  int run_guarded(const std::string &program, bool prints, const std::function<int()> &body);

  /** Runs what reads the user's files: there, a runtime error is the input's fault. Returns what `read` returns. */
  template <typename Read>
  auto as_bad_input(const Read &read);
} // namespace apps

#include "apps/bad_input.h"

template <typename Read>
auto apps::as_bad_input(const Read &read)
{
  try
    {
      return read();
    }
  catch (const BadInput &)
    {
      throw;
    }
  catch (const std::runtime_error &error)
    {
      throw BadInput(error.what());
    }
}

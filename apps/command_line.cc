#include "apps/command_line.h"

#include "apps/bad_input.h"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <filesystem>
#include <iostream>

namespace apps
{
  const char *get_version()
  {
    return SLOWSAND_VERSION;
  }

  const char *get_git_revision()
  {
    return SLOWSAND_GIT_REVISION;
  }

  const char *get_march()
  {
    return SLOWSAND_MARCH_USED;
  }

  std::string describe_build()
  {
    return fmt::format("{} (git {}, -march={})", get_version(), get_git_revision(), get_march());
  }

  namespace
  {
    void complete(CommandLine &line, const std::string &resumed)
    {
      line.is_resumed = !resumed.empty();
      if (line.is_resumed && (!line.output.empty() || line.may_overwrite))
        throw BadInput("--resume names the run folder: it goes with neither --output nor --overwrite");
      if (line.is_resumed && line.case_file.empty())
        line.case_file = (std::filesystem::path(resumed) / "parameters.prm").string();
      if (line.is_resumed)
        line.output = resumed;
      if (line.case_file.empty() && !line.only_template)
        throw BadInput("no parameter file: give CASE.prm, or --template to print one, or --help");
      if (line.output.empty())
        line.output = "runs/" + std::filesystem::path(line.case_file).stem().string();
    }
  } // namespace

  CommandLine parse_command_line(int argc, char **argv, const std::string &description, const bool prints)
  {
    const std::string program = std::filesystem::path(argv[0]).filename().string();
    CommandLine line;
    std::string resumed;
    CLI::App app(description, program);
    app.set_version_flag("--version", program + " " + describe_build());
    app.add_option("CASE", line.case_file, "parameter file, .prm or .json");
    app.add_flag("--template", line.only_template, "print every parameter with its default, unit and range, and stop");
    app.add_flag("--check", line.only_check, "read and check the parameters, and stop");
    app.add_option("--set", line.overrides, "\"Section/Name=value\": beats the file (repeatable)")
        ->allow_extra_args(false);
    app.add_option("--output", line.output, "run folder to write (default: runs/CASE)");
    app.add_option("--resume", resumed, "run folder to go on with, from its last checkpoint");
    app.add_flag("--overwrite", line.may_overwrite, "remove the run that the run folder holds");
    app.add_option("--threads", line.n_threads, "threads (of each rank)")->check(CLI::Range(1u, 1024u));
    app.add_flag("--quiet", line.is_quiet, "no progress on the terminal");
    try
      {
        app.parse(argc, argv);
      }
    catch (const CLI::Success &wanted) // --help and --version
      {
        if (prints)
          app.exit(wanted, std::cout, std::cerr);
        line.is_done = true;
        return line;
      }
    catch (const CLI::ParseError &error)
      {
        throw BadInput(std::string(error.what()) + "; see --help");
      }
    complete(line, resumed);
    return line;
  }

  int run_guarded(const std::string &program, const bool prints, const std::function<int()> &body)
  {
    const auto say = [&](const std::string &what) {
      if (prints)
        std::cerr << program + ": " + what + "\n" << std::flush; // one write: ranks must not mix their lines
    };
    try
      {
        return body();
      }
    catch (const BadInput &error)
      {
        say(error.what());
        return 2;
      }
    catch (const std::invalid_argument &error)
      {
        say(error.what());
        return 2;
      }
    catch (const std::exception &error)
      {
        say(error.what());
        return 1;
      }
  }
} // namespace apps

#include "apps/rev_run.h"

#include <iostream>

namespace
{
  int run(int argc, char **argv)
  {
    const apps::CommandLine line = apps::parse_command_line(
        argc, argv, "Runs a programme of laboratory stages on one representative volume of crushable, ageing grains.",
        true);
    if (line.is_done)
      return 0;
    apps::ParameterFile file;
    if (!line.case_file.empty())
      file = apps::ParameterFile(line.case_file);
    for (const std::string &assignment : line.overrides)
      file.override_with(assignment);
    const apps::RevCase rev_case = apps::read_rev_case(file);
    if (line.only_template)
      std::cout << rev_case.parameters;
    if (line.only_template || line.only_check)
      return 0;
    return apps::run_rev(rev_case, line);
  }
} // namespace

int main(int argc, char **argv)
{
  return apps::run_guarded("slowsand-rev", true, [&] { return run(argc, argv); });
}

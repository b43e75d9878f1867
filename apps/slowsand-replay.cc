// Runs a REV that failed in a boundary-value problem once more, alone, and says what happens.

#include "apps/command_line.h"

#include "coupling/rev_failure.h"

#include <deal.II/base/mpi.h>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <iostream>

namespace
{
  int replay(const std::string &file)
  {
    const coupling::RevFailure failure = apps::as_bad_input([&]() { return coupling::read_failure(file); });
    const char *kinds[] = {"to be strained", "to age", "to split what is overstressed"};
    fmt::print("REV {} of seed {}: {} grains, {} contacts, at {:g} s\n", failure.model.identity.rev,
               failure.model.identity.seed, failure.state.grains.size(), failure.state.contacts.size(),
               failure.state.time);
    fmt::print("was asked {}", kinds[static_cast<int>(failure.question.kind)]);
    if (failure.question.kind == coupling::QuestionKind::age)
      fmt::print(" by {:g} s", failure.question.dt);
    if (failure.question.kind == coupling::QuestionKind::deform)
      for (int i = 0; i < 3; ++i)
        fmt::print("{}{:.9g} {:.9g} {:.9g}", i == 0 ? " by the stretch [" : "; ", failure.question.stretch(i, 0),
                   failure.question.stretch(i, 1), failure.question.stretch(i, 2));
    fmt::print("{}\nand then:  {}\n", failure.question.kind == coupling::QuestionKind::deform ? "]" : "", failure.what);
    std::cout.flush();

    dem::Rev rev(failure.model, failure.state);
    const coupling::AgeingReport report = coupling::ask(rev, failure.question, failure.ageing);
    fmt::print("now again: {}\n", coupling::describe(report));
    return report.has_failed() ? 1 : 0;
  }
} // namespace

int main(int argc, char **argv)
{
  const dealii::Utilities::MPI::MPI_InitFinalize mpi(argc, argv, 1);
  return apps::run_guarded("slowsand-replay", true, [&]() {
    std::string file;
    CLI::App app(
        "Runs a failed REV again, alone. Exit status: 0 it is at rest this time, 1 it fails again, 2 bad file.",
        "slowsand-replay");
    app.set_version_flag("--version", "slowsand-replay " + apps::describe_build());
    app.add_option("FILE", file, "failures/point_ID_N.h5 of a run folder")->required();
    try
      {
        app.parse(argc, argv);
      }
    catch (const CLI::ParseError &error)
      {
        return app.exit(error) == 0 ? 0 : 2;
      }
    return replay(file);
  });
}

// A boundary-value problem whose Gauss points are volumes of crushable, slowly cracking grains.

#include "apps/bvp_run.h"
#include "apps/rank_guard.h"

#include <deal.II/base/mpi.h>

#include <iostream>
#include <sstream>

namespace
{
  constexpr const char *description = "Creep of crushable sand across two scales: a boundary-value problem that asks a "
                                      "volume of grains at each of its Gauss points. Runs alone or under mpirun.";

  template <int dim>
  int solve(const apps::BvpCase &bvp, const apps::CommandLine &line, const apps::RunFolder &folder)
  {
    return apps::BvpRun<dim>(bvp, line, folder).run();
  }

  int run(int argc, char **argv, const bool is_first_rank)
  {
    const apps::CommandLine line = apps::parse_command_line(argc, argv, description, is_first_rank);
    if (line.is_done)
      return 0;
    apps::ParameterFile file = line.case_file.empty() ? apps::ParameterFile() : apps::ParameterFile(line.case_file);
    for (const std::string &assignment : line.overrides)
      file.override_with(assignment);
    apps::ParameterBinder binder;
    apps::BvpCase bvp;
    apps::read_bvp_case(file, binder, bvp);
    std::ostringstream parameters;
    binder.print(parameters);
    if (line.only_template && is_first_rank)
      std::cout << parameters.str();
    if (line.only_template)
      return 0;
    apps::check_bvp_case(binder, bvp);
    if (line.only_check)
      return 0;

    const apps::RunFolder folder(line);
    folder.check();
    MPI_Barrier(MPI_COMM_WORLD); // nobody writes before all have looked
    if (is_first_rank)
      folder.prepare(parameters.str());
    MPI_Barrier(MPI_COMM_WORLD);
    return bvp.problem.geometry == fem::Geometry::three_dimensional ? solve<3>(bvp, line, folder)
                                                                    : solve<2>(bvp, line, folder);
  }
} // namespace

int main(int argc, char **argv)
{
  const dealii::Utilities::MPI::MPI_InitFinalize mpi(argc, argv, 1);
  const bool is_first_rank = dealii::Utilities::MPI::this_mpi_process(MPI_COMM_WORLD) == 0;
  return apps::run_guarded_on_ranks("slowsand-bvp", [&]() { return run(argc, argv, is_first_rank); });
}

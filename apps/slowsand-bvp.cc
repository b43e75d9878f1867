// A boundary-value problem whose Gauss points are volumes of crushable, slowly cracking grains.

#include "apps/bvp_run.h"
#include "apps/rank_guard.h"

#include <deal.II/base/mpi.h>

#include <iostream>

namespace
{
  constexpr const char *description = "Creep of crushable sand across two scales: a boundary-value problem that asks a "
                                      "volume of grains at each of its Gauss points. Runs alone or under mpirun.";

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
    if (line.only_template && is_first_rank)
      std::cout << bvp.parameters;
    if (line.only_template)
      return 0;
    apps::check_bvp_case(binder, bvp);
    if (line.only_check)
      return 0;

    return bvp.problem.geometry == fem::Geometry::three_dimensional ? apps::BvpRun<3>(bvp, line).run()
                                                                    : apps::BvpRun<2>(bvp, line).run();
  }
} // namespace

int main(int argc, char **argv)
{
  const dealii::Utilities::MPI::MPI_InitFinalize mpi(argc, argv, 1);
  const bool is_first_rank = dealii::Utilities::MPI::this_mpi_process(MPI_COMM_WORLD) == 0;
  return apps::run_guarded_on_ranks("slowsand-bvp", [&]() { return run(argc, argv, is_first_rank); });
}

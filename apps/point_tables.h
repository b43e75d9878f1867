#pragma once

#include "apps/history_file.h"

#include "fem/quasi_static_problem.h"

#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace apps
{
  /** Columns of a Gauss point beside a pile: depth, stresses as the pile's wall sees them, then the material's fields.
   */
  std::vector<std::string> name_shaft_columns(const fem::ConstitutiveModel &material);

  /**
   * Values of those columns for the ground's Gauss points beside the shaft, one row a point, by their numbers; known to
   * all ranks of the mesh. Normal stresses compression-positive; shear positive where the pile pushes the ground down.
   *
   * @param shaft          comma-separated names of interfaces
   * @param surface_level  from which depth counts [m]
   */
  template <int dim>
  std::vector<std::vector<double>> compute_shaft_rows(const fem::QuasiStaticProblem<dim> &problem,
                                                      const std::string &shaft, double surface_level);

  /**
   * What became of single Gauss points, at each output of the run: points.csv, all of them, and shaft.csv, those
   * beside the shaft. Collective over the ranks of the mesh.
   */
  template <int dim>
  class PointTables
  {
  public:
    /** What the tables need to know of their run. */
    struct Run
    {
      std::string folder;
      std::string shaft;          ///< comma-separated names of interfaces
      double surface_level = 0.;  ///< [m]
      bool is_first_rank = true;  ///< the one that writes
      bool is_resumed = false;    ///< rows beyond last_step are dropped
      unsigned int last_step = 0; ///< committed before the run goes on
    };

    PointTables(const Run &run, const fem::QuasiStaticProblem<dim> &problem);

    /** @param stage  from 1; 0: before the first @param time [s] */
    void write(const fem::QuasiStaticProblem<dim> &problem, unsigned int stage, unsigned int step, double time);

  private:
    std::unique_ptr<HistoryFile> open(const std::string &name, std::vector<std::string> columns) const;

    Run run_;
    std::unique_ptr<HistoryFile> points_, shaft_; ///< on the first rank
  };
} // namespace apps

#pragma once

#include "fem/quasi_static_problem.h"

#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace fem
{
  /** A field's name as files have it, letters, digits and single underscores: "void ratio [-]" becomes "void_ratio". */
  std::string compute_field_name(const std::string &name);

  /**
   * Writes FOLDER/fields/NAME_0001.pvtu and so on, numbered by the committed step, and FOLDER/NAME.pvd with their times
   * after each output: valid if the run dies. Displacement [m] at the nodes; a cell's averages of stress [Pa] and
   * strain [-], COMPRESSION-POSITIVE (the only place of this room that turns signs), and of the material's own fields.
   *
   * Collective over MPI_COMM_WORLD. Where every rank holds the whole problem, rank 0 writes.
   */
  class FieldOutput
  {
  public:
    /** @param folder  the run folder @param name  of the series
     *  @param resume_step  outputs of an existing series up to this step are kept, later ones dropped: time may stand
     * still over many steps. Nothing: the series begins. Throws std::runtime_error naming the path. */
    FieldOutput(const std::string &folder, const std::string &name, std::optional<unsigned int> resume_step = {});

    /** @param step  committed ones so far, more than at the last output @param time [s] */
    template <int dim>
    void write(const QuasiStaticProblem<dim> &problem, unsigned int step, double time);

  private:
    void read_series(unsigned int resume_step);
    void write_series() const;

    std::string folder_;
    std::string name_;
    std::vector<std::pair<double, std::string>> times_and_files_;
  };
} // namespace fem

#include "apps/point_tables.h"

#include "apps/name_list.h"

#include "coupling/rev_material.h"
#include "coupling/rev_pool.h"

#include "dem/homogenisation.h"

#include "fem/field_output.h"

#include <algorithm>
#include <filesystem>

namespace apps
{
  namespace
  {
    using Row = std::vector<double>;
    using Rows = std::vector<Row>;

    /** Fields of the state alone: what a REV cost depends on the machine, and no other run would write the same bytes.
     */
    bool is_of_state(const std::string &name)
    {
      return name != coupling::cost_field;
    }

    std::vector<std::string> name_field_columns(const fem::ConstitutiveModel &material)
    {
      std::vector<std::string> names;
      for (const std::string &name : material.get_field_names())
        if (is_of_state(name))
          names.push_back(fem::compute_field_name(name));
      return names;
    }

    void append_fields(const fem::ConstitutiveModel &material, const fem::PointId id, Row &row)
    {
      const std::vector<std::string> names = material.get_field_names();
      const std::vector<double> fields = material.compute_fields(id);
      for (std::size_t i = 0; i < names.size(); ++i)
        if (is_of_state(names[i]))
          row.push_back(fields[i]);
    }

    /** Rows of all ranks, in the order of the points. @param id_column  where each has its point's number */
    Rows gather_points(const Rows &own, const std::size_t id_column, MPI_Comm communicator)
    {
      std::vector<double> numbers;
      for (const Row &row : own)
        numbers.insert(numbers.end(), row.begin(), row.end());
      const std::size_t n_columns =
          dealii::Utilities::MPI::max(own.empty() ? std::size_t(0) : own.front().size(), communicator);
      numbers = coupling::gather_rows(numbers, communicator);
      Rows all;
      for (std::size_t at = 0; n_columns > 0 && at < numbers.size(); at += n_columns)
        all.emplace_back(numbers.begin() + at, numbers.begin() + at + n_columns);
      std::stable_sort(all.begin(), all.end(), [&](const Row &a, const Row &b) { return a[id_column] < b[id_column]; });
      return all;
    }

    Row make_shaft_row(const fem::InterfacePoint &point, const double surface_level)
    {
      const fem::PointState &state = point.state;
      const dealii::Tensor<1, 3> down({0., 0., -1.});
      const dealii::Tensor<1, 3> along = dealii::cross_product_3d(down, point.normal);
      const dealii::Tensor<1, 3> traction = state.stress * point.normal;
      return {double(state.id),           surface_level - state.position[2], point.distance,
              -(traction * point.normal), -(along * (state.stress * along)), -state.stress[2][2],
              -(traction * down)}; // the pile pushes with -sigma n, since n leads out of it
    }

    template <int dim>
    Rows compute_point_rows(const fem::QuasiStaticProblem<dim> &problem)
    {
      Rows rows;
      for (const fem::PointState &state : problem.compute_point_states())
        {
          Row row = {double(state.id), state.position[0], state.position[1], state.position[2]};
          for (const auto *tensor : {&state.stress, &state.strain})
            for (const auto &index : dem::tangent_index)
              row.push_back(-(*tensor)[index[0]][index[1]]);
          append_fields(problem.get_material(), state.id, row);
          rows.push_back(row);
        }
      return gather_points(rows, 0, problem.get_communicator());
    }
  } // namespace

  std::vector<std::string> name_shaft_columns(const fem::ConstitutiveModel &material)
  {
    std::vector<std::string> names = {
        "point",          "depth_m", "distance_m", "radial_stress_Pa", "hoop_stress_Pa", "vertical_stress_Pa",
        "shear_stress_Pa"};
    const std::vector<std::string> fields = name_field_columns(material);
    names.insert(names.end(), fields.begin(), fields.end());
    return names;
  }

  template <int dim>
  std::vector<std::vector<double>> compute_shaft_rows(const fem::QuasiStaticProblem<dim> &problem,
                                                      const std::string &shaft, const double surface_level)
  {
    Rows rows;
    for (const std::string &name : split_names(shaft))
      for (const fem::InterfacePoint &point : problem.compute_interface_points(name))
        {
          rows.push_back(make_shaft_row(point, surface_level));
          append_fields(problem.get_material(), point.state.id, rows.back());
        }
    return gather_points(rows, 0, problem.get_communicator());
  }

  template <int dim>
  PointTables<dim>::PointTables(const Run &run, const fem::QuasiStaticProblem<dim> &problem) : run_(run)
  {
    if (!run_.is_first_rank)
      return;
    const fem::ConstitutiveModel &material = problem.get_material();
    std::vector<std::string> columns = {"time_s", "stage", "step", "point", "x_m", "y_m", "z_m"};
    for (const auto &names :
         {name_tensor_columns("stress", "_Pa"), name_tensor_columns("strain", ""), name_field_columns(material)})
      columns.insert(columns.end(), names.begin(), names.end());
    points_ = open("points.csv", columns);
    columns = {"age_s", "stage", "step"};
    const std::vector<std::string> names = name_shaft_columns(material);
    columns.insert(columns.end(), names.begin(), names.end());
    shaft_ = open("shaft.csv", columns);
  }

  template <int dim>
  std::unique_ptr<HistoryFile> PointTables<dim>::open(const std::string &name, std::vector<std::string> columns) const
  {
    const std::string file = run_.folder + "/" + name;
    if (!run_.is_resumed || !std::filesystem::exists(file))
      return std::make_unique<HistoryFile>(file, columns);
    return std::make_unique<HistoryFile>(file, columns, [&](const std::vector<std::string> &row) {
      return std::strtoul(row[2].c_str(), nullptr, 10) <= run_.last_step; // the column "step"
    });
  }

  template <int dim>
  void PointTables<dim>::write(const fem::QuasiStaticProblem<dim> &problem, const unsigned int stage,
                               const unsigned int step, const double time)
  {
    const auto write_rows = [&](const Rows &rows, HistoryFile *file) {
      if (file != nullptr)
        for (const Row &row : rows)
          {
            HistoryRow text;
            text.add(time).add(stage).add(step).add(static_cast<std::uint64_t>(row[0]));
            for (std::size_t i = 1; i < row.size(); ++i)
              text.add(row[i]);
            file->write(text);
          }
    };
    write_rows(compute_point_rows(problem), points_.get());
    write_rows(compute_shaft_rows(problem, run_.shaft, run_.surface_level), shaft_.get());
  }

  template std::vector<std::vector<double>> compute_shaft_rows(const fem::QuasiStaticProblem<2> &, const std::string &,
                                                               double);
  template std::vector<std::vector<double>> compute_shaft_rows(const fem::QuasiStaticProblem<3> &, const std::string &,
                                                               double);
  template class PointTables<2>;
  template class PointTables<3>;
} // namespace apps

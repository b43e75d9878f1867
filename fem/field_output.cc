#include "fem/field_output.h"

#include <deal.II/numerics/data_out.h>

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iomanip>
#include <limits>
#include <sstream>
#include <stdexcept>

namespace fem
{
  namespace
  {
    bool is_first_rank()
    {
      return dealii::Utilities::MPI::this_mpi_process(MPI_COMM_WORLD) == 0;
    }

    /** Cell averages by name, one value an active cell. */
    using CellFields = std::vector<std::pair<std::string, dealii::Vector<float>>>;

    CellFields create_fields(const ConstitutiveModel &material, unsigned int n_cells)
    {
      CellFields fields;
      for (const std::string component : {"xx", "yy", "zz", "xy", "yz", "xz"})
        fields.push_back({"stress_" + component + "_Pa", dealii::Vector<float>(n_cells)});
      for (const std::string component : {"xx", "yy", "zz", "xy", "yz", "xz"})
        fields.push_back({"strain_" + component, dealii::Vector<float>(n_cells)});
      for (const std::string &name : material.get_field_names())
        fields.push_back({compute_field_name(name), dealii::Vector<float>(n_cells)});
      return fields;
    }

    /** Compression-positive values of a point, in the order of create_fields(). */
    std::vector<double> compute_values(const PointState &point, const ConstitutiveModel &material)
    {
      constexpr unsigned int rows[] = {0, 1, 2, 0, 1, 0}, columns[] = {0, 1, 2, 1, 2, 2};
      std::vector<double> values;
      for (const auto *tensor : {&point.stress, &point.strain})
        for (unsigned int i = 0; i < 6; ++i)
          values.push_back(-(*tensor)[rows[i]][columns[i]]);
      const std::vector<double> own = material.compute_fields(point.id);
      values.insert(values.end(), own.begin(), own.end());
      return values;
    }

    template <int dim>
    CellFields compute_cell_fields(const QuasiStaticProblem<dim> &problem)
    {
      const ConstitutiveModel &material = problem.get_material();
      const auto &triangulation = problem.get_dof_handler().get_triangulation();
      CellFields fields = create_fields(material, triangulation.n_active_cells());
      const std::vector<PointState> points = problem.compute_point_states();
      const unsigned int n_points = problem.get_n_points_per_cell();
      std::size_t point = 0;
      for (const auto &cell : triangulation.active_cell_iterators())
        if (cell->is_locally_owned())
          for (unsigned int q = 0; q < n_points; ++q)
            {
              const auto values = compute_values(points[point++], material);
              for (std::size_t f = 0; f < fields.size(); ++f)
                fields[f].second[cell->active_cell_index()] += values.at(f) / n_points;
            }
      return fields;
    }

    /** Value of NAME="VALUE" in a line of XML; empty if it is not there. */
    std::string get_attribute(const std::string &line, const std::string &name)
    {
      const std::string opening = " " + name + "=\"";
      const auto begin = line.find(opening);
      if (begin == std::string::npos)
        return "";
      const auto value = begin + opening.size();
      return line.substr(value, line.find('"', value) - value);
    }
  } // namespace

  std::string compute_field_name(const std::string &name)
  {
    std::string kept;
    for (const char c : name)
      if (std::isalnum(static_cast<unsigned char>(c)))
        kept += c;
      else if (!kept.empty() && kept.back() != '_')
        kept += '_';
    while (!kept.empty() && kept.back() == '_')
      kept.pop_back();
    return kept;
  }

  FieldOutput::FieldOutput(const std::string &folder, const std::string &name, std::optional<unsigned int> resume_step)
      : folder_(folder), name_(name)
  {
    if (is_first_rank())
      {
        std::error_code error;
        std::filesystem::create_directories(folder_ + "/fields", error);
        if (error)
          throw std::runtime_error(fmt::format("{}/fields: {}", folder_, error.message()));
      }
    if (resume_step)
      read_series(*resume_step);
    MPI_Barrier(MPI_COMM_WORLD); // nobody writes before all have read
  }

  void FieldOutput::read_series(unsigned int resume_step)
  {
    const std::string beginning = "fields/" + name_ + "_"; // of a file's name; then comes its step
    std::ifstream stream(folder_ + "/" + name_ + ".pvd");
    for (std::string line; std::getline(stream, line);)
      {
        const std::string time = get_attribute(line, "timestep"), file = get_attribute(line, "file");
        if (file.starts_with(beginning) && std::strtoul(file.c_str() + beginning.size(), nullptr, 10) <= resume_step)
          times_and_files_.push_back({std::strtod(time.c_str(), nullptr), file});
      }
  }

  template <int dim>
  void FieldOutput::write(const QuasiStaticProblem<dim> &problem, unsigned int step, double time)
  {
    const CellFields fields = compute_cell_fields(problem);
    const bool is_alone = dealii::Utilities::MPI::n_mpi_processes(problem.get_communicator()) == 1;
    const std::string file = fmt::format("{}_{:04d}.pvtu", name_, step);
    times_and_files_.push_back({time, "fields/" + file});
    if (is_alone && !is_first_rank())
      return;

    dealii::DataOut<dim> output;
    output.attach_dof_handler(problem.get_dof_handler());
    output.add_data_vector(problem.get_dof_handler(), problem.get_displacement(),
                           std::vector<std::string>(dim, "displacement_m"),
                           std::vector<dealii::DataComponentInterpretation::DataComponentInterpretation>(
                               dim, dealii::DataComponentInterpretation::component_is_part_of_vector));
    for (const auto &[name, values] : fields)
      output.add_data_vector(values, name, dealii::DataOut<dim>::type_cell_data);
    output.build_patches(problem.get_mapping(), problem.get_dof_handler().get_fe().degree);
    output.write_vtu_with_pvtu_record(folder_ + "/fields/", name_, step, problem.get_communicator(), 4);
    if (is_first_rank())
      write_series();
  }

  void FieldOutput::write_series() const
  {
    const std::string file = folder_ + "/" + name_ + ".pvd", temporary = file + ".tmp";
    std::ostringstream text;
    text << std::setprecision(std::numeric_limits<double>::max_digits10);
    dealii::DataOutBase::write_pvd_record(text, times_and_files_);
    std::ofstream stream(temporary);
    stream << text.str();
    stream.close();
    if (!stream || std::rename(temporary.c_str(), file.c_str()) != 0)
      throw std::runtime_error(fmt::format("{}: cannot be written: {}", file, std::strerror(errno)));
  }

  template void FieldOutput::write(const QuasiStaticProblem<2> &, unsigned int, double);
  template void FieldOutput::write(const QuasiStaticProblem<3> &, unsigned int, double);
} // namespace fem

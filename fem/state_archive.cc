#include "fem/state_archive.h"

#include "fem/hdf5_file.h"

#include <deal.II/base/mpi.h>

#include <fmt/format.h>

namespace fem
{
  void write_states(const std::string &file, const StateArchive &archive,
                    const std::map<PointId, std::vector<double>> &states)
  {
    std::vector<double> ids, numbers;
    for (const auto &[id, state] : states)
      {
        ids.push_back(id);
        numbers.insert(numbers.end(), state.begin(), state.end());
      }
    const auto all_ids = dealii::Utilities::MPI::gather(archive.communicator, ids);
    const auto all_numbers = dealii::Utilities::MPI::gather(archive.communicator, numbers);
    if (dealii::Utilities::MPI::this_mpi_process(MPI_COMM_WORLD) != 0)
      return;
    ids.clear();
    numbers.clear();
    for (std::size_t rank = 0; rank < all_ids.size(); ++rank)
      {
        ids.insert(ids.end(), all_ids[rank].begin(), all_ids[rank].end());
        numbers.insert(numbers.end(), all_numbers[rank].begin(), all_numbers[rank].end());
      }
    Hdf5File output(file, Hdf5File::Mode::append);
    output.write(archive.group + "/point_ids", ids, "1");
    output.write(archive.group + "/" + archive.name, numbers, archive.unit);
    output.close();
  }

  std::map<PointId, std::vector<double>> read_states(const std::string &file, const StateArchive &archive)
  {
    const Hdf5File input(file, Hdf5File::Mode::read);
    const std::vector<double> ids = input.read(archive.group + "/point_ids");
    const std::vector<double> numbers = input.read(archive.group + "/" + archive.name, archive.n_numbers * ids.size());
    std::map<PointId, std::vector<double>> states;
    for (std::size_t i = 0; i < ids.size(); ++i)
      states[static_cast<PointId>(ids[i])].assign(numbers.begin() + i * archive.n_numbers,
                                                  numbers.begin() + (i + 1) * archive.n_numbers);
    return states;
  }

  void check_n_states(const std::string &file, const StateArchive &archive, const std::size_t n_found,
                      const std::size_t n_points)
  {
    if (n_found != n_points)
      throw std::runtime_error(fmt::format("{}: {}/point_ids holds {} of this problem's {} Gauss points", file,
                                           archive.group, n_found, n_points));
  }
} // namespace fem

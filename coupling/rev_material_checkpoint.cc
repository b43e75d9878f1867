// Checkpoints of a RevMaterial.

#include "coupling/rev_material.h"

#include "dem/rev_snapshot.h"

#include <fmt/format.h>

#include <cstring>
#include <stdexcept>

namespace coupling
{
  namespace
  {
    const std::string gradings_dataset = "/material/initial_gradings";
    const std::string lazy_dataset = "/material/lazy_states";

    std::string name_dataset(const PointId id)
    {
      return fmt::format("/material/points/{}", id);
    }

    /** One message of bytes from a rank to rank 0; empty on the others. */
    std::vector<std::byte> send_to_first(std::vector<std::byte> bytes, const unsigned int source, const RevPool &pool)
    {
      if (source == 0 || (pool.get_rank() != 0 && pool.get_rank() != source))
        return bytes;
      std::uint64_t n_bytes = bytes.size();
      const int from = static_cast<int>(source), tag = 0;
      if (pool.get_rank() == source)
        {
          MPI_Send(&n_bytes, 1, MPI_UINT64_T, 0, tag, pool.get_communicator());
          MPI_Send(bytes.data(), static_cast<int>(n_bytes), MPI_BYTE, 0, tag, pool.get_communicator());
          return {};
        }
      MPI_Recv(&n_bytes, 1, MPI_UINT64_T, from, tag, pool.get_communicator(), MPI_STATUS_IGNORE);
      bytes.resize(n_bytes);
      MPI_Recv(bytes.data(), static_cast<int>(n_bytes), MPI_BYTE, from, tag, pool.get_communicator(),
               MPI_STATUS_IGNORE);
      return bytes;
    }
  } // namespace

  // One point after another, so that rank 0 never holds more than one state of the others.
  void RevMaterial::save(const std::string &file) const
  {
    for (const PointId id : pool_.get_points())
      {
        std::vector<std::byte> bytes;
        if (pool_.get_owner(id) == pool_.get_rank())
          bytes = dem::serialise(get_local_rev(id).get_committed());
        bytes = send_to_first(std::move(bytes), pool_.get_owner(id), pool_);
        pool_.agree([&]() {
          if (pool_.get_rank() == 0)
            dem::write_bytes(file, name_dataset(id), bytes);
        });
      }
    save_lazy_states(file);
    save_gradings(file);
  }

  void RevMaterial::save_gradings(const std::string &file) const
  {
    pool_.agree([&]() {
      if (pool_.get_rank() == 0)
        dem::write_bytes(file, gradings_dataset, std::as_bytes(std::span(initial_gradings_)));
    });
  }

  // A checkpoint of a program that did not know them leaves breakage unknown.
  void RevMaterial::load_gradings(const std::string &file)
  {
    initial_gradings_.assign(pool_.get_points().size(), {});
    if (!dem::has_bytes(file, gradings_dataset))
      return;
    const auto bytes = dem::read_bytes(file, gradings_dataset);
    if (bytes.size() != initial_gradings_.size() * sizeof(dem::InitialGrading))
      throw std::runtime_error(fmt::format("{}, dataset {}: of another number of points", file, gradings_dataset));
    std::memcpy(initial_gradings_.data(), bytes.data(), bytes.size());
  }

  // Rows of doubles in the order of the points; nothing where no REV has ever been lazy.
  void RevMaterial::save_lazy_states(const std::string &file) const
  {
    const auto rows = pool_.collect(LazyRev::n_committed_numbers, [&](const PointId id, std::span<double> row) {
      points_.at(id).rev->write_committed(row);
    });
    if (!parameters_.point.is_lazy() && compute_totals().lazy.n_questions == 0.)
      return;
    pool_.agree([&]() {
      if (pool_.get_rank() == 0)
        dem::write_bytes(file, lazy_dataset, std::as_bytes(std::span(rows)));
    });
  }

  void RevMaterial::load_lazy_states(const std::string &file)
  {
    if (!dem::has_bytes(file, lazy_dataset))
      return;
    const auto bytes = dem::read_bytes(file, lazy_dataset);
    std::vector<double> rows(bytes.size() / sizeof(double));
    if (rows.size() != pool_.get_points().size() * LazyRev::n_committed_numbers)
      throw std::runtime_error(fmt::format("{}, dataset {}: of another number of points", file, lazy_dataset));
    std::memcpy(rows.data(), bytes.data(), bytes.size());
    for (const PointId id : pool_.get_local_points())
      points_.at(id).rev->read_committed(std::span<const double>(rows).subspan(
          pool_.get_index(id) * LazyRev::n_committed_numbers, LazyRev::n_committed_numbers));
  }

  void RevMaterial::load(const std::string &file)
  {
    pool_.agree([&]() {
      for (const PointId id : pool_.get_local_points())
        {
          const auto bytes = dem::read_bytes(file, name_dataset(id));
          try
            {
              points_.at(id).rev =
                  std::make_unique<LazyRev>(dem::Rev(make_model(id), dem::deserialise(bytes)), parameters_.point);
            }
          catch (const std::runtime_error &error)
            {
              throw std::runtime_error(
                  fmt::format("{}, dataset {}: {}", file, name_dataset(id), std::string(error.what())));
            }
        }
      load_lazy_states(file);
      load_gradings(file);
    });
    fields_.clear(); // of another history
    update_fields();
  }
} // namespace coupling

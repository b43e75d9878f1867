// What leaves a RevMaterial: fields, totals, snapshots and checkpoints.

#include "coupling/rev_material.h"
#include "coupling/tensor_conversion.h"

#include "dem/snapshot.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <stdexcept>

namespace coupling
{
  namespace
  {
    /** Order of the fields of a point. */
    enum Field : std::size_t
    {
      void_ratio,
      void_ratio_with_fines,
      fines_share,
      coordination,
      time_to_fracture,
      broken_instant,
      broken_delayed,
      grains,
      cycles,
      error_bound,
      cost,
      n_fields
    };

    /** Behind the fields of a point: what only sums tell of. */
    constexpr std::size_t n_columns = n_fields + LazyRev::n_tally_numbers;

    void fill_fields(const LazyRev &lazy, std::span<double> row)
    {
      const dem::Rev &rev = lazy.get_rev();
      const dem::RevState &state = rev.get_committed();
      const auto contacts = dem::list_contacts(state, rev.get_law());
      const double pending_volume = lazy.get_committed_state().pending.determinant(); // over that of the grains' cell
      row[void_ratio] = (1. + dem::compute_void_ratio(state)) * pending_volume - 1.;
      row[void_ratio_with_fines] = (1. + dem::compute_void_ratio_with_fines(state)) * pending_volume - 1.;
      row[fines_share] = 1. - dem::compute_solid_volume(state.grains) / state.initial_solid_volume;
      row[coordination] =
          dem::compute_coordination(contacts, state.grains.size(), rev.get_model().dynamics.motion.is_rotation_free)
              .without_rattlers;
      row[time_to_fracture] = rev.compute_time_to_next_batch();
      row[broken_instant] = static_cast<double>(state.counters.broken_instant);
      row[broken_delayed] = static_cast<double>(state.counters.broken_delayed);
      row[grains] = static_cast<double>(state.grains.size());
      row[cycles] = static_cast<double>(state.counters.cycles);
      row[error_bound] = lazy.get_committed_state().error_bound;
      lazy.write_tally(row.subspan(n_fields));
    }

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

  std::vector<std::string> RevMaterial::get_field_names() const
  {
    return {"void ratio [-]",
            "void ratio with fines [-]",
            "fines [-]",
            "coordination [-]",
            "time to fracture [s]",
            "broken at once [-]",
            "broken delayed [-]",
            "grains [-]",
            "cycles [-]",
            "bound of error of stress [Pa]",
            cost_field};
  }

  void RevMaterial::update_fields()
  {
    fields_ = pool_.collect(n_columns,
                            [&](const PointId id, std::span<double> row) { fill_fields(*points_.at(id).rev, row); });
    for (std::size_t i = 0; i < pool_.get_points().size(); ++i)
      fields_[i * n_columns + cost] = pool_.get_step_costs()[i];
  }

  std::vector<double> RevMaterial::compute_fields(const PointId id) const
  {
    const auto row = fields_.begin() + static_cast<std::ptrdiff_t>(pool_.get_index(id) * n_columns);
    return {row, row + n_fields};
  }

  RevTotals RevMaterial::compute_totals() const
  {
    RevTotals totals;
    const std::size_t n_points = pool_.get_points().size();
    for (std::size_t i = 0; i < n_points; ++i)
      {
        const double *row = fields_.data() + i * n_columns;
        totals.grains += static_cast<std::uint64_t>(row[grains]);
        totals.cycles += static_cast<std::uint64_t>(row[cycles]);
        totals.broken_instant += static_cast<std::uint64_t>(row[broken_instant]);
        totals.broken_delayed += static_cast<std::uint64_t>(row[broken_delayed]);
        totals.void_ratio += row[void_ratio] / static_cast<double>(n_points);
        totals.void_ratio_with_fines += row[void_ratio_with_fines] / static_cast<double>(n_points);
        totals.n_lazy += row[error_bound] > 0. ? 1 : 0;
        totals.largest_error_bound = std::max(totals.largest_error_bound, row[error_bound]);
        totals.lazy = add(totals.lazy, LazyRev::read_tally({row + n_fields, LazyRev::n_tally_numbers}));
      }
    return totals;
  }

  dem::Profile RevMaterial::compute_local_profile() const
  {
    dem::Profile profile = departed_profile_;
    for (const PointId id : pool_.get_local_points())
      profile += get_local_rev(id).get_profile();
    return profile;
  }

  std::map<PointId, dealii::SymmetricTensor<2, 3>> RevMaterial::collect_stresses() const
  {
    constexpr std::size_t n_columns = dealii::SymmetricTensor<2, 3>::n_independent_components;
    const auto rows = pool_.collect(n_columns, [&](const PointId id, std::span<double> row) {
      const auto stress = points_.at(id).rev->compute_committed_stress();
      std::copy(stress.begin_raw(), stress.end_raw(), row.begin());
    });
    std::map<PointId, dealii::SymmetricTensor<2, 3>> stresses;
    for (std::size_t i = 0; i < pool_.get_points().size(); ++i)
      for (unsigned int m = 0; m < n_columns; ++m)
        stresses[pool_.get_points()[i]].access_raw_entry(m) = rows[i * n_columns + m];
    return stresses;
  }

  void RevMaterial::write_snapshots(const std::string &prefix, const std::string &suffix) const
  {
    pool_.agree([&]() {
      for (const PointId id : pool_.get_local_points())
        {
          const dem::Rev &rev = get_local_rev(id);
          const dem::RevState &state = rev.get_committed();
          dem::write_snapshot(fmt::format("{}_{}_{}.h5", prefix, id, suffix), state,
                              dem::list_contacts(state, rev.get_law()), {parameters_.model.identity.seed, id});
        }
    });
  }

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
    });
    update_fields();
  }
} // namespace coupling

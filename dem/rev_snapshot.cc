#include "dem/rev_snapshot.h"

#include "dem/checksum.h"
#include "dem/snapshot.h"
#include "dem/walls.h"

#include <cassert>
#include <cstring>
#include <filesystem>
#include <stdexcept>
#include <unordered_map>

namespace dem
{
  namespace
  {
    constexpr std::uint64_t format_version = 1;
    const std::string format_name = "slowsand-rev";

    [[noreturn]] void reject(const Hdf5File &file, const std::string &what, const std::string &cause)
    {
      throw std::runtime_error(file.name() + ": " + what + ": " + cause);
    }

    /** One number of each item. */
    template <typename T, typename Items, typename Get>
    std::vector<T> gather(const Items &items, const Get &get)
    {
      std::vector<T> values;
      values.reserve(items.size());
      for (const auto &item : items)
        values.push_back(get(item));
      return values;
    }

    /** A vector of each item, by rows. */
    template <typename Items, typename Get>
    std::vector<double> gather_vectors(const Items &items, const Get &get)
    {
      std::vector<double> values;
      values.reserve(3 * items.size());
      for (const auto &item : items)
        {
          const Vector v = get(item);
          values.insert(values.end(), {v.x(), v.y(), v.z()});
        }
      return values;
    }

    std::vector<std::int64_t> to_signed(const std::span<const GrainId> ids)
    {
      return {ids.begin(), ids.end()};
    }

    void write_matrix(Hdf5File &file, const std::string &path, const Matrix &matrix, const std::string &unit)
    {
      const Matrix by_rows = matrix.transpose();
      file.write(path, std::vector<double>(by_rows.data(), by_rows.data() + 9), {3, 3}, unit);
    }

    Matrix read_matrix(const Hdf5File &file, const std::string &path)
    {
      const std::vector<double> values = file.read<double>(path, {3, 3});
      return Eigen::Map<const Matrix>(values.data()).transpose();
    }

    void write_state(Hdf5File &file, const RevState &state, const SnapshotInfo &info)
    {
      file.write_attribute("/", "format", format_name);
      file.write_attribute("/", "format_version", format_version);
      file.write_attribute("/", "time_s", state.time);
      file.write_attribute("/", "seed", info.seed);
      file.write_attribute("/", "rev", info.rev);
      file.write_attribute("/", "cycles", state.counters.cycles);
      file.write_attribute("/", "broken_instant", state.counters.broken_instant);
      file.write_attribute("/", "broken_delayed", state.counters.broken_delayed);
      file.write_attribute("/", "next_id", state.counters.next_id);
      file.write_attribute("/", "unbalanced_ratio", state.unbalanced_ratio);
      file.write_attribute("/", "initial_solid_volume_m3", state.initial_solid_volume);
      write_matrix(file, "/cell/matrix", state.cell.edges, "m");
      file.write_attribute("/cell/matrix", "kind", std::string(state.cell.has_walls() ? "rigid" : "periodic"));
      write_matrix(file, "/cell/deformation", state.cell.deformation, "-");
      write_matrix(file, "/cell/rotation", state.rotation, "-");
      write_matrix(file, "/state/stress", state.stress, "Pa");
      file.write_attribute("/state/stress", "sign", std::string("tension-positive"));
    }

    void write_rows(Hdf5File &file, const std::string &name, const std::span<const Row> rows, const std::string &unit)
    {
      file.write("/grains/" + name, gather_vectors(rows, to_vector), {rows.size(), 3}, unit);
    }

    void write_last(Hdf5File &file, const std::string &name, const std::span<const Row> rows, const std::string &unit)
    {
      file.write("/grains/" + name, gather<double>(rows, [](const Row &row) { return row.w; }), {rows.size()}, unit);
    }

    template <typename T>
    void write_numbers(Hdf5File &file, const std::string &name, const Column<T> &numbers, const std::string &unit)
    {
      file.write("/grains/" + name, std::vector<T>(numbers.begin(), numbers.end()), {numbers.size()}, unit);
    }

    void write_grains(Hdf5File &file, const Cell &cell, const Grains &grains)
    {
      const std::size_t n = grains.size();
      const auto place_of = [&cell](const Row &row) -> Vector { return cell.edges * to_vector(row); };
      file.write("/grains/id", to_signed(grains.id), {n}, "-");
      file.write("/grains/parent", to_signed(grains.parent), {n}, "-");
      write_numbers(file, "generation", grains.generation, "-");
      file.write("/grains/position", gather_vectors(grains.place, place_of), {n, 3}, "m");
      write_rows(file, "fraction", grains.place, "-"); // what is read back: the position is rounded once more
      write_rows(file, "velocity", grains.velocity, "m/s");
      write_rows(file, "spin", grains.spin, "1/s");
      write_last(file, "radius", grains.place, "m");
      write_last(file, "mass", grains.velocity, "kg");
      write_last(file, "moment", grains.spin, "kg m2");
      write_numbers(file, "strength", grains.strength, "Pa");
      write_numbers(file, "crack_half_length", grains.crack_half_length, "m");
      write_numbers(file, "crack_velocity", grains.crack_velocity, "m/s");
      write_numbers(file, "largest_contact_stress", grains.largest_contact_stress, "Pa");
    }

    void write_contacts(Hdf5File &file, const RevState &state, const std::span<const Contact> contacts)
    {
      using Memory = ContactMemory;
      const std::size_t n = contacts.size();
      const auto &ids = state.grains.id;
      const auto id_a = [&ids](const Memory &c) { return static_cast<std::int64_t>(ids[c.a]); };
      const auto id_b = [&ids](const Memory &c) {
        return is_wall(c.b) ? std::int64_t(to_number(c.b)) : static_cast<std::int64_t>(ids[c.b]);
      };
      const auto shear_force = [](const Memory &c) { return c.shear_force; };
      const auto is_sliding = [](const Memory &c) { return c.is_sliding; };
      file.write("/contacts/grain_a", gather<std::int64_t>(state.contacts, id_a), {n}, "-");
      file.write("/contacts/grain_b", gather<std::int64_t>(state.contacts, id_b), {n}, "-");
      file.write("/contacts/shear_force", gather_vectors(state.contacts, shear_force), {n, 3}, "N");
      file.write("/contacts/is_sliding", gather<std::uint8_t>(state.contacts, is_sliding), {n}, "-");
      const auto normal = [](const Contact &c) { return c.normal; };
      const auto overlap = [](const Contact &c) { return c.overlap; };
      const auto normal_force = [](const Contact &c) { return c.normal_force; };
      file.write("/contacts/normal", gather_vectors(contacts, normal), {n, 3}, "-");
      file.write("/contacts/overlap", gather<double>(contacts, overlap), {n}, "m");
      file.write("/contacts/normal_force", gather<double>(contacts, normal_force), {n}, "N");
    }

    /** What has crept at Burgers contacts, grains by id and walls by number; no group where nothing has. */
    void write_creep(Hdf5File &file, const std::span<const CreptContact> crept)
    {
      const std::size_t n = crept.size();
      if (n == 0)
        return;
      const auto id_a = [](const CreptContact &c) { return static_cast<std::int64_t>(c.a); };
      const auto id_b = [](const CreptContact &c) { return static_cast<std::int64_t>(c.b); };
      const auto viscous = [](const CreptContact &c) { return c.normal_viscous; };
      const auto retarded = [](const CreptContact &c) { return c.normal_retarded; };
      const auto slip = [](const CreptContact &c) { return c.shear_retarded; };
      file.write("/creep/grain_a", gather<std::int64_t>(crept, id_a), {n}, "-");
      file.write("/creep/grain_b", gather<std::int64_t>(crept, id_b), {n}, "-");
      file.write("/creep/normal_viscous", gather<double>(crept, viscous), {n}, "m");
      file.write("/creep/normal_retarded", gather<double>(crept, retarded), {n}, "m");
      file.write("/creep/shear_retarded", gather_vectors(crept, slip), {n, 3}, "m");
    }

    void read_creep(const Hdf5File &file, RevState &state)
    {
      if (!file.has("/creep/grain_a"))
        return;
      const std::vector<std::int64_t> a = file.read<std::int64_t>("/creep/grain_a", {any_number});
      const std::size_t n = a.size();
      const std::vector<std::int64_t> b = file.read<std::int64_t>("/creep/grain_b", {n});
      const std::vector<double> viscous = file.read<double>("/creep/normal_viscous", {n});
      const std::vector<double> retarded = file.read<double>("/creep/normal_retarded", {n});
      const std::vector<double> slip = file.read<double>("/creep/shear_retarded", {n, 3});
      for (std::size_t i = 0; i < n; ++i)
        state.add(CreptContact{static_cast<GrainId>(a[i]), static_cast<GrainId>(b[i]), viscous[i], retarded[i],
                               Vector(&slip[3 * i])});
    }

    void check_format(const Hdf5File &file)
    {
      const std::string format = file.read_attribute<std::string>("/", "format");
      if (format != format_name)
        reject(file, "foreign", "format is '" + format + "', not '" + format_name + "'");
      const auto version = file.read_attribute<std::uint64_t>("/", "format_version");
      if (version != format_version)
        reject(file, "wrong version",
               std::to_string(version) + ", this program reads " + std::to_string(format_version));
    }

    CellKind read_kind(const Hdf5File &file)
    {
      const std::string kind = file.read_attribute<std::string>("/cell/matrix", "kind");
      if (kind != "periodic" && kind != "rigid")
        reject(file, "/cell/matrix attribute kind", "'" + kind + "', neither 'periodic' nor 'rigid'");
      return kind == "rigid" ? CellKind::rigid : CellKind::periodic;
    }

    void read_state(const Hdf5File &file, Snapshot &snapshot)
    {
      RevState &state = snapshot.state;
      snapshot.info.seed = file.read_attribute<std::uint64_t>("/", "seed");
      snapshot.info.rev = file.read_attribute<std::uint64_t>("/", "rev");
      state.time = file.read_attribute<double>("/", "time_s");
      state.counters.cycles = file.read_attribute<std::uint64_t>("/", "cycles");
      state.counters.broken_instant = file.read_attribute<std::uint64_t>("/", "broken_instant");
      state.counters.broken_delayed = file.read_attribute<std::uint64_t>("/", "broken_delayed");
      state.counters.next_id = file.read_attribute<std::uint64_t>("/", "next_id");
      state.unbalanced_ratio = file.read_attribute<double>("/", "unbalanced_ratio");
      state.initial_solid_volume = file.read_attribute<double>("/", "initial_solid_volume_m3");
      state.cell.kind = read_kind(file);
      state.cell.edges = read_matrix(file, "/cell/matrix");
      state.cell.deformation = read_matrix(file, "/cell/deformation");
      state.rotation = read_matrix(file, "/cell/rotation");
      state.stress = read_matrix(file, "/state/stress");
      if (!(state.cell.compute_volume() > 0.))
        reject(file, "/cell/matrix", "its volume is not positive");
      if (state.cell.has_walls() && !state.cell.edges.isDiagonal(0.))
        reject(file, "/cell/matrix", "rigid walls must stand across the axes");
    }

    void read_rows(const Hdf5File &file, const std::string &first, const std::string &last, Column<Row> &rows)
    {
      const std::size_t n = rows.size();
      const std::vector<double> vectors = file.read<double>("/grains/" + first, {n, 3});
      const std::vector<double> scalars = file.read<double>("/grains/" + last, {n});
      for (std::size_t i = 0; i < n; ++i)
        rows[i] = {vectors[3 * i], vectors[3 * i + 1], vectors[3 * i + 2], scalars[i]};
    }

    template <typename T>
    void read_numbers(const Hdf5File &file, const std::string &name, Column<T> &numbers)
    {
      const std::vector<T> values = file.read<T>("/grains/" + name, {numbers.size()});
      std::copy(values.begin(), values.end(), numbers.begin());
    }

    void read_grains(const Hdf5File &file, RevState &state)
    {
      const std::vector<std::int64_t> id = file.read<std::int64_t>("/grains/id", {any_number});
      const std::size_t n = id.size();
      state.resize_grains(n);
      Grains &grains = state.grains;
      std::copy(id.begin(), id.end(), grains.id.begin());
      const std::vector<std::int64_t> parent = file.read<std::int64_t>("/grains/parent", {n});
      std::copy(parent.begin(), parent.end(), grains.parent.begin());
      read_numbers(file, "generation", grains.generation);
      read_rows(file, "fraction", "radius", grains.place);
      read_rows(file, "velocity", "mass", grains.velocity);
      read_rows(file, "spin", "moment", grains.spin);
      read_numbers(file, "strength", grains.strength);
      read_numbers(file, "crack_half_length", grains.crack_half_length);
      read_numbers(file, "crack_velocity", grains.crack_velocity);
      read_numbers(file, "largest_contact_stress", grains.largest_contact_stress);
      for (std::size_t i = 0; i < n; ++i)
        if (!(grains.place[i].w > 0.))
          reject(file, "/grains/radius",
                 "grain " + std::to_string(grains.id[i]) + " has radius " + std::to_string(grains.place[i].w) +
                     " m, not a positive one");
    }

    /** Places of the grains that a dataset names by id, walls as they are. */
    std::vector<std::uint32_t> read_places(const Hdf5File &file, const std::string &path,
                                           const std::unordered_map<std::int64_t, std::uint32_t> &place_of,
                                           const bool may_be_wall)
    {
      std::vector<std::uint32_t> places;
      for (const std::int64_t id : file.read<std::int64_t>(path, {any_number}))
        {
          if (may_be_wall && id < 0 && id >= -static_cast<std::int64_t>(n_walls))
            {
              places.push_back(static_cast<std::uint32_t>(id));
              continue;
            }
          const auto found = place_of.find(id);
          if (found == place_of.end())
            reject(file, path, "unknown grain " + std::to_string(id));
          places.push_back(found->second);
        }
      return places;
    }

    void read_contacts(const Hdf5File &file, RevState &state)
    {
      std::unordered_map<std::int64_t, std::uint32_t> place_of;
      for (std::uint32_t i = 0; i < state.grains.size(); ++i)
        if (!place_of.emplace(static_cast<std::int64_t>(state.grains.id[i]), i).second)
          reject(file, "/grains/id", "grain " + std::to_string(state.grains.id[i]) + " stands there twice");
      const std::vector<std::uint32_t> a = read_places(file, "/contacts/grain_a", place_of, false);
      const std::vector<std::uint32_t> b = read_places(file, "/contacts/grain_b", place_of, state.cell.has_walls());
      const std::size_t n = a.size();
      if (b.size() != n)
        reject(file, "/contacts/grain_b", "not as long as /contacts/grain_a");
      const std::vector<double> shear_force = file.read<double>("/contacts/shear_force", {n, 3});
      const std::vector<std::uint8_t> is_sliding = file.read<std::uint8_t>("/contacts/is_sliding", {n});
      state.resize_contacts(n);
      for (std::size_t i = 0; i < n; ++i)
        state.contacts[i] = {a[i], b[i], Vector(&shear_force[3 * i]), is_sliding[i] != 0};
    }

    std::size_t estimate_size(const RevState &state)
    {
      // bytes per grain and contact, rounded up
      return 256 * state.grains.size() + 128 * (state.contacts.size() + state.crept_contacts.size());
    }
  } // namespace

  void write_snapshot(const std::string &file, const RevState &state, const std::span<const Contact> contacts,
                      const SnapshotInfo &info)
  {
    assert(contacts.size() == state.contacts.size());
    const std::string temporary = file + ".tmp";
    try
      {
        create_hdf5_file(temporary);
        {
          Hdf5File hdf5(temporary, estimate_size(state));
          write_state(hdf5, state, info);
          write_grains(hdf5, state.cell, state.grains);
          write_contacts(hdf5, state, contacts);
          write_creep(hdf5, state.crept_contacts);
          hdf5.flush();
        }
        flush_and_rename(temporary, file);
      }
    catch (...)
      {
        std::error_code ignored; // what went wrong first is what counts
        std::filesystem::remove(temporary, ignored);
        throw;
      }
  }

  Snapshot read_snapshot(const std::string &file)
  {
    const Hdf5File hdf5(file);
    check_format(hdf5);
    Snapshot snapshot;
    read_state(hdf5, snapshot);
    read_grains(hdf5, snapshot.state);
    read_contacts(hdf5, snapshot.state);
    read_creep(hdf5, snapshot.state);
    return snapshot;
  }

  void write_bytes(const std::string &file, const std::string &dataset, const std::span<const std::byte> bytes)
  {
    Hdf5File hdf5(file, bytes.size());
    std::vector<std::uint8_t> values(bytes.size());
    if (!bytes.empty())
      std::memcpy(values.data(), bytes.data(), bytes.size());
    hdf5.write(dataset, values, {values.size()}, "-");
    hdf5.write_attribute(dataset, "checksum", compute_checksum(bytes));
    hdf5.flush();
  }

  std::vector<std::byte> read_bytes(const std::string &file, const std::string &dataset)
  {
    const Hdf5File hdf5(file);
    const std::vector<std::uint8_t> values = hdf5.read<std::uint8_t>(dataset, {any_number});
    std::vector<std::byte> bytes(values.size());
    if (!bytes.empty())
      std::memcpy(bytes.data(), values.data(), values.size());
    if (compute_checksum(bytes) != hdf5.read_attribute<std::uint64_t>(dataset, "checksum"))
      reject(hdf5, dataset, "corrupted, its checksum does not fit");
    return bytes;
  }

  bool has_bytes(const std::string &file, const std::string &dataset)
  {
    return Hdf5File(file).has(dataset);
  }

  void write_text(const std::string &file, const std::string &dataset, const std::string &text)
  {
    Hdf5File hdf5(file, text.size());
    hdf5.write_text(dataset, text);
    hdf5.flush();
  }

  std::string read_text(const std::string &file, const std::string &dataset)
  {
    return Hdf5File(file).read_text(dataset);
  }

  void create_file(const std::string &file)
  {
    create_hdf5_file(file);
  }

  void publish_file(const std::string &temporary, const std::string &file)
  {
    flush_and_rename(temporary, file);
  }
} // namespace dem

#include "dem/rev_state.h"

#include "dem/checksum.h"
#include "dem/spatial_order.h"
#include "dem/walls.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <stdexcept>
#include <string>
#include <type_traits>

namespace dem
{
  namespace
  {
    constexpr std::array<char, 8> magic = {'S', 'L', 'O', 'W', 'R', 'E', 'V', '\0'};

    // The bytes are the same; programs older than the walls must not take one kind of cell for the other. Where
    // contacts have crept the version is higher by two, and what has crept stands at the end: its number follows from
    // the length.
    constexpr std::uint64_t version_periodic = 1, version_rigid = 2, crept = 2;

    /** What stands before the body. Eight-byte fields only: no padding, the same bytes each time. */
    struct Header
    {
      std::array<char, 8> magic;
      std::uint64_t version;
      std::uint64_t n_bytes; ///< of the whole, header included
      std::uint64_t n_grains;
      std::uint64_t n_contacts;
      std::uint64_t checksum; ///< of the body
    };
    static_assert(sizeof(Header) == 48);

    class ByteWriter
    {
    public:
      template <typename T>
      void operator()(const T &value)
      {
        static_assert(std::is_trivially_copyable_v<T>);
        const std::byte *first = reinterpret_cast<const std::byte *>(&value);
        bytes_.insert(bytes_.end(), first, first + sizeof(T));
      }

      template <typename T>
      void operator()(const Column<T> &values)
      {
        static_assert(std::is_trivially_copyable_v<T>);
        const std::byte *first = reinterpret_cast<const std::byte *>(values.data());
        bytes_.insert(bytes_.end(), first, first + values.size() * sizeof(T));
      }

      template <int rows, int columns>
      void operator()(const Eigen::Matrix<double, rows, columns> &matrix)
      {
        for (Eigen::Index i = 0; i < matrix.size(); ++i)
          (*this)(matrix.data()[i]);
      }

      std::vector<std::byte> &bytes() { return bytes_; }

    private:
      std::vector<std::byte> bytes_;
    };

    /** Takes back what a ByteWriter wrote; vectors have their length already. @pre the bytes suffice */
    class ByteReader
    {
    public:
      explicit ByteReader(std::span<const std::byte> bytes) : rest_(bytes) {}

      template <typename T>
      void operator()(T &value)
      {
        take(&value, sizeof(T));
      }

      template <typename T>
      void operator()(Column<T> &values)
      {
        take(values.data(), values.size() * sizeof(T));
      }

      template <int rows, int columns>
      void operator()(Eigen::Matrix<double, rows, columns> &matrix)
      {
        take(matrix.data(), matrix.size() * sizeof(double));
      }

    private:
      void take(void *to, std::size_t n)
      {
        if (n > 0)
          std::memcpy(to, rest_.data(), n);
        rest_ = rest_.subspan(n);
      }

      std::span<const std::byte> rest_;
    };

    /** Shows every part of a state to `transfer`, in the order of the bytes: writing and reading cannot differ. */
    template <typename State, typename Transfer>
    void transfer_state(State &state, Transfer &transfer)
    {
      transfer(state.cell.edges);
      transfer(state.cell.deformation);
      auto &g = state.grains;
      transfer(g.place);
      transfer(g.velocity);
      transfer(g.spin);
      transfer(g.id);
      transfer(g.parent);
      transfer(g.generation);
      transfer(g.strength);
      transfer(g.crack_half_length);
      transfer(g.crack_velocity);
      transfer(g.largest_contact_stress);
      for (auto &contact : state.contacts)
        {
          transfer(contact.a);
          transfer(contact.b);
          transfer(contact.shear_force);
          transfer(contact.is_sliding);
        }
      transfer(state.stress);
      transfer(state.rotation);
      transfer(state.time);
      transfer(state.unbalanced_ratio);
      transfer(state.initial_solid_volume);
      transfer(state.counters.cycles);
      transfer(state.counters.broken_instant);
      transfer(state.counters.broken_delayed);
      transfer(state.counters.next_id);
      for (auto &contact : state.crept_contacts)
        {
          transfer(contact.a);
          transfer(contact.b);
          transfer(contact.normal_viscous);
          transfer(contact.normal_retarded);
          transfer(contact.shear_retarded);
        }
    }

    constexpr std::size_t bytes_per_grain = 3 * sizeof(Row) + 2 * sizeof(GrainId) + sizeof(std::uint32_t) + 4 * 8;
    constexpr std::size_t bytes_per_contact = 2 * sizeof(std::uint32_t) + 3 * sizeof(double) + sizeof(bool);
    constexpr std::size_t bytes_per_crept_contact = 2 * sizeof(GrainId) + 5 * sizeof(double);
    constexpr std::size_t bytes_of_the_rest = (4 * 9 + 3) * sizeof(double) + 4 * sizeof(std::uint64_t);

    [[noreturn]] void reject(const std::string &why)
    {
      throw std::runtime_error("state of a REV: " + why);
    }

    std::size_t count_bytes_without_creep(const std::size_t n_grains, const std::size_t n_contacts)
    {
      return sizeof(Header) + n_grains * bytes_per_grain + n_contacts * bytes_per_contact + bytes_of_the_rest;
    }

    /** The header, once magic, version, lengths and checksum have been found right. */
    Header check_header(std::span<const std::byte> bytes)
    {
      const std::string n_given = std::to_string(bytes.size());
      Header header{};
      if (bytes.size() >= magic.size() && std::memcmp(bytes.data(), magic.data(), magic.size()) != 0)
        reject("foreign: the bytes do not begin as one");
      if (bytes.size() < sizeof(Header))
        reject("truncated: " + n_given + " bytes do not hold its header");
      std::memcpy(&header, bytes.data(), sizeof(Header));
      if (header.version < version_periodic || header.version > version_rigid + crept)
        reject("wrong version: " + std::to_string(header.version) + ", this program reads " +
               std::to_string(version_periodic) + " to " + std::to_string(version_rigid + crept));
      if (bytes.size() < header.n_bytes)
        reject("truncated: " + n_given + " of " + std::to_string(header.n_bytes) + " bytes");
      // The counts first: a corrupted one could overflow the product.
      const std::size_t least = count_bytes_without_creep(std::min<std::size_t>(header.n_grains, bytes.size()),
                                                          std::min<std::size_t>(header.n_contacts, bytes.size()));
      const bool has_crept = header.version > version_rigid;
      if (bytes.size() != header.n_bytes || bytes.size() < least || has_crept != (bytes.size() > least) ||
          (bytes.size() - least) % bytes_per_crept_contact != 0)
        reject("corrupted: its lengths do not add up to " + n_given + " bytes");
      if (compute_checksum(bytes.subspan(sizeof(Header))) != header.checksum)
        reject("corrupted: the checksum does not fit");
      return header;
    }
  } // namespace

  std::size_t count_bytes(const RevState &state)
  {
    return sizeof state + state.count_bytes();
  }

  void sort_in_space(RevState &state)
  {
    const std::vector<std::uint32_t> order = compute_spatial_order(state.cell, state.grains.place);
    if (std::is_sorted(order.begin(), order.end()))
      return;
    state.grains.permute(order);
    std::vector<std::uint32_t> place(order.size());
    for (std::uint32_t i = 0; i < order.size(); ++i)
      place[order[i]] = i;
    for (ContactMemory &memory : state.contacts)
      {
        memory.a = place[memory.a];
        if (!is_wall(memory.b))
          memory.b = place[memory.b];
      }
  }

  std::vector<std::byte> serialise(const RevState &state)
  {
    ByteWriter writer;
    writer.bytes().reserve(count_bytes_without_creep(state.grains.size(), state.contacts.size()) +
                           state.crept_contacts.size() * bytes_per_crept_contact);
    writer(Header{});
    transfer_state(state, writer);
    std::vector<std::byte> bytes = std::move(writer.bytes());
    const std::span<const std::byte> body = std::span<const std::byte>(bytes).subspan(sizeof(Header));
    const Header header{magic,
                        (state.cell.has_walls() ? version_rigid : version_periodic) +
                            (state.crept_contacts.empty() ? 0 : crept),
                        bytes.size(),
                        state.grains.size(),
                        state.contacts.size(),
                        compute_checksum(body)};
    std::memcpy(bytes.data(), &header, sizeof(Header));
    return bytes;
  }

  RevState deserialise(std::span<const std::byte> bytes)
  {
    const Header header = check_header(bytes);
    RevState state;
    state.cell.kind = header.version % crept == version_rigid % crept ? CellKind::rigid : CellKind::periodic;
    const std::size_t n_crept =
        (bytes.size() - count_bytes_without_creep(header.n_grains, header.n_contacts)) / bytes_per_crept_contact;
    state.resize({header.n_grains, n_crept, header.n_contacts});
    ByteReader reader(bytes.subspan(sizeof(Header)));
    transfer_state(state, reader);
    for (const ContactMemory &contact : state.contacts)
      if (contact.a >= header.n_grains ||
          (contact.b >= header.n_grains && !(state.cell.has_walls() && is_wall(contact.b))))
        reject("corrupted: a contact with a grain that is not there");
    return state;
  }

  double compute_void_ratio(const RevState &state)
  {
    const double solids = compute_solid_volume(state.grains);
    return (state.cell.compute_volume() - solids) / solids;
  }

  double compute_void_ratio_with_fines(const RevState &state)
  {
    return (state.cell.compute_volume() - state.initial_solid_volume) / state.initial_solid_volume;
  }
} // namespace dem

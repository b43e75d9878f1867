#include "dem/rev_arrays.h"

#include "dem/memory.h"

#include <algorithm>
#include <cstring>
#include <utility>

namespace dem
{
  namespace
  {
    using Lengths = RevArrays::Lengths;

    // The order in the block. Calls the operation with which of the lengths is a column's, the column of the first
    // arrays, and the same one of the others.
    template <typename Operation, typename First, typename... Others>
    void for_each_column(const Operation &operation, First &arrays, Others &...others)
    {
      for_each_array([&](auto &...columns) { operation(&Lengths::grains, columns...); }, arrays.grains,
                     others.grains...);
      operation(&Lengths::crept_contacts, arrays.crept_contacts, others.crept_contacts...);
      operation(&Lengths::contacts, arrays.contacts, others.contacts...);
    }

    /** Bytes from one column to the next where the first has room for n. */
    template <typename T>
    std::size_t count_stride(const Column<T> &, const std::size_t n)
    {
      static_assert(alignof(T) <= cache_line);
      return (n * sizeof(T) + cache_line - 1) / cache_line * cache_line;
    }

    /** [bytes] */
    std::size_t count_block(const RevArrays &arrays, const Lengths &room)
    {
      std::size_t n_bytes = 0;
      const auto add = [&](const auto length, const auto &column) { n_bytes += count_stride(column, room.*length); };
      for_each_column(add, arrays);
      return n_bytes;
    }

    // Values are numbers and nothing else, to be copied as bytes; so are Eigen's fixed vectors, though their
    // constructors hide it from the compiler: hence void.
    void copy_bytes(const void *const from, const std::size_t n_bytes, void *const to)
    {
      if (n_bytes > 0)
        std::memcpy(to, from, n_bytes);
    }

    void clear_bytes(void *const first, const std::size_t n_bytes)
    {
      if (n_bytes > 0)
        std::memset(first, 0, n_bytes);
    }

    /** The first time no more than is asked for: most states never grow. */
    std::size_t choose_room(const std::size_t room, const std::size_t n)
    {
      return n <= room ? room : room == 0 ? n : n + n / 8 + 1;
    }
  } // namespace

  RevArrays &RevArrays::operator=(const RevArrays &other)
  {
    if (this != &other)
      copy(other);
    return *this;
  }

  RevArrays &RevArrays::operator=(RevArrays &&other) noexcept
  {
    swap(other);
    return *this;
  }

  void RevArrays::copy(const RevArrays &from)
  {
    const std::span<const std::byte> used = from.get_used_block();
    if (block_.size() < used.size())
      MemoryBlock(from.block_.size()).swap(block_);
    copy_bytes(used.data(), used.size(), block_.data());
    room_ = from.room_;
    place_columns(from.get_lengths());
  }

  void RevArrays::swap(RevArrays &other) noexcept
  {
    const Lengths own = get_lengths(), of_other = other.get_lengths();
    block_.swap(other.block_);
    std::swap(room_, other.room_);
    place_columns(of_other);
    other.place_columns(own);
  }

  void RevArrays::place_columns(const Lengths &lengths)
  {
    std::byte *next = block_.data();
    const auto place = [&]<typename T>(const auto length, Column<T> &column) {
      column.place(reinterpret_cast<T *>(next), lengths.*length);
      next += count_stride(column, room_.*length);
    };
    for_each_column(place, *this);
    const std::byte *const first = reinterpret_cast<const std::byte *>(contacts.data());
    room_.contacts = static_cast<std::size_t>(block_.data() + block_.size() - first) / sizeof(ContactMemory);
  }

  void RevArrays::make_room(const Lengths &lengths)
  {
    const Lengths larger{choose_room(room_.grains, lengths.grains),
                         choose_room(room_.crept_contacts, lengths.crept_contacts),
                         choose_room(room_.contacts, lengths.contacts)};
    if (larger != room_)
      move_into(larger);
  }

  void RevArrays::move_into(const Lengths &room)
  {
    RevArrays moved;
    MemoryBlock(count_block(*this, room)).swap(moved.block_);
    moved.room_ = room;
    moved.place_columns(get_lengths());
    const auto copy = []<typename T>(auto, const Column<T> &from, Column<T> &to) {
      copy_bytes(from.data(), from.size() * sizeof(T), to.data());
    };
    for_each_column(copy, std::as_const(*this), moved);
    swap(moved);
  }

  void RevArrays::resize(const Lengths &lengths)
  {
    make_room(lengths);
    const auto resize = [&]<typename T>(const auto length, Column<T> &column) {
      if (lengths.*length > column.size())
        clear_bytes(column.end(), (lengths.*length - column.size()) * sizeof(T));
      column.place(column.data(), lengths.*length);
    };
    for_each_column(resize, *this);
  }

  void RevArrays::resize_grains(const std::size_t n)
  {
    resize({n, crept_contacts.size(), contacts.size()});
  }

  void RevArrays::reserve_grains(const std::size_t n)
  {
    if (n > room_.grains)
      move_into({n, room_.crept_contacts, room_.contacts});
  }

  void RevArrays::resize_contacts(const std::size_t n)
  {
    resize({grains.size(), crept_contacts.size(), n});
  }

  void RevArrays::set_contacts(const std::span<const ContactMemory> values)
  {
    resize_contacts(values.size());
    std::copy(values.begin(), values.end(), contacts.begin());
  }

  void RevArrays::set_crept_contacts(const std::span<const CreptContact> values)
  {
    resize({grains.size(), values.size(), contacts.size()});
    std::copy(values.begin(), values.end(), crept_contacts.begin());
  }

  void RevArrays::add(const ContactMemory contact)
  {
    resize_contacts(contacts.size() + 1);
    contacts[contacts.size() - 1] = contact;
  }

  void RevArrays::add(const CreptContact contact)
  {
    resize({grains.size(), crept_contacts.size() + 1, contacts.size()});
    crept_contacts[crept_contacts.size() - 1] = contact;
  }

  std::span<const std::byte> RevArrays::get_used_block() const
  {
    const std::byte *const end = reinterpret_cast<const std::byte *>(contacts.end());
    return {block_.data(), static_cast<std::size_t>(end - block_.data())};
  }
} // namespace dem

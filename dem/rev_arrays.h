#pragma once

#include "dem/grains.h"
#include "dem/memory_block.h"

#include <span>

namespace dem
{
  /** What a touching pair remembers. The order of these is the order in which forces are summed: part of the state. */
  struct ContactMemory
  {
    std::uint32_t a, b; ///< places in the arrays of the grains; b may stand for a wall (dem/walls.h)
    Vector shear_force; ///< t, acts on a [N]
    bool is_sliding;
  };

  /** What has crept at a Burgers contact. Grains by their ids, so that it outlives sorting, splitting and new networks;
   * a wall's id is its number below zero. It is forgotten once the contact is open at rest. */
  struct CreptContact
  {
    GrainId a, b;           ///< a below b
    double normal_viscous;  ///< of the dashpot in series; the overlap's spring feels so much less [m]
    double normal_retarded; ///< of the Kelvin element, likewise [m]
    Vector shear_retarded;  ///< slip of b beside a that the Kelvin element holds [m]
  };

  /**
   * The arrays of a state in one block of memory, one behind another, each beginning with a cache line: a state is kept
   * or restored by one memcpy, which asks for no memory where the block is large enough.
   *
   * Grains, contacts that have crept, contacts, in this order. Each has room; where it is not enough all move into a
   * larger block, with an eighth more room than was asked for: growing grain by grain moves rarely. Contacts stand
   * last, since their number changes most: room behind them is copied by nobody.
   */
  struct RevArrays
  {
    struct Lengths
    {
      std::size_t grains = 0, crept_contacts = 0, contacts = 0;
      bool operator==(const Lengths &) const = default;
    };

    Grains grains;
    Column<CreptContact> crept_contacts; ///< by a, then b; empty but for Burgers contacts
    Column<ContactMemory> contacts;

    RevArrays() = default;
    RevArrays(const RevArrays &other) { copy(other); }
    RevArrays(RevArrays &&other) noexcept { swap(other); }
    RevArrays &operator=(const RevArrays &other);
    RevArrays &operator=(RevArrays &&other) noexcept;
    ~RevArrays() = default;

    /** What is there stays, what is new is zero. References to the arrays stay valid, those to values do not. */
    void resize(const Lengths &lengths);
    void resize_grains(std::size_t n);
    /** Room for n grains in all: rows of more than there are may be written behind those of the grains. */
    void reserve_grains(std::size_t n);
    void resize_contacts(std::size_t n);

    void set_contacts(std::span<const ContactMemory> values);      ///< @pre not its own
    void set_crept_contacts(std::span<const CreptContact> values); ///< @pre not its own
    void add(ContactMemory contact);
    void add(CreptContact contact);

    Lengths get_lengths() const { return {grains.size(), crept_contacts.size(), contacts.size()}; }

    std::size_t count_bytes() const { return block_.size(); } ///< memory that it holds

    /** The piece of memory in which all of it lies, from the first grain to the last contact: what a copy copies. */
    std::span<const std::byte> get_used_block() const;

  private:
    void copy(const RevArrays &from);
    void swap(RevArrays &other) noexcept;
    void make_room(const Lengths &lengths);
    void move_into(const Lengths &room);
    void place_columns(const Lengths &lengths);

    MemoryBlock block_;
    Lengths room_; // contacts have what the others leave of the block
  };
} // namespace dem

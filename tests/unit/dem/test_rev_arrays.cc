#include "dem/memory.h"
#include "dem/rev_arrays.h"

#include <gtest/gtest.h>

#include <cstring>
#include <set>

namespace
{
  using namespace dem;

  /** No two values alike. */
  RevArrays make_arrays(const std::size_t n_grains, const std::size_t n_crept, const std::size_t n_contacts)
  {
    RevArrays arrays;
    arrays.resize({n_grains, n_crept, n_contacts});
    double next = 0.5;
    for_each_array(
        [&next]<typename T>(Column<T> &column) {
          for (T &value : column)
            if constexpr (std::is_same_v<T, Row>)
              value = {next += 1., next += 1., next += 1., next += 1.};
            else
              value = static_cast<T>(next += 1.);
        },
        arrays.grains);
    for (CreptContact &crept : arrays.crept_contacts)
      crept = {static_cast<GrainId>(next += 1.), static_cast<GrainId>(next += 1.), next += 1., next += 1.,
               Vector(next += 1., next += 1., next += 1.)};
    for (ContactMemory &memory : arrays.contacts)
      memory = {static_cast<std::uint32_t>(next += 1.), static_cast<std::uint32_t>(next += 1.),
                Vector(next += 1., next += 1., next += 1.), (static_cast<int>(next) & 4) != 0};
    return arrays;
  }

  /** The bytes of each array, in the order of the block. */
  std::vector<std::span<const std::byte>> list_bytes(const RevArrays &arrays)
  {
    std::vector<std::span<const std::byte>> bytes;
    const auto append = [&bytes](const auto &column) { bytes.push_back(std::as_bytes(std::span(column))); };
    for_each_array(append, arrays.grains);
    append(arrays.crept_contacts);
    append(arrays.contacts);
    return bytes;
  }

  bool are_equal(const std::span<const std::byte> first, const std::span<const std::byte> second)
  {
    return first.size() == second.size() &&
           (first.empty() || std::memcmp(first.data(), second.data(), first.size()) == 0);
  }

  /** Whether the first n values of each array are the same, n the lengths of `fewer`. */
  void expect_beginning(const RevArrays &arrays, const RevArrays &fewer)
  {
    const auto all = list_bytes(arrays), kept = list_bytes(fewer);
    for (std::size_t k = 0; k < all.size(); ++k)
      EXPECT_TRUE(are_equal(all[k].first(kept[k].size()), kept[k])) << k;
  }

  void expect_same(const RevArrays &first, const RevArrays &second)
  {
    EXPECT_EQ(first.get_lengths(), second.get_lengths());
    expect_beginning(first, second);
  }

  TEST(RevArrays, AllLiesInOneBlock)
  {
    // Law: each array begins with a cache line, behind the one before it and within the one piece of memory that a copy
    // takes over, which ends with the last contact; empty ones too. Exact.
    for (const RevArrays &arrays : {make_arrays(37, 3, 80), make_arrays(1, 0, 0), make_arrays(0, 0, 5), RevArrays()})
      {
        const std::span<const std::byte> block = arrays.get_used_block();
        const std::byte *end = block.data();
        for (const std::span<const std::byte> bytes : list_bytes(arrays))
          {
            EXPECT_EQ(reinterpret_cast<std::uintptr_t>(bytes.data()) % cache_line, 0u);
            EXPECT_GE(bytes.data(), end);
            end = bytes.data() + bytes.size();
          }
        EXPECT_EQ(end, block.data() + block.size());
        EXPECT_LE(block.size(), arrays.count_bytes());
      }
  }

  TEST(RevArrays, ACopyIsTheSameBlockElsewhere)
  {
    // Law: the bytes of a copy are those of the block, gaps included, and its arrays lie at the same distances from its
    // beginning: one memcpy. Neither feels what becomes of the other. Exact.
    const RevArrays arrays = make_arrays(37, 3, 80);
    RevArrays copy = arrays;
    EXPECT_TRUE(are_equal(copy.get_used_block(), arrays.get_used_block()));
    const auto here = list_bytes(arrays), there = list_bytes(copy);
    for (std::size_t k = 0; k < here.size(); ++k)
      {
        EXPECT_EQ(here[k].data() - arrays.get_used_block().data(), there[k].data() - copy.get_used_block().data());
        EXPECT_NE(here[k].data(), there[k].data());
      }
    const RevArrays kept = copy;
    copy.grains.place[36].w = -1.;
    copy.grains.largest_contact_stress[0] = -1.;
    copy.crept_contacts[2].b = 0;
    copy.contacts[79].shear_force.z() = -1.;
    expect_same(arrays, kept);
    EXPECT_FALSE(are_equal(copy.get_used_block(), arrays.get_used_block()));
  }

  TEST(RevArrays, ACopyIntoRoomThatIsThereAsksForNone)
  {
    // Law: kept and restored as often as you like, and whatever was there before, a block that is large enough stays.
    const RevArrays large = make_arrays(60, 2, 130), small = make_arrays(37, 3, 80);
    RevArrays here = large, there = large;
    const std::byte *const block = here.get_used_block().data();
    for (int i = 0; i < 3; ++i)
      {
        here = small;
        expect_same(here, small);
        there = here;
        here = large;
        expect_same(here, large);
        EXPECT_EQ(here.get_used_block().data(), block);
      }
    expect_same(there, small);
    there = large; // and one that has become too small does not
    expect_same(there, large);
    here = here;
    expect_same(here, large);
  }

  TEST(RevArrays, MoreContactsUseWhatIsLeftOfALargerBlock)
  {
    // Law: room for contacts is what a block has left, also where a copy came from a smaller one: a trial that starts
    // from the same state again and again and finds more contacts asks for memory once.
    const RevArrays start = make_arrays(37, 0, 80);
    RevArrays trial = start;
    trial.resize_contacts(100);
    const std::byte *const block = trial.get_used_block().data();
    trial = start;
    trial.resize_contacts(100);
    EXPECT_EQ(trial.get_used_block().data(), block);
    expect_beginning(trial, start);
  }

  TEST(RevArrays, GrowthKeepsEveryBitAndMovesRarely)
  {
    // Law: what was there stays, what is new is zero, and arrays that double in steps move six times at most: each time
    // they have an eighth more room, 1.125^6 > 2. Contacts that come one by one are like that too.
    const RevArrays start = make_arrays(1000, 0, 2500);
    RevArrays arrays = start;
    std::set<const std::byte *> blocks;
    for (std::size_t n = 1000; n <= 2000; n += 14)
      {
        arrays.resize_grains(n);
        blocks.insert(arrays.get_used_block().data());
      }
    EXPECT_LE(blocks.size(), 7u);
    expect_beginning(arrays, start);
    EXPECT_EQ(arrays.grains.spin[1993].w, 0.);
    EXPECT_EQ(arrays.grains.parent[1993], 0u);
    blocks.clear();
    for (std::uint32_t i = 0; i < 2500; ++i)
      {
        arrays.add(ContactMemory{i, i + 1, Vector(1., 2., 3.), true});
        blocks.insert(arrays.get_used_block().data());
      }
    EXPECT_LE(blocks.size(), 7u);
    expect_beginning(arrays, start);
    EXPECT_EQ(arrays.contacts[4999].b, 2500u);
    arrays.add(CreptContact{1, 2, 3., 4., Vector(5., 6., 7.)});
    expect_beginning(arrays, start);
    EXPECT_EQ(arrays.crept_contacts[0].shear_retarded.z(), 7.);
    EXPECT_EQ(arrays.contacts[4999].b, 2500u);
  }

  TEST(RevArrays, RoomBehindGrainsBelongsToNobody)
  {
    // Law: reserving keeps every bit and every length; what is written behind the grains changes none of the arrays,
    // and grains that come there are zero; room that is there already moves nothing.
    const RevArrays start = make_arrays(100, 2, 200);
    RevArrays arrays = start;
    arrays.reserve_grains(130);
    expect_same(arrays, start);
    const std::byte *const block = arrays.get_used_block().data();
    for (Column<Row> *rows : {&arrays.grains.place, &arrays.grains.velocity, &arrays.grains.spin})
      std::fill_n(rows->data() + 100, 30, Row{1., 2., 3., 4.});
    expect_same(arrays, start);
    arrays.reserve_grains(120);
    arrays.resize_grains(130);
    EXPECT_EQ(arrays.get_used_block().data(), block);
    EXPECT_EQ(arrays.grains.place[129].w, 0.);
    expect_beginning(arrays, start);
  }

  TEST(RevArrays, ShrinkingAndGrowingAgainStaysInPlace)
  {
    // Law: grains that are taken out leave room; a copy of what is left has what is left. New values are zero though
    // others stood there.
    const RevArrays start = make_arrays(100, 2, 200);
    RevArrays arrays = start;
    const std::byte *const block = arrays.get_used_block().data();
    std::vector<bool> is_kept(100, true);
    is_kept[0] = is_kept[50] = false;
    arrays.grains.keep(is_kept);
    arrays.contacts.erase_if([](const ContactMemory &memory) { return memory.is_sliding; });
    ASSERT_EQ(arrays.grains.size(), 98u);
    EXPECT_EQ(arrays.grains.strength[0], start.grains.strength[1]);
    EXPECT_EQ(arrays.grains.strength[97], start.grains.strength[99]);
    const RevArrays copy = arrays;
    expect_same(copy, arrays);
    arrays.resize_grains(100);
    EXPECT_EQ(arrays.get_used_block().data(), block);
    EXPECT_EQ(arrays.grains.strength[97], start.grains.strength[99]);
    EXPECT_EQ(arrays.grains.strength[99], 0.);
    arrays.resize_contacts(200);
    EXPECT_EQ(arrays.get_used_block().data(), block);
    EXPECT_EQ(arrays.contacts[199].a, 0u);
    EXPECT_EQ(arrays.contacts[199].shear_force, Vector::Zero());
    EXPECT_FALSE(arrays.contacts[199].is_sliding);
    expect_beginning(arrays, copy);
  }

  TEST(RevArrays, WhatIsMovedStaysWhereItIs)
  {
    // Law: moving hands the block over and copies nothing.
    const RevArrays start = make_arrays(37, 3, 80);
    RevArrays arrays = start;
    const std::byte *const block = arrays.get_used_block().data();
    RevArrays moved = std::move(arrays);
    EXPECT_EQ(moved.get_used_block().data(), block);
    expect_same(moved, start);
    RevArrays assigned = make_arrays(5, 0, 1);
    assigned = std::move(moved);
    EXPECT_EQ(assigned.get_used_block().data(), block);
    expect_same(assigned, start);
  }

  TEST(RevArrays, ContactsAreSetAsAWhole)
  {
    // Law: what is set is what is there; the grains stay.
    const RevArrays start = make_arrays(37, 3, 80), other = make_arrays(1, 8, 200);
    RevArrays arrays = start;
    arrays.set_contacts(other.contacts);
    arrays.set_crept_contacts(other.crept_contacts);
    EXPECT_EQ(arrays.get_lengths(), (RevArrays::Lengths{37, 8, 200}));
    const auto all = list_bytes(arrays), first = list_bytes(start), second = list_bytes(other);
    for (std::size_t k = 0; k < all.size(); ++k)
      EXPECT_TRUE(are_equal(all[k], k < all.size() - 2 ? first[k] : second[k])) << k;
  }
} // namespace

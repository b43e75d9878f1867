#pragma once

#include "dem/contact_network.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <span>
#include <utility>
#include <vector>

namespace dem::cases
{
  /** The same contacts with the same memories, in whatever order. */
  inline void expect_same_memories(const std::span<const ContactMemory> first,
                                   const std::span<const ContactMemory> second)
  {
    std::vector found(first.begin(), first.end()), expected(second.begin(), second.end());
    const auto get_names = [](const ContactMemory &memory) { return std::pair(memory.a, memory.b); };
    std::ranges::sort(found, {}, get_names);
    std::ranges::sort(expected, {}, get_names);
    ASSERT_EQ(found.size(), expected.size());
    for (std::size_t i = 0; i < found.size(); ++i)
      {
        EXPECT_EQ(get_names(found[i]), get_names(expected[i]));
        EXPECT_EQ(found[i].shear_force, expected[i].shear_force);
        EXPECT_EQ(found[i].is_sliding, expected[i].is_sliding);
      }
  }
} // namespace dem::cases

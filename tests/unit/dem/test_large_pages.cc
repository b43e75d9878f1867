#include "dem/large_pages.h"
#include "dem/memory.h"

#include <gtest/gtest.h>

#include <cstdint>

namespace
{
  constexpr std::size_t page = std::size_t(2) << 20; // [bytes]

  std::size_t count_bytes_beyond(const void *const memory, const std::size_t unit)
  {
    return reinterpret_cast<std::uintptr_t>(memory) % unit;
  }
} // namespace

TEST(LargePages, LongArraysBeginWithAPageAndShortOnesWithACacheLine)
{
  EXPECT_EQ(count_bytes_beyond(dem::LongArray<double>(page / sizeof(double)).data(), page), 0u);
  for (const std::size_t n : {1u, 7u, 1000u})
    EXPECT_EQ(count_bytes_beyond(dem::LongArray<double>(n).data(), dem::cache_line), 0u);
}

TEST(LargePages, ArraysKeepTheirValuesAsTheyGrow)
{
  dem::LongArray<std::size_t> array;
  const std::size_t n = 3 * page / sizeof(std::size_t);
  for (std::size_t i = 0; i < n; ++i) // from less than a cache line to several pages
    array.push_back(i);
  for (std::size_t i = 0; i < n; ++i)
    ASSERT_EQ(array[i], i);
}

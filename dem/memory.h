#pragma once

#include <cstddef>
#include <vector>

namespace dem
{
  inline constexpr std::size_t cache_line = 64; ///< [bytes]

  /** Memory that some arrays hold [bytes]. */
  template <typename... T>
  std::size_t count_bytes(const std::vector<T> &...arrays)
  {
    return (std::size_t(0) + ... + (arrays.capacity() * sizeof(T)));
  }
} // namespace dem

#pragma once

#include <cstddef>

namespace dem
{
  inline constexpr std::size_t cache_line = 64; ///< [bytes]

  /** Memory that some arrays hold [bytes]. */
  template <typename... Array>
  std::size_t count_bytes(const Array &...arrays)
  {
    return (std::size_t(0) + ... + (arrays.capacity() * sizeof(typename Array::value_type)));
  }
} // namespace dem

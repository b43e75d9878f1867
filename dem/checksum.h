#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>

namespace dem
{
  /** FNV-1a in words of eight bytes: each step is a bijection, so a change within one word always shows. */
  inline std::uint64_t compute_checksum(const std::span<const std::byte> bytes)
  {
    std::uint64_t hash = 0xcbf29ce484222325ull;
    for (std::size_t at = 0; at < bytes.size(); at += 8)
      {
        std::uint64_t word = 0;
        std::memcpy(&word, bytes.data() + at, std::min<std::size_t>(8, bytes.size() - at));
        hash = (hash ^ word) * 0x100000001b3ull;
      }
    return hash;
  }
} // namespace dem

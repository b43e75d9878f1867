#pragma once

#include "dem/large_pages.h"

#include <cstddef>
#include <memory>
#include <utility>

namespace dem
{
  /** A piece of memory that begins with a cache line. What lies in it is its owner's affair. */
  class MemoryBlock
  {
  public:
    MemoryBlock() = default;
    explicit MemoryBlock(const std::size_t n_bytes)
        : bytes_(static_cast<std::byte *>(allocate_in_large_pages(n_bytes))), size_(n_bytes)
    {}

    std::byte *data() const { return bytes_.get(); }
    std::size_t size() const { return size_; } ///< [bytes]

    void swap(MemoryBlock &other) noexcept
    {
      bytes_.swap(other.bytes_);
      std::swap(size_, other.size_);
    }

  private:
    struct Free
    {
      void operator()(std::byte *const bytes) const { release_large_pages(bytes); }
    };

    std::unique_ptr<std::byte, Free> bytes_;
    std::size_t size_ = 0;
  };
} // namespace dem

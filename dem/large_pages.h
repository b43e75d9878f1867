#pragma once

#include <cstddef>
#include <vector>

/** Arrays that a loop passes through many times, in large pages of memory once they are longer than the caches. */
namespace dem
{
  /** Memory that begins with a cache line. From one large page (2 MiB) on it begins with such a page, and the system is
   * asked for as many as it fills: it then looks a place up once in 2 MiB instead of once in 4 KiB. Where it has none
   * to give nothing changes. @throws std::bad_alloc */
  void *allocate_in_large_pages(std::size_t n_bytes);

  void release_large_pages(void *memory) noexcept; ///< what allocate_in_large_pages gave

  /** The same for std::vector. */
  template <typename T>
  struct LargePages
  {
    using value_type = T;

    LargePages() = default;
    template <typename Other>
    LargePages(const LargePages<Other> &) noexcept
    {}

    T *allocate(const std::size_t n) { return static_cast<T *>(allocate_in_large_pages(n * sizeof(T))); }
    void deallocate(T *const first, std::size_t) noexcept { release_large_pages(first); }
    bool operator==(const LargePages &) const = default;
  };

  template <typename T>
  using LongArray = std::vector<T, LargePages<T>>;
} // namespace dem

#pragma once

#include "dem/memory.h"

/** Calls of memory into the caches of a core ahead of its use, which then need not wait for it. */
namespace dem
{
  namespace detail
  {
    constexpr int to_read = 0, to_write = 1, into_first = 3, into_second = 2; ///< as __builtin_prefetch numbers them

    /** Calls n objects, one of each line of the cache. */
    template <int use, int cache, typename T>
    [[gnu::always_inline]] inline void fetch(const T *const first, const std::size_t n)
    {
      for (std::size_t byte = 0; byte < n * sizeof(T); byte += cache_line)
        __builtin_prefetch(reinterpret_cast<const char *>(first) + byte, use, cache);
    }
  } // namespace detail

  /** Into the first cache, to be read soon. Nothing happens where there is no memory. */
  template <typename T>
  [[gnu::always_inline]] inline void fetch(const T *const first, const std::size_t n = 1)
  {
    detail::fetch<detail::to_read, detail::into_first>(first, n);
  }

  /** Into the first cache, to be written soon. */
  template <typename T>
  [[gnu::always_inline]] inline void fetch_to_write(const T *const first, const std::size_t n = 1)
  {
    detail::fetch<detail::to_write, detail::into_first>(first, n);
  }

  /** Into the second cache, to be read while other blocks of grains are computed. */
  template <typename T>
  [[gnu::always_inline]] inline void fetch_for_later(const T *const first, const std::size_t n = 1)
  {
    detail::fetch<detail::to_read, detail::into_second>(first, n);
  }
} // namespace dem

#include "dem/large_pages.h"

#include "dem/memory.h"

#include <cstdlib>
#include <new>
#include <sys/mman.h>

namespace dem
{
  namespace
  {
    /** A large one [bytes]. */
    constexpr std::size_t page = std::size_t(1) << 21;
  } // namespace

  void *allocate_in_large_pages(const std::size_t n_bytes)
  {
    const std::size_t n_pages = n_bytes / page;
    void *const memory = std::aligned_alloc(n_pages > 0 ? page : cache_line, n_bytes);
    if (!memory)
      throw std::bad_alloc();
    if (n_pages > 0)
      madvise(memory, n_pages * page, MADV_HUGEPAGE); // a wish: what it answers changes nothing
    return memory;
  }

  void release_large_pages(void *const memory) noexcept
  {
    std::free(memory);
  }
} // namespace dem

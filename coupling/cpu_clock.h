#pragma once

#include <ctime>
#include <functional>

namespace coupling
{
  /** Processor time that this thread has used [s]. A neighbour that takes the core away adds nothing to it. */
  inline double measure_thread_seconds()
  {
    timespec time{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
    return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
  }

  /** What costs are measured with: time that the calling thread has used since any moment [s]. */
  using CostClock = std::function<double()>;
} // namespace coupling

#pragma once

#include <chrono>

namespace apps
{
  using Clock = std::chrono::steady_clock;

  inline double measure_seconds_since(const Clock::time_point start)
  {
    return std::chrono::duration<double>(Clock::now() - start).count();
  }
} // namespace apps

#pragma once

#include <chrono>

namespace dem
{
  using Clock = std::chrono::steady_clock;

  inline double measure_seconds_since(const Clock::time_point start)
  {
    return std::chrono::duration<double>(Clock::now() - start).count();
  }

  /** Adds the time of its life to a sum. */
  class Stopwatch
  {
  public:
    explicit Stopwatch(double &sum) : sum_(sum), start_(Clock::now()) {}
    ~Stopwatch() { sum_ += measure_seconds_since(start_); }
    Stopwatch(const Stopwatch &) = delete;
    Stopwatch &operator=(const Stopwatch &) = delete;

  private:
    double &sum_;
    const Clock::time_point start_;
  };
} // namespace dem

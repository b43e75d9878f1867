#pragma once

#include <atomic>
#include <cstddef>
#include <functional>
#include <thread>
#include <vector>

namespace dem
{
  /** Waits until `is_done` says so: spins for a while, then gives way. */
  template <typename Condition>
  void wait_until(const Condition &is_done)
  {
    constexpr int spins = 4000; // some microseconds: longer than a servo's decision, shorter than a slice of time
    for (int spin = 0; !is_done(); ++spin)
      if (spin < spins)
        {
#ifdef __x86_64__
          __builtin_ia32_pause();
#endif
        }
      else
        std::this_thread::yield();
  }

  /**
   * A few threads that share short pieces of work, thousands of times a second. Each takes one contiguous share of the
   * tasks, always the same one, so that what it touches stays in its cache. The caller is one of them.
   *
   * Waiting threads spin for a while, then give way: more threads than cores are slow, but do not hang.
   */
  class Team
  {
  public:
    explicit Team(std::size_t n_threads);
    ~Team();
    Team(const Team &) = delete;
    Team &operator=(const Team &) = delete;

    /** Calls task(k) for k = 0 ... n_tasks - 1 and returns when all are done. Tasks must not throw. */
    void run(std::size_t n_tasks, const std::function<void(std::size_t)> &task);

    std::size_t size() const { return helpers_.size() + 1; }

  private:
    void help(std::size_t number);
    void do_share(std::size_t number) const;

    std::vector<std::thread> helpers_;
    const std::function<void(std::size_t)> *task_ = nullptr;
    std::size_t n_tasks_ = 0;
    std::atomic<std::size_t> n_started_ = 0; // pieces of work so far
    std::atomic<std::size_t> n_busy_ = 0;    // helpers that have not finished the present one
    std::atomic<bool> is_over_ = false;
  };
} // namespace dem

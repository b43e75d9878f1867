#include "dem/team.h"

namespace dem
{
  Team::Team(const std::size_t n_threads)
  {
    for (std::size_t number = 1; number < n_threads; ++number)
      helpers_.emplace_back([this, number] { help(number); });
  }

  Team::~Team()
  {
    is_over_ = true;
    n_started_.fetch_add(1);
    for (std::thread &helper : helpers_)
      helper.join();
  }

  void Team::run(const std::size_t n_tasks, const std::function<void(std::size_t)> &task)
  {
    if (n_tasks == 0)
      return;
    task_ = &task;
    n_tasks_ = n_tasks;
    n_busy_.store(helpers_.size(), std::memory_order_relaxed);
    n_started_.fetch_add(1, std::memory_order_release);
    do_share(0);
    wait_until([this] { return n_busy_.load(std::memory_order_acquire) == 0; });
  }

  void Team::do_share(const std::size_t number) const
  {
    const std::size_t n_threads = size();
    for (std::size_t k = n_tasks_ * number / n_threads; k < n_tasks_ * (number + 1) / n_threads; ++k)
      (*task_)(k);
  }

  void Team::help(const std::size_t number)
  {
    for (std::size_t n_seen = 0;; ++n_seen)
      {
        wait_until([&] { return n_started_.load(std::memory_order_acquire) != n_seen; });
        if (is_over_)
          return;
        do_share(number);
        n_busy_.fetch_sub(1, std::memory_order_release);
      }
  }
} // namespace dem

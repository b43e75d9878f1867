#include "coupling/work_sharing.h"

#include "dem/stopwatch.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstring>
#include <limits>
#include <thread>

namespace coupling
{
  namespace
  {
    constexpr int request_tag = 71, reply_tag = 72;
    constexpr std::uint64_t nothing = std::numeric_limits<std::uint64_t>::max();

    // How long the clerk sleeps: a REV's answer takes milliseconds, a message microseconds.
    constexpr std::chrono::microseconds while_working(300), while_idle(50);

    bool has_arrived(MPI_Comm communicator, const int source, const int tag, MPI_Status &status)
    {
      int is_there = 0;
      MPI_Iprobe(source, tag, communicator, &is_there, &status);
      return is_there != 0;
    }

    void record_worker(const double spent_s, const double wall_s, PhaseReport &report)
    {
      report.work_s += spent_s;
      report.longest_s = std::max(report.longest_s, spent_s);
      report.wall_s = std::max(report.wall_s, wall_s);
    }
  } // namespace

  WorkSharing::WorkSharing(MPI_Comm communicator, const unsigned int n_workers, const double smallest_cost,
                           const Travel &travel, const CostClock &clock)
      : communicator_(communicator), n_workers_(n_workers), smallest_cost_(smallest_cost), travel_(travel),
        clock_(clock)
  {}

  PhaseReport WorkSharing::run(const std::vector<WaitingRev> &waiting, const std::vector<unsigned int> &victims,
                               std::span<const PointId> question_ids, const Work &work)
  {
    waiting_.assign(waiting.begin(), waiting.end());
    victims_.assign(victims.begin(), victims.end());
    {
      std::vector<std::jthread> workers;
      for (unsigned int w = 0; w < n_workers_; ++w)
        workers.emplace_back([&]() { work_through(work); });
      serve(question_ids);
    }
    return report_;
  }

  // A worker: what was taken over first, since another rank waits for it no longer.
  void WorkSharing::work_through(const Work &work)
  {
    const double start = clock_();
    double wall_s = 0.;
    std::unique_lock lock(mutex_);
    while (!is_over_)
      {
        std::deque<WaitingRev> &queue = taken_.empty() ? waiting_ : taken_;
        if (queue.empty())
          {
            ++n_idle_;
            for_clerk_.notify_one();
            for_workers_.wait(lock, [&]() { return is_over_ || !waiting_.empty() || !taken_.empty(); });
            --n_idle_;
            continue;
          }
        const WaitingRev rev = queue.front();
        queue.pop_front();
        lock.unlock();
        try
          {
            const dem::Stopwatch watch(wall_s);
            work(rev);
            lock.lock();
          }
        catch (...)
          {
            lock.lock();
            keep_failure();
          }
      }
    record_worker(clock_() - start, wall_s, report_);
  }

  void WorkSharing::keep_failure()
  {
    if (!report_.failure)
      report_.failure = std::current_exception();
  }

  // Gives the costliest waiting REV to whoever asks, or says that there is none.
  bool WorkSharing::answer_requests()
  {
    MPI_Status status;
    bool has_answered = false;
    while (has_arrived(communicator_, MPI_ANY_SOURCE, request_tag, status))
      {
        MPI_Recv(nullptr, 0, MPI_BYTE, status.MPI_SOURCE, request_tag, communicator_, MPI_STATUS_IGNORE);
        std::vector<std::byte> message(sizeof(nothing));
        std::uint64_t question = nothing;
        {
          std::unique_lock lock(mutex_);
          if (!waiting_.empty() && waiting_.front().expected_s >= smallest_cost_)
            {
              const WaitingRev rev = waiting_.front();
              waiting_.pop_front();
              lock.unlock();
              try
                {
                  const std::vector<std::byte> bytes = travel_.pack(rev.id);
                  message.insert(message.end(), bytes.begin(), bytes.end());
                  question = rev.question;
                }
              catch (...) // the phase goes on, so that all ranks come to its end and hear of it
                {
                  lock.lock();
                  keep_failure();
                }
            }
        }
        std::memcpy(message.data(), &question, sizeof(question));
        // Blocking is safe: who asked has nothing to give, so no two ranks can wait for each other.
        MPI_Send(message.data(), static_cast<int>(message.size()), MPI_BYTE, status.MPI_SOURCE, reply_tag,
                 communicator_);
        has_answered = true;
      }
    return has_answered;
  }

  bool WorkSharing::receive_reply(std::span<const PointId> question_ids)
  {
    MPI_Status status;
    if (!is_asking_ || !has_arrived(communicator_, static_cast<int>(victims_.front()), reply_tag, status))
      return false;
    is_asking_ = false;
    int n_bytes = 0;
    MPI_Get_count(&status, MPI_BYTE, &n_bytes);
    std::vector<std::byte> message(static_cast<std::size_t>(n_bytes));
    MPI_Recv(message.data(), n_bytes, MPI_BYTE, status.MPI_SOURCE, reply_tag, communicator_, MPI_STATUS_IGNORE);
    std::uint64_t question = nothing;
    std::memcpy(&question, message.data(), sizeof(question));
    if (question == nothing)
      {
        victims_.pop_front();
        return true;
      }
    message.erase(message.begin(), message.begin() + sizeof(question));
    const PointId id = question_ids[question];
    std::unique_lock lock(mutex_, std::defer_lock);
    try
      {
        travel_.unpack(id, message);
        lock.lock();
      }
    catch (...)
      {
        lock.lock();
        keep_failure();
        return true;
      }
    ++report_.n_taken;
    report_.bytes_taken += message.size();
    taken_.push_back({id, question, 0.});
    for_workers_.notify_one();
    return true;
  }

  void WorkSharing::ask_for_work()
  {
    if (is_asking_ || victims_.empty())
      return;
    {
      const std::lock_guard lock(mutex_);
      if (n_idle_ == 0 || !waiting_.empty() || !taken_.empty())
        return;
    }
    MPI_Send(nullptr, 0, MPI_BYTE, static_cast<int>(victims_.front()), request_tag, communicator_);
    is_asking_ = true;
  }

  bool WorkSharing::is_idle()
  {
    const std::lock_guard lock(mutex_);
    return n_idle_ == n_workers_ && waiting_.empty() && taken_.empty() && !is_asking_ && victims_.empty();
  }

  void WorkSharing::serve(std::span<const PointId> question_ids)
  {
    MPI_Request barrier = MPI_REQUEST_NULL;
    for (bool has_begun = false;;)
      {
        ask_for_work();
        const bool has_acted = answer_requests() | receive_reply(question_ids);
        if (!has_begun && is_idle())
          {
            MPI_Ibarrier(communicator_, &barrier);
            has_begun = true;
          }
        int is_everyone_idle = 0;
        if (has_begun)
          MPI_Test(&barrier, &is_everyone_idle, MPI_STATUS_IGNORE);
        std::unique_lock lock(mutex_);
        if (is_everyone_idle != 0)
          {
            is_over_ = true;
            for_workers_.notify_all();
            return;
          }
        const bool is_someone_idle = n_idle_ > 0;
        if (has_acted)
          continue;
        if (is_someone_idle)
          for_clerk_.wait_for(lock, while_idle);
        else
          for_clerk_.wait_for(lock, while_working, [&]() { return n_idle_ > 0; });
      }
  }

  PhaseReport run_workers(const std::vector<WaitingRev> &waiting, const unsigned int n_workers, const CostClock &clock,
                          const WorkSharing::Work &work)
  {
    PhaseReport report;
    std::atomic<std::size_t> next = 0;
    std::mutex mutex;
    const auto run = [&]() {
      const double start = clock();
      const dem::Clock::time_point wall_start = dem::Clock::now();
      for (std::size_t i = next++; i < waiting.size(); i = next++)
        try
          {
            work(waiting[i]);
          }
        catch (...)
          {
            const std::lock_guard lock(mutex);
            report.failure = report.failure ? report.failure : std::current_exception();
          }
      const std::lock_guard lock(mutex);
      record_worker(clock() - start, dem::measure_seconds_since(wall_start), report);
    };
    std::vector<std::jthread> threads;
    for (unsigned int t = 1; t < std::min<std::size_t>(n_workers, waiting.size()); ++t)
      threads.emplace_back(run);
    run();
    threads.clear(); // waits for them
    return report;
  }
} // namespace coupling

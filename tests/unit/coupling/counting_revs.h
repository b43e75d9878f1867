#pragma once

#include "coupling/rev_pool.h"

#include <gtest/gtest.h>

#include <chrono>
#include <condition_variable>
#include <map>
#include <mutex>
#include <numeric>
#include <stdexcept>
#include <utility>
#include <vector>

/** REVs without grains, to see what moves between ranks and when. */
namespace counting_revs
{
  using coupling::PointId;
  using coupling::RevPool;

  inline constexpr double dear = 10e-3, cheap = 1e-4; // what an answer costs by the clock of the test [s]

  /** The test's clock: each thread's own, moved on by the work alone, so that costs are known beforehand. */
  inline thread_local double worked_s = 0.;

  /** REVs that count what they were asked, and are dear if they were dealt to the first rank. */
  class CountingRevs
  {
  public:
    CountingRevs(const coupling::BalanceRule &rule, const unsigned int n_threads)
        : pool_(MPI_COMM_WORLD, true, n_threads, rule)
    {
      pool_.set_clock([]() { return worked_s; });
      pool_.set_travel({[this](const PointId id) { return pack(id); },
                        [this](const PointId id, const std::vector<std::byte> &bytes) { unpack(id, bytes); }});
      for (PointId id = 0; id < n_revs; ++id)
        counts_[id] = absent;
      std::vector<PointId> ids(n_revs);
      std::iota(ids.begin(), ids.end(), 0);
      pool_.set_points(ids);
      for (const PointId id : pool_.get_local_points())
        counts_[id] = 0;
    }

    /** The first rank's answers wait until one of its REVs has left it: idle ranks must have come for work by then. */
    void wait_for_a_departure() { is_waiting_ = pool_.get_rank() == 0 && pool_.get_n_ranks() > 1; }

    /** The next REV that leaves this rank, or comes to it, does not succeed. */
    void fail_once_in_packing() { fails_in_packing_ = true; }
    void fail_once_in_unpacking() { fails_in_unpacking_ = true; }

    std::vector<double> ask()
    {
      return pool_.ask_all(coupling::WorkKind::evaluate, 2, [&](const PointId id, std::span<double> row) {
        if (is_waiting_)
          expect_departure();
        worked_s += id % pool_.get_n_ranks() == 0 ? dear : cheap;
        row[0] = id;
        row[1] = ++counts_.at(id);
      });
    }

    RevPool &get_pool() { return pool_; }

    /** How many of them are where the pool says they are. */
    unsigned int count_present()
    {
      unsigned int n = 0;
      for (const PointId id : pool_.get_local_points())
        n += counts_.at(id) != absent ? 1 : 0;
      return dealii::Utilities::MPI::sum(n, MPI_COMM_WORLD);
    }

    static constexpr PointId n_revs = 24;

  private:
    std::vector<std::byte> pack(const PointId id)
    {
      {
        const std::lock_guard lock(mutex_);
        has_departed_ = true;
        for_departure_.notify_all();
      }
      if (std::exchange(fails_in_packing_, false))
        throw std::runtime_error("it is too heavy");
      std::vector<std::byte> bytes(1 + 1000 * id); // different lengths, beyond what MPI buffers
      bytes[0] = static_cast<std::byte>(counts_.at(id));
      counts_.at(id) = absent;
      return bytes;
    }

    void unpack(const PointId id, const std::vector<std::byte> &bytes)
    {
      if (std::exchange(fails_in_unpacking_, false))
        throw std::runtime_error("it has lost a grain");
      EXPECT_EQ(bytes.size(), 1 + 1000 * id);
      EXPECT_EQ(counts_.at(id), absent);
      counts_.at(id) = static_cast<int>(bytes.at(0));
    }

    void expect_departure()
    {
      std::unique_lock lock(mutex_);
      // No bound of the test: whoever never comes is told by a failure and not by a test that hangs.
      EXPECT_TRUE(for_departure_.wait_for(lock, std::chrono::minutes(2), [&]() { return has_departed_; }));
    }

    static constexpr int absent = -1;
    RevPool pool_;
    std::map<PointId, int> counts_;
    std::mutex mutex_;
    std::condition_variable for_departure_;
    bool is_waiting_ = false, has_departed_ = false, fails_in_packing_ = false, fails_in_unpacking_ = false;
  };
} // namespace counting_revs

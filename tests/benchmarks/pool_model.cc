#include "tests/benchmarks/pool_model.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <fstream>
#include <map>
#include <queue>
#include <random>
#include <span>
#include <sstream>
#include <stdexcept>

namespace pool_model
{
  namespace
  {
    constexpr double cost_of_the_unknown = 1.; // [s], as in the pool

    /** The numbers of a row, by the columns step, stage, time_s, point, rank, cost_s, size_B. */
    std::vector<double> read_row(const std::string &line, const std::string &place)
    {
      std::vector<double> row;
      std::istringstream stream(line);
      for (std::string entry; std::getline(stream, entry, ',');)
        row.push_back(std::stod(entry));
      if (row.size() != 7)
        throw std::runtime_error(place + ": expected seven numbers");
      return row;
    }

    void require_header(std::istream &stream, const std::string &file)
    {
      std::string header;
      if (!std::getline(stream, header) || header != "step,stage,time_s,point,rank,cost_s,size_B")
        throw std::runtime_error(file + ":1: is no costs.csv");
    }
  } // namespace

  Recording read_recording(const std::string &file, const unsigned int stage)
  {
    std::ifstream stream(file);
    require_header(stream, file);
    std::map<double, std::map<double, std::pair<double, double>>> steps; // cost and size by step and point
    std::string line;
    for (int number = 2; std::getline(stream, line); ++number)
      {
        const auto row = read_row(line, file + ":" + std::to_string(number));
        if (stage == 0 || row[1] == stage)
          steps[row[0]][row[3]] = {row[5], row[6]};
      }
    if (steps.empty())
      throw std::runtime_error(file + ": holds no step of that stage");
    Recording recording;
    recording.sizes.assign(steps.begin()->second.size(), 0.);
    for (const auto &[step, points] : steps)
      {
        if (points.size() != recording.sizes.size())
          throw std::runtime_error(file + ": step " + std::to_string(step) + " has another number of points");
        std::vector<double> &costs = recording.costs.emplace_back();
        for (const auto &[point, numbers] : points)
          {
            double &size = recording.sizes[costs.size()];
            size = std::max(size, numbers.second);
            costs.push_back(numbers.first);
          }
      }
    return recording;
  }

  std::vector<std::size_t> resample(const std::size_t n_points, const std::size_t n_revs, const std::uint64_t seed)
  {
    std::mt19937_64 draw(seed);
    std::vector<std::size_t> sources(n_revs);
    for (std::size_t &source : sources)
      source = draw() % n_points;
    return sources;
  }

  namespace
  {
    /** A phase of work as work_sharing.h plays it, with events instead of threads. */
    class Phase
    {
    public:
      Phase(const Setup &setup, const std::vector<double> &costs, const std::vector<double> &expected,
            const std::vector<double> &sizes)
          : setup_(setup), costs_(costs), expected_(expected), sizes_(sizes), waiting_(setup.n_ranks),
            next_victim_(setup.n_ranks, 0), work_(setup.n_ranks, 0.)
      {}

      /** @param owners  of each REV; those that are taken over get another one */
      void run(std::vector<unsigned int> &owners, Outcome &outcome)
      {
        for (const std::size_t rev : coupling::sort_by_cost(expected_))
          waiting_[owners[rev]].push_back(rev);
        victims_ = coupling::sort_by_cost(coupling::compute_loads(owners, expected_, setup_.n_ranks));
        victims_.resize(std::min<std::size_t>(victims_.size(), setup_.n_victims));
        n_waiting_ = costs_.size();
        for (unsigned int rank = 0; rank < setup_.n_ranks; ++rank)
          events_.push({0., rank});
        while (!events_.empty())
          {
            const auto [time, rank] = events_.top();
            events_.pop();
            go_on(time, rank, owners, outcome);
          }
        outcome.clock_s += end_s_;
        outcome.busiest_s += *std::max_element(work_.begin(), work_.end());
      }

    private:
      using Event = std::pair<double, unsigned int>; ///< when which rank has nothing to do

      void go_on(const double time, const unsigned int rank, std::vector<unsigned int> &owners, Outcome &outcome)
      {
        if (!waiting_[rank].empty())
          {
            work_on(take_first(rank), rank, time);
            return;
          }
        if (!setup_.takes_over || next_victim_[rank] == victims_.size())
          {
            end_s_ = std::max(end_s_, time);
            return;
          }
        if (n_waiting_ == 0) // all that are left will refuse
          {
            const auto left = std::span(victims_).subspan(next_victim_[rank]);
            const auto n_left = static_cast<double>(left.size() - std::count(left.begin(), left.end(), rank));
            next_victim_[rank] = victims_.size();
            events_.push({time + n_left * setup_.reply_s, rank});
            return;
          }
        ask(static_cast<unsigned int>(victims_[next_victim_[rank]]), rank, time, owners, outcome);
      }

      void ask(const unsigned int victim, const unsigned int rank, const double time, std::vector<unsigned int> &owners,
               Outcome &outcome)
      {
        if (waiting_[victim].empty() || expected_[waiting_[victim].front()] < setup_.rule.smallest_cost)
          {
            ++next_victim_[rank];
            events_.push({victim == rank ? time : time + setup_.reply_s, rank});
            return;
          }
        const std::size_t rev = take_first(victim);
        owners[rev] = rank;
        ++outcome.n_taken;
        outcome.bytes_taken += sizes_[rev];
        work_on(rev, rank, time + setup_.reply_s + sizes_[rev] / setup_.bandwidth);
      }

      std::size_t take_first(const unsigned int rank)
      {
        const std::size_t rev = waiting_[rank].front();
        waiting_[rank].pop_front();
        --n_waiting_;
        return rev;
      }

      void work_on(const std::size_t rev, const unsigned int rank, const double time)
      {
        work_[rank] += costs_[rev];
        events_.push({time + costs_[rev], rank});
      }

      const Setup &setup_;
      const std::vector<double> &costs_, &expected_, &sizes_;
      std::vector<std::deque<std::size_t>> waiting_;
      std::vector<std::size_t> victims_; ///< the one with the most expected work first
      std::vector<std::size_t> next_victim_;
      std::vector<double> work_;
      std::priority_queue<Event, std::vector<Event>, std::greater<>> events_; ///< equal times by their ranks
      std::size_t n_waiting_ = 0;
      double end_s_ = 0.;
    };

    void smooth(double &expected, const double measured)
    {
      expected = std::isnan(expected) ? measured : 0.5 * (expected + measured);
    }

    /** Costs of a step spread over its phases: of each phase, of each REV. */
    std::vector<std::vector<double>> spread(const std::vector<double> &costs, const unsigned int n_phases,
                                            std::mt19937_64 &draw)
    {
      if (n_phases == 1)
        return {costs};
      std::vector<std::vector<double>> phases(n_phases, std::vector<double>(costs.size()));
      for (std::size_t i = 0; i < costs.size(); ++i)
        {
          double sum = 0.;
          for (auto &phase : phases)
            sum += phase[i] = -std::log((static_cast<double>(draw() >> 11) + 0.5) * 0x1p-53);
          for (auto &phase : phases)
            phase[i] *= costs[i] / sum;
        }
      return phases;
    }

    /** Moves REVs between steps. A rank's link carries what it sends and what comes. */
    void migrate(const std::vector<double> &expected, const std::vector<double> &sizes, const Setup &setup,
                 std::vector<unsigned int> &owners, Outcome &outcome)
    {
      std::vector<double> traffic(setup.n_ranks, 0.);
      for (const coupling::Move &move : coupling::plan_migration(owners, expected, setup.n_ranks, setup.rule.tolerance))
        {
          owners[move.rev] = move.to;
          traffic[move.from] += sizes[move.rev];
          traffic[move.to] += sizes[move.rev];
          outcome.bytes_migrated += sizes[move.rev];
          ++outcome.n_migrated;
        }
      outcome.clock_s += *std::max_element(traffic.begin(), traffic.end()) / setup.bandwidth;
    }
  } // namespace

  Outcome simulate(const Recording &recording, const std::vector<std::size_t> &sources, const Setup &setup)
  {
    const std::size_t n = sources.size();
    std::vector<unsigned int> owners(n);
    std::vector<double> sizes(n), costs(n), expected(n, std::nan("")), expected_of_step(n, std::nan(""));
    for (std::size_t i = 0; i < n; ++i)
      {
        owners[i] = static_cast<unsigned int>(i % setup.n_ranks); // dealt out like cards
        sizes[i] = recording.sizes[sources[i]];
      }
    std::mt19937_64 draw(setup.seed);
    Outcome outcome;
    for (const std::vector<double> &recorded : recording.costs)
      {
        for (std::size_t i = 0; i < n; ++i)
          costs[i] = recorded[sources[i]];
        for (const std::vector<double> &now : spread(costs, setup.n_phases, draw))
          {
            std::vector<double> known = expected;
            for (double &cost : known)
              cost = std::isnan(cost) ? cost_of_the_unknown : cost;
            Phase(setup, now, known, sizes).run(owners, outcome);
            double sum = 0.;
            for (std::size_t i = 0; i < n; ++i)
              {
                sum += now[i];
                smooth(expected[i], now[i]);
              }
            outcome.work_s += sum;
            outcome.shortest_s += std::max(sum / setup.n_ranks, *std::max_element(now.begin(), now.end()));
          }
        for (std::size_t i = 0; i < n; ++i)
          smooth(expected_of_step[i], costs[i]);
        if (setup.migrates)
          migrate(expected_of_step, sizes, setup, owners, outcome);
      }
    return outcome;
  }
} // namespace pool_model

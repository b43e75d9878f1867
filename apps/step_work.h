#pragma once

#include "apps/run_folder.h"

#include "dem/stopwatch.h"

#include <functional>

namespace apps
{
  /**
   * What the steps of a run cost on this rank: the way from one committed step to the next, without preparation, files
   * and load tests. A measurement: no result depends on it.
   */
  class StepWork
  {
  public:
    /** @param measure_profile  what the REVs of this rank have done so far; empty: there are none */
    explicit StepWork(std::function<dem::Profile()> measure_profile = {}) : measure_profile_(std::move(measure_profile))
    {}

    void resume();
    void pause();

    /** Figures of summary.json. @param n_threads  that work on REVs at once */
    void add_figures(unsigned int n_threads, Summary &summary) const;

  private:
    std::function<dem::Profile()> measure_profile_;
    bool is_running_ = false;
    dem::Clock::time_point wall_start_;
    double cpu_start_ = 0.; ///< [s]
    dem::Profile profile_start_;
    double wall_s_ = 0., cpu_s_ = 0.;
    dem::Profile profile_;
  };
} // namespace apps

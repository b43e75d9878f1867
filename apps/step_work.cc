#include "apps/step_work.h"

#include <ctime>

namespace apps
{
  namespace
  {
    /** Of all threads of this process [s]. */
    double measure_processor_time()
    {
      timespec now{};
      clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
      return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
    }
  } // namespace

  void StepWork::resume()
  {
    if (!measure_profile_)
      return;
    is_running_ = true;
    profile_start_ = measure_profile_();
    wall_start_ = dem::Clock::now();
    cpu_start_ = measure_processor_time();
  }

  void StepWork::pause()
  {
    if (!is_running_)
      return;
    is_running_ = false;
    wall_s_ += dem::measure_seconds_since(wall_start_);
    cpu_s_ += measure_processor_time() - cpu_start_;
    profile_ += compute_difference(measure_profile_(), profile_start_);
  }

  void StepWork::add_figures(const unsigned int n_threads, Summary &summary) const
  {
    if (!measure_profile_ || !(wall_s_ > 0.))
      return;
    summary.figures["steps: wall time [s]"] = wall_s_;
    summary.figures["steps: processor time [s]"] = cpu_s_;
    summary.figures["steps: runs of a REV to rest"] = static_cast<double>(profile_.n_rests);
    summary.figures["steps: cycles in them"] = static_cast<double>(profile_.n_cycles);
    summary.figures["steps: share of time outside cycles [-]"] =
        1. - profile_.compute_cycle_time() / (wall_s_ * n_threads);
  }
} // namespace apps

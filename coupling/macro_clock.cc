#include "coupling/macro_clock.h"

#include "dem/ageing.h"

#include <algorithm>
#include <limits>

namespace coupling
{
  namespace
  {
    /** One jump and what it breaks. */
    void jump(dem::Rev &rev, const double dt, AgeingReport &report)
    {
      const dem::RevState &baseline = rev.get_baseline();
      const std::size_t n_broken = rev.age(snap_to_fracture(baseline.grains, dt, baseline.time));
      report.n_broken += n_broken;
      if (n_broken > 0)
        report.rest = rev.relax();
    }

    /** Splits batch after batch until nothing is overstressed at this strain. */
    void exhaust_avalanche(dem::Rev &rev, const AgeingRule &rule, AgeingReport &report)
    {
      for (unsigned int round = 0; !report.has_failed(); ++round)
        {
          const std::size_t n_broken = rev.split_overstressed();
          if (n_broken == 0)
            return;
          report.n_broken += n_broken;
          report.is_capped = round >= rule.round_cap;
          report.rest = rev.relax();
        }
    }

    void age_through_batches(dem::Rev &rev, const double dt, const AgeingRule &rule, AgeingReport &report)
    {
      double left = dt;
      for (unsigned int round = 0; !report.has_failed(); ++round)
        {
          const double to_batch = rev.compute_time_to_next_batch();
          jump(rev, std::min(to_batch, left), report);
          if (!(to_batch < left))
            return;
          left -= to_batch;
          exhaust_avalanche(rev, rule, report);
          report.is_capped |= round >= rule.round_cap;
        }
    }

    void make_trial_the_baseline(dem::Rev &rev)
    {
      rev.deform(dem::Matrix::Identity());
    }
  } // namespace

  double compute_time_to_next_event(const dem::Rev &rev, const AgeingRule &rule, const unsigned int n_cuts)
  {
    return rule.mode == AgeingMode::events ? rev.compute_time_to_next_batch(n_cuts)
                                           : std::numeric_limits<double>::infinity();
  }

  bool can_cut_batch(const dem::Rev &rev, const AgeingRule &rule, const unsigned int n_cuts)
  {
    const auto compute_limit = [&](const unsigned int cuts) {
      return dem::compute_batch_limit(rev.get_model().fracture, rev.get_baseline().grains.size(), cuts);
    };
    return rule.mode == AgeingMode::events && compute_limit(n_cuts + 1) < compute_limit(n_cuts);
  }

  AgeingReport age(dem::Rev &rev, const double dt, const AgeingRule &rule)
  {
    AgeingReport report;
    if (rule.mode == AgeingMode::events)
      jump(rev, dt, report);
    else
      age_through_batches(rev, dt, rule, report);
    make_trial_the_baseline(rev);
    return report;
  }

  bool is_excessive(const dem::Rev &rev)
  {
    return rev.count_overstressed() >
           dem::compute_batch_limit(rev.get_model().fracture, rev.get_baseline().grains.size());
  }

  AgeingReport split_overstressed(dem::Rev &rev)
  {
    AgeingReport report;
    report.n_broken = rev.split_overstressed();
    if (report.n_broken > 0)
      report.rest = rev.relax();
    make_trial_the_baseline(rev);
    return report;
  }

  double snap_to_fracture(const dem::Grains &grains, const double dt, const double now)
  {
    const double rounding = 8. * std::numeric_limits<double>::epsilon() * (now + dt);
    double snapped = dt;
    for (const auto &[time, place] : dem::sort_times_to_fracture(grains))
      if (time > dt && time <= dt + rounding)
        snapped = time;
    return snapped;
  }
} // namespace coupling

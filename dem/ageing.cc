#include "dem/ageing.h"

#include "dem/fracture.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace dem
{
  std::vector<TimeToFracture> sort_times_to_fracture(const Grains &grains)
  {
    std::vector<TimeToFracture> times;
    for (std::size_t i = 0; i < grains.size(); ++i)
      {
        if (!(grains.crack_velocity[i] > 0.))
          continue;
        const double time =
            compute_time_to_fracture(grains.place[i].w, grains.crack_half_length[i], grains.crack_velocity[i]);
        if (std::isfinite(time))
          times.push_back({time, i});
      }
    std::sort(times.begin(), times.end(), [&](const TimeToFracture &first, const TimeToFracture &second) {
      return first.time != second.time ? first.time < second.time : grains.id[first.place] < grains.id[second.place];
    });
    return times;
  }

  double compute_time_to_batch(const Grains &grains, const std::size_t batch_limit)
  {
    const auto times = sort_times_to_fracture(grains);
    if (times.empty())
      return std::numeric_limits<double>::infinity();
    return times[std::min(batch_limit, times.size()) - 1].time;
  }

  std::vector<std::size_t> advance_cracks(Grains &grains, const double dt)
  {
    std::vector<std::size_t> broken;
    // A time just above dt can still grow a crack through by rounding: left whole, the grain would have no time left.
    for (const auto &[time, place] : sort_times_to_fracture(grains))
      if (time <= dt || grains.crack_half_length[place] + grains.crack_velocity[place] * dt >= grains.place[place].w)
        broken.push_back(place);
    for (std::size_t i = 0; i < grains.size(); ++i)
      grains.crack_half_length[i] += grains.crack_velocity[i] * dt;
    return broken;
  }
} // namespace dem

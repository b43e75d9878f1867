#pragma once

#include "dem/contact_forces.h"
#include "dem/contact_lanes.h"

namespace dem
{
  /** What ContactSums has of contacts: a sum a lane of V until the end of a block. */
  template <typename V>
  class LaneSums
  {
  public:
    /** @tparam L  V, or several of it  @param force  on a [N]  @param branch  x_b - x_a [m] */
    template <typename L, typename Mask>
    [[gnu::always_inline]] void add(const LaneVectorOf<L> &force, const LaneVectorOf<L> &branch,
                                    const NormalLanesOf<L> &normal, const L &distance, const Mask &is_touching)
    {
      const LaneVectorOf<L> &x = branch;
      moment_[0] += force.x * x.x, moment_[1] += force.x * x.y, moment_[2] += force.x * x.z;
      moment_[3] += force.y * x.x, moment_[4] += force.y * x.y, moment_[5] += force.y * x.z;
      moment_[6] += force.z * x.x, moment_[7] += force.z * x.y, moment_[8] += force.z * x.z;
      normal_force_ += normal.force;
      stiffness_moment_ += normal.stiffness * (distance * distance);
      n_touching_ += static_cast<std::size_t>(count(is_touching));
    }

    ContactSums add_up() const
    {
      ContactSums sums;
      for (int k = 0; k < 9; ++k)
        sums.force_times_branch(k / 3, k % 3) = sum_lanes(moment_[k]);
      sums.normal_force = sum_lanes(normal_force_);
      sums.stiffness_moment = sum_lanes(stiffness_moment_);
      sums.n_touching = n_touching_;
      return sums;
    }

  private:
    V moment_[9] = {0, 0, 0, 0, 0, 0, 0, 0, 0}, normal_force_ = 0, stiffness_moment_ = 0;
    std::size_t n_touching_ = 0;
  };
} // namespace dem

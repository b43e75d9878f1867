#pragma once

#include "dem/contact_forces.h"
#include "dem/single_twins.h"

namespace dem
{
  /** What ContactSums has of contacts, in single precision: a sum a lane until the end of a block. */
  class SingleSums
  {
  public:
    /** @param force  on a [N] @param branch  x_b - x_a [m] */
    template <typename L, typename Mask>
    [[gnu::always_inline]] void add(const LaneVectorOf<L> &force, const LaneVectorOf<L> &branch,
                                    const NormalLanesOf<L> &normal, const L &distance, const Mask &is_touching)
    {
      const LaneVectorOf<L> &x = branch;
      add_to(moment_[0], force.x * x.x), add_to(moment_[1], force.x * x.y), add_to(moment_[2], force.x * x.z);
      add_to(moment_[3], force.y * x.x), add_to(moment_[4], force.y * x.y), add_to(moment_[5], force.y * x.z);
      add_to(moment_[6], force.z * x.x), add_to(moment_[7], force.z * x.y), add_to(moment_[8], force.z * x.z);
      add_to(normal_force_, normal.force);
      add_to(stiffness_moment_, normal.stiffness * (distance * distance));
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
    template <typename L>
    [[gnu::always_inline]] static void add_to(Singles &sum, const L &value)
    {
      for_each_part<L>([&](const int part) { sum += get_part(value, part); });
    }

    Singles moment_[9] = {0.f, 0.f, 0.f, 0.f, 0.f, 0.f, 0.f, 0.f, 0.f}, normal_force_ = 0.f, stiffness_moment_ = 0.f;
    std::size_t n_touching_ = 0;
  };
} // namespace dem

#pragma once

#include "dem/contact_law.h"
#include "dem/lanes.h"
#include "dem/power.h"

#include <algorithm>

/** The contact law for sixteen contacts at once; compute_normal_response is its reference. */
namespace dem
{
  /** A vector of space, lane by lane. */
  struct LaneVector
  {
    Lanes x, y, z;
  };

  [[gnu::always_inline]] inline Lanes dot(const LaneVector &a, const LaneVector &b)
  {
    return a.x * b.x + a.y * b.y + a.z * b.z;
  }

  [[gnu::always_inline]] inline LaneVector cross(const LaneVector &a, const LaneVector &b)
  {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
  }

  /** sum + a x b */
  [[gnu::always_inline]] inline LaneVector add_cross(const LaneVector &sum, const LaneVector &a, const LaneVector &b)
  {
    return {sum.x + a.y * b.z - a.z * b.y, sum.y + a.z * b.x - a.x * b.z, sum.z + a.x * b.y - a.y * b.x};
  }

  /** a + factor b */
  [[gnu::always_inline]] inline LaneVector add(const LaneVector &a, const Lanes factor, const LaneVector &b)
  {
    return {a.x + factor * b.x, a.y + factor * b.y, a.z + factor * b.z};
  }

  struct NormalLanes
  {
    Lanes force;     ///< N [N], compression-positive
    Lanes stiffness; ///< kn [N/m]
  };

  struct ShearLanes
  {
    LaneVector force; ///< t on a [N]
    LaneMask is_sliding;
  };

  /** Plain Hertz, docs/theory.md Eq. 1. @param root_radius  sqrt(R*) [m^0.5] */
  [[gnu::always_inline]] inline NormalLanes compute_hertz_law(const ContactLaw &law, const Lanes overlap,
                                                              const Lanes root_radius)
  {
    constexpr double tiny = 1e-290; // keeps a touch of no depth from 0/0
    const double scale = 4. / 3. * law.effective_modulus;
    const Lanes root = root_radius * (overlap * compute_inverse_root(compute_larger(overlap, tiny)));
    return {scale * root * overlap, 1.5 * scale * root};
  }

  /** The three stages, docs/theory.md Eq. 2-5. @param root_radius  sqrt(R*) [m^0.5] */
  [[gnu::always_inline]] inline NormalLanes compute_rough_law(const ContactLaw &law, const Lanes overlap,
                                                              const Lanes root_radius)
  {
    // Of its length: a touch of no depth gives no force, no 0/0, and a power within its range whatever the exponent.
    const double smallest = std::exp2(-900. / std::max(law.b, law.c));
    const double first_length = 1. / law.dT1, second_length = 1. / (law.dT2 - law.d1);
    const LaneMask is_later = law.dT1 < overlap;
    const Lanes exponent = select(is_later, law.b, law.c);
    const Lanes length = select(is_later, second_length, first_length);
    const Lanes scale = select(is_later, law.force_scale_2, law.force_scale_1);
    const Lanes share = (overlap - keep(is_later, law.d1)) * length;
    const Lanes base = compute_larger(share, smallest);
    const Lanes force = root_radius * scale * compute_power(base, exponent);
    NormalLanes normal{force, force * exponent * length / base};

    const LaneMask is_hertz = law.dT2 < overlap;
    if (is_any(is_hertz))
      {
        const Lanes depth = select(is_hertz, overlap - (law.d1 + law.d2), 1.);
        const NormalLanes hertz = compute_hertz_law(law, depth, root_radius);
        normal.force = select(is_hertz, hertz.force, normal.force);
        normal.stiffness = select(is_hertz, hertz.stiffness, normal.stiffness);
      }
    return normal;
  }

  /**
   * The shear force turned into the present contact plane with its size kept, grown by kt du_t, capped at mu N
   * (docs/theory.md Eq. 12-13).
   *
   * @param before  shear force so far [N]   @param step  relative displacement of b at the contact [m]
   */
  [[gnu::always_inline]] inline ShearLanes compute_shear_law(const ContactLaw &law, const NormalLanes &normal,
                                                             const LaneVector &n, const LaneVector &before,
                                                             const LaneVector &step)
  {
    constexpr double tiny = 1e-200; // keeps an unloaded contact's zero shear from 0/0
    // What lies along the normal but for rounding has no direction in the plane to be turned to, and is left behind.
    constexpr double smallest_share = 1e-8;
    const Lanes square = dot(before, before), along = dot(before, n);
    const Lanes flat_square = compute_larger(square - along * along, smallest_share * square);
    const Lanes turn = square * compute_inverse_root(compute_larger(square * flat_square, tiny));
    const Lanes kt = law.shear_ratio * normal.stiffness;
    const LaneVector leaning{turn * before.x + kt * step.x, turn * before.y + kt * step.y,
                             turn * before.z + kt * step.z};
    const LaneVector grown = add(leaning, -dot(leaning, n), n);
    const Lanes cap = law.friction * normal.force;
    const Lanes size_square = dot(grown, grown);
    ShearLanes shear;
    shear.is_sliding = cap * cap < size_square;
    const Lanes share = select(shear.is_sliding, cap * compute_inverse_root(compute_larger(size_square, tiny)), 1.);
    shear.force = {share * grown.x, share * grown.y, share * grown.z};
    return shear;
  }
} // namespace dem

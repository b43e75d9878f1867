#pragma once

#include "dem/contact_law.h"
#include "dem/lanes.h"
#include "dem/power.h"

#include <algorithm>
#include <type_traits>

/** The contact law for many contacts at once, in any kind of lanes; compute_normal_response is its reference. */
namespace dem
{
  /** What the formulas below must know of the numbers in the lanes. */
  template <typename L>
  struct LaneLimits;

  template <>
  struct LaneLimits<Lanes>
  {
    using Real = double;
    static constexpr double depth = 1e-290;  ///< keeps a touch of no depth from 0/0 [m]
    static constexpr double square = 1e-200; ///< keeps an unloaded contact's zero shear from 0/0 [N2, N4]
  };

  /** A vector of space, lane by lane. */
  template <typename L>
  struct LaneVectorOf
  {
    L x, y, z;
  };

  using LaneVector = LaneVectorOf<Lanes>;

  template <typename L>
  [[gnu::always_inline]] inline L dot(const LaneVectorOf<L> &a, const LaneVectorOf<L> &b)
  {
    return a.x * b.x + a.y * b.y + a.z * b.z;
  }

  template <typename L>
  [[gnu::always_inline]] inline LaneVectorOf<L> cross(const LaneVectorOf<L> &a, const LaneVectorOf<L> &b)
  {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
  }

  /** sum + a x b */
  template <typename L>
  [[gnu::always_inline]] inline LaneVectorOf<L> add_cross(const LaneVectorOf<L> &sum, const LaneVectorOf<L> &a,
                                                          const LaneVectorOf<L> &b)
  {
    return {sum.x + a.y * b.z - a.z * b.y, sum.y + a.z * b.x - a.x * b.z, sum.z + a.x * b.y - a.y * b.x};
  }

  /** a + factor b */
  template <typename L>
  [[gnu::always_inline]] inline LaneVectorOf<L> add(const LaneVectorOf<L> &a, const std::type_identity_t<L> factor,
                                                    const LaneVectorOf<L> &b)
  {
    return {a.x + factor * b.x, a.y + factor * b.y, a.z + factor * b.z};
  }

  /** The constants of a contact law that all contacts share, ready to use. */
  template <typename Real>
  struct LaneLaw
  {
    Real hertz_scale;                  ///< 4/3 E* [Pa]
    Real friction, shear_ratio;        ///< [-]
    Real b, c;                         ///< exponents of stages 2 and 1 [-]
    Real d1, d12, dT1, dT2;            ///< d12 = d1 + d2 [m]
    Real first_length, second_length;  ///< one over the lengths of stages 1 and 2 [1/m]
    Real force_scale_1, force_scale_2; ///< [N/m^0.5]
    Real smallest_share; ///< of a length: a touch of no depth gives no force, no 0/0, and a power within its range [-]

    LaneLaw(const ContactLaw &law)
        : hertz_scale(4. / 3. * law.effective_modulus), friction(law.friction), shear_ratio(law.shear_ratio), b(law.b),
          c(law.c), d1(law.d1), d12(law.d1 + law.d2), dT1(law.dT1), dT2(law.dT2), first_length(1. / law.dT1),
          second_length(1. / (law.dT2 - law.d1)), force_scale_1(law.force_scale_1), force_scale_2(law.force_scale_2),
          smallest_share(std::exp2(-power_range / std::max(law.b, law.c)))
    {}

  private:
    static constexpr double power_range = std::is_same_v<Real, double> ? 900. : 100.; ///< binary digits below one
  };

  template <typename L>
  using LaneLawOf = LaneLaw<typename LaneLimits<L>::Real>;

  template <typename L>
  struct NormalLanesOf
  {
    L force;     ///< N [N], compression-positive
    L stiffness; ///< kn [N/m]
  };

  using NormalLanes = NormalLanesOf<Lanes>;

  template <typename L, typename Mask>
  struct ShearLanesOf
  {
    LaneVectorOf<L> force; ///< t on a [N]
    Mask is_sliding;
  };

  using ShearLanes = ShearLanesOf<Lanes, LaneMask>;

  /** Plain Hertz, docs/theory.md Eq. 1. @param root_radius  sqrt(R*) [m^0.5] */
  template <typename L>
  [[gnu::always_inline]] inline NormalLanesOf<L> compute_hertz_law(const LaneLawOf<L> &law, const L overlap,
                                                                   const L root_radius)
  {
    const L root = root_radius * compute_root(overlap);
    return {law.hertz_scale * root * overlap, typename LaneLimits<L>::Real(1.5) * law.hertz_scale * root};
  }

  /** The three stages, docs/theory.md Eq. 2-5. @param root_radius  sqrt(R*) [m^0.5] */
  template <typename L>
  [[gnu::always_inline]] inline NormalLanesOf<L> compute_rough_law(const LaneLawOf<L> &law, const L overlap,
                                                                   const L root_radius)
  {
    const auto is_later = L(law.dT1) < overlap;
    const L exponent = select(is_later, L(law.b), L(law.c));
    const L length = select(is_later, L(law.second_length), L(law.first_length));
    const L scale = select(is_later, L(law.force_scale_2), L(law.force_scale_1));
    const L share = (overlap - select(is_later, L(law.d1), L(0.f))) * length;
    const L base = compute_larger(share, L(law.smallest_share));
    const L force = root_radius * scale * compute_power(base, exponent);
    NormalLanesOf<L> normal{force, force * exponent * length / base};

    const auto is_hertz = L(law.dT2) < overlap;
    if (is_any(is_hertz))
      {
        const L depth = select(is_hertz, overlap - law.d12, L(1.f));
        const NormalLanesOf<L> hertz = compute_hertz_law(law, depth, root_radius);
        normal.force = select(is_hertz, hertz.force, normal.force);
        normal.stiffness = select(is_hertz, hertz.stiffness, normal.stiffness);
      }
    return normal;
  }

  /** What a shear force must grow by to keep its size when it loses its part along the normal [-]. In double.
   * @param square  of the shear force [N2]  @param along  its part along the normal [N] */
  [[gnu::always_inline]] inline Lanes compute_turn(const Lanes square, const Lanes along)
  {
    // What lies along the normal but for rounding has no direction in the plane to be turned to, and is left behind.
    constexpr double smallest_share = 1e-8;
    const Lanes flat_square = compute_larger(square - along * along, smallest_share * square);
    return square * compute_inverse_root(compute_larger(square * flat_square, LaneLimits<Lanes>::square));
  }

  /**
   * The shear force turned into the present contact plane with its size kept, grown by kt du_t, capped at mu N
   * (docs/theory.md Eq. 12-13).
   *
   * @param before  shear force so far [N]   @param step  relative displacement of b at the contact [m]
   */
  template <typename L>
  [[gnu::always_inline]] inline auto compute_shear_law(const LaneLawOf<L> &law, const NormalLanesOf<L> &normal,
                                                       const LaneVectorOf<L> &n, const LaneVectorOf<L> &before,
                                                       const LaneVectorOf<L> &step)
  {
    const L turn = compute_turn(dot(before, before), dot(before, n));
    const L kt = law.shear_ratio * normal.stiffness;
    const LaneVectorOf<L> leaning{turn * before.x + kt * step.x, turn * before.y + kt * step.y,
                                  turn * before.z + kt * step.z};
    const LaneVectorOf<L> grown = add(leaning, -dot(leaning, n), n);
    const L cap = law.friction * normal.force;
    const L size_square = dot(grown, grown);
    const auto is_sliding = cap * cap < size_square;
    const L inverse_size = compute_inverse_root(compute_larger(size_square, LaneLimits<L>::square));
    const L share = select(is_sliding, cap * inverse_size, L(1.f));
    return ShearLanesOf<L, std::remove_const_t<decltype(is_sliding)>>{
        {share * grown.x, share * grown.y, share * grown.z}, is_sliding};
  }
} // namespace dem

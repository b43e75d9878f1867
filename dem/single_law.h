#pragma once

#include "dem/contact_lanes.h"
#include "dem/single_power.h"

/** What the contact law in lanes needs to work in single precision. */
namespace dem
{
  template <>
  struct LaneLimits<Singles>
  {
    using Real = float;
    static constexpr float depth = 1e-36f;  ///< keeps a touch of no depth from 0/0 [m]
    static constexpr float square = 1e-36f; ///< keeps an unloaded contact's zero shear from 0/0 [N2]
  };

  [[gnu::always_inline]] inline bool is_any(const SinglesMask mask)
  {
    return count(mask) != 0;
  }

  /**
   * What a shear force must grow by to keep its size when it loses its part along the normal [-]. Fourth powers of
   * forces would leave the range of floats; and where a contact stands still this is one to the last bit, so that
   * nothing adds up over cycles.
   */
  [[gnu::always_inline]] inline Singles compute_turn(const Singles square, const Singles along)
  {
    constexpr float tiny = LaneLimits<Singles>::square;
    const Singles lost = along * along * estimate_inverse(compute_larger(square, tiny));
    return compute_inverse_root(compute_larger(1.f - lost, 1e-6f));
  }
} // namespace dem

#pragma once

#include "coupling/balance.h"

#include "fem/constitutive_model.h"

#include <deal.II/base/mpi.h>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

namespace coupling
{
  using fem::PointId;

  /** How a REV leaves a rank and comes to another one. Both are called for one REV at a time. */
  struct Travel
  {
    std::function<std::vector<std::byte>(PointId)> pack; ///< the REV is here no longer, unless it throws; never empty
    std::function<void(PointId, const std::vector<std::byte> &)> unpack; ///< the REV is here from now on
  };

  /**
   * Carries out moves that all ranks have planned alike, each REV at most once. Collective.
   *
   * @param points  of the places that the moves name
   * @return bytes sent by all ranks together
   *
   * If a REV cannot be packed or unpacked, the others are moved all the same, so that no rank waits for a message that
   * never comes; then its rank throws the first cause. The others hear of it through RevPool::agree().
   */
  std::uint64_t migrate(std::span<const Move> moves, std::span<const PointId> points, const Travel &travel,
                        MPI_Comm communicator);
} // namespace coupling

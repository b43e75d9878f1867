#pragma once

#include "dem/contact_network.h"
#include "dem/fetch.h"

#include <algorithm>

namespace dem
{
  /**
   * Gives the grains of a block what far pairs of other blocks do to them.
   *
   * @tparam R         what acts on a grain, of either precision
   * @param far_rows   what each far pair does to its second grain
   * @param rows       of the grains of the block, found by the number of a grain
   */
  template <typename R>
  void take_incoming(const ContactNetwork &network, const GrainBlock &block, const R *const far_rows, R *const rows)
  {
    constexpr std::size_t fetch_ahead = 100; // far pairs
    const std::uint32_t *const grains = network.incoming_grain.data(), *const far = network.incoming_far.data();
    const std::size_t end = block.incoming_end;
    for (std::size_t k = block.incoming_begin; k < end;)
      {
        const std::uint32_t grain = grains[k];
        auto sum = load_row(rows[grain]);
        do // in a register: through memory each addition would wait for the one before
          {
            fetch(far_rows + far[std::min(k + fetch_ahead, end - 1)]);
            sum += load_row(far_rows[far[k]]);
        } while (++k < end && grains[k] == grain);
        store_row(rows[grain], sum);
      }
  }
} // namespace dem

#pragma once

#include "dem/rev.h"

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

namespace coupling
{
  /**
   * A REV that waits for its next question, as bytes: committed and baseline state with the fractures that the baseline
   * has recorded. Its trial is left behind, since every question starts at the baseline. Its model is not part of it,
   * nor is what it has measured of itself.
   */
  std::vector<std::byte> pack_rev(const dem::Rev &rev);

  /** The same REV, every bit. Throws std::runtime_error saying what is wrong with the bytes. */
  std::unique_ptr<dem::Rev> unpack_rev(const dem::RevModel &model, std::span<const std::byte> bytes);
} // namespace coupling

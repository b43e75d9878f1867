#pragma once

#include "dem/rev.h"

#include <string>

namespace coupling
{
  /** Every parameter of a REV as "name = value" lines, all digits; units as in the structs. */
  std::string write_model_text(const dem::RevModel &model);

  /** Reads it back, the same bits. Throws std::runtime_error naming what is missing or no number. */
  dem::RevModel read_model_text(const std::string &text);
} // namespace coupling

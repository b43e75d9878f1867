#pragma once

#include <stdexcept>

namespace apps
{
  /** What the user gave is wrong: the message names file, line, parameter, value and allowed range. Exit status 2. */
  struct BadInput : std::runtime_error
  {
    using std::runtime_error::runtime_error;
  };
} // namespace apps

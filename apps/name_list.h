#pragma once

#include <string>
#include <vector>

namespace apps
{
  /** Names of a comma-separated list, without the blanks around them; empty ones are left out. */
  std::vector<std::string> split_names(const std::string &text);
} // namespace apps

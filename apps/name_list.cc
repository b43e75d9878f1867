#include "apps/name_list.h"

#include <sstream>

namespace apps
{
  std::vector<std::string> split_names(const std::string &text)
  {
    std::vector<std::string> names;
    std::string part;
    for (std::istringstream stream(text); std::getline(stream, part, ',');)
      if (std::string name; std::istringstream(part) >> name)
        names.push_back(name);
    return names;
  }
} // namespace apps

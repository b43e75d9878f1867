#pragma once

#include <functional>
#include <string>

namespace apps
{
  /**
   * run_guarded() for a program on several ranks. What all ranks find, the first one says, and the program ends in
   * order. An error of one rank alone would leave the others waiting for it: then the whole job is stopped.
   *
   * @pre MPI is initialised
   */
  int run_guarded_on_ranks(const std::string &program, const std::function<int()> &body);
} // namespace apps

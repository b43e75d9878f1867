#pragma once

#include "dem/stopwatch.h"

#include <string>

namespace apps
{
  /**
   * Tells the user what is going on, how far it is and how long it will take still: one line drawn over and over on a
   * terminal, plain lines now and then in a log.
   */
  class Progress
  {
  public:
    /** @param is_shown  false: silent (--quiet, ranks above the first) */
    explicit Progress(bool is_shown);
    ~Progress();

    /**
     * @param what   such as "creep 1.2e5 s, 31 grains broken"
     * @param share  of the whole run that is done, 0 to 1
     */
    void show(const std::string &what, double share);

    /** A line that stays: a stage begins, a step was cut. */
    void say(const std::string &line);

  private:
    void clear_line();

    bool is_shown_, is_terminal_;
    bool has_line_ = false;
    double first_share_ = -1.; // a resumed run does not start at 0
    dem::Clock::time_point start_, last_;
  };

  /** "4 h 05 min", "3 min 20 s", "12 s". */
  std::string describe_duration(double seconds);
} // namespace apps

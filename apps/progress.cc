#include "apps/progress.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <sys/ioctl.h>
#include <unistd.h>

namespace apps
{
  namespace
  {
    constexpr std::chrono::milliseconds terminal_pause(200);
    constexpr std::chrono::milliseconds log_pause(5000);

    std::size_t measure_terminal_width()
    {
      winsize size{};
      return ::ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 10 ? size.ws_col : 80;
    }
  } // namespace

  Progress::Progress(const bool is_shown)
      : is_shown_(is_shown), is_terminal_(::isatty(STDERR_FILENO) != 0), start_(dem::Clock::now()),
        last_(start_ - std::chrono::hours(1))
  {}

  Progress::~Progress()
  {
    if (has_line_)
      std::cerr << std::endl;
  }

  void Progress::show(const std::string &what, const double share)
  {
    if (first_share_ < 0.)
      first_share_ = share;
    const auto now = dem::Clock::now();
    if (!is_shown_ || now - last_ < (is_terminal_ ? terminal_pause : log_pause))
      return;
    last_ = now;
    std::string line = fmt::format("[{:3.0f} %] {}", 100. * std::clamp(share, 0., 1.), what);
    const double elapsed = dem::measure_seconds_since(start_);
    if (const double done = share - first_share_; done > 0.01 && share < 1.)
      line += fmt::format(", about {} left", describe_duration(elapsed * (1. - share) / done));
    if (!is_terminal_)
      {
        std::cerr << line + "\n" << std::flush;
        return;
      }
    clear_line();
    std::cerr << line.substr(0, measure_terminal_width() - 1) << std::flush;
    has_line_ = true;
  }

  void Progress::say(const std::string &line)
  {
    if (!is_shown_)
      return;
    clear_line();
    std::cerr << line + "\n" << std::flush;
  }

  void Progress::clear_line()
  {
    if (has_line_)
      std::cerr << "\r\033[K";
    has_line_ = false;
  }

  std::string describe_duration(const double seconds)
  {
    const auto total = static_cast<long>(std::llround(std::max(0., seconds)));
    if (total < 60)
      return fmt::format("{} s", total);
    if (total < 3600)
      return fmt::format("{} min {:02} s", total / 60, total % 60);
    return fmt::format("{} h {:02} min", total / 3600, total % 3600 / 60);
  }
} // namespace apps

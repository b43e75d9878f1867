"""Says how far a study is: one line drawn over and over on a terminal, plain lines now and then in a log."""

import os
import sys
import time

TERMINAL_PAUSE, LOG_PAUSE = 0.2, 5.  # [s], as the programs have them


class Progress:
    def __init__(self, is_shown):
        self._is_shown, self._is_terminal = is_shown, sys.stderr.isatty()
        self._last, self._has_line = -LOG_PAUSE, False

    def show(self, line):
        now = time.monotonic()
        if not self._is_shown or now - self._last < (TERMINAL_PAUSE if self._is_terminal else LOG_PAUSE):
            return
        self._last = now
        if not self._is_terminal:
            print(line, file=sys.stderr, flush=True)
            return
        width = os.get_terminal_size(sys.stderr.fileno()).columns
        print("\r\033[K" + line[:(width if width > 10 else 80) - 1], end="", file=sys.stderr, flush=True)
        self._has_line = True

    def say(self, line):
        """A line that stays."""
        if not self._is_shown:
            return
        print(("\r\033[K" if self._has_line else "") + line, file=sys.stderr, flush=True)
        self._has_line = False

    def end(self):
        if self._has_line:
            print(file=sys.stderr, flush=True)
        self._has_line = False


def describe_duration(seconds):
    """"4 h 05 min", "3 min 20 s", "12 s"."""
    total = max(0, round(seconds))
    if total < 60:
        return f"{total} s"
    if total < 3600:
        return f"{total // 60} min {total % 60:02} s"
    return f"{total // 3600} h {total % 3600 // 60:02} min"

"""A study from its plan to its tables."""

import dataclasses
import signal
import sys
import time

from plotting.errors import BadInput

from .progress import Progress, describe_duration
from .run_plan import plan_runs
from .run_queue import RunQueue
from .study_folder import FAILED, FINISHED, TIMED_OUT
from .tables import write_tables

TABLE_PAUSE = 5.  # [s] between two writings of the tables while runs go on
NO_RESULTS = "no results"  # of a run that finished, but left nothing where the study looks


class StudyRun:
    def __init__(self, study, folder, is_shown):
        self._study, self._folder, self._progress = study, folder, Progress(is_shown)
        self._runs = plan_runs(study)
        self._outcomes, self._results = {}, {}
        self._start, self._last_table, self._n_ended_now = time.monotonic(), time.monotonic(), 0

    def run(self, program, n_processes, retries_failed):
        """Exit status: 0 if all runs have finished, 1 otherwise."""
        for run in self._runs:
            outcome = self._folder.read_outcome(run.name)
            if outcome and (outcome.status == FINISHED or not retries_failed):
                self._take(run, outcome)
        waiting = [run for run in self._runs if run.name not in self._outcomes]
        self._progress.say(f"{len(self._runs)} runs, {len(waiting)} to be run, {n_processes} at a time, into "
                           f"{self._folder.path}")
        queue = RunQueue(program, self._study.case, self._folder, n_processes, self._study.timeout)
        for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
            signal.signal(number, lambda *_: queue.stop())
        try:
            is_whole = queue.work(waiting, self._end_run, self._watch)
        finally:
            self._write_tables()
            self._progress.end()
        return self._conclude(is_whole)

    def _end_run(self, run, outcome):
        self._take(run, outcome)
        self._n_ended_now += 1
        now = self._outcomes[run.name]
        if now.status != FINISHED:
            self._progress.say(f"{run.name}: {now.status}: {now.message}")

    def _take(self, run, outcome):
        """The outcome as the table has it, and the results of a run that finished."""
        if outcome.status == FINISHED:
            try:
                tables = {}
                folder = self._folder.get_run_folder(run.name)
                self._results[run.name] = [value for result in self._study.results
                                           for value in result.read(folder, tables)]
            except (BadInput, OSError) as error:
                outcome = dataclasses.replace(outcome, status=NO_RESULTS, message=str(error))
        self._outcomes[run.name] = outcome

    def _watch(self, n_active):
        n, n_ended = len(self._runs), len(self._outcomes)
        line = f"[{100 * n_ended // n:3} %] {n_ended} of {n} runs, {n_active} under way"
        n_failed = self._count_failed()
        line += f", {n_failed} failed" if n_failed else ""
        if self._n_ended_now and n_ended < n:  # those under way are half done, on average
            done = self._n_ended_now + n_active / 2
            left = (time.monotonic() - self._start) * (n - n_ended - n_active / 2) / done
            line += f", about {describe_duration(left)} left"
        self._progress.show(line)
        if time.monotonic() - self._last_table > TABLE_PAUSE:
            self._write_tables()

    def _write_tables(self):
        write_tables(self._folder.path, self._study, [
            (run, self._outcomes.get(run.name), self._results.get(run.name, [])) for run in self._runs])
        self._last_table = time.monotonic()

    def _count_failed(self):
        return sum(outcome.status != FINISHED for outcome in self._outcomes.values())

    def _conclude(self, is_whole):
        n_failed, path = self._count_failed(), self._folder.path
        seconds = describe_duration(time.monotonic() - self._start)
        self._progress.say(f"{len(self._outcomes) - n_failed} of {len(self._runs)} runs finished, {n_failed} failed, in "
                           f"{seconds}; {path / 'table.csv'}, {path / 'summary.csv'}")
        if not is_whole:
            print(f"slowsand-study: interrupted after {len(self._outcomes)} of {len(self._runs)} runs; go on with "
                  f"--resume {path}", file=sys.stderr)
        elif n_failed:
            causes = [outcome.status for outcome in self._outcomes.values()]
            counts = ", ".join(f"{causes.count(cause)} {cause}" for cause in (FAILED, TIMED_OUT, NO_RESULTS)
                               if cause in causes)
            print(f"slowsand-study: {n_failed} of {len(self._runs)} runs without results ({counts}); see status and "
                  f"message in {path / 'table.csv'}", file=sys.stderr)
        return 0 if is_whole and not n_failed else 1

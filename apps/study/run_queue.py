"""Starts the runs of a study, so many processes at a time, and sees each to its end."""

import ctypes
import os
import signal
import subprocess
import time
from dataclasses import dataclass

from .study_folder import FAILED, FINISHED, TIMED_OUT, Outcome

# One core each: several runs at a time use the machine better than one on several threads.
ENVIRONMENT = {"OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1",
               "OMPI_MCA_rmaps_base_oversubscribe": "1", "OMPI_MCA_hwloc_base_binding_policy": "none",
               "OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1", "DEAL_II_NUM_THREADS": "1"}
PAUSE = 0.02  # [s] between two looks at the processes
GRACE = 10.  # [s] from SIGTERM to SIGKILL
PR_SET_PDEATHSIG = 1  # <sys/prctl.h>
LIBC = ctypes.CDLL(None)  # loaded here: a child before its exec should do as little as it can


@dataclass
class Process:
    """A run under way."""

    run: object  # PlannedRun
    process: subprocess.Popen
    start: float  # [s] of the monotonic clock
    is_resumed: bool
    end_by: float  # [s] of that clock: SIGTERM
    is_late: bool = False


class RunQueue:
    def __init__(self, program, case, folder, n_processes, timeout):
        """@param program, case  paths; @param folder  StudyFolder; @param timeout  [s] of each run"""
        self._program, self._case, self._folder = program, case, folder
        self._n_processes, self._timeout = n_processes, timeout
        self._is_stopped = False

    def stop(self):
        """No more runs are started, those under way are ended; what a signal handler may call."""
        self._is_stopped = True

    def work(self, runs, ended, watch):
        """Takes the runs to their ends. False if it was stopped.

        @param ended  called with (run, outcome) as each ends
        @param watch  called with the number of runs under way, again and again
        """
        waiting, active = list(reversed(runs)), []
        try:
            while (waiting or active) and not self._is_stopped:
                while waiting and len(active) < self._n_processes:
                    active.append(self._start(waiting.pop()))
                for process in [process for process in active if process.process.poll() is not None]:
                    active.remove(process)
                    self._finish(process, ended)
                self._end_late(active)
                watch(len(active))
                time.sleep(PAUSE)
        finally:
            end_processes([process.process for process in active])
        return not self._is_stopped

    def _start(self, run):
        """A run with a checkpoint and without outcome was interrupted: it goes on from there."""
        folder = self._folder.get_run_folder(run.name)
        folder.mkdir(exist_ok=True)
        outcome = self._folder.read_outcome(run.name)
        is_resumed = (folder / "checkpoint.h5").is_file() and (outcome is None or outcome.status == TIMED_OUT)
        (folder / "outcome.json").unlink(missing_ok=True)
        if is_resumed:
            command = [self._program, "--resume", folder]
        else:  # an earlier attempt's checkpoint must not be taken for this one's, should it be interrupted in turn
            (folder / "checkpoint.h5").unlink(missing_ok=True)
            command = [self._program, self._case, "--output", folder, "--overwrite"]
            command += [part for path, value in run.settings for part in ("--set", f"{path}={value}")]
        with open(folder / "run.log", "ab" if is_resumed else "wb") as log:
            process = subprocess.Popen([*map(str, command), "--quiet"], stdin=subprocess.DEVNULL,
                                       stdout=subprocess.DEVNULL, stderr=log, env=dict(os.environ, **ENVIRONMENT),
                                       start_new_session=True, preexec_fn=die_with_parent)
        now = time.monotonic()
        return Process(run, process, now, is_resumed, now + self._timeout)

    def _end_late(self, active):
        now = time.monotonic()
        for late in (process for process in active if now > process.end_by):
            late.process.send_signal(signal.SIGKILL if late.is_late else signal.SIGTERM)
            late.is_late, late.end_by = True, now + GRACE

    def _finish(self, process, ended):
        seconds, status = time.monotonic() - process.start, process.process.returncode
        if process.is_late:
            outcome = Outcome(TIMED_OUT, status, seconds, process.is_resumed, f"not finished within {self._timeout:g} s")
        elif status == 0:
            outcome = Outcome(FINISHED, status, seconds, process.is_resumed, "")
        else:
            outcome = Outcome(FAILED, status, seconds, process.is_resumed, self._read_message(process.run, status))
        self._folder.write_outcome(process.run.name, outcome)
        ended(process.run, outcome)

    def _read_message(self, run, status):
        """Last line that the run said."""
        log = (self._folder.get_run_folder(run.name) / "run.log").read_text(encoding="utf-8", errors="replace")
        lines = log.strip().splitlines()
        if lines:
            return lines[-1]
        return f"ended by signal {-status}" if status < 0 else "no message"


def die_with_parent():
    """In the child: no run outlives what started it and was killed, to write into a folder that is then resumed."""
    LIBC.prctl(PR_SET_PDEATHSIG, signal.SIGKILL)


def end_processes(processes):
    """SIGTERM to each that still runs, SIGKILL to those that have not ended a while later."""
    for process in processes:
        process.terminate()
    limit = time.monotonic() + GRACE
    for process in processes:
        try:
            process.wait(max(0., limit - time.monotonic()))
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()

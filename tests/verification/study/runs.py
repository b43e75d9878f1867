"""Runs of the report: started once for each program and set of parameters, found again the next time."""

import hashlib
import json
import os
import shlex
import shutil
import subprocess
import sys
from pathlib import Path

SOURCE = Path(__file__).resolve().parents[3]
sys.path.insert(0, str(SOURCE / "apps"))
os.environ.setdefault("MPLCONFIGDIR", "/tmp/slowsand-matplotlib")

from plotting.run_folder import RunFolder  # noqa: E402

ENVIRONMENT = {"OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1",
               "OMPI_MCA_rmaps_base_oversubscribe": "1", "OMPI_MCA_hwloc_base_binding_policy": "none",
               "OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1", "DEAL_II_NUM_THREADS": "1"}
LONGEST_RUN = 3600  # [s]; beyond it a run is reported as failed


class RunFailed(Exception):
    """A run that did not finish; the message is one line, `command` what was run."""

    def __init__(self, message, command):
        super().__init__(message)
        self.command = command


class Runs:
    """Where programs and run folders are.

    A run is done when its folder says "finished" and was made by the same program, case and settings; what decides is
    the programs' contents, since a revision does not change when somebody builds with local changes.
    """

    def __init__(self, programs, folder, n_ranks):
        self.programs, self.folder, self.n_ranks = Path(programs).resolve(), Path(folder).resolve(), n_ranks
        self.folder.mkdir(parents=True, exist_ok=True)

    def run(self, name, program, case, settings, n_ranks=1, longest=LONGEST_RUN):
        """RunFolder of a finished run, with its `command` and `summary`. Throws RunFailed, also after `longest` [s]."""
        arguments = [str(case)] + [part for key, value in settings.items() for part in ("--set", f"{key}={value}")]
        launcher = ["mpirun", "-n", str(n_ranks)] if n_ranks > 1 else []
        command = " ".join(launcher + [program] + [shlex.quote(argument) for argument in arguments])
        output = self.folder / name
        key = self._compute_key(program, case, settings, command)
        if not self._is_done(output, key):
            self._start(launcher + [str(self.programs / program)] + arguments, output, command, longest)
            self._get_key_file(output).write_text(key, encoding="utf-8")
        run = RunFolder(output)
        run.command, run.summary = command, read_summary(output)
        return run

    def describe_program(self, program):
        """Version line of a program."""
        try:
            done = subprocess.run([str(self.programs / program), "--version"], capture_output=True, text=True,
                                  timeout=60, env=dict(os.environ, **ENVIRONMENT))
            return done.stdout.strip() or f"{program}: no version"
        except OSError as error:
            return f"{program}: {error.strerror}"

    def _compute_key(self, program, case, settings, command):
        path = self.programs / program
        if not path.is_file():
            raise RunFailed(f"{path} has not been built", command)
        parts = [path.read_bytes(), (SOURCE / case).read_bytes(), json.dumps(settings, sort_keys=True).encode()]
        return hashlib.sha256(b"".join(hashlib.sha256(part).digest() for part in parts)).hexdigest()

    def _get_key_file(self, output):
        return output.with_name(output.name + ".key")

    def _is_done(self, output, key):
        file = self._get_key_file(output)
        return (file.is_file() and file.read_text(encoding="utf-8") == key
                and read_summary(output).get("status") == "finished")

    def _start(self, call, output, command, longest):
        self._get_key_file(output).unlink(missing_ok=True)
        shutil.rmtree(output, ignore_errors=True)
        print(f"{command}\n  -> {output}", file=sys.stderr, flush=True)
        try:
            done = subprocess.run(call + ["--output", str(output), "--quiet"], cwd=SOURCE, capture_output=True,
                                  text=True, timeout=longest, env=dict(os.environ, **ENVIRONMENT))
        except subprocess.TimeoutExpired:
            raise RunFailed(f"not finished within {longest} s", command) from None
        if done.returncode != 0:
            last = (done.stderr.strip().splitlines() or ["no message"])[-1]
            raise RunFailed(f"exit status {done.returncode}: {last}", command)


def read_summary(folder):
    """summary.json of a run folder; empty if there is none."""
    file = Path(folder) / "summary.json"
    return json.loads(file.read_text(encoding="utf-8")) if file.is_file() else {}

"""Runs of the experiments. A run may go on from another one's end, so that what many begin with is made once.

A case is run stage by stage: its first stages make one run folder, and a copy of that folder goes on with more stages.
slowsand-rev continues with the same bits as if the whole case had been run at once.
"""

import copy
import hashlib
import json
import os
import shutil
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from plotting.errors import BadInput, NotInThisRun
from plotting.run_folder import RunFolder, read_parameters
from study.run_queue import ENVIRONMENT, die_with_parent

SOURCE = Path(__file__).resolve().parents[2]
PROGRAM = "slowsand-rev"
DONE = ("finished", "ruptured")  # status of summary.json; a rupture is what a creep test is for
LONGEST_RUN = 7200  # [s]; beyond it a run is reported as failed


class RunFailed(Exception):
    """A run that did not finish; the message is one line."""


class Chains:
    """Where the program and the run folders are, and what is set in every run."""

    def __init__(self, programs, folder, settings, n_processes):
        built, self._folder = Path(programs).resolve() / PROGRAM, Path(folder).resolve()
        self._settings, self._n_processes = settings, n_processes
        if not built.is_file():
            raise BadInput(f"{built}: has not been built (bash apps/build.sh), or is elsewhere (--programs DIR)")
        self._folder.mkdir(parents=True, exist_ok=True)
        self._program = self._keep_program(built)

    def vary(self, settings):
        """The same with further settings in every run."""
        varied = copy.copy(self)
        varied._settings = {**self._settings, **settings}
        return varied

    def _keep_program(self, built):
        """A copy beside the runs: whoever builds anew meanwhile must not mix two programs in one table."""
        content = built.read_bytes()
        self._digest = hashlib.sha256(content).hexdigest()
        kept = self._folder / f"{PROGRAM}-{self._digest[:10]}"
        if not kept.is_file() or kept.read_bytes() != content:
            temporary = kept.with_name(f"{kept.name}.{os.getpid()}.tmp")
            shutil.copy2(built, temporary)
            temporary.rename(kept)
        return kept

    def describe_program(self):
        """Version line of the program."""
        said = subprocess.run([self._program, "--version"], capture_output=True, text=True, timeout=60).stdout.strip()
        return said.replace(self._program.name, PROGRAM)

    def run_seeds(self, run_one, seeds, label="seed"):
        """(results of the seeds that could be run, what went wrong with the others, a line each).

        @param run_one  of a seed; several seeds at a time
        """
        with ThreadPoolExecutor(self._n_processes) as pool:
            waiting = [(seed, pool.submit(run_one, seed)) for seed in seeds]
            results, faults = [], []
            for seed, result in waiting:
                try:
                    results.append(result.result())
                except (RunFailed, BadInput, NotInThisRun) as error:
                    faults.append(f"{label} {seed}: {error}")
                    print(f"paper: {faults[-1]}", file=sys.stderr, flush=True)
        return results, faults

    def run(self, name, case, n_stages, seed, settings=None, base=None):
        """RunFolder of the case's first stages, with `key`, `seed` and `summary`. Raises RunFailed.

        @param case  name of a file of apps/cases/paper
        @param settings  Section/Name -> value, beside the case
        @param base  RunFolder of fewer stages with the same parameters, to go on from
        """
        path = SOURCE / "apps" / "cases" / "paper" / case
        own = {**self._settings, **(settings or {}), "Seed": seed, "Number of stages": n_stages}
        key = hashlib.sha256(json.dumps([self._digest, path.read_text(encoding="utf-8"), own,
                                         base.key if base else ""]).encode()).hexdigest()
        output = self._folder / f"{name}-seed_{seed}-{key[:10]}"
        if read_summary(output).get("status") not in DONE:
            self._start(path, n_stages, own, base, output)
        run = RunFolder(output)
        run.key, run.summary, run.seed = key, read_summary(output), seed
        return run

    def _start(self, path, n_stages, own, base, output):
        if not (output / "checkpoint.h5").is_file():
            shutil.rmtree(output, ignore_errors=True)
            if base:
                temporary = output.with_name(output.name + ".copy")
                shutil.rmtree(temporary, ignore_errors=True)
                shutil.copytree(base.path, temporary)
                (temporary / "summary.json").unlink()
                temporary.rename(output)
        settings = {**read_stages(path, n_stages), **own}
        case = output.with_name(output.name + ".prm")
        case.write_text(f"set Number of stages = {n_stages}\n", encoding="utf-8")  # the rest follows by --set
        arguments = ["--resume", output] if (output / "checkpoint.h5").is_file() else [case, "--output", output]
        arguments += [part for name, value in settings.items() for part in ("--set", f"{name}={value}")]
        print(f"paper: {output.name}", file=sys.stderr, flush=True)
        try:
            done = subprocess.run([self._program, *map(str, arguments), "--quiet"], capture_output=True, text=True,
                                  timeout=LONGEST_RUN, env=dict(os.environ, **ENVIRONMENT),
                                  preexec_fn=die_with_parent)
        except subprocess.TimeoutExpired:
            raise RunFailed(f"{output.name}: not finished within {LONGEST_RUN} s") from None
        if done.returncode != 0:
            raise RunFailed(f"{output.name}: exit status {done.returncode}: "
                            f"{(done.stderr.strip().splitlines() or ['no message'])[-1]}")


def read_stages(path, n_stages):
    """Section/Name -> value of a case, without the stages behind the first n."""
    stages = [f"Stage {k}" for k in range(1, n_stages + 1)]
    return {"/".join(filter(None, (section, name))): value for section, name, value in read_parameters(path)
            if not section.startswith("Stage ") or section in stages}


def read_summary(folder):
    """summary.json of a run folder; empty if there is none."""
    file = Path(folder) / "summary.json"
    return json.loads(file.read_text(encoding="utf-8")) if file.is_file() else {}


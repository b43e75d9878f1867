"""Law: a run killed under load or in creep and resumed, on any number of ranks, leaves the history and the list of fields
of an undisturbed one, whether REVs move between ranks or not, and answer from their tangents or not."""

import argparse
import os
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

sys.dont_write_bytecode = True
sys.path.insert(0, str(Path(__file__).resolve().parent))

import small_case  # noqa: E402

LOAD, CREEP = "1", "2"
MOVE, STAY = small_case.MOVE, small_case.STAY


def count_rows(history, stage):
    if not history.is_file():
        return 0
    return sum(1 for line in history.read_text(errors="replace").splitlines() if line.split(",")[1:2] == [stage])


def list_fields(folder):
    """What fields.pvd lists, without deal.II's remark on the time of writing."""
    return [line for line in (folder / "fields.pvd").read_text().splitlines() if "<DataSet" in line]


LAZY = ("--set", "REVs/Lazy tolerance=3e-2")


def kill_in_stage(build, case, output, stage, n_rows, interval, options=()):
    """Starts a run and kills it with SIGKILL once it has written so many rows of a stage; returns how many it had."""
    process = subprocess.Popen(small_case.make_command(build, 1, case, "--output", output, "--set",
                                                       f"Output/Checkpoint interval={interval}", *options),
                               env=small_case.make_environment(), stderr=subprocess.DEVNULL)
    history = output / "history.csv"
    while process.poll() is None and count_rows(history, stage) < n_rows:
        time.sleep(0.002)
    if process.poll() is not None:
        raise AssertionError(f"the run ended by itself ({process.returncode}) before it could be killed")
    os.kill(process.pid, signal.SIGKILL)
    process.wait()
    return count_rows(history, stage)


def check(build, folder, runs, options=()):
    """Kills and resumes runs with some options, and compares them with one that nobody killed."""
    case = small_case.write_case(folder)
    whole = Path(folder) / "whole"
    small_case.run(build, 1, case, "--output", whole, *options)
    expected = (whole / "history.csv").read_bytes()
    lines = expected.decode().splitlines()
    n_lazy = int(dict(zip(lines[0].split(","), lines[-1].split(",")))["lazy_answers"])
    if (n_lazy > 0) != (options == LAZY):
        raise AssertionError(f"{n_lazy} answers from tangents with {options}")
    for i, (stage, n_ranks, interval, moves) in enumerate(runs):
        n_rows = count_rows(whole / "history.csv", stage)
        killed = Path(folder) / f"killed_{i}"
        n_before = kill_in_stage(build, case, killed, stage, n_rows // 2, interval, options)
        if not n_before < n_rows:
            raise AssertionError("the run was over before it was killed")
        small_case.run(build, n_ranks, "--resume", killed, *moves)
        event = f"killed after {n_before} of {n_rows} rows of stage {stage}, resumed on {n_ranks} rank(s) {' '.join((*options, *moves))}"
        if (killed / "history.csv").read_bytes() != expected:
            raise AssertionError(f"{event}: history.csv differs from that of the undisturbed run")
        if list_fields(killed) != list_fields(whole):
            raise AssertionError(f"{event}: fields.pvd lists other fields than that of the undisturbed run")
        print(f"{event}: the same bytes, the same fields")


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--source")
    parser.add_argument("--build", required=True)
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        # Under load from the first checkpoint: fields have been written since, all at one time.
        check(options.build, folder, ((LOAD, 1, 100, ()), (CREEP, 1, 4, ()), (CREEP, 2, 4, MOVE), (CREEP, 2, 4, STAY),
                                      (CREEP, 4, 4, MOVE)))
    with tempfile.TemporaryDirectory() as folder:
        check(options.build, folder, ((CREEP, 1, 4, ()), (CREEP, 2, 4, MOVE)), LAZY)


if __name__ == "__main__":
    main()

"""Law: a run killed in mid-creep and resumed, on any number of ranks, leaves the history of an undisturbed one."""

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

CREEP_STAGE = "2"


def count_creep_rows(history):
    if not history.is_file():
        return 0
    return sum(1 for line in history.read_text(errors="replace").splitlines() if line.split(",")[1:2] == [CREEP_STAGE])


def kill_in_creep(build, case, output, n_rows):
    """Starts a run and kills it with SIGKILL once it has written so many rows of creep; returns how many it had."""
    process = subprocess.Popen(small_case.make_command(build, 1, case, "--output", output),
                               env=small_case.make_environment(), stderr=subprocess.DEVNULL)
    history = output / "history.csv"
    while process.poll() is None and count_creep_rows(history) < n_rows:
        time.sleep(0.002)
    if process.poll() is not None:
        raise AssertionError(f"the run ended by itself ({process.returncode}) before it could be killed")
    os.kill(process.pid, signal.SIGKILL)
    process.wait()
    return count_creep_rows(history)


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--source")
    parser.add_argument("--build", required=True)
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        case = small_case.write_case(folder)
        whole = Path(folder) / "whole"
        small_case.run(options.build, 1, case, "--output", whole)
        expected = (whole / "history.csv").read_bytes()
        n_rows = count_creep_rows(whole / "history.csv")
        for n_ranks in (1, 2):
            killed = Path(folder) / f"killed_{n_ranks}"
            n_before = kill_in_creep(options.build, case, killed, n_rows // 2)
            if not n_before < n_rows:
                raise AssertionError("the run was over before it was killed")
            small_case.run(options.build, n_ranks, "--resume", killed)
            if (killed / "history.csv").read_bytes() != expected:
                raise AssertionError(f"killed after {n_before} of {n_rows} rows of creep and resumed on {n_ranks} "
                                     "ranks: history.csv differs from that of the undisturbed run")
            print(f"killed after {n_before} of {n_rows} rows of creep, resumed on {n_ranks} rank(s): the same bytes")


if __name__ == "__main__":
    main()

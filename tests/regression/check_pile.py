"""Law: load tests leave a pile's run as it was; killed and resumed it has the same history and the same capacities."""

import argparse
import csv
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

CASE = "apps/cases/bvp_pile_elastic.prm"


def make_environment():
    return dict(os.environ, OMPI_ALLOW_RUN_AS_ROOT="1", OMPI_ALLOW_RUN_AS_ROOT_CONFIRM="1", OPENBLAS_NUM_THREADS="1",
                DEAL_II_NUM_THREADS="1")


def make_command(options, *arguments):
    return [str(Path(options.build).resolve() / "slowsand-bvp"), "--quiet", *map(str, arguments)]


def run(options, *arguments, expected=0):
    done = subprocess.run(make_command(options, *arguments), cwd=options.source, env=make_environment(),
                          capture_output=True, text=True, timeout=120, check=False)
    if done.returncode != expected:
        raise AssertionError(f"{' '.join(done.args)}: exit status {done.returncode}\n{done.stderr}")
    return done.stderr


def read_table(file):
    with open(file, encoding="utf-8", newline="") as stream:
        return list(csv.DictReader(stream))


def check_capacities(folder):
    """What a load test of a bonded pile in ground without strength must give."""
    rows = read_table(folder / "capacity.csv")
    if [float(row["age_s"]) for row in rows] != [0., 1e5, 1e7]:
        raise AssertionError(f"ages of capacity.csv: {[row['age_s'] for row in rows]}")
    for row in rows:
        curve = read_table(folder / "load_tests" / f"{float(row['age_s']):g}_s.csv")
        last = {name: float(value) for name, value in curve[-1].items()}
        # The pile is as heavy as ground in its place, and its weight is passed on beside the head's load.
        weight = 16e3 * 3.14159265 * 0.125 ** 2 * 5.
        difference = last["shaft_force_N"] + last["base_force_N"] - last["head_force_N"] - weight
        if abs(difference) > 5e-3 * last["head_force_N"]:  # Newton's tolerance is 1e-3 of all reactions
            raise AssertionError(f"shaft and base bear {difference:g} N more than the head and the pile's weight")
        # Nothing slips: the shaft's force rises to the end, and its largest is the last.
        if row["outcome"] != "finished" or abs(float(row["head_displacement_m"]) - 0.05) > 1e-9:
            raise AssertionError(f"a test that ended elsewhere: {row}")
        if float(row["shaft_capacity_N"]) != last["shaft_force_N"]:
            raise AssertionError(f"the peak of a rising curve is its last value, not {row['shaft_capacity_N']}")


def kill_in_creep(options, output):
    """Starts a run and kills it with SIGKILL once a load test has been made."""
    process = subprocess.Popen(make_command(options, CASE, "--output", output, "--set", "Output/Checkpoint interval=1"),
                               cwd=options.source, env=make_environment(), stderr=subprocess.DEVNULL)
    while process.poll() is None:
        if (output / "capacity.csv").is_file() and len((output / "capacity.csv").read_text().splitlines()) > 1:
            process.kill()
            break
        time.sleep(0.001)
    process.wait()
    return process.returncode


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--source", required=True)
    parser.add_argument("--build", required=True)
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        run(options, CASE, "--output", folder / "whole")
        check_capacities(folder / "whole")
        # The ages are outputs of the creep in any case: the programme is the same without them.
        run(options, CASE, "--output", folder / "untested", "--set", "Load tests/Ages=")
        whole = (folder / "whole" / "history.csv").read_bytes()
        if (folder / "untested" / "history.csv").read_bytes() != whole:
            raise AssertionError("load tests change history.csv")
        status = kill_in_creep(options, folder / "killed")
        if status == 0:
            print("skipped in part: the run ended before it could be killed")
        else:
            run(options, "--resume", folder / "killed")
        for file in ("history.csv", "capacity.csv"):
            if (folder / "killed" / file).read_bytes() != (folder / "whole" / file).read_bytes():
                raise AssertionError(f"killed and resumed, {file} differs")
        message = run(options, CASE, "--output", folder / "wrong", "--set", "Pile/Regions=pyle", expected=2)
        if "pyle" not in message or "interface" not in message:
            raise AssertionError(f"a misspelt region is not named beside those there are: {message}")
    print(f"{len(whole.splitlines()) - 1} rows: the same bytes without load tests, and after a kill")


if __name__ == "__main__":
    sys.exit(main())

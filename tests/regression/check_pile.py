"""Law: load tests leave a pile's run as it was; killed and resumed it has the same tables; they agree with each other."""

import argparse
import csv
import math
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

CASE = "apps/cases/bvp_pile_elastic.prm"
SPACE = "apps/cases/bvp_pile_3d.prm"


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


def check_growth(folder):
    """Growth is that of the capacities beside it; no logarithm counts from age 0."""
    rows = [{name: row[name] for name in ("age_s", "shaft_capacity_N", "shaft_growth_per_decade")}
            for row in read_table(folder / "capacity.csv")]
    ages, capacities, growths = ([float(row[name]) for row in rows] for name in rows[0])
    if not (math.isnan(growths[0]) and math.isnan(growths[1])):
        raise AssertionError(f"growth from age 0: {growths}")
    expected = (capacities[2] / capacities[1] - 1.) / math.log10(ages[2] / ages[1])
    if abs(growths[2] - expected) > 1e-8:  # ten digits of each capacity
        raise AssertionError(f"growth {growths[2]} per tenfold age, {expected} by the capacities")


def check_shaft(folder):
    """Shear stress on the wall sums up to the shaft's force; the last output is the state that the last test began at."""
    rows = read_table(folder / "load_tests" / "1e+07_s_shaft.csv")
    force = float(read_table(folder / "load_tests" / "1e+07_s.csv")[-1]["shaft_force_N"])
    last = [row for row in rows if row["head_displacement_m"] == rows[-1]["head_displacement_m"]]
    total = 0.
    depths = sorted({float(row["depth_m"]) for row in last})
    edges = [0.] + [0.5 * (depths[i] + depths[i + 1]) for i in range(1, len(depths) - 1, 2)] + [5.]
    for top, bottom in zip(edges, edges[1:]):
        cell = [row for row in last if top < float(row["depth_m"]) < bottom]
        # tau r is what the slices of ground pass on; the hole's wall stands at 0.25 m, these points a little further out.
        mean = sum(float(row["shear_stress_Pa"]) for row in cell if float(row["distance_m"]) < 0.025)
        mean /= sum(float(row["distance_m"]) < 0.025 for row in cell)
        total += 2 * math.pi * 0.25 * (bottom - top) * mean
    # Edges between cells of unequal height are not halfway between points, and these lie a little beyond the wall.
    if abs(total - force) > 0.1 * force:
        raise AssertionError(f"shear stress along the shaft sums up to {total:g} N, the shaft bears {force:g} N")
    final = {row["point"]: row for row in read_table(folder / "shaft.csv")}
    for row in rows[:len(last)]:
        start = final[row["point"]]
        for name in ("radial_stress_Pa", "vertical_stress_Pa"):
            if abs(float(row[name]) - float(start[name])) > 1e-2 * abs(float(start[name])):  # Newton's 1e-3, twice
                raise AssertionError(f"point {row['point']}, {name}: {row[name]} at the test's beginning, "
                                     f"{start[name]} in the run")


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


def check_space(options, folder):
    """A quarter of a square pile: what the head and a quarter of the weight press with goes through both walls and base."""
    run(options, SPACE, "--output", folder)
    rows = read_table(folder / "capacity.csv")
    curve = read_table(folder / "load_tests" / f"{float(rows[-1]['age_s']):g}_s.csv")
    last = {name: float(value) for name, value in curve[-1].items()}
    weight = 16e3 * 0.1 ** 2 * 5.  # of the ground that stood in the pile's place at first
    difference = last["shaft_force_N"] + last["base_force_N"] - last["head_force_N"] - weight
    if rows[-1]["outcome"] != "finished" or abs(difference) > 5e-3 * last["head_force_N"]:  # as above
        raise AssertionError(f"in space: {rows[-1]}; shaft and base bear {difference:g} N more than head and weight")
    walls = {row["point"] for row in read_table(folder / "shaft.csv")}
    if len(walls) != 48:  # two walls of three cells of eight points
        raise AssertionError(f"{len(walls)} points beside the walls")


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--source", required=True)
    parser.add_argument("--build", required=True)
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        run(options, CASE, "--output", folder / "whole")
        check_capacities(folder / "whole")
        check_growth(folder / "whole")
        check_shaft(folder / "whole")
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
        for file in ("history.csv", "capacity.csv", "points.csv", "shaft.csv"):
            if (folder / "killed" / file).read_bytes() != (folder / "whole" / file).read_bytes():
                raise AssertionError(f"killed and resumed, {file} differs")
        check_space(options, folder / "space")
        message = run(options, CASE, "--output", folder / "wrong", "--set", "Pile/Regions=pyle", expected=2)
        if "pyle" not in message or "interface" not in message:
            raise AssertionError(f"a misspelt region is not named beside those there are: {message}")
    print(f"{len(whole.splitlines()) - 1} rows: the same bytes without load tests, and after a kill")


if __name__ == "__main__":
    sys.exit(main())

"""Law: the simulated pool has the efficiencies that can be told beforehand: equal REVs, one too many, one that outweighs all,
and a rank whose load was made by chance; a file that is no costs.csv is refused."""

import argparse
import subprocess
import sys
import tempfile
from pathlib import Path

HEADER = "step,stage,time_s,point,rank,cost_s,size_B\n"
STEPS = 20


def write_costs(path, costs):
    """The same costs in each step."""
    rows = (f"{step},1,{step},{point},0,{cost},1000\n" for step in range(STEPS) for point, cost in enumerate(costs))
    path.write_text(HEADER + "".join(rows))
    return path


def simulate(build, path, *options):
    """Columns work, clock, limit, taken, moved, bytes by mode."""
    done = subprocess.run([str(Path(build) / "tests" / "pool_simulation"), str(path), *map(str, options)],
                          capture_output=True, text=True, check=True)
    rows = [line.split() for line in done.stdout.splitlines()[2:]]
    return {" ".join(row[1:-6]): [float(number) for number in row[-6:]] for row in rows}


def expect(name, value, expected, tolerance=5e-4):  # three decimals are printed
    if not abs(value - expected) <= tolerance:
        raise AssertionError(f"{name}: {value}, expected {expected} within {tolerance}")


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--source")
    parser.add_argument("--build", required=True)
    options = parser.parse_args()
    quick = ("--reply", 0, "--bandwidth", 1e15)
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "costs.csv"

        write_costs(file, [0.5])
        for mode, row in simulate(options.build, file, "--revs", 64, "--ranks", 16, *quick).items():
            expect(f"equal REVs, {mode}: work", row[0], 1.0)
            expect(f"equal REVs, {mode}: moves", row[3] + row[4], 0.0)
        for mode, row in simulate(options.build, file, "--revs", 65, "--ranks", 16, *quick).items():
            expect(f"one REV too many, {mode}: work", row[0], 65 / 16 / 5)
        # Five REVs one after the other, then fifteen refusals of a tenth of a second for the last rank.
        slow = simulate(options.build, file, "--revs", 65, "--ranks", 16, "--reply", 0.1, "--bandwidth", 1e15)
        expect("refusals, REVs stay: clock", slow["stay"][1], 65 / 16 / 5)
        expect("refusals, REVs are taken over: clock", slow["are taken over"][1], 65 / 16 * 0.5 / (2.5 + 1.5))

        write_costs(file, [1e-3, 1e-3, 1e-3, 100.0])
        rows = simulate(options.build, file, "--revs", 16, "--ranks", 16, *quick)
        for mode, row in rows.items():
            expect(f"REVs that outweigh all, {mode}: work", row[0], row[2])

        write_costs(file, [1.0, 2.0, 3.0, 4.0, 5.0])
        rows = simulate(options.build, file, "--revs", 1000, "--ranks", 16, *quick)
        # Migration ends 5 % above the mean, and knows nothing in the first step. Who takes over ends within one REV, 5 s, of
        # the mean of 187 s. 0.001: the three decimals.
        bounds = {"migrate": 1.0 / (0.95 * 1.05 + 0.05 / rows["stay"][0]), "are taken over": 1.0 / (1.0 + 5.0 / 187.0)}
        for mode, bound in bounds.items():
            if not rows[mode][0] > max(rows["stay"][0], bound - 1e-3):
                raise AssertionError(f"unequal REVs, {mode}: {rows[mode][0]}, bound {bound}; {rows['stay'][0]} when they stay")
        if not rows["migrate"][4] > 0 or not rows["are taken over"][3] > 0 or not rows["do both"][5] > 0:
            raise AssertionError(f"nothing moved: {rows}")

        file.write_text("time_s,colour\n1,2\n")
        done = subprocess.run([str(Path(options.build) / "tests" / "pool_simulation"), str(file)], capture_output=True,
                              text=True, check=False)
        if done.returncode != 2 or f"{file}:1" not in done.stderr:
            raise AssertionError(f"a foreign file: exit status {done.returncode}, {done.stderr!r}")
    print("equal, too many, outweighing and unequal REVs: the efficiencies foretold")


if __name__ == "__main__":
    sys.exit(main())

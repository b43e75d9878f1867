"""How many cycles a REV needs to come to rest, by variations of the way to rest, and what they do to creep."""

import argparse
import csv
import json
import shutil
import statistics
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

# Name of a variation and what it sets beside the case.
VARIATIONS = {"default": []}
for _damping in ("0.3", "0.5", "0.8", "0.9"):
    VARIATIONS[f"damping-{_damping}"] = [f"Motion/Local damping={_damping}"]
for _gain in ("0.02", "0.05", "0.1", "0.4"):
    VARIATIONS[f"gain-{_gain}"] = [f"Equilibrium/Servo gain={_gain}"]
for _strain in ("3e-6", "3e-5", "1e-4"):
    VARIATIONS[f"strain-{_strain}"] = [f"Equilibrium/Strain per cycle={_strain}"]
for _ratio in ("1e-3", "1e-5"):
    VARIATIONS[f"unbalanced-{_ratio}"] = [f"Equilibrium/Unbalanced ratio={_ratio}"]

# A case small enough for the paper's count: one grain a batch, outputs only at decades.
PAPER_CASE = ["Stage 1/Increments=10", "Stage 2/Points per decade=1"]
PAPER_RULE = ["Equilibrium/Fixed cycles=150000"]


@dataclass
class Computation:
    """One dynamic computation of a run."""
    stage: int  # from 1
    cycles: int
    is_first: bool  # of its increment or jump: no grain has split since the one before


@dataclass
class Run:
    computations: list
    cycles_total: int  # of the programme, without the packing
    creep_strain: dict  # axial, since loading ended [%], by time [s]


def run_case(program, case, settings, folder):
    """One run; a folder that holds a finished run of the same settings is read again."""
    arguments = [str(program), str(case), "--quiet", "--output", str(folder)]
    for setting in settings:
        arguments += ["--set", setting]
    done = folder / "arguments.txt"
    stamp = "\n".join([*arguments, str(program.stat().st_mtime_ns)])
    if not (done.exists() and done.read_text() == stamp):
        shutil.rmtree(folder, ignore_errors=True)
        outcome = subprocess.run(arguments, capture_output=True, text=True, check=False)
        if outcome.returncode != 0:
            sys.exit(f"cycles.py: {' '.join(arguments)}: exit status {outcome.returncode}\n{outcome.stderr}")
        done.write_text(stamp)
    return read_run(folder)


def read_run(folder):
    with open(folder / "history.csv", newline="") as file:
        rows = list(csv.DictReader(file))
    computations = []
    cycles = n_broken = 0
    for row in rows:
        n_broken_now = int(row["broken_instant"]) + int(row["broken_delayed"])
        if row["kind"] != "ageing":
            computations.append(Computation(int(row["stage"]), int(row["cycles"]) - cycles, n_broken_now == n_broken))
            n_broken = n_broken_now  # a row of ageing is written before the split
        cycles = int(row["cycles"])
    start = float([row for row in rows if row["stage"] == "1"][-1]["strain_zz"])
    creep = [(float(row["time_s"]), float(row["strain_zz"])) for row in rows if row["stage"] == "2"]
    decades = [10.0 ** k for k in range(20) if 10.0 ** k <= creep[-1][0] * (1 + 1e-9)]
    strain = {time: 100.0 * ([e for t, e in creep if t <= time * (1 + 1e-9)][-1] - start) for time in decades}
    summary = json.loads((folder / "summary.json").read_text())
    return Run(computations, summary["cycles"], strain)


def list_cycles_per_increment(run):
    """Of the loading: what an increment takes together with the avalanche that it sets off."""
    sums = []
    for computation in run.computations:
        if computation.stage == 1:
            if computation.is_first or not sums:
                sums.append(0)
            sums[-1] += computation.cycles
    return sums


def list_cycles_per_batch(run, stage):
    """What each dynamic computation after a split takes."""
    return [c.cycles for c in run.computations if c.stage == stage and not c.is_first]


def describe(values):
    """Median, mean and the value that nine in ten stay below."""
    if not values:
        return f"{'-':>8} {'-':>8} {'-':>8}"
    ordered = sorted(values)
    ninth = ordered[min(len(ordered) - 1, int(0.9 * len(ordered)))]
    return f"{statistics.median(values):8.0f} {statistics.mean(values):8.0f} {ninth:8.0f}"


def describe_strains(runs):
    """Mean over the seeds and, for more than one, their standard deviation, at each decade [%]."""
    texts = []
    for time in runs[0].creep_strain:
        values = [run.creep_strain[time] for run in runs]
        scatter = f"+-{statistics.stdev(values):.3f}" if len(values) > 1 else ""
        texts.append(f"{statistics.mean(values):.3f}{scatter}")
    return "  ".join(texts)


def print_tables(results):
    print(f"{'':20} {'an increment':^26}   {'a batch in loading':^26}   {'a batch in creep':^26}")
    print(f"{'cycles':20}" + f" {'median':>8} {'mean':>8} {'90 %':>8}  " * 3)
    for name, runs in results.items():
        columns = [[n for run in runs for n in values(run)]
                   for values in (list_cycles_per_increment, lambda run: list_cycles_per_batch(run, 1),
                                  lambda run: list_cycles_per_batch(run, 2))]
        print(f"{name:20} " + "   ".join(describe(values) for values in columns))
    times = next(iter(results.values()))[0].creep_strain
    print("\naxial creep strain [%], mean +- standard deviation over seeds, at " +
          ", ".join(f"{time:g}" for time in times) + " s")
    for name, runs in results.items():
        print(f"{name:20} {describe_strains(runs)}")


def print_differences(runs, others):
    """Of the creep strains of one seed, at each decade [%]."""
    for seed, (run, other) in enumerate(zip(runs, others), start=1):
        print(f"{f'difference, seed {seed}':20} " +
              "  ".join(f"{run.creep_strain[time] - other.creep_strain[time]:+.3f}" for time in run.creep_strain))


def print_csv(results):
    print("\nvariation,stage,cycles_per_increment,cycles_per_batch,cycles_total,creep_strain_1e6_s_percent")
    for name, runs in results.items():
        for stage, kind in ((1, "loading"), (2, "creep")):
            increments = [n for run in runs for n in list_cycles_per_increment(run)] if stage == 1 else []
            batches = [n for run in runs for n in list_cycles_per_batch(run, stage)]
            total = statistics.mean(sum(c.cycles for c in run.computations if c.stage == stage) for run in runs)
            creep = statistics.mean(run.creep_strain.get(1e6, float("nan")) for run in runs)
            print(f"{name},{kind},{statistics.median(increments) if increments else 'nan'},"
                  f"{statistics.median(batches) if batches else 'nan'},{total:.0f},{creep:.4f}")


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("case", type=Path, help="parameter file: loading, then creep")
    parser.add_argument("--program", type=Path, required=True, help="slowsand-rev")
    parser.add_argument("--work", type=Path, required=True, help="folder for the runs, which are kept")
    parser.add_argument("--seeds", type=int, help="packings of each variation (2; 5 with --paper-rule)")
    parser.add_argument("--grains", type=int, help="of a REV (1000; 250 with --paper-rule)")
    parser.add_argument("--only", nargs="+", choices=list(VARIATIONS), default=list(VARIATIONS), metavar="VARIATION",
                        help=", ".join(VARIATIONS))
    parser.add_argument("--set", action="append", default=[], help="of all runs")
    parser.add_argument("--paper-rule", action="store_true", help="150000 cycles against the criterion")
    arguments = parser.parse_args()
    n_seeds = arguments.seeds or (5 if arguments.paper_rule else 2)
    n_grains = arguments.grains or (250 if arguments.paper_rule else 1000)
    plan = {name: (VARIATIONS[name], n_seeds) for name in arguments.only}
    if arguments.paper_rule:
        plan = {"criterion": (PAPER_CASE, n_seeds), "150000-cycles": (PAPER_CASE + PAPER_RULE, n_seeds)}
    results = {}
    for name, (settings, n) in plan.items():
        results[name] = [run_case(arguments.program, arguments.case,
                                  [f"Packing/Grains={n_grains}", f"Seed={seed}", *settings, *arguments.set],
                                  arguments.work / f"{name}-{n_grains}-{seed}") for seed in range(1, n + 1)]
    print_tables(results)
    if arguments.paper_rule:
        print_differences(results["150000-cycles"], results["criterion"])
    print_csv(results)


if __name__ == "__main__":
    sys.exit(main())

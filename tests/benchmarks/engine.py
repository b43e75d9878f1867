"""One packing, one protocol, every DEM code: times per step, and whether all find the same stress."""

import argparse
import statistics
import sys
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import systems

# Of the stress, largest over smallest. LAMMPS's gran/hertz/history takes the radius as lever arm, the others the radius
# less half the overlap: a packing that sheds half of its stress shows 2.4 %, one near rest 0.1 %.
TOLERANCE = 0.03
QUIET = 0.9  # core share below which times say little


@dataclass
class System:
    name: str
    cores: int
    run: object  # of a Case
    is_compared: bool = True  # its stress is to agree with the others'


def list_systems(case):
    rough = ("--rough", "--blocked")
    chosen = [
        System("yade", 1, systems.run_yade),
        System("liggghts", 1, systems.run_liggghts),
        System("lammps", 1, systems.run_lammps),
        System("lammps", 2, partial(systems.run_lammps, cores=2)),
        System("slowsand-double", 1, systems.run_slowsand),
        System("slowsand-single", 1, partial(systems.run_slowsand, options=("--single",))),
        System("slowsand-rough-blocked", 1, partial(systems.run_slowsand, options=rough), False),
        System("slowsand-rough-blocked-single", 1, partial(systems.run_slowsand, options=rough + ("--single",)), False),
    ]
    if not systems.can_thread(case):
        print("notice: ours runs a packing on one thread; its rows with 2 cores are left out")
        return chosen
    return chosen + [
        System("slowsand-double", 2, partial(systems.run_slowsand, cores=2)),
        System("slowsand-single", 2, partial(systems.run_slowsand, cores=2, options=("--single",))),
        System("slowsand-rough-blocked", 2, partial(systems.run_slowsand, cores=2, options=rough), False),
    ]


def measure(chosen, case, n_runs, clock):
    """Per system its runs, in alternation, so that what disturbs the machine disturbs all."""
    runs = [[] for _ in chosen]
    for _ in range(n_runs):
        for system, own in zip(chosen, runs):
            own.append(systems.measure(system.run, case, clock))
    return runs


def tabulate(chosen, runs, case):
    """Rows of the CSV, and the core share of each."""
    n_grains, n_contacts = case.n_grains, systems.count_contacts(case)
    print(f"{case.packing}: {n_grains} grains, {n_contacts} touching pairs, {case.n_steps} steps of "
          f"{systems.TIME_STEP:g} s, {systems.STRAIN_RATE:g}/s along z\n")
    rows = []
    for system, own in zip(chosen, runs):
        seconds = statistics.median(run.seconds for run in own)
        share = statistics.median(run.core_share for run in own)
        rows.append((system, seconds / case.n_steps / n_grains * 1e9, seconds / case.n_steps / n_contacts * 1e9,
                     own[0].stress_before, own[0].stress_after, share))
    return rows


def print_table(rows):
    print(f"{'system':24}{'cores':>6}{'ns/grain/step':>15}{'ns/contact/step':>17}{'MPa before':>12}{'MPa after':>11}"
          f"{'core share':>12}{'times ours':>12}")
    ours = next((row[1] for row in rows if row[0].name == "slowsand-double" and row[0].cores == 1), float("nan"))
    for system, per_grain, per_contact, before, after, share in rows:
        print(f"{system.name:24}{system.cores:6}{per_grain:15.1f}{per_contact:17.1f}{before / 1e6:12.4f}"
              f"{after / 1e6:11.4f}{share:12.2f}{per_grain / ours:12.2f}")
    if min(row[5] for row in rows) < QUIET:
        print("notice: a core share below 0.9 means that others used the machine; wall times and ratios are then rough")


def find_disagreement(rows, tolerance):
    """Where the stresses before or after differ by more than the tolerance; empty when all agree."""
    faults = []
    for column, moment in ((3, "before"), (4, "after")):
        stress = {f"{row[0].name} on {row[0].cores}": row[column] for row in rows if row[0].is_compared}
        if not stress:
            continue
        lowest, highest = min(stress, key=stress.get), max(stress, key=stress.get)
        spread = stress[highest] / stress[lowest] - 1.0
        print(f"stress {moment}: within {100 * spread:.2f} %, from {lowest} to {highest}")
        if not 0.0 <= spread <= tolerance:
            faults.append(f"the stresses {moment} differ by {100 * spread:.1f} %, more than {100 * tolerance:g} %")
    return faults


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("packing", type=Path)
    parser.add_argument("--benchmark", type=Path, required=True, help="the program engine_benchmark")
    parser.add_argument("--work", type=Path, required=True, help="folder for the packing in the peers' format")
    parser.add_argument("--steps", type=int, default=1000)
    parser.add_argument("--runs", type=int, default=5)
    parser.add_argument("--tolerance", type=float, default=TOLERANCE, help="of the stresses, largest over smallest [-]")
    parser.add_argument("--only", nargs="*", help="names of systems; without it all")
    parser.add_argument("--clock", choices=systems.CLOCKS, default="wall", help=systems.CLOCK_HELP)
    arguments = parser.parse_args()
    case = systems.Case(arguments.packing, arguments.steps, arguments.benchmark, arguments.work)
    chosen = [system for system in list_systems(case) if not arguments.only or system.name in arguments.only]
    rows = tabulate(chosen, measure(chosen, case, arguments.runs, arguments.clock), case)
    print_table(rows)
    faults = find_disagreement(rows, arguments.tolerance)
    print("\nsystem,cores,ns_per_grain_step,ns_per_contact_step,stress_before_Pa,stress_after_Pa")
    for system, per_grain, per_contact, before, after, _ in rows:
        print(f"{system.name},{system.cores},{per_grain:.2f},{per_contact:.2f},{before:.0f},{after:.0f}")
    sys.stdout.flush()
    for fault in faults:
        print(f"engine.py: {fault}", file=sys.stderr)
    return 1 if faults else 0


if __name__ == "__main__":
    try:
        sys.exit(main())
    except (OSError, RuntimeError, ValueError) as error:
        print(f"engine.py: {error}", file=sys.stderr)
        sys.exit(2)

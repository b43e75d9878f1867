"""How the cost of a grain and step depends on the number of grains and on the dust that crushing makes."""

import argparse
import statistics
import sys
from pathlib import Path

import systems
from packing_text import read_packing, replicate, write_packing

GRAIN_STEPS = 12e6  # of one run: a second or two


def make_replicas(packing, work):
    """Files of larger packings with the same forces."""
    original = read_packing(packing)
    for times in ((2, 2, 1), (3, 3, 2)):
        path = work / f"replica-{'x'.join(map(str, times))}.txt"
        if not path.exists():
            write_packing(path, replicate(original, times))
        yield path


def crush(benchmark, packing, work):
    """Files of the packing with a fifth of its grains split, and with some siblings split once more."""
    for name, options in (("crushed-10", []), ("crushed-20", ["--second-share", "0.05"])):
        path = work / f"{name}.txt"
        if not path.exists():
            part = path.with_suffix(".part")
            systems.run_program([benchmark, "crush", packing, part, *options])
            part.rename(path)
        yield name, path


def list_measurements(arguments):
    """Per row the case's name, the case and what runs it."""
    def make_case(path):
        n_grains = len(read_packing(path).grains)
        n_steps = min(4000, max(200, int(GRAIN_STEPS / n_grains)))
        return systems.Case(path, n_steps, arguments.benchmark, arguments.work)

    for path in (arguments.small, arguments.packing, *make_replicas(arguments.packing, arguments.work)):
        case = make_case(path)
        yield "fresh", case, "slowsand-double", systems.run_slowsand
        yield "fresh", case, "lammps", systems.run_lammps
    for name, path in crush(arguments.benchmark, arguments.packing, arguments.work):
        yield name, make_case(path), "slowsand-double", systems.run_slowsand


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("small", type=Path, help="packing of 1000 grains")
    parser.add_argument("packing", type=Path, help="packing of 11497 grains")
    parser.add_argument("--benchmark", type=Path, required=True, help="the program engine_benchmark")
    parser.add_argument("--work", type=Path, required=True, help="folder for packings")
    parser.add_argument("--runs", type=int, default=3)
    parser.add_argument("--clock", choices=systems.CLOCKS, default="wall", help=systems.CLOCK_HELP)
    arguments = parser.parse_args()
    measurements = list(list_measurements(arguments))
    costs = [[] for _ in measurements]
    for _ in range(arguments.runs):
        for (_, case, _, run), own in zip(measurements, costs):
            own.append(systems.measure(run, case, arguments.clock).seconds / case.n_steps / case.n_grains * 1e9)
    print("grains,case,system,ns_per_grain_step")
    for (name, case, system, _), own in zip(measurements, costs):
        print(f"{case.n_grains},{name},{system},{statistics.median(own):.2f}")


if __name__ == "__main__":
    sys.exit(main())

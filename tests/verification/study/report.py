#!/usr/bin/python3
"""Regenerates the tables and figures of docs/verification.md from the programs.

Runs that were made by the same programs with the same parameters are kept and not made again. A run that fails is a
row of the table. Exit status: 0 every bound holds (--quick: every study finished); 1 one does not; 2 bad input.
"""

import argparse
import os
import sys
from dataclasses import dataclass
from pathlib import Path

sys.dont_write_bytecode = True
sys.path.insert(0, str(Path(__file__).resolve().parent))

from runs import SOURCE, RunFailed, Runs  # noqa: E402

import creep_study  # noqa: E402
import demo_run  # noqa: E402
import one_element  # noqa: E402
import sensitivity  # noqa: E402
import strain_path  # noqa: E402
import triaxial  # noqa: E402
from plotting.errors import BadInput, NotInThisRun  # noqa: E402
from results import Results  # noqa: E402

STUDIES = ("creep", "one_element", "strain_path", "triaxial", "sensitivity", "demo")
SMALL = {"Packing/Grains": 150, "Packing/Void ratio tolerance": 0.02}  # --quick


@dataclass
class Options:
    seeds: list
    small: dict  # settings of a quick run
    is_quick: bool
    figures: Path
    n_ranks: int


def parse_arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--quick", action="store_true", help="two seeds of 150 grains, into runs/verification_quick: "
                        "shows that the report can be made, its numbers mean nothing")
    parser.add_argument("--programs", type=Path, default=SOURCE / "build" / "release", metavar="DIR",
                        help="folder of the programs (build/release)")
    parser.add_argument("--output", type=Path, metavar="DIR", help="where tables and figures go (docs/verification)")
    parser.add_argument("--runs", type=Path, metavar="DIR", help="where run folders are kept (runs/verification)")
    parser.add_argument("--ranks", type=int, default=min(8, len(os.sched_getaffinity(0))), metavar="N",
                        help="processes of the demo's run (all cores)")
    parser.add_argument("--only", nargs="+", choices=STUDIES, metavar="STUDY",
                        help=f"some of: {', '.join(STUDIES)}; the tables then hold these alone")
    arguments = parser.parse_args()
    if not arguments.programs.is_dir():
        parser.error(f"--programs: {arguments.programs} is not a folder; bash apps/build.sh makes build/release")
    kept = SOURCE / "runs" / ("verification_quick" if arguments.quick else "verification")
    arguments.runs = arguments.runs or kept
    arguments.output = arguments.output or (kept / "report" if arguments.quick else SOURCE / "docs" / "verification")
    return arguments


def run_studies(runs, results, options, chosen):
    """Each study in turn; one that cannot go on is a row, and the others follow."""
    scatter = (float("nan"), float("nan"))
    for name in chosen:
        try:
            if name == "creep":
                scatter = creep_study.study(runs, results, options)
            elif name == "sensitivity":
                sensitivity.study(runs, results, options, scatter)
            else:
                {"one_element": one_element, "strain_path": strain_path, "triaxial": triaxial,
                 "demo": demo_run}[name].study(runs, results, options)
        except (RunFailed, BadInput, NotInThisRun) as error:
            results.add_failure({"creep": creep_study, "one_element": one_element, "strain_path": strain_path,
                                 "triaxial": triaxial, "sensitivity": sensitivity, "demo": demo_run}[name].POINT, error)
        yield name


def describe_making(runs, arguments):
    """Heading of results.md: what made it."""
    versions = ", ".join(dict.fromkeys(runs.describe_program(name) for name in ("slowsand-rev", "slowsand-bvp")))
    kind = " --quick (two seeds of 150 grains: the numbers mean nothing)" if arguments.quick else ""
    return f"# Results\n\nMade by `bash docs/verification/run.sh{kind}` with {versions}. Do not edit."


def main():
    arguments = parse_arguments()
    runs, results = Runs(arguments.programs, arguments.runs, arguments.ranks), Results()
    options = Options([1, 2] if arguments.quick else [1, 2, 3, 4, 5], SMALL if arguments.quick else {},
                      arguments.quick, arguments.output / "figures", arguments.ranks)
    arguments.output.mkdir(parents=True, exist_ok=True)
    for name in run_studies(runs, results, options, arguments.only or STUDIES):
        print(f"{name}: done", file=sys.stderr, flush=True)
        results.write_csv(arguments.output / "results.csv")
        results.write_markdown(arguments.output / "results.md", describe_making(runs, arguments))
    n_broken = results.count_failures() if arguments.quick else results.count_broken_bounds()
    print(f"{arguments.output / 'results.md'}: {len(results.rows)} rows, {n_broken} {'studies failed' if arguments.quick else 'bounds broken'}")
    return 1 if n_broken else 0


if __name__ == "__main__":
    sys.exit(main())

"""Runs the experiments of the time-to-fracture paper, draws its figures, and holds its statements against what came out.

Writes results.csv, rows.csv and figures/*.png. Runs are kept and found again as long as program, case and settings are the
same; interrupted ones go on. Exit status: 0 every experiment has been made, agreement or not; 1 a run failed (its
experiment says which); 2 bad input.
"""

import argparse
import os
import sys
from pathlib import Path

sys.dont_write_bytecode = True  # the sources may lie where the user cannot write
os.environ.setdefault("MPLCONFIGDIR", "/tmp/slowsand-matplotlib")
SOURCE = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(SOURCE / "apps"))

from paper import compression, cracks, document, oedometer, packing, sensitivity, triaxial, waiting, walls  # noqa: E402
from paper.chains import Chains, RunFailed  # noqa: E402
from paper.specimens import FULL_BATCH, Laboratory  # noqa: E402
from paper.statements import Results, read_statements  # noqa: E402
from plotting.errors import BadInput  # noqa: E402

EXPERIMENTS = {"fig1": packing.draw_split_grain, "fig2": packing.draw_rev, "fig3": cracks.draw_velocities,
               "fig5": cracks.draw_times, "fig6": oedometer.draw_creep, "fig7": oedometer.draw_first_computation,
               "fig8": oedometer.draw_fluctuation, "triaxial": triaxial.draw_strength, "fig9": triaxial.draw_creep,
               "fig10": triaxial.draw_fluctuation, "fig11": triaxial.draw_deviations, "walls": walls.draw_walls,
               "compression": compression.draw_compression, "waiting": waiting.draw_waiting,
               "sensitivity": sensitivity.draw_choices}
CASES = SOURCE / "apps" / "cases" / "paper"
SMALL = {"Packing/Grains": 200, "Packing/Void ratio tolerance": 0.02, "Fracture/Batch limit": 1}
BATCHES = {"small": (1, 2, 4), "full": (5, 10, 20, 30, 60, 100, 200)}
HEADINGS = {"full": "Full size: 11497 grains", "small": "Small size: 200 grains"}


def parse_arguments():
    parser = argparse.ArgumentParser(prog="run.sh", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("size", choices=BATCHES, help="small: 200 grains; full: 11497")
    parser.add_argument("experiments", nargs="*", metavar="EXPERIMENT", help=f"of: {', '.join(EXPERIMENTS)} (default: all)")
    parser.add_argument("--programs", type=Path, default=SOURCE / "build" / "release", metavar="DIR",
                        help="folder of slowsand-rev (build/release)")
    parser.add_argument("--output", type=Path, metavar="DIR", help="where tables and figures go (runs/paper/SIZE)")
    parser.add_argument("--runs", type=Path, metavar="DIR", help="where run folders are kept (OUTPUT/runs)")
    parser.add_argument("--seeds", type=int, default=3, metavar="N", help="seeds 1 to N (3)")
    parser.add_argument("--processes", type=int, default=len(os.sched_getaffinity(0)), metavar="N",
                        help="runs at a time (all cores)")
    parser.add_argument("--set", action="append", default=[], dest="settings", metavar="SECTION/NAME=VALUE",
                        help="in every run, instead of the cases' value; may be repeated")
    parser.add_argument("--document", type=Path, metavar="FILE", help="write the tables, too, as a page whose figures lie "
                        "beside it in paper/SIZE; it shows the sizes that lie there")
    options = parser.parse_args()
    for name in options.experiments:
        if name not in EXPERIMENTS:
            parser.error(f"no experiment '{name}', there are {', '.join(EXPERIMENTS)}")
    for setting in options.settings:
        if not all(setting.partition("=")):
            parser.error(f"--set: '{setting}' is not SECTION/NAME=VALUE")
    for name in ("seeds", "processes"):
        if not 1 <= getattr(options, name) <= 1000:
            parser.error(f"--{name}: {getattr(options, name)} is not from 1 to 1000")
    if options.document and not options.output:
        options.runs = options.runs or SOURCE / "runs" / "paper" / options.size / "runs"
        options.output = options.document.parent / "paper" / options.size
    options.output = options.output or SOURCE / "runs" / "paper" / options.size
    options.runs = options.runs or options.output / "runs"
    return options


def main():
    options = parse_arguments()
    is_full = options.size == "full"
    try:
        own = dict(setting.split("=", 1) for setting in options.settings)
        chains = Chains(options.programs, options.runs, {**({} if is_full else SMALL), **own}, options.processes)
        results = Results(read_statements(CASES / "statements.csv"), is_full)
        seeds = list(range(1, options.seeds + 1))
        laboratory = Laboratory(chains, results, seeds, options.output / "figures", is_full, BATCHES[options.size],
                                FULL_BATCH if is_full else SMALL["Fracture/Batch limit"])
        options.output.mkdir(parents=True, exist_ok=True)
        version = chains.describe_program()
        for name in options.experiments or EXPERIMENTS:
            try:
                EXPERIMENTS[name](laboratory)
            except RunFailed as error:
                results.add_note(name, "experiment", "-", [], [str(error)])
            document.write_rows(options.output, results, ", ".join(
                (version, "seed 1" if options.seeds == 1 else f"seeds 1 to {options.seeds}", *options.settings)))
        if options.document:
            write_page(options.document)
    except BadInput as error:
        print(f"run.sh: {error}", file=sys.stderr)
        return 2
    except OSError as error:
        print(f"run.sh: {error}", file=sys.stderr)
        return 1
    rows = results.sort_rows()
    verdicts = [results.judge(row) for row in rows]
    print(f"{options.output / 'results.csv'}: {len(rows)} rows, {verdicts.count('yes')} agree, {verdicts.count('no')} "
          "disagree")
    return 1 if results.list_faults() else 0


def write_page(file):
    parts = [(HEADINGS[size], folder, size) for size in HEADINGS
             if (folder := file.resolve().parent / "paper" / size).is_dir()]
    document.write_document(file.resolve(), (CASES / "introduction.md").read_text(encoding="utf-8"), parts)


if __name__ == "__main__":
    sys.exit(main())

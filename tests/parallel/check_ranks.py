"""Law: history.csv is the same, byte for byte, on 1, 2 and 4 ranks, and with threads, whether REVs move between ranks or not,
and whether they may answer from their tangents or not."""

import argparse
import json
import subprocess
import sys
import tempfile
from pathlib import Path

sys.dont_write_bytecode = True
sys.path.insert(0, str(Path(__file__).resolve().parent))

import small_case  # noqa: E402


STAY, MOVE = small_case.STAY, small_case.MOVE
ALL = (("1 rank", 1, ()), ("2 ranks", 2, MOVE), ("4 ranks", 4, MOVE), ("1 rank, 3 threads", 1, ("--threads", 3)),
       ("2 ranks, 2 threads", 2, ("--threads", 2, *MOVE)), ("2 ranks, REVs stay", 2, STAY), ("4 ranks, REVs stay", 4, STAY))


def check_lazy(build, folder):
    """Some answers from tangents, some not."""
    lazy = ("--set", "REVs/Lazy tolerance=3e-2")
    lines = check_histories(build, folder, [(f"lazy, {name}", n_ranks, (*lazy, *options)) for name, n_ranks, options in ALL[:3]])
    last = dict(zip(lines[0].split(","), lines[-1].split(",")))
    questions, forecasts = int(last["rev_questions"]), int(last["lazy_answers"])
    if not 0 < forecasts < questions:
        raise AssertionError(f"{forecasts} of {questions} answers are tangents'")
    print(f"{forecasts} of {questions} answers from tangents")


def check_histories(build, folder, runs):
    case = small_case.write_case(folder)
    histories = {}
    for name, n_ranks, options in runs:
        output = Path(folder) / name.replace(" ", "_").replace(",", "")
        small_case.run(build, n_ranks, case, "--output", output, *options)
        histories[name] = (output / "history.csv").read_bytes()
        moved = json.loads((output / "summary.json").read_text())["figures"]["REVs that changed their rank"]
        if (moved > 0) != (options[-2:] == MOVE[-2:]):  # moves that never happen would prove nothing
            raise AssertionError(f"{name}: {moved:g} REVs changed their rank")
    one = histories[runs[0][0]]
    lines = one.decode().splitlines()
    broken = sum(int(value) for value in lines[-1].split(",")[5:7])
    if broken < 5:  # a run in which nothing happens would prove nothing
        raise AssertionError(f"only {broken} grains broke")
    for name, history in histories.items():
        if history != one:
            differing = next((i for i, (a, b) in enumerate(zip(lines, history.decode().splitlines())) if a != b), None)
            raise AssertionError(f"{name}: history.csv differs from that of 1 rank, first in line "
                                 f"{differing + 1 if differing is not None else 'none: lengths differ'}")
    print(f"{len(lines) - 1} rows, {broken} grains broken: the same bytes on 1, 2, 4 ranks and with threads, REVs moving or not")
    return lines


def check_unit_tests(build):
    """The tests of the coupling hold on several ranks, too."""
    for n_ranks in (2, 3):
        subprocess.run(["mpirun", "-np", str(n_ranks), str(Path(build) / "tests" / "unit_coupling"),
                        "--gtest_filter=RevPool*:MovingRevs*:RevMaterial*:RevTravel*:LazyRev*:Balance*"], env=small_case.make_environment(), check=True,
                       timeout=200, stdout=subprocess.DEVNULL)


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--source")
    parser.add_argument("--build", required=True)
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        check_histories(options.build, folder, ALL)
        check_lazy(options.build, folder)
    check_unit_tests(options.build)


if __name__ == "__main__":
    main()

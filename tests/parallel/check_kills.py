"""Law: a run killed by SIGKILL at any moment and resumed, on any number of ranks, REVs moving or not, ends in the bytes of
an undisturbed one; a job that loses one rank ends with a message. --kills N and --seed S: more moments, other moments."""

import argparse
import os
import random
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

sys.dont_write_bytecode = True
sys.path.insert(0, str(Path(__file__).resolve().parent))

import small_case  # noqa: E402

MOVE, STAY = small_case.MOVE, small_case.STAY
# Ranks and options of the resumed run, in turn.
RESUMPTIONS = ((1, ()), (2, MOVE), (1, ()), (4, MOVE), (1, ()), (2, STAY))
PATIENCE = 120  # [s]; a machine may be slow, but a job that has lost a rank ends by itself


def start(build, n_ranks, case, output, errors=subprocess.DEVNULL):
    """A run that writes a checkpoint at each step, so that kills meet the writing of one, too."""
    return subprocess.Popen(small_case.make_command(build, n_ranks, case, "--output", output, "--overwrite", "--set",
                                                    "Output/Checkpoint interval=1"),
                            env=small_case.make_environment(), stdout=subprocess.DEVNULL, stderr=errors)


def wait_for(condition, process, what):
    """Returns whether it came before the process ended."""
    deadline = time.monotonic() + PATIENCE
    while not condition():
        if process.poll() is not None:
            return False
        if time.monotonic() > deadline:
            process.kill()
            raise AssertionError(f"{what}: not within {PATIENCE} s")
        time.sleep(0.002)
    return True


def list_children(pid):
    """Processes that one has started, by the kernel's table."""
    children = []
    for stat in Path("/proc").glob("[0-9]*/stat"):
        try:
            fields = stat.read_text().rsplit(")", 1)[1].split()
        except (OSError, IndexError):  # has ended meanwhile
            continue
        if int(fields[1]) == pid:
            children.append(int(stat.parent.name))
    return children


def is_alive(pid):
    try:
        return Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()[0] not in "ZX"  # ended, if not yet buried
    except OSError:
        return False


def count_rows(output):
    history = output / "history.csv"
    return max(0, len(history.read_bytes().splitlines()) - 1) if history.is_file() else 0


def resume_and_compare(build, output, whole, resumption, event):
    n_ranks, options = resumption
    n_before = count_rows(output)
    small_case.run(build, n_ranks, "--resume", output, *options)
    if (output / "history.csv").read_bytes() != whole:
        raise AssertionError(f"{event}: resumed on {n_ranks} rank(s) {' '.join(options)}: history.csv differs from that of the "
                             "undisturbed run")
    print(f"{event}, {n_before} rows; resumed on {n_ranks} rank(s) {' '.join(options)}: the same bytes", flush=True)


def measure_course(build, case, output):
    """An undisturbed run: its history, and its time from the first checkpoint on [s]."""
    process = start(build, 1, case, output)
    wait_for((output / "checkpoint.h5").is_file, process, "the first checkpoint")
    begin = time.monotonic()
    if process.wait(PATIENCE) != 0:
        raise AssertionError(f"the undisturbed run ended with {process.returncode}")
    return (output / "history.csv").read_bytes(), time.monotonic() - begin


def kill_at_random(build, case, output, draw, duration):
    """Kills a run at a moment between its first checkpoint and its end, anew if it was faster; returns the moment [s]."""
    while True:
        process = start(build, 1, case, output)
        wait_for((output / "checkpoint.h5").is_file, process, "the first checkpoint")
        delay = draw.uniform(0.0, duration)
        time.sleep(delay)
        was_running = process.poll() is None
        process.send_signal(signal.SIGKILL)
        process.wait()
        if was_running:
            return delay
        duration *= 0.7  # it has the machine to itself now
        for path in (output / "checkpoint.h5", output / "checkpoint_previous.h5"):
            path.unlink(missing_ok=True)


def check_loss_of_a_rank(build, case, output, whole):
    log = output.with_suffix(".log")
    with log.open("wb") as errors:
        process = start(build, 2, case, output, errors)
        if not wait_for(lambda: count_rows(output) >= 8, process, "eight rows"):
            raise AssertionError("the run on two ranks was over before one could be killed")
        ranks = list_children(process.pid)
        if len(ranks) != 2:
            process.kill()
            raise AssertionError(f"mpirun has {len(ranks)} children, not two ranks")
        os.kill(ranks[1], signal.SIGKILL)
        try:
            status = process.wait(PATIENCE)
        except subprocess.TimeoutExpired:
            process.kill()
            raise AssertionError(f"one of two ranks was killed, and the job had not ended {PATIENCE} s later") from None
    message = log.read_text(errors="replace")
    if status == 0 or "signal 9" not in message:
        raise AssertionError(f"one of two ranks was killed: exit status {status}, and on standard error: {message!r}")
    deadline = time.monotonic() + PATIENCE
    while any(map(is_alive, ranks)):
        if time.monotonic() > deadline:
            raise AssertionError(f"one of two ranks was killed, mpirun has ended, and the other rank still lives {PATIENCE} s later")
        time.sleep(0.01)
    resume_and_compare(build, output, whole, (1, ()), "one of two ranks killed: the job ended with a message")


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--source")
    parser.add_argument("--build", required=True)
    parser.add_argument("--kills", type=int, default=10)
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    draw = random.Random(options.seed)
    with tempfile.TemporaryDirectory() as folder:
        folder = Path(folder)
        case = small_case.write_case(folder)
        whole, duration = measure_course(options.build, case, folder / "whole")
        for i in range(options.kills):
            output = folder / f"killed_{i}"
            delay = kill_at_random(options.build, case, output, draw, duration)
            resume_and_compare(options.build, output, whole, RESUMPTIONS[i % len(RESUMPTIONS)],
                               f"killed {delay:.3f} s after the first checkpoint")
        check_loss_of_a_rank(options.build, case, folder / "lost_a_rank", whole)


if __name__ == "__main__":
    main()

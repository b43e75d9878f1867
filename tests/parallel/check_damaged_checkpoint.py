"""Law: of the two checkpoints that are kept, a run goes on from the newest that is whole, says which one was not, and ends
in the bytes of an undisturbed one; if none is whole, the folder is refused and left as it is."""

import argparse
import json
import random
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

sys.dont_write_bytecode = True
sys.path.insert(0, str(Path(__file__).resolve().parent))

import small_case  # noqa: E402

NEWEST, PREVIOUS = "checkpoint.h5", "checkpoint_previous.h5"
FLIPS = 4


def flip_byte(path, draw):
    content = bytearray(path.read_bytes())
    content[draw.randrange(len(content))] ^= 1 << draw.randrange(8)
    path.write_bytes(content)


def truncate(path, draw):
    content = path.read_bytes()
    path.write_bytes(content[: draw.randrange(len(content))])


def remove(path, _draw):
    path.unlink()


def resume(build, n_ranks, output):
    return subprocess.run(small_case.make_command(build, n_ranks, "--resume", output), env=small_case.make_environment(),
                          capture_output=True, text=True, timeout=300, check=False)


def expect_fallback(build, run, output, damage, n_ranks, draw):
    """Damages the newest, and looks whether the older one leads to the same end."""
    shutil.copytree(run, output)
    expected = (run / "history.csv").read_bytes()
    damage(output / NEWEST, draw)
    done = resume(build, n_ranks, output)
    event = f"{damage.__name__}, {n_ranks} rank(s)"
    if done.returncode != 0:
        raise AssertionError(f"{event}: exit status {done.returncode}: {done.stderr}")
    for word in (f"{NEWEST}: ", f"going on from {output / PREVIOUS}"):
        if word not in done.stderr:
            raise AssertionError(f"{event}: standard error does not say {word!r}: {done.stderr!r}")
    if (output / "history.csv").read_bytes() != expected:
        raise AssertionError(f"{event}: history.csv differs from that of the undisturbed run")
    again = resume(build, 1, output)  # the damaged one has been replaced, and has not taken the older one's place
    if again.returncode != 0 or "going on" in again.stderr:
        raise AssertionError(f"{event}: resumed once more: exit status {again.returncode}, {again.stderr!r}")
    print(f"{event}: {done.stderr.strip()}")


def expect_refusal(build, run, output, draw):
    shutil.copytree(run, output)
    for name in (NEWEST, PREVIOUS):
        flip_byte(output / name, draw)
    before = {path: path.read_bytes() for path in output.rglob("*") if path.is_file()}
    done = resume(build, 1, output)
    if done.returncode != 2 or NEWEST not in done.stderr or PREVIOUS not in done.stderr:
        raise AssertionError(f"both damaged: exit status {done.returncode}, {done.stderr!r}")
    if before != {path: path.read_bytes() for path in output.rglob("*") if path.is_file()}:
        raise AssertionError("both damaged: the folder was changed")
    print(f"both damaged: {done.stderr.strip()}")


def check_report(run):
    """Time and size of checkpoints are told."""
    summary = json.loads((run / "summary.json").read_text())
    size = (run / NEWEST).stat().st_size
    if summary["figures"]["size of the last checkpoint [B]"] != size:
        raise AssertionError(f"the checkpoint has {size} B, summary.json says otherwise")
    if not summary["figures"]["checkpoints written"] > 2 or not summary["wall_s"]["writing checkpoints"] > 0.0:
        raise AssertionError("summary.json does not tell what checkpoints took")


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--source")
    parser.add_argument("--build", required=True)
    options = parser.parse_args()
    draw = random.Random(5)
    with tempfile.TemporaryDirectory() as folder:
        folder = Path(folder)
        run = folder / "whole"
        small_case.run(options.build, 1, small_case.write_case(folder), "--output", run)
        check_report(run)
        damages = [(flip_byte, 1 + i % 2) for i in range(FLIPS)] + [(truncate, 1), (truncate, 4), (remove, 2)]
        for i, (damage, n_ranks) in enumerate(damages):
            expect_fallback(options.build, run, folder / f"damaged_{i}", damage, n_ranks, draw)
        expect_refusal(options.build, run, folder / "lost", draw)


if __name__ == "__main__":
    main()

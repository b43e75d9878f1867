"""The runs of docs/pile.md: which case with which settings, and how one is started, found again or gone on with."""

import json
import os
import subprocess
import time
from dataclasses import dataclass, field
from pathlib import Path

SOURCE = Path(__file__).resolve().parents[2]
CASES = SOURCE / "apps" / "cases"
ENVIRONMENT = {"OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1", "OPENBLAS_NUM_THREADS": "1",
               "OMP_NUM_THREADS": "1", "DEAL_II_NUM_THREADS": "1"}


@dataclass
class Series:
    """One pile and its seeds."""

    name: str
    case: str
    settings: dict = field(default_factory=dict)
    seeds: tuple = (1,)


LOW_STRESS = {"Ground/Surcharge": "1e5", "Boundary conditions/Condition 4/Value": "1e5",
              "Boundary conditions/Condition 8/Value": "1e5", "Loading/Stage 4/Targets": "head pressure: 1e6"}
FRICTION = {"Mesh/File": "meshes/pile_hole_slip.msh", "Interface/Regions": "interface", "Interface/Friction coefficient": "0.5",
            "Interface/Normal modulus": "2e9", "Interface/Shear modulus": "5e8"}


def withdraw_to(widening):
    """Settings that let the hole back to a widening [m]; the case's own is 0.073 m."""
    return {"Loading/Stage 3/Targets": f"shaft displacement r: {widening}; cone displacement r: {widening}"}


SERIES = (
    Series("installed", "bvp_pile_small.prm", seeds=(1, 2, 3)),
    Series("wished in place", "bvp_pile_wished.prm", seeds=(1, 2, 3)),
    Series("withdrawn", "bvp_pile_withdrawn.prm", seeds=(1, 2, 3)),
    Series("withdrawn by 4 mm", "bvp_pile_withdrawn.prm", withdraw_to(0.071)),
    Series("withdrawn by 6 mm", "bvp_pile_withdrawn.prm", withdraw_to(0.069)),
    Series("withdrawn by 6 mm, friction 0.5", "bvp_pile_withdrawn.prm", withdraw_to(0.069) | FRICTION),
    Series("low stress", "bvp_pile_small.prm", LOW_STRESS),
    Series("first radius 0.15 m", "bvp_pile_small.prm",
           {"Mesh/File": "meshes/pile_first_radius.msh",
            "Loading/Stage 2/Targets": "shaft displacement r: 0.05; cone displacement r: 0.05; base displacement z: -0.05"}),
    Series("friction 0.5", "bvp_pile_small.prm", FRICTION),
    Series("own dilatation", "bvp_pile_small.prm", {"Problem/Dilatation": "point"}),
    Series("more steps", "bvp_pile_small.prm", {"Loading/Stage 5/First output": "1", "Loading/Stage 5/Steps per decade": "8"}),
    Series("400 grains", "bvp_pile_small.prm", {"Packing/Grains": "400"}),
    Series("fine mesh", "bvp_pile_small.prm", {"Mesh/File": "meshes/pile_fine.msh"}),
    Series("large", "bvp_pile.prm"),
)


def list_runs(series):
    """(folder name, seed) of each run of a series."""
    return [(f"{series.name.replace(' ', '_').replace(',', '')}-seed_{seed}", seed) for seed in series.seeds]


def is_finished(folder):
    """Whether a run folder says that its run has come to its end."""
    try:
        return json.loads((folder / "summary.json").read_text(encoding="utf-8"))["status"] == "finished"
    except (OSError, ValueError, KeyError):
        return False


def make_command(programs, series, seed, folder):
    """Command that begins a run, or goes on with it where it has left a checkpoint."""
    program = str(Path(programs).resolve() / "slowsand-bvp")
    if (folder / "checkpoint.h5").is_file():
        return [program, "--quiet", "--resume", str(folder)]
    settings = {"Seed": seed, **series.settings}
    return [program, "--quiet", str(CASES / series.case), "--output", str(folder), "--overwrite"] + [
        part for name, value in settings.items() for part in ("--set", f"{name}={value}")]


def run(programs, series, seed, folder):
    """Brings a run to its end unless it is there; says what it does. Returns whether it is finished."""
    if is_finished(folder):
        return True
    command = make_command(programs, series, seed, folder)
    start = time.monotonic()
    print(f"{folder.name}: {'goes on' if '--resume' in command else 'begins'}", flush=True)
    if "--overwrite" in command and not folder.exists():
        command.remove("--overwrite")
    done = subprocess.run(command, cwd=SOURCE, env=dict(os.environ, **ENVIRONMENT), capture_output=True, text=True,
                          check=False)
    print(f"{folder.name}: exit status {done.returncode} after {time.monotonic() - start:.0f} s {done.stderr.strip()}",
          flush=True)
    return done.returncode == 0

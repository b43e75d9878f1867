"""The demo's run: its figures, how many evaluations an equilibrium took, and what the macro scale costs."""

import shutil
import subprocess
import sys

from runs import SOURCE, RunFailed

POINT = "The demo's specimen"
CASE = "apps/cases/bvp_oedometer_creep.prm"
EVALUATIONS, RESIDUAL = 4., 1e-3
KEPT = ("creep", "compression", "grading", "stress_path", "specimen", "rev")


def study(runs, results, options):
    run = runs.run("demo", "slowsand-bvp", CASE, dict(options.small), options.n_ranks)
    figures, command = run.summary["figures"], run.command
    results.add_below(POINT, "REV evaluations a point and equilibrium in creep, avalanche rounds apart",
                      figures["REV evaluations a point and creep step"], "-", command, EVALUATIONS)
    results.add_below(POINT, "largest residual over reaction of a committed step",
                      figures["largest residual over reaction [-]"], "-", command, RESIDUAL)
    for name in ("creep steps", "avalanche rounds", "avalanche evaluations", "steps taken back",
                 "evaluations lost with them"):
        results.add(POINT, name, figures[name], "-", command)
    results.add(POINT, "share of wall time outside REVs", 100 * figures["share of wall time outside REVs [-]"], "%",
                command)
    results.add(POINT, f"wall time on {options.n_ranks} processes", run.summary["wall_s"]["total"], "s", command)
    results.add(POINT, "grains at the end", run.summary["grains"], "-", command)
    for kind in ("instant", "delayed"):
        results.add(POINT, f"grains broken, {kind}", run.summary[f"broken_{kind}"], "-", command)
    _draw(run, options)


def _draw(run, options):
    """What slowsand-plot draws, under the report's names."""
    plot = [sys.executable, str(SOURCE / "apps" / "slowsand-plot"), str(run.path)]
    done = subprocess.run(plot, capture_output=True, text=True, timeout=600)
    if done.returncode != 0:
        raise RunFailed(f"slowsand-plot: {done.stderr.strip().splitlines()[-1]}", f"slowsand-plot {run.path}")
    options.figures.mkdir(parents=True, exist_ok=True)
    for name in KEPT:
        figure = run.path / "figures" / f"{name}.png"
        if figure.is_file():
            shutil.copyfile(figure, options.figures / f"demo_{name}.png")

"""Triaxial compression at 10 MPa against the strength that the time-to-fracture paper reports."""

import numpy as np

from plotting import style

POINT = "Triaxial strength at 10 MPa"
CASE = "apps/cases/rev_triaxial.prm"
PUBLISHED = 22.6  # q_max [MPa]
SHARE = 0.1  # of it: packings of 1000 grains scatter by about 7 %


def study(runs, results, options):
    done = [runs.run(f"triaxial_seed_{seed}", "slowsand-rev", CASE, {"Seed": seed, **options.small})
            for seed in options.seeds[:3]]
    figure, axes = style.new_figure(2.6)
    peaks = []
    for seed, run in zip(options.seeds, done):
        strain, q = compute_shearing(run)
        axes.plot(100 * strain, q, linewidth=0.9, label=f"seed {seed}")
        peaks.append(q.max())
        results.add(POINT, f"q_max, seed {seed}", peaks[-1], "MPa", run.command)
        results.add(POINT, f"axial strain at q_max, seed {seed}", 100 * strain[q.argmax()], "%", run.command)
    mean = float(np.mean(peaks))
    results.add(POINT, f"q_max, mean of {len(peaks)} seeds", mean, "MPa", done[0].command,
                f"{PUBLISHED} within {100 * SHARE:g} %", abs(mean - PUBLISHED) <= SHARE * PUBLISHED)
    axes.axhline(PUBLISHED, color="0.5", linestyle="--", linewidth=0.8, label="published maximum")
    axes.set_xlabel("axial strain since the start of shearing [%]\n(compression positive)")
    axes.set_ylabel("deviatoric stress q [MPa]")
    axes.set_ylim(bottom=0)
    axes.legend(loc="lower right")
    style.save(figure, options.figures, "triaxial")


def compute_shearing(run):
    """(axial strain since the start of stage 2 [-], q [MPa]): axial less mean lateral stress."""
    stress, stage = run.get_tensor("stress"), run.get_column("stage")
    strain = run.get_column("strain_zz")
    start = np.flatnonzero(stage == 1)[-1]
    q = (stress[:, 2] - stress[:, :2].mean(axis=1)) / 1e6
    return strain[start:] - strain[start], q[start:]

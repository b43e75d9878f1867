"""What the creep slope owes to each choice that the source leaves open: one run each, all else as shipped."""

import numpy as np

from creep_curves import compute_slope, make_times, sample
from creep_study import CASE, FIRST, LAST
from plotting import style
from runs import RunFailed

LONGEST_RUN = 150  # [s], ten times the usual: a specimen that is crushed to powder would keep the machine for hours
POINT = "Sensitivity of the creep slope"
VARIANTS = (
    ("d0 = 0.21 mm", {"Strength/Reference diameter": 0.21e-3}),
    ("d0 = 1 mm", {"Strength/Reference diameter": 1e-3}),
    ("d0 = 4 mm", {"Strength/Reference diameter": 4e-3}),
    ("grains turn freely", {"Grains/Rotation is free": "true"}),
    ("roughness of each grain", {"Grains/Roughness rule": "per grain"}),
    ("strength truncated at 2", {"Strength/Truncation": 2}),
    ("strength truncated at 2.6", {"Strength/Truncation": 2.6}),
    ("N_max = 1 grain", {"Fracture/Batch limit": 1}),
    ("N_max = 10 grains", {"Fracture/Batch limit": 10}),
    ("strain per cycle 2.5e-6", {"Equilibrium/Strain per cycle": 2.5e-6}),
    ("strain per cycle 4e-5", {"Equilibrium/Strain per cycle": 4e-5}),
    ("unbalanced ratio 1e-3", {"Equilibrium/Unbalanced ratio": 1e-3}),
    ("unbalanced ratio 1e-5", {"Equilibrium/Unbalanced ratio": 1e-5}),
    ("250 grains", {"Packing/Grains": 250}),
    ("500 grains", {"Packing/Grains": 500}),
)


def study(runs, results, options, scatter):
    """@param scatter  (mean, standard deviation) of the slope over seeds, to tell an effect from chance"""
    variants = [("as shipped, 1000 grains", {})] + list(VARIANTS if not options.is_quick else VARIANTS[:1])
    slopes = {}
    for name, settings in variants:
        try:
            run = runs.run("sensitivity_" + "".join(c if c.isalnum() else "_" for c in name), "slowsand-rev", CASE,
                           {"Seed": options.seeds[0], **options.small, **settings}, longest=LONGEST_RUN)
        except RunFailed as error:
            results.add(POINT, f"slope, {name}", f"no result: {error}", "", error.command)
            continue
        times = make_times(FIRST, LAST, 4)
        strains = sample(run, times)
        slopes[name] = 100 * compute_slope(times, strains)
        results.add(POINT, f"slope, {name}", slopes[name], "% per decade", run.command)
        results.add(POINT, f"creep strain at 1e{LAST} s, {name}", 100 * strains[-1], "%", run.command)
    style.save(_draw(slopes, scatter), options.figures, "sensitivity")


def _draw(slopes, scatter):
    """Slopes as points beside the band of the seeds."""
    names = list(slopes)[::-1]
    figure, axes = style.new_figure(0.6 + 0.17 * len(names))
    mean, deviation = (100 * value for value in scatter)
    axes.axvspan(mean - deviation, mean + deviation, color="0.88", linewidth=0, label="scatter over seeds")
    axes.axvline(mean, color="0.5", linewidth=0.8, label="their mean")
    axes.plot([slopes[name] for name in names], np.arange(len(names)), "o", color=style.BLUE)
    axes.set_yticks(np.arange(len(names)), names)
    axes.set_xlim(left=0)
    axes.set_xlabel("creep slope [% per decade]")
    axes.legend(loc="lower right")
    return figure

"""Creep: axial strain against the logarithm of time, the fracture events that made it, and its slope per decade."""

import numpy as np

from . import style
from .curves import fit_slope
from .errors import NotInThisRun
from .run_folder import select_creep


def draw(run, options):
    """Upper panel: creep curve from the start of the creep stage on, a tick where grains broke. Lower: how many."""
    creep = select_creep(run, options.creep_stage)
    shown = creep.time > 0
    if not shown.any():
        raise NotInThisRun(f"stage {creep.stage} of {run.path} lasts no time")
    figure, (upper, lower) = style.new_figure(3.4, 2, sharex=True, height_ratios=(2.4, 1))
    _draw_points(run, options, upper)
    upper.semilogx(creep.time[shown], 100 * creep.strain[shown], color="black",
                   label="REV" if run.is_rev() else "mean of the Gauss points")
    for counts, height, colour, label in ((creep.broken_delayed, 0.08, style.ORANGE, "delayed"),
                                          (creep.broken_instant, 0.03, style.VERMILION, "instantaneous")):
        grew = shown & (np.diff(counts, prepend=counts[0]) > 0)
        upper.plot(creep.time[grew], np.full(grew.sum(), height), "|", color=colour, markersize=5,
                   markeredgewidth=0.6, transform=upper.get_xaxis_transform(), label=f"{label} fracture")
        lower.step(creep.time[shown], counts[shown], where="post", color=colour, label=label)
    upper.set_ylim(bottom=_leave_room_for_marks(upper))
    upper.set_ylabel("axial creep strain [%]\n(compression positive)")
    upper.legend(loc="upper left")
    lower.set_ylabel("broken grains [-]")
    lower.set_xlabel("time since the start of creep [s]")
    lower.set_ylim(bottom=0)
    return figure


def _draw_points(run, options, axes):
    """Thin lines: each Gauss point of a boundary-value problem."""
    for i, probe in enumerate([] if run.is_rev() else run.get_probes()):
        creep = select_creep(run, options.creep_stage, run.get_column(f"{probe}_strain_zz"))
        shown = creep.time > 0
        axes.semilogx(creep.time[shown], 100 * creep.strain[shown], color="0.75", linewidth=0.6, zorder=1,
                      label="each Gauss point" if i == 0 else None)


def _leave_room_for_marks(axes):
    """Lower end of the axis such that the curve keeps clear of the two rows of marks in its lowest eighth."""
    low, high = axes.get_ylim()
    return low - (high - low) / 7


def draw_comparison(runs, options):
    """The creep curves of several runs in one panel."""
    figure, axes = style.new_figure(2.6)
    for run in runs:
        creep = select_creep(run, options.creep_stage)
        shown = creep.time > 0
        axes.semilogx(creep.time[shown], 100 * creep.strain[shown], label=run.name)
    axes.set_xlabel("time since the start of creep [s]")
    axes.set_ylabel("axial creep strain [%]\n(compression positive)")
    axes.legend(loc="upper left")
    return figure


def print_slopes(runs, options):
    """CSV on standard output: each decade between the two given ones, then the whole range, for every run."""
    low, high = options.decades
    ranges = [(d, d + 1) for d in range(low, high)] + ([(low, high)] if high > low + 1 else [])
    print("run,from_s,to_s,rows,slope_per_decade,interval_low,interval_high")
    for run in runs:
        creep = select_creep(run, options.creep_stage)
        for first, last in ranges:
            n, slope, half = fit_slope(creep.time, creep.strain, first, last)
            print(f"{run.name},{10.**first:g},{10.**last:g},{n},{slope:.8g},{slope - half:.8g},{slope + half:.8g}")

"""Sorted times to fracture of a REV's grains at frozen crack velocities (docs/theory.md, Eq. 18)."""

import numpy as np

from . import style
from .errors import NotInThisRun
from .snapshot import find_first_and_last, read_cracks

LATEST = 1e12  # [s], some thirty thousand years: later fractures are not drawn


def sort_times(cracks):
    """Ids of the grains that will break and their times from now [s], the first first (ties by id)."""
    growing = cracks.velocity > 0
    time = np.full(len(cracks.id), np.inf)
    with np.errstate(over="ignore"):  # a crack may be too slow for a time that a double holds: it never breaks
        time[growing] = np.maximum(cracks.radius[growing] - cracks.half_length[growing], 0.) / cracks.velocity[growing]
    order = np.lexsort((cracks.id, time))
    order = order[np.isfinite(time[order])]
    return cracks.id[order], time[order]


def draw(run, options):
    """A line for each snapshot of a REV alone; of a boundary-value problem one for each Gauss point's last."""
    figure, axes = style.new_figure(2.6)
    if run.is_rev():
        lines = [(file, {"label": file.stem}) for file in run.find_snapshots()]
    else:
        ends = find_first_and_last(run.find_snapshots()).values()
        lines = [(last.path, {"color": "0.5", "linewidth": 0.6, "label": "each REV, last" if i == 0 else None})
                 for i, (_, last) in enumerate(ends)]
    for file, look in lines:
        time = sort_times(read_cracks(file))[1]
        time = time[(time > 0) & (time < LATEST)]
        if time.size:
            axes.loglog(time, np.arange(1, time.size + 1), drawstyle="steps-post", **look)
    if not axes.lines:
        style.plt.close(figure)
        raise NotInThisRun(f"no grain of a snapshot in {run.path} breaks within {LATEST:g} s")
    axes.set_xlabel("time to fracture [s]")
    axes.set_ylabel("grains that break until then [-]")
    axes.legend(loc="upper left")
    return figure


def print_times(runs, options):
    """CSV on standard output: every grain of every snapshot that will break, in order."""
    print("run,snapshot,rank,grain,time_to_fracture_s")
    for run in runs:
        for file in run.find_snapshots():
            for rank, (grain, time) in enumerate(zip(*sort_times(read_cracks(file))), start=1):
                print(f"{run.name},{file.stem},{rank},{grain},{time:.10g}")

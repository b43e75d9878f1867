"""The runs of a study in one figure: for each set of values the median over its seeds, with bands of their scatter."""

import csv
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from . import style
from .curves import sample_steps
from .errors import BadInput, NotInThisRun
from .run_folder import RunFolder

POINTS = 400  # of each curve
TIME = "time_s"


@dataclass
class Curve:
    """What is drawn of one run."""

    x: np.ndarray
    y: np.ndarray


def read_sets(folder):
    """Title of each set of values -> run folders of its finished runs, in the order of table.csv."""
    table = Path(folder) / "table.csv"
    if not table.is_file():
        raise BadInput(f"{folder}: not the folder of a study, table.csv is missing")
    with open(table, newline="", encoding="utf-8", errors="replace") as file:
        rows = list(csv.reader(file))
    header = rows[0] if rows else []
    for name in ("run", "seed", "status"):
        if name not in header:
            raise BadInput(f"{table}: column {name} is missing")
    status, seed, sets = header.index("status"), header.index("seed"), {}
    for line, row in enumerate(rows[1:], start=2):
        if len(row) != len(header):
            raise BadInput(f"{table}, line {line}: {len(row)} values for {len(header)} columns")
        title = ", ".join(f"{header[k]} = {_shorten(row[k])}" for k in range(1, seed))
        if row[status] == "finished":
            sets.setdefault(title, []).append(RunFolder(Path(folder) / "runs" / row[0]))
    if not sets:
        raise NotInThisRun(f"{table}: no run has finished")
    return sets


def make_curve(run, options):
    """Rows of the stage wanted, or all; time counts from the last row before the stage, y too if a change is wanted."""
    for name in (options.x, options.y):
        if isinstance(run.get_column(name), list):
            raise BadInput(f"{run.path / 'history.csv'}: column {name} holds text")
    x, y = run.get_column(options.x), run.get_column(options.y)
    if options.stage is None:
        return Curve(x, y)
    rows = np.flatnonzero(run.get_column("stage") == options.stage)
    if rows.size == 0:
        raise BadInput(f"{run.path / 'history.csv'}: column stage holds no stage {options.stage}")
    origin = max(rows[0] - 1, 0)
    rows = np.concatenate(([origin], rows[rows > origin]))
    return Curve(x[rows] - (x[origin] if options.x == TIME else 0.), y[rows] - (y[origin] if options.change else 0.))


def sample_together(curves, is_time):
    """(x, values of each curve at x): as far as all of them reach, so that the median is over the same runs everywhere.

    Against time values keep until the next row and x is spaced evenly in its logarithm. Against another column they
    are interpolated between the rows in which that column goes beyond all rows before: it may waver.
    """
    if is_time:
        first = min(np.min(curve.x[curve.x > 0], initial=np.inf) for curve in curves)
        last = min(curve.x[-1] for curve in curves)
    else:
        curves = [_keep_advances(curve) for curve in curves]
        first, last = max(curve.x[0] for curve in curves), min(curve.x[-1] for curve in curves)
    if not first < last:
        raise NotInThisRun("the runs have no range in common")
    if is_time:
        x = np.geomspace(first, last, POINTS)
        return x, np.array([sample_steps(curve.x, curve.y, x) for curve in curves])
    x = np.linspace(first, last, POINTS)
    return x, np.array([np.interp(x, curve.x, curve.y) for curve in curves])


def compute_bands(values):
    """(least, lower quartile, median, upper quartile, largest) over the runs (rows), quartiles interpolated linearly."""
    return np.percentile(values, (0, 25, 50, 75, 100), axis=0)


def draw(folder, options):
    """One colour a set: median, quartiles (darker band), least to largest (lighter band)."""
    sets = read_sets(folder)
    if len(sets) > len(style.CYCLE):
        colours = style.plt.cm.viridis(np.linspace(0., 0.9, len(sets)))
    else:
        colours = style.CYCLE
    figure, axes = style.new_figure(2.8)
    for colour, (title, runs) in zip(colours, sets.items()):
        x, values = sample_together([make_curve(run, options) for run in runs], options.x == TIME)
        x, values = x * _get_scale(options.x), values * _get_scale(options.y)
        least, low, median, high, largest = compute_bands(values)
        if len(runs) > 1:
            axes.fill_between(x, least, largest, color=colour, alpha=0.12, linewidth=0)
            axes.fill_between(x, low, high, color=colour, alpha=0.3, linewidth=0)
        axes.plot(x, median, color=colour, label=f"{title or 'all'} ({len(runs)} runs)")
    if options.x == TIME:
        axes.set_xscale("log")
    since = "" if options.stage is None else f"since the start of stage {options.stage}"
    axes.set_xlabel(_name_axis(options.x) + (f" {since}" if options.x == TIME else ""))
    axes.set_ylabel(_name_axis(options.y) + (f"\n{since}" if options.change else ""))
    axes.legend(loc="upper left", title="median, quartiles, least and largest", title_fontsize=7)
    return figure


def _keep_advances(curve):
    """The rows in which x goes beyond all before, as rising x."""
    sign = 1. if curve.x[-1] >= curve.x[0] else -1.
    x = sign * curve.x
    beyond = np.concatenate(([True], x[1:] > np.maximum.accumulate(x)[:-1]))
    order = slice(None) if sign > 0 else slice(None, None, -1)
    return Curve(curve.x[beyond][order], curve.y[beyond][order])


def _shorten(text):
    try:
        return f"{float(text):g}"
    except ValueError:
        return text


def _get_scale(column):
    """Stresses are drawn in MPa, all else as the history has it."""
    return 1e-6 if column.endswith("_Pa") else 1.


def _name_axis(column):
    """A column's name with its unit: its last part says Pa, s, N or m, else it is a pure number."""
    for ending, unit in (("_Pa", "MPa"), ("_s", "s"), ("_N", "N"), ("_m", "m")):
        if column.endswith(ending):
            return f"{column[:-len(ending)].replace('_', ' ')} [{unit}]"
    return f"{column.replace('_', ' ')} [-]"

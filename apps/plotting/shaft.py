"""What the shaft of a pile feels: radial and shear stress against age and against depth, from shaft.csv."""

import numpy as np

from . import style
from .errors import NotInThisRun


def select_wall(table):
    """(ages, steps, depths, index) of the Gauss points nearest to the wall at each depth: `index[row, place]` is the
    table's row of one output and one place along the shaft, places from the top down."""
    depth, distance, step = (table.get_column(name) for name in ("depth_m", "distance_m", "step"))
    if not len(depth):
        raise NotInThisRun(f"no Gauss points beside a shaft in {table.path}")
    nearest = np.flatnonzero(distance <= distance.min() * (1 + 1e-6))  # one column of points; thickness is the layer's
    steps = np.unique(step)
    first = nearest[step[nearest] == steps[0]]
    order = first[np.argsort(depth[first], kind="stable")]
    places = {point: i for i, point in enumerate(table.get_column("point")[order])}
    index = np.full((len(steps), len(places)), -1)
    row_of_step = {value: i for i, value in enumerate(steps)}
    for row in nearest:
        index[row_of_step[step[row]], places[table.get_column("point")[row]]] = row
    return table.get_column("age_s")[index[:, 0]], steps, depth[order], index


def compute_means(table, column):
    """Ages [s], stages, and the mean over the shaft's length of a column, one value an output.

    Between Gauss points the column is taken as linear, beyond the first and last as constant.
    """
    ages, _, depths, index = select_wall(table)
    values = table.get_column(column)[index]
    unique = np.unique(depths)
    level = np.stack([values[:, depths == depth].mean(axis=1) for depth in unique], axis=1)
    if len(unique) == 1:
        means = level[:, 0]
    else:
        means = np.trapezoid(level, unique, axis=1) if hasattr(np, "trapezoid") else np.trapz(level, unique, axis=1)
        means = means / np.ptp(unique)
    return ages, table.get_column("stage")[index[:, 0]], means


def draw(run, options):
    """Upper panel: means over the shaft since creep began. Lower: radial stress against depth then and at the end."""
    table = run.read_table("shaft.csv")
    ages, stages, radial = compute_means(table, "radial_stress_Pa")
    shear = compute_means(table, "shear_stress_Pa")[2]
    figure, (upper, lower) = style.new_figure(4.4, 2)
    aged = ages > 0
    for values, colour, label in ((radial, style.BLUE, "radial"), (shear, style.VERMILION, "shear")):
        upper.semilogx(ages[aged], values[aged] / 1e6, "o-", color=colour, label=label)
    upper.set_xlabel("age [s]")
    upper.set_ylabel("mean stress on the shaft [MPa]\n(compression positive)")
    upper.legend(loc="best")
    _, _, depths, index = select_wall(table)
    last_load = np.flatnonzero(~aged)[-1]
    for row, colour, label in ((0, style.GREY, "untouched ground"), (last_load, style.BLUE, "before creep"),
                               (len(ages) - 1, style.VERMILION, f"at {ages[-1]:.3g} s")):
        lower.plot(table.get_column("radial_stress_Pa")[index[row]] / 1e6, depths, "o-", color=colour, label=label)
    lower.invert_yaxis()
    lower.set_xlabel("radial stress [MPa]")
    lower.set_ylabel("depth [m]")
    lower.legend(loc="best")
    return figure

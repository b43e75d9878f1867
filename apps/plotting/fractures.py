"""Fractures by cause, size and generation of the grains that broke."""

import numpy as np

from . import style
from .errors import NotInThisRun
from .snapshot import find_first_and_last

N_CLASSES = 6  # of diameter
CAUSES = (("delayed", style.ORANGE), ("instant", style.VERMILION))


def make_size_classes(diameters):
    """Edges [m] of classes of equal ratio from the smallest to the largest diameter, ends included."""
    low, high = diameters.min() * (1 - 1e-9), diameters.max() * (1 + 1e-9)
    return np.geomspace(low, high, N_CLASSES + 1)


def count(run):
    """Rows (cause, generation, from [m], to [m], broken, grains) of the classes in which grains are or broke; `grains`
    counts those of the packing, nan for siblings."""
    table = run.read_table("fractures.csv")
    diameter, generation = table.get_column("diameter_m"), table.get_column("generation").astype(int)
    cause = np.array(table.get_column("cause"), dtype=str)
    packing = 2 * next(iter(find_first_and_last(run.find_snapshots()).values()))[0].radius
    edges = make_size_classes(np.concatenate((packing, diameter)))
    there = np.histogram(packing, edges)[0]
    rows = []
    for number in range(generation.max(initial=0) + 1):
        for name, _ in CAUSES:
            broken = np.histogram(diameter[(cause == name) & (generation == number)], edges)[0]
            rows += [(name, number, edges[k], edges[k + 1], int(broken[k]), there[k] if number == 0 else np.nan)
                     for k in range(N_CLASSES) if broken[k] > 0 or (number == 0 and there[k] > 0)]
    return rows


def draw(run, options):
    """Stacked bars over the size of the grain; later generations are hatched."""
    rows = count(run)
    if not any(row[4] for row in rows):
        raise NotInThisRun(f"nothing broke in {run.path / 'fractures.csv'}")
    figure, axes = style.new_figure(2.6)
    foot, colours = {}, dict(CAUSES)
    for cause, generation, low, high, broken, _ in rows:
        label = cause if generation == 0 else f"{cause}, siblings (generation {generation})"
        known = axes.get_legend_handles_labels()[1]
        axes.bar(1e3 * low, broken, 1e3 * (high - low), bottom=foot.get(low, 0), align="edge", linewidth=0.4,
                 color=colours[cause], edgecolor="black", hatch="" if generation == 0 else "//",
                 label=None if label in known else label)
        foot[low] = foot.get(low, 0) + broken
    axes.set_xlabel("diameter of the grain that broke [mm]")
    axes.set_ylabel("fractures [-]")
    axes.legend(loc="best")
    return figure


def print_counts(runs, options):
    """CSV on standard output."""
    print("run,cause,generation,from_diameter_m,to_diameter_m,broken,grains_of_the_packing")
    for run in runs:
        for cause, generation, low, high, broken, there in count(run):
            print(f"{run.name},{cause},{generation},{low:.6g},{high:.6g},{broken},{there:g}")

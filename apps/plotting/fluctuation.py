"""Fluctuation of the controlled stresses in dynamic computations against the number of grains that broke at once."""

from dataclasses import dataclass

import numpy as np

from . import style
from .errors import NotInThisRun

COMPONENTS = ("xx", "yy", "zz", "xy", "yz", "xz")


@dataclass
class Fluctuation:
    """Of the dynamic computations that grains' breaking began, one entry each; compression-positive."""

    broken: np.ndarray  # grains at once [-]
    rise: np.ndarray  # largest rise of a controlled stress above its target [Pa], not negative
    drop: np.ndarray  # largest drop below it [Pa], not negative

    @property
    def mean(self):
        """Mean of the sizes of both [Pa]: the measure of the time-to-fracture paper."""
        return 0.5 * (self.rise + self.drop)


def read_fluctuation(run):
    """Of all jumps of the run after which grains broke under a controlled stress: the largest component counts."""
    table = run.read_table("jumps.csv")
    broken = table.get_column("broken")

    def find_extreme(name, sign):
        deviations = np.column_stack([sign * table.get_column(f"{name}_deviation_{c}_Pa") for c in COMPONENTS])
        return np.max(np.where(np.isnan(deviations), -np.inf, deviations), axis=1)

    rise, drop = find_extreme("largest", 1.), find_extreme("smallest", -1.)
    chosen = (broken > 0) & np.isfinite(rise)
    if not chosen.any():
        raise NotInThisRun(f"no grains broke under a controlled stress in {table.path}")
    return Fluctuation(broken[chosen], rise[chosen], drop[chosen])


def draw(run, options):
    """A point for each dynamic computation."""
    fluctuation = read_fluctuation(run)
    figure, axes = style.new_figure(2.6)
    for values, marker, colour, label in ((fluctuation.rise, "^", style.VERMILION, "largest rise"),
                                          (-fluctuation.drop, "v", style.BLUE, "largest drop"),
                                          (fluctuation.mean, "o", "black", "mean of their sizes")):
        axes.plot(fluctuation.broken, values / 1e6, marker, color=colour, markerfacecolor="none",
                  markeredgewidth=0.6, label=label)
    axes.axhline(0., color="0.75", linewidth=0.6, zorder=1)
    axes.xaxis.get_major_locator().set_params(integer=True)
    axes.set_xlabel("grains broken at once [-]")
    axes.set_ylabel("deviation from the target [MPa]\n(compression positive)")
    axes.legend(loc="best")
    return figure

"""Grading: share of the mass that is finer than a diameter, before and after, with and without the fines."""

import numpy as np

from . import style
from .errors import BadInput
from .snapshot import find_first_and_last


def compute_passing(volumes_by_diameter, fines_volume, largest_fine, at_diameters):
    """Share of the mass finer than each given diameter [-].

    @param volumes_by_diameter  (diameters [m], volumes [m3]) of the grains
    @param fines_volume  [m3], spread log-uniformly by mass over [largest_fine/10, largest_fine]: a choice, the fines
                         are not simulated
    """
    diameters, volumes = volumes_by_diameter
    order = np.argsort(diameters)
    finer = np.concatenate(([0.], np.cumsum(volumes[order])))
    passing = finer[np.searchsorted(diameters[order], at_diameters, side="right")]
    if fines_volume > 0:
        passing = passing + fines_volume * np.clip(np.log10(10 * at_diameters / largest_fine), 0., 1.)
    return passing / (np.sum(volumes) + fines_volume)


def gather_grains(snapshots):
    """(diameters [m], volumes [m3]) of all grains of several REVs together."""
    diameters = np.concatenate([2 * snapshot.radius for snapshot in snapshots])
    return diameters, np.pi / 6 * diameters**3


def find_comminution_limit(run, options):
    """d_c [m]: given by hand, or from parameters.prm."""
    if options.comminution_limit is not None:
        return _require_positive(options.comminution_limit, "--comminution-limit")
    found = run.find_parameter("comminution")
    if found is None:
        raise BadInput(f"{run.path / 'parameters.prm'}: no parameter names the comminution limit; "
                       "give it with --comminution-limit [m]")
    place = f"{run.path / 'parameters.prm'}: {found[0]}/{found[1]}"
    try:
        return _require_positive(float(found[2]), place)
    except ValueError:
        raise BadInput(f"{place} = '{found[2]}' is not a number") from None


def _require_positive(limit, place):
    if not limit > 0:
        raise BadInput(f"{place} = {limit:g} m: fines need a positive limit to lie below")
    return limit


def draw(run, options):
    """Curves of all REVs of the run pooled: fines are the volume lost since the first snapshot."""
    ends = find_first_and_last(run.find_snapshots()).values()
    before, after = (gather_grains([pair[i] for pair in ends]) for i in (0, 1))
    fines = max(np.sum(before[1]) - np.sum(after[1]), 0.)
    if fines < 1e-12 * np.sum(before[1]):  # rounding of the sums: nothing was lost
        fines = 0.
    limit = find_comminution_limit(run, options) if fines > 0 else 0.
    smallest = min(after[0].min(), before[0].min(), limit / 10 if fines > 0 else np.inf)
    diameters = np.geomspace(0.9 * smallest, 1.05 * max(before[0].max(), after[0].max()), 2000)
    figure, axes = style.new_figure(2.6)
    axes.semilogx(1e3 * diameters, 100 * compute_passing(before, 0., limit, diameters), color="black", label="before")
    axes.semilogx(1e3 * diameters, 100 * compute_passing(after, 0., limit, diameters), color=style.BLUE,
                  label="after, without fines")
    if fines > 0:
        share = fines / np.sum(before[1])
        axes.semilogx(1e3 * diameters, 100 * compute_passing(after, fines, limit, diameters), "--",
                      color=style.VERMILION, label=f"after, with fines ({100 * share:.2g} % of mass)")
    axes.set_xlabel("grain diameter [mm]")
    axes.set_ylabel("finer by mass [%]")
    axes.set_ylim(0, 100)
    axes.xaxis.set_major_formatter(style.plt.FuncFormatter(lambda value, _: f"{value:g}"))
    axes.legend(loc="upper left")
    return figure

"""Compression: void ratio against the logarithm of the vertical stress, without and with the fines."""

import numpy as np

from . import style
from .errors import NotInThisRun

STRESS_LABEL = "vertical stress [MPa] (compression positive)"


def get_curves(run):
    """(name, vertical stress [Pa], void ratio or None, the same with fines or None) of the REV or each Gauss point."""
    if run.is_rev():
        return [("REV", run.get_column("stress_zz_Pa"), run.get_column("void_ratio"),
                 run.get_column("void_ratio_with_fines"))]
    return [(probe, run.get_column(f"{probe}_stress_zz_Pa"), run.history.get(f"{probe}_void_ratio"),
             run.history.get(f"{probe}_void_ratio_with_fines")) for probe in run.get_probes()]


def draw(run, options):
    """Void ratios; of a boundary-value problem without void ratios among its probes, the axial strain instead."""
    curves = get_curves(run)
    if not curves:
        raise NotInThisRun(f"no probe columns in {run.path / 'history.csv'}")
    figure, axes = style.new_figure(2.6)
    if curves[0][2] is None:
        _draw_strain(run, curves, axes)
        return figure
    width = 1.2 if len(curves) == 1 else 0.6
    for i, (_, stress, bare, with_fines) in enumerate(curves):
        for values, colour, line, label in ((bare, style.BLUE, "-", "fines counted as pores"),
                                            (with_fines, style.VERMILION, "--", "fines counted as solids")):
            if values is not None:
                shown = stress > 0
                axes.semilogx(stress[shown] / 1e6, values[shown], line, color=colour, linewidth=width,
                              label=label if i == 0 else None)
    axes.set_xlabel(STRESS_LABEL)
    axes.set_ylabel("void ratio [-]")
    axes.legend(loc="lower left")
    return figure


def _draw_strain(run, curves, axes):
    for i, (probe, stress, _, _) in enumerate(curves):
        shown = stress > 0
        axes.semilogx(stress[shown] / 1e6, 100 * run.get_column(f"{probe}_strain_zz")[shown], color="0.6",
                      linewidth=0.6, label="each Gauss point" if i == 0 else None)
    mean_stress = np.mean([curve[1] for curve in curves], axis=0)
    mean_strain = np.mean([run.get_column(f"{curve[0]}_strain_zz") for curve in curves], axis=0)
    shown = mean_stress > 0
    axes.semilogx(mean_stress[shown] / 1e6, 100 * mean_strain[shown], color=style.BLUE, label="mean")
    axes.invert_yaxis()  # compression downwards, as a void ratio would fall
    axes.set_xlabel(STRESS_LABEL)
    axes.set_ylabel("axial strain [%]\n(compression positive)")
    axes.legend(loc="lower left")


def draw_comparison(runs, options):
    """Void ratio without fines of several REVs in one panel."""
    if not all(run.is_rev() for run in runs):
        raise NotInThisRun("compression curves are compared between runs of slowsand-rev only")
    figure, axes = style.new_figure(2.6)
    for run in runs:
        stress = run.get_column("stress_zz_Pa")
        axes.semilogx(stress[stress > 0] / 1e6, run.get_column("void_ratio")[stress > 0], label=run.name)
    axes.set_xlabel(STRESS_LABEL)
    axes.set_ylabel("void ratio [-] (fines counted as pores)")
    axes.legend(loc="lower left")
    return figure

"""Stress path: deviatoric stress q against mean stress p, of the REV or of each Gauss point."""

import numpy as np

from . import style
from .errors import NotInThisRun


def compute_invariants(stress):
    """p = tr/3 and q = sqrt(3 J2), both [unit of the stress], of rows xx, yy, zz, xy, yz, xz; compression positive.

    q is the equivalent (von Mises) stress: |axial - radial| in axisymmetric compression, never negative.
    """
    xx, yy, zz, xy, yz, xz = stress.T
    p = (xx + yy + zz) / 3
    squares = (xx - yy)**2 + (yy - zz)**2 + (zz - xx)**2
    return p, np.sqrt(squares / 2 + 3 * (xy**2 + yz**2 + xz**2))


def draw(run, options):
    """One line a Gauss point; open circle at its first row, full circle at its last."""
    probes = [None] if run.is_rev() else run.get_probes()
    if not probes:
        raise NotInThisRun(f"no probe columns in {run.path / 'history.csv'}")
    figure, axes = style.new_figure(2.8)
    few = len(probes) <= len(style.CYCLE)
    for i, probe in enumerate(probes):
        p, q = (values / 1e6 for values in compute_invariants(run.get_tensor("stress", probe)))
        colour = style.CYCLE[i] if few else style.plt.cm.viridis(i / (len(probes) - 1))
        axes.plot(p, q, color=colour, linewidth=1.2 if few else 0.8, label=probe or "REV")
        axes.plot(p[0], q[0], "o", color=colour, markerfacecolor="white")
        axes.plot(p[-1], q[-1], "o", color=colour)
    axes.set_xlim(left=0)
    axes.set_ylim(bottom=0)
    axes.set_xlabel("mean stress p [MPa] (compression positive)")
    axes.set_ylabel("deviatoric stress q = $\\sqrt{3 J_2}$ [MPa]")
    if len(probes) > 1:
        axes.legend(loc="upper left", ncols=1 if few else 2, title="open: first, full: last state", title_fontsize=7)
    return figure

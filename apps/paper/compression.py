"""Beyond the paper: compression to 60 MPa and its grading."""

import numpy as np

from plotting import style
from plotting.grading import compute_passing, gather_grains
from plotting.snapshot import read_snapshot

from .specimens import find_snapshot, load

UNLOADINGS = "rev_unloadings.prm"
TO_60_MPA = 11  # stages of that case
BEFORE, BEHIND = (1e6, 5e6), (30e6, 60e6)  # [Pa], on both sides of the knee
LIMIT = 0.1155e-3  # d_c [m], Table 1


def compress_to_60(chains, seed):
    return chains.run("compression", UNLOADINGS, TO_60_MPA, seed, base=load(chains, seed))


def read_curve(run):
    """(axial stress [Pa], axial strain [-]) at the equilibria under stresses that had not been reached before."""
    stress, strain = run.get_column("stress_zz_Pa"), run.get_column("strain_zz")
    first = stress > np.concatenate(([0.], np.maximum.accumulate(stress)[:-1]))
    return stress[first], strain[first]


def fit_between(curve, ends):
    """(strain per decade of stress, strain at 1 Pa) of the line through the curve at stresses between two [Pa]."""
    stress, strain = curve
    grid = np.linspace(*np.log10(ends), 21)
    return np.polyfit(grid, np.interp(grid, np.log10(stress), strain), 1)


def find_yield(curve):
    """Stress [Pa] at which the lines before and behind the knee cross."""
    (slope, level), (steep, low) = fit_between(curve, BEFORE), fit_between(curve, BEHIND)
    return 10.**((level - low) / (steep - slope))


def draw_compression(laboratory):
    """The curve, its yield, and the grading at 60 MPa."""
    runs, faults = laboratory.chains.run_seeds(lambda seed: compress_to_60(laboratory.chains, seed), laboratory.seeds)
    curves, results = [read_curve(run) for run in runs], laboratory.results
    steep = [100 * fit_between(curve, BEHIND)[0] for curve in curves]
    results.add("knee", [s / (100 * fit_between(curve, BEFORE)[0]) for s, curve in zip(steep, curves)], faults)
    results.add("yield", [find_yield(curve) / 1e6 for curve in curves], faults)
    results.add("compression_slope", steep, faults)
    ends = [[gather_grains([read_snapshot(find_snapshot(run, stage))]) for stage in (0, TO_60_MPA)] for run in runs]
    results.add("largest_left", [after[0].max() / before[0].max() for before, after in ends], faults)
    for key, column in (("einav", "relative_breakage_einav_with_fines"), ("fines", "fines_share")):
        results.add(key, [_read_breakage(run, column) for run in runs], faults)
    if runs:
        style.save(_draw_curves(runs, curves, ends), laboratory.figures, "compression")


def _read_breakage(run, column):
    """At the highest stress."""
    table = run.read_table("breakage.csv")
    return table.get_column(column)[table.get_column("stage") == TO_60_MPA][-1]


def _draw_curves(runs, curves, ends):
    figure, (upper, lower) = style.new_figure(4.6, 2)
    for run, (stress, strain) in zip(runs, curves):
        line, = upper.semilogx(stress / 1e6, 100 * strain, linewidth=0.9, label=f"seed {run.seed}")
        upper.semilogx(run.get_column("stress_zz_Pa") / 1e6, 100 * run.get_column("strain_zz"), color=line.get_color(),
                       linewidth=0.4)
        upper.plot(find_yield((stress, strain)) / 1e6, 0., "v", color=line.get_color(), clip_on=False)
    upper.invert_yaxis()
    upper.set_xlabel("axial stress [MPa] (triangles: yield)")
    upper.set_ylabel("axial strain [%]\n(compression positive)")
    upper.legend(loc="lower left")
    diameters = np.geomspace(0.1 * LIMIT, 0.28e-3, 400)
    for run, (before, after) in zip(runs, ends):
        colour = style.CYCLE[runs.index(run) % len(style.CYCLE)]
        lost = np.sum(before[1]) - np.sum(after[1])
        if run is runs[0]:
            lower.semilogx(1e3 * diameters, 100 * compute_passing(before, 0., LIMIT, diameters), color="black", linewidth=0.9,
                           label="packing")
        lower.semilogx(1e3 * diameters, 100 * compute_passing(after, lost, LIMIT, diameters), color=colour, linewidth=0.9,
                       label=f"at 60 MPa with fines, seed {run.seed}")
    lower.set_xlabel("grain diameter [mm]")
    lower.set_ylabel("finer by mass [%]")
    lower.legend(loc="upper left")
    return figure

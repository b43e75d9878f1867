"""Beyond the paper: compression to 60 MPa and its grading; creep beside the compression that it is worth."""

import numpy as np

from plotting import style
from plotting.grading import compute_passing, gather_grains
from plotting.snapshot import read_snapshot

from .oedometer import STRESS, compute_slope
from .specimens import OEDOMETER, creep, find_snapshot, load, pack, sample_creep

UNLOADINGS = "rev_unloadings.prm"
TO_60_MPA, ALL_STAGES = 11, 16  # stages of that case
BEFORE, BEHIND = (1e6, 5e6), (30e6, 60e6)  # [Pa], on both sides of the knee
LIMIT = 0.1155e-3  # d_c [m], Table 1
EXPONENTS, USUAL = (30, 60, 120), 60  # n of Charles' law
TRANSITION = 1.83472  # b of the contacts' transition stage with Table 1's n1, n2 (docs/theory.md, section 2)
ONSET = 0.25 * 0.21e-3 / 0.1  # [s] that a mean crack takes to grow through a median grain at v0
WINDOW = (1e2, 1e6)  # [s], of the creep slope
LABORATORY = 0.02  # C_alpha/C_c of sands (Mesri and Godlewski 1977), +- 0.01


def compress_to_60(chains, seed):
    return chains.run("compression", UNLOADINGS, TO_60_MPA, seed, base=load(chains, seed))


def compress_on(chains, seed):
    """To 104 MPa, which is what 1e6 s at 21.7 MPa are worth at n = 30."""
    return chains.run("compression_on", UNLOADINGS, ALL_STAGES, seed, base=compress_to_60(chains, seed))


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


def creep_with(chains, seed, exponent):
    """Creep with another n of Charles' law, from the packing on: velocities belong to the state."""
    if exponent == USUAL:
        return creep(chains, seed)
    return chains.run(f"creep_n_{exponent}", OEDOMETER, 3, seed, {"Crack growth/Exponent": exponent}, pack(chains, seed))


def compute_share(exponent):
    """1/(n (1 - 1/b)): what C_alpha/C_c should be."""
    return 1. / (exponent * (1. - 1. / TRANSITION))


def raise_stress(times, exponent):
    """Stress [Pa] that breaks at once what times [s] at 21.7 MPa break with delay."""
    return STRESS * (np.asarray(times) / ONSET)**compute_share(exponent)


def read_irrecoverable(run):
    """(highest stress so far [Pa], axial strain [-] when it has been taken off down to 21.7 MPa)."""
    stage, stress, strain = (run.get_column(name) for name in ("stage", "stress_zz_Pa", "strain_zz"))
    ends = [int(np.flatnonzero(stage == k)[-1]) for k in range(2, ALL_STAGES + 1)]
    tops, bottoms = [ends[0], *ends[1::2]], [ends[0], *ends[2::2]]
    return stress[tops], strain[bottoms]


def compute_irrecoverable(curve, stress):
    return np.interp(np.log10(stress), np.log10(curve[0]), curve[1])


def draw_waiting(laboratory):
    """C_alpha/C_c for three n; creep curves beside what loading to the raised stress leaves."""
    chains, results = laboratory.chains, laboratory.results
    figure, axes = style.new_figure(2.8)
    for exponent, colour in zip(EXPONENTS, style.CYCLE):
        pairs, faults = chains.run_seeds(
            lambda seed, n=exponent: (creep_with(chains, seed, n), compress_on(chains, seed)), laboratory.seeds)
        slopes, indices = [], []
        low, high = raise_stress(WINDOW, exponent)
        for k, (crept, compressed) in enumerate(pairs):
            curve = read_irrecoverable(compressed)
            indices.append(np.diff(compute_irrecoverable(curve, [low, high]))[0] / np.log10(high / low))
            slopes.append(compute_slope(crept))
            _draw_pair(axes, crept, curve, exponent, colour, k == 0)
        # Over the mean of all seeds: in a small REV one of them may break no grain between the two stresses.
        ratios = [slope / np.mean(indices) for slope in slopes]
        results.add(f"ratio_{exponent}", ratios, faults)
        if exponent == USUAL:
            results.add("laboratory", ratios, faults)
        results.add_note("waiting", f"n = {exponent}: creep strain per decade of time from 1e2 to 1e6 s", "% per decade",
                         100 * np.array(slopes))
        results.add_note("waiting", f"n = {exponent}: irrecoverable strain per decade of stress from {low / 1e6:.1f} to "
                         f"{high / 1e6:.1f} MPa", "% per decade", 100 * np.array(indices))
    axes.set_xlabel("time at 21.7 MPa [s]")
    axes.set_ylabel("axial strain since loading [%]\n(compression positive)")
    axes.set_yscale("log")
    axes.set_ylim(bottom=0.01)
    axes.legend(loc="upper left", title="lines: creep; broken: what the raised\nstress leaves", title_fontsize=7)
    style.save(figure, laboratory.figures, "waiting")


def _draw_pair(axes, crept, curve, exponent, colour, is_first):
    times = np.logspace(0, 6, 121)
    axes.semilogx(times, 100 * sample_creep(crept, times), color=colour, linewidth=0.8,
                  label=f"n = {exponent}" if is_first else None)
    worth = raise_stress(times, exponent)
    axes.semilogx(times, 100 * (compute_irrecoverable(curve, worth) - curve[1][0]), "--", color=colour, linewidth=0.6)

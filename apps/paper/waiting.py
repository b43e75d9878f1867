"""Beyond the paper: creep beside the compression that it is worth, C_alpha/C_c."""

import h5py
import numpy as np

from plotting import style

from .compression import UNLOADINGS, compress_to_60
from .oedometer import STRESS, compute_slope
from .specimens import OEDOMETER, creep, find_snapshot, load, pack, sample_creep

TO_104_MPA, ALL_STAGES = 15, 16  # stages of UNLOADINGS
UNBROKEN = {"Fracture/Grains break": "false"}
EXPONENTS, USUAL = (30, 60, 120), 60  # n of Charles' law
TRANSITION = 1.83472  # b of the contacts' transition stage with Table 1's n1, n2 (docs/theory.md, section 2)
ONSET = 0.25 * 0.21e-3 / 0.1  # [s] that a mean crack takes to grow through a median grain at v0
WINDOW = (1e2, 1e6)  # [s], of the creep slope


def compress_on(chains, seed):
    """To 104 MPa, which is what 1e6 s at 21.7 MPa are worth at n = 30."""
    return chains.run("compression_on", UNLOADINGS, ALL_STAGES, seed, base=compress_to_60(chains, seed))


def compress_unbroken(chains, seed):
    """The same from 21.7 MPa on with grains that do not break: what it leaves is sliding alone."""
    return chains.run("compression_unbroken", UNLOADINGS, ALL_STAGES, seed, UNBROKEN, load(chains, seed))


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


def compute_index(curve, ends):
    """Strain left per decade of stress between two [Pa]."""
    return np.diff(compute_irrecoverable(curve, ends))[0] / np.log10(ends[1] / ends[0])


def count_broken(crept, compressed, exponent):
    """(grains broken within 1e6 s at 21.7 MPa, those broken by the stress that this is worth)"""
    broken = [run.get_column("broken_instant") + run.get_column("broken_delayed") for run in (crept, compressed)]
    start = [np.flatnonzero(run.get_column("stage") == 2)[-1] for run in (crept, compressed)]
    within = crept.get_column("time_s") <= WINDOW[1] * (1 + 1e-9)
    stress = np.maximum.accumulate(compressed.get_column("stress_zz_Pa"))
    worth = np.interp(raise_stress(WINDOW[1], exponent), stress[start[1]:], broken[1][start[1]:])
    return broken[0][within][-1] - broken[0][start[0]], worth - broken[1][start[1]]


def measure_contact_exponent(unbroken):
    """Exponent with which the largest contact stresses (the 90 % quantile over the grains) grow with the axial stress from
    21.7 to 104 MPa."""
    first, last = (read_largest_stresses(find_snapshot(unbroken, stage)) for stage in (2, TO_104_MPA))
    stress = [unbroken.get_column("stress_zz_Pa")[unbroken.get_column("stage") == stage][-1] for stage in (2, TO_104_MPA)]
    return np.log(np.quantile(last, 0.9) / np.quantile(first, 0.9)) / np.log(stress[1] / stress[0])


def read_largest_stresses(snapshot):
    """Largest contact stress of each grain [Pa]."""
    with h5py.File(snapshot) as file:
        return file["grains/largest_contact_stress"][...]


def draw_waiting(laboratory):
    """C_alpha/C_c for three n; creep curves beside what loading to the raised stress leaves."""
    chains, results = laboratory.chains, laboratory.results
    figure, axes = style.new_figure(2.8)
    unbroken, faults = chains.run_seeds(lambda seed: compress_unbroken(chains, seed), laboratory.seeds)
    results.add_note("waiting", "exponent of the largest contact stresses with the axial stress, 21.7 to 104 MPa, no grain "
                     "breaks (1 - 1/b = 0.455)", "-", [measure_contact_exponent(run) for run in unbroken], faults)
    slid = [read_irrecoverable(run) for run in unbroken]
    for exponent, colour in zip(EXPONENTS, style.CYCLE):
        pairs, faults = chains.run_seeds(
            lambda seed, n=exponent: (creep_with(chains, seed, n), compress_on(chains, seed)), laboratory.seeds)
        curves = [read_irrecoverable(compressed) for _, compressed in pairs]
        for k, ((crept, _), curve) in enumerate(zip(pairs, curves)):
            _draw_pair(axes, crept, curve, exponent, colour, k == 0)
        _add_ratios(results, exponent, pairs, curves, slid, faults)
    axes.set_xlabel("time at 21.7 MPa [s]")
    axes.set_ylabel("axial strain since loading [%]\n(compression positive)")
    axes.set_yscale("log")
    axes.set_ylim(bottom=0.01)
    axes.legend(loc="upper left", title="lines: creep; broken: what the raised\nstress leaves", title_fontsize=7)
    style.save(figure, laboratory.figures, "waiting")


def _add_ratios(results, exponent, pairs, curves, slid, faults):
    ends = raise_stress(WINDOW, exponent)
    slopes = [compute_slope(crept) for crept, _ in pairs]
    # Over the mean of all seeds: in a small REV one of them may break no grain between the two stresses.
    indices, sliding = ([compute_index(curve, ends) for curve in of] for of in (curves, slid))
    ratios = [slope / np.mean(indices) for slope in slopes]
    results.add(f"ratio_{exponent}", ratios, faults)
    broken_index = np.mean(indices) - np.mean(sliding) if indices and sliding else np.nan
    results.add(f"breaking_{exponent}", [slope / broken_index for slope in slopes] if broken_index > 0. else [], faults)
    if exponent == USUAL:
        results.add("laboratory", ratios, faults)
    low, high = ends / 1e6
    for text, unit, values in (
            ("creep strain per decade of time from 1e2 to 1e6 s", "% per decade", 100 * np.array(slopes)),
            (f"irrecoverable strain per decade of stress from {low:.1f} to {high:.1f} MPa", "% per decade",
             100 * np.array(indices)),
            ("of that where no grain breaks", "% per decade", 100 * np.array(sliding)),
            ("grains broken within 1e6 s at 21.7 MPa over those that the raised stress breaks", "-",
             [np.divide(*count_broken(*pair, exponent)) for pair in pairs if count_broken(*pair, exponent)[1] > 0])):
        results.add_note("waiting", f"n = {exponent}: {text}", unit, values)


def _draw_pair(axes, crept, curve, exponent, colour, is_first):
    times = np.logspace(0, 6, 121)
    axes.semilogx(times, 100 * sample_creep(crept, times), color=colour, linewidth=0.8,
                  label=f"n = {exponent}" if is_first else None)
    worth = raise_stress(times, exponent)
    axes.semilogx(times, 100 * (compute_irrecoverable(curve, worth) - curve[1][0]), "--", color=colour, linewidth=0.6)

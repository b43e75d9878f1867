"""q_max from 10 MPa; Figs. 9 to 11: creep at shares of it."""

import numpy as np

from plotting import style
from plotting.run_folder import select_creep

from .specimens import STRENGTH, TRIAXIAL, compress, fit_line, read_disturbances, sample_creep

SHARES = (0.4, 0.6, 0.8, 0.9, 0.95)
STRAIGHT, LOOKED_AT = 0.4, (0.4, 0.9)  # shares of Fig. 9's first row, of Figs. 10 and 11
DECADES = np.logspace(2, 6, 17)  # times [s] over which a line is looked for
CONFINEMENT, PUBLISHED = 10e6, 22.6  # [Pa], the paper's q_max [MPa]
LIMITS = 0.3, 2.  # of the fluctuation [MPa] and of the deviation [%], the paper's
SERVO = {"Equilibrium/Strain per cycle": 1e-4}  # in creep: at the 1e-5 of all loads it is too slow for a batch of thirty
VARIANTS = ({"Equilibrium/Strain per cycle": 1e-5}, {"Equilibrium/Strain per cycle": 1e-5, "Fracture/Batch limit": 10},
            {"Equilibrium/Strain per cycle": 1e-5, "Motion/Local damping": 0.9})  # of 1e-4, 30 and 0.7, for Fig. 11
RUPTURE_STRAINS, USUAL_RUPTURE = (0.10, 0.15, 0.20), 0.15  # runs go on to the last
WINDOW, GRID = 0.5, 0.125  # decades of time: over which the steepest creep is looked for, and how finely


def find_strength(chains, seed):
    return chains.run("strength", STRENGTH, 3, seed, base=compress(chains, seed))


def creep_at(chains, seed, share, variant=None):
    """At a share of the q_max of the seed's own specimen. @param variant  Section/Name -> value, of the creep alone"""
    q_max = find_strength(chains, seed).summary["q_max_Pa"]
    own = {"Stage 3/Share of q_max": share, "Stage 3/q_max": repr(q_max)}
    sheared = chains.run(f"sheared_to_{share}", TRIAXIAL, 3, seed, own, compress(chains, seed))
    name = f"creep_at_{share}" + "".join(f"-{_shorten(key)}_{value}" for key, value in (variant or {}).items())
    return chains.run(name, TRIAXIAL, 4, seed, {**own, **SERVO, **(variant or {})}, sheared)


def _shorten(name):
    return name.rsplit("/", 1)[-1].lower().replace(" ", "_")


def find_rupture(run, strain):
    """Time of rupture [s] since the creep began, inf if there is none: the program's own, or when the creep strain first
    exceeds the given one."""
    curve = select_creep(run)
    beyond = curve.time[curve.strain > strain]
    own = run.summary.get("rupture_time_s", np.inf)  # loads take no time: creep begins at 0 s
    return min(own, beyond[0]) if len(beyond) else own


def find_steepest(run):
    """(largest creep strain per decade of time over half a decade [-], the same over the mean slope before it; nan unless
    a decade lies before it). A curve that is straight in log time has about 1, a bent one more."""
    curve = select_creep(run)
    crept = curve.time[curve.strain > 0.]
    if not len(crept) or crept[0] >= curve.time[-1]:
        return np.nan, np.nan
    first, last = np.log10(crept[0]), np.log10(curve.time[-1])
    logs = np.append(np.arange(first, last, GRID), last)
    strains = sample_creep(run, 10.**logs * (1 + 1e-9))
    starts = logs[logs <= last - WINDOW] if last - WINDOW >= first else logs[:1]
    rises = [(np.interp(min(start + WINDOW, last), logs, strains) - np.interp(start, logs, strains)) / WINDOW
             for start in starts]
    steepest = int(np.argmax(rises))
    before = starts[steepest] - first
    mean = (np.interp(starts[steepest], logs, strains) - strains[0]) / before if before >= 1. else np.nan
    return rises[steepest], rises[steepest] / mean if mean > 0. else np.nan


def draw_strength(laboratory):
    runs, faults = laboratory.chains.run_seeds(lambda seed: find_strength(laboratory.chains, seed), laboratory.seeds)
    laboratory.results.add("q_max", [run.summary["q_max_Pa"] / 1e6 for run in runs], faults)
    figure, axes = style.new_figure(2.6)
    strains = []
    for run in runs:
        strain, q = _compute_shearing(run)
        strains.append(100 * strain[np.argmax(q)])
        axes.plot(100 * strain, q, linewidth=0.9, label=f"seed {run.seed}")
    laboratory.results.add("strain_q_max", strains, faults)
    axes.axhline(PUBLISHED, color="0.6", linestyle="--", linewidth=0.6, label=r"the paper's q$_{max}$")
    axes.set_xlabel("axial strain since the start of shearing [%]\n(compression positive)")
    axes.set_ylabel("deviatoric stress q [MPa]")
    axes.set_ylim(bottom=0)
    axes.legend(loc="lower right")
    style.save(figure, laboratory.figures, "triaxial")


def _compute_shearing(run):
    """(axial strain [-] since stage 3 began, q [MPa])."""
    start = np.flatnonzero(run.get_column("stage") == 2)[-1]
    strain, stress = run.get_column("strain_zz")[start:], run.get_tensor("stress")[start:]
    return strain - strain[0], (stress[:, 2] - stress[:, :2].mean(axis=1)) / 1e6


def run_shares(laboratory, shares):
    """share -> (runs, faults)"""
    chains = laboratory.chains
    return {share: chains.run_seeds(lambda seed, s=share: creep_at(chains, seed, s), laboratory.seeds)
            for share in shares}


def draw_creep(laboratory):
    """Fig. 9."""
    found, results = run_shares(laboratory, SHARES), laboratory.results
    for share, (runs, faults) in found.items():
        _add_ruptures(results, share, runs, faults)
        lines = [fit_line(DECADES, 100 * sample_creep(run, DECADES)) for run in runs]
        results.add_note("fig9", f"q/q_max = {share}: creep strain per decade from 1e2 s on, of the seeds that get there",
                         "% per decade", [slope for slope, _ in lines if np.isfinite(slope)])
        if share == STRAIGHT:
            results.add(f"straight_{share}", [r for _, r in lines if np.isfinite(r)], faults)
        steepest = [find_steepest(run) for run in runs]
        results.add_note("fig9", f"q/q_max = {share}: largest creep strain per decade, over half a decade of time",
                         "% per decade", [100 * slope for slope, _ in steepest if np.isfinite(slope)])
        results.add_note("fig9", f"q/q_max = {share}: that over the mean slope before it", "-",
                         [bend for _, bend in steepest if np.isfinite(bend)])
    style.save(_draw_creep(found), laboratory.figures, "fig9")


def _add_ruptures(results, share, runs, faults):
    """Shares and times of ruptures, with what another bound on strain would make of them."""
    for strain in RUPTURE_STRAINS:
        times = np.array([find_rupture(run, strain) for run in runs])
        label = f"q/q_max = {share}" + ("" if strain == USUAL_RUPTURE else f", rupture at {100 * strain:.0f} % of strain")
        if strain == USUAL_RUPTURE and share in (SHARES[0], SHARES[-1]):
            results.add(f"rupture_{share}", np.isfinite(times), faults)
        else:
            results.add_note("fig9", f"{label}: share of seeds that rupture", "-", np.isfinite(times), faults)
        results.add_note("fig9", f"{label}: log10 of the time of rupture [s], of the seeds that rupture", "-",
                         np.log10(times[np.isfinite(times)]))


def _draw_creep(found):
    figure, axes = style.new_figure(2.8)
    for (share, (runs, _)), colour in zip(found.items(), style.CYCLE):
        for k, run in enumerate(runs):
            curve = select_creep(run)
            shown = curve.time > 0
            axes.semilogx(curve.time[shown], 100 * curve.strain[shown], color=colour, linewidth=0.8,
                          label=rf"q/q$_{{max}}$ = {share}" if k == 0 else None)
            rupture = find_rupture(run, USUAL_RUPTURE)
            if np.isfinite(rupture):
                axes.plot(rupture, 100 * sample_creep(run, [rupture * (1 + 1e-9)])[0], "x", color=colour)
    axes.set_xlabel("time since the start of creep [s] (cross: rupture)")
    axes.set_ylabel("axial creep strain [%]\n(compression positive)")
    axes.legend(loc="upper left")
    return figure


def draw_fluctuation(laboratory):
    """Fig. 10: against the number broken at once."""
    found = run_shares(laboratory, LOOKED_AT)
    figure, axes = style.new_figure(2.6)
    for (share, (runs, faults)), colour in zip(found.items(), (style.BLUE, style.VERMILION)):
        jumps = [read_disturbances(run, 4) for run in runs]
        laboratory.results.add(f"mean_{share}", [np.mean(j.mean) / 1e6 for j in jumps if len(j.time)], faults)
        laboratory.results.add_note("fig10", f"q/q_max = {share}: largest fluctuation of one computation", "MPa",
                                    [np.max(j.mean) / 1e6 for j in jumps if len(j.time)])
        axes.plot(np.concatenate([j.broken for j in jumps] or [[]]), np.concatenate([j.mean for j in jumps] or [[]]) / 1e6,
                  "o", color=colour, markerfacecolor="none", markeredgewidth=0.6, label=rf"q/q$_{{max}}$ = {share}")
    axes.axhline(LIMITS[0], color="0.6", linestyle="--", linewidth=0.6, label="the paper's limit")
    axes.xaxis.get_major_locator().set_params(integer=True)
    axes.set_xlabel("grains broken at once [-]")
    axes.set_ylabel("mean of largest rise and drop\nof vertical stress [MPa]")
    axes.legend(loc="best")
    style.save(figure, laboratory.figures, "fig10")


def draw_deviations(laboratory):
    """Fig. 11: of all dynamic computations, over the target; at 0.9 with other servos, N_max and damping, too."""
    found, results = run_shares(laboratory, LOOKED_AT), laboratory.results
    figure, panels = style.new_figure(3.2, 2, sharex=True)
    for axes, (share, (runs, faults)) in zip(panels, found.items()):
        largest, measures = measure_deviations(runs)
        results.add(f"share_{share}", largest, faults)
        results.add_note("fig11", f"q/q_max = {share}: the same in the paper's measure of Fig. 10 (mean of rise and drop)", "%",
                         measures)
        for run, colour in zip(runs, style.CYCLE):
            jumps, target = read_disturbances(run, 4), find_target(run)
            for values in (jumps.rise, -jumps.drop):
                axes.semilogx(jumps.time, 100 * values / target, "o", color=colour, markersize=2)
        for sign in (-1, 1):
            axes.axhline(sign * LIMITS[1], color="0.6", linestyle="--", linewidth=0.6)
        axes.set_title(rf"q/q$_{{max}}$ = {share}", fontsize=7)
        axes.set_ylabel("deviation [%]")
    panels[-1].set_xlabel("time since the start of creep [s]\n(broken lines: the paper's 2 %)")
    style.save(figure, laboratory.figures, "fig11")
    for variant in VARIANTS[:len(VARIANTS) if laboratory.is_full else 1]:
        _add_variant(laboratory, LOOKED_AT[-1], variant)


def _add_variant(laboratory, share, variant):
    chains = laboratory.chains
    runs, faults = chains.run_seeds(lambda seed: creep_at(chains, seed, share, variant), laboratory.seeds)
    label = f"q/q_max = {share}, " + ", ".join(f"{key.rsplit('/', 1)[-1].lower()} {value}" for key, value in variant.items())
    largest, measures = measure_deviations(runs)
    laboratory.results.add_note("fig11", f"{label}: largest deviation", "%", largest, faults)
    laboratory.results.add_note("fig11", f"{label}: largest in the measure of Fig. 10", "%", measures)


def measure_deviations(runs):
    """(largest deviation to one side, largest mean of rise and drop) over the target [%], one a run that was disturbed."""
    largest, measures = [], []
    for run in runs:
        jumps, target = read_disturbances(run, 4), find_target(run)
        if len(jumps.time):
            largest.append(100 * np.max(np.maximum(jumps.rise, jumps.drop)) / target)
            measures.append(100 * np.max(jumps.mean) / target)
    return largest, measures


def find_target(run):
    """Axial stress [Pa] that the creep holds: 10 MPa and the share of q_max."""
    values = {name: value for section, name, value in run.parameters if section == "Stage 3"}
    return CONFINEMENT + float(values["Share of q_max"]) * float(values["q_max"])

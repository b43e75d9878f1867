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


def find_strength(chains, seed):
    return chains.run("strength", STRENGTH, 3, seed, base=compress(chains, seed))


def creep_at(chains, seed, share):
    """At a share of the q_max of the seed's own specimen."""
    q_max = find_strength(chains, seed).summary["q_max_Pa"]
    return chains.run(f"creep_at_{share}", TRIAXIAL, 4, seed,
                      {"Stage 3/Share of q_max": share, "Stage 3/q_max": repr(q_max)}, compress(chains, seed))


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
        ruptured = ["rupture_time_s" in run.summary for run in runs]
        if share in (SHARES[0], SHARES[-1]):
            results.add(f"rupture_{share}", ruptured, faults)
        else:
            results.add_note("fig9", f"q/q_max = {share}: share of seeds that rupture", "-", ruptured, faults)
        results.add_note("fig9", f"q/q_max = {share}: log10 of the time of rupture [s], of the seeds that rupture", "-",
                         [np.log10(run.summary["rupture_time_s"]) for run in runs if "rupture_time_s" in run.summary])
        lines = [fit_line(DECADES, 100 * sample_creep(run, DECADES)) for run in runs]
        results.add_note("fig9", f"q/q_max = {share}: creep strain per decade from 1e2 s on, of the seeds that get there",
                         "% per decade", [slope for slope, _ in lines if np.isfinite(slope)])
        if share == STRAIGHT:
            results.add(f"straight_{share}", [r for _, r in lines if np.isfinite(r)], faults)
    style.save(_draw_creep(found), laboratory.figures, "fig9")


def _draw_creep(found):
    figure, axes = style.new_figure(2.8)
    for (share, (runs, _)), colour in zip(found.items(), style.CYCLE):
        for k, run in enumerate(runs):
            curve = select_creep(run)
            shown = curve.time > 0
            axes.semilogx(curve.time[shown], 100 * curve.strain[shown], color=colour, linewidth=0.8,
                          label=rf"q/q$_{{max}}$ = {share}" if k == 0 else None)
            if "rupture_time_s" in run.summary and shown.any():
                axes.plot(curve.time[shown][-1], 100 * curve.strain[shown][-1], "x", color=colour)
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
    """Fig. 11: of all dynamic computations, over the target."""
    found = run_shares(laboratory, LOOKED_AT)
    figure, panels = style.new_figure(3.2, 2, sharex=True)
    for axes, (share, (runs, faults)) in zip(panels, found.items()):
        largest = []
        for run, colour in zip(runs, style.CYCLE):
            jumps, target = read_disturbances(run, 4), find_target(run)
            if not len(jumps.time):
                continue
            largest.append(100 * np.max(np.maximum(jumps.rise, jumps.drop)) / target)
            for values in (jumps.rise, -jumps.drop):
                axes.semilogx(jumps.time, 100 * values / target, "o", color=colour, markersize=2)
        laboratory.results.add(f"share_{share}", largest, faults)
        for sign in (-1, 1):
            axes.axhline(sign * LIMITS[1], color="0.6", linestyle="--", linewidth=0.6)
        axes.set_title(rf"q/q$_{{max}}$ = {share}", fontsize=7)
        axes.set_ylabel("deviation [%]")
    panels[-1].set_xlabel("time since the start of creep [s]\n(broken lines: the paper's 2 %)")
    style.save(figure, laboratory.figures, "fig11")


def find_target(run):
    """Axial stress [Pa] that the creep holds: 10 MPa and the share of q_max."""
    values = {name: value for section, name, value in run.parameters if section == "Stage 3"}
    return CONFINEMENT + float(values["Share of q_max"]) * float(values["q_max"])

"""Fig. 6: creep in the oedometer. Figs. 7, 8: what a batch of breaking grains does to the stress that is held."""

import numpy as np

from plotting import style
from plotting.run_folder import select_creep

from .specimens import creep, fit_line, load, read_disturbances, run_batch, sample_creep

STRESS = 21.7e6  # [Pa]
DECADES = np.logspace(2, 6, 17)  # times [s] between which slopes are taken
LIMIT = 0.5  # of the fluctuation [MPa], the paper's
VARIANTS = (("Equilibrium/Servo gain", 0.05), ("Equilibrium/Servo gain", 0.8), ("Motion/Local damping", 0.2),
            ("Motion/Local damping", 0.9))  # as shipped: 0.2 and 0.7
FIXED_CYCLES = (2, 5, 10, 15, 20, 30, 40, 60, 80, 120, 160, 240, 320)  # after which Fig. 7 looks at the stress


def compute_slope(run):
    """Creep strain [-] per decade from 1e2 to 1e6 s; 0 of a REV that breaks no grain meanwhile."""
    strains = sample_creep(run, DECADES)
    return 0. if np.ptp(strains) == 0. else fit_line(DECADES, strains)[0]


def draw_creep(laboratory):
    """Fig. 6."""
    results = laboratory.results
    runs, faults = laboratory.chains.run_seeds(lambda seed: creep(laboratory.chains, seed), laboratory.seeds)
    for decade in (2, 4, 6):
        values = [100 * sample_creep(run, [10.**decade])[0] for run in runs]
        results.add(f"creep_1e{decade}", values, faults)
    lines = [fit_line(DECADES, 100 * sample_creep(run, DECADES)) for run in runs]
    results.add("creep_slope", [slope for slope, _ in lines], faults)
    results.add("creep_straight", [share for _, share in lines], faults)
    results.add("dynamic", [len(read_disturbances(run, 3).time) for run in runs], faults)
    if not runs:
        return
    figure, axes = style.new_figure(2.6)
    for run in runs:
        curve, jumps = select_creep(run), read_disturbances(run, 3)
        shown = curve.time > 0
        line, = axes.semilogx(curve.time[shown], 100 * curve.strain[shown], linewidth=0.9, label=f"seed {run.seed}")
        axes.plot(jumps.time, 100 * sample_creep(run, jumps.time), "o", color=line.get_color(), markersize=2)
    axes.set_xlabel("time since the start of creep [s]")
    axes.set_ylabel("axial creep strain [%]\n(compression positive)")
    axes.legend(loc="upper left", title="points: dynamic computations", title_fontsize=7)
    style.save(figure, laboratory.figures, "fig6")


def draw_first_computation(laboratory):
    """Fig. 7: the first dynamic computation, of all seeds in numbers, of the first one in its course."""
    chains, batch, results = laboratory.chains, laboratory.usual_batch, laboratory.results
    runs, faults = chains.run_seeds(lambda seed: run_batch(chains, seed, batch), laboratory.seeds)
    firsts = [find_first(run, batch) for run in runs]
    results.add("first_mean", [mean / 1e6 for _, _, mean, _ in firsts], faults)
    results.add("first_strain", [100 * strain for _, _, _, strain in firsts], faults)
    course, faults = follow_first(chains, laboratory.seeds[0], batch)
    results.add_note("fig7", "points of the course", "-", [len(course) - 1] if len(course) > 1 else [], faults)
    style.save(_draw_course(course), laboratory.figures, "fig7")


def follow_first(chains, seed, batch):
    """(cycles since the grains broke, axial stress [Pa], axial strain since then [-]) in rows; faults

    From runs that are stopped after so many cycles.
    """
    stopped, faults = chains.run_seeds(
        lambda cycles: (cycles, run_batch(chains, seed, batch, {"Equilibrium/Fixed cycles": cycles})), FIXED_CYCLES,
        "cycles")
    start = load(chains, seed)
    course = [(0, start.get_column("stress_zz_Pa")[-1], 0.)]
    for cycles, run in stopped:
        row = np.flatnonzero(np.diff(run.get_column("broken_delayed")) > 0)[0] + 1  # at the end of its cycles
        course.append((cycles, run.get_column("stress_zz_Pa")[row],
                       run.get_column("strain_zz")[row] - start.get_column("strain_zz")[-1]))
    return np.array(course), faults


def find_first(run, batch):
    """(largest rise, largest drop, their mean [Pa], axial strain [-]) of the computation after the run's only jump."""
    jumps = read_disturbances(run, 3)
    first = int(np.argmax(jumps.is_delayed & (jumps.broken == batch)))
    return jumps.rise[first], jumps.drop[first], jumps.mean[first], jumps.strain[first]


def _draw_course(course):
    cycles, stress, strain = course.T
    figure, (upper, lower) = style.new_figure(3.2, 2, sharex=True)
    upper.plot(cycles, stress / 1e6, "o-", color=style.BLUE)
    upper.axhline(STRESS / 1e6, color="0.6", linewidth=0.6)
    upper.set_ylabel("axial stress [MPa]")
    lower.plot(cycles, 100 * strain, "o-", color=style.VERMILION)
    lower.set_ylabel("volumetric strain [%]\n(compression positive)")
    lower.set_xlabel("DEM cycles since the grains broke")
    return figure


def draw_fluctuation(laboratory):
    """Fig. 8, and what the servo's gain and the damping change at N_max."""
    chains, results, found = laboratory.chains, laboratory.results, {}
    for batch in laboratory.batches:
        runs, faults = chains.run_seeds(lambda seed, n=batch: run_batch(chains, seed, n), laboratory.seeds)
        found[batch] = np.array([find_first(run, batch) for run in runs]).reshape(-1, 4)
        for column, name in enumerate(("largest rise", "largest drop", "mean of both")):
            results.add_note("fig8", f"{batch} broken at once: {name}", "MPa", found[batch][:, column] / 1e6)
    usual = [batch for batch in found if batch <= laboratory.usual_batch]
    largest = max(usual, key=lambda batch: found[batch][:, 2].mean() if len(found[batch]) else -np.inf)
    results.add("batch_30", found[largest][:, 2] / 1e6, faults)
    last, first = found[laboratory.batches[-1]], found[laboratory.usual_batch]
    results.add("batch_growth", last[:, 2] / first[:, 2] if len(last) == len(first) else [], faults)
    style.save(_draw_fluctuation(found), laboratory.figures, "fig8")
    batch = laboratory.usual_batch
    for name, value in VARIANTS:
        runs, faults = chains.run_seeds(lambda seed, own={name: value}: run_batch(chains, seed, batch, own),
                                        laboratory.seeds)
        results.add_note("fig8", f"{batch} broken at once, {name.rsplit('/', 1)[-1].lower()} {value}: mean of both", "MPa",
                         [find_first(run, batch)[2] / 1e6 for run in runs], faults)


def _draw_fluctuation(found):
    figure, axes = style.new_figure(2.6)
    batches = [batch for batch in found if len(found[batch])]
    for column, sign, marker, colour, label in ((0, 1, "^", style.VERMILION, "largest rise"),
                                                (1, -1, "v", style.BLUE, "largest drop"),
                                                (2, 1, "o", "black", "mean of their sizes")):
        for batch in batches:
            axes.plot(np.full(len(found[batch]), batch), sign * found[batch][:, column] / 1e6, marker, color=colour,
                      markerfacecolor="none", markeredgewidth=0.6, label=label if batch == batches[0] else None)
    axes.plot(batches, [found[batch][:, 2].mean() / 1e6 for batch in batches], color="black", linewidth=0.6)
    axes.axhline(LIMIT, color="0.6", linestyle="--", linewidth=0.6, label="the paper's limit")
    axes.set_xscale("log")
    axes.set_xticks(batches, [str(batch) for batch in batches])
    axes.minorticks_off()
    axes.set_xlabel("grains broken at once [-]")
    axes.set_ylabel("deviation of axial stress [MPa]\n(compression positive)")
    axes.legend(loc="best")
    return figure

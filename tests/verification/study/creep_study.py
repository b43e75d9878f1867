"""Creep of the oedometer over several seeds: strain, slope per decade and its scatter, steadiness."""

import numpy as np

from creep_curves import compute_slope, make_times, sample
from plotting import style
from plotting.run_folder import select_creep

POINT = "Oedometer creep at 21.7 MPa"
CASE = "apps/cases/rev_oedometer_creep.prm"
STRESS = 21.7e6  # [Pa]
FIRST, LAST = 2, 6  # decades of time [s] between which the slope is taken
UNLOADED = 0.99  # share of the stress to which the modulus is measured


def study(runs, results, options):
    """Adds its rows and figure; returns (mean, standard deviation) of the slope for comparison with single runs."""
    seeds = options.seeds
    done = [runs.run(f"creep_seed_{seed}", "slowsand-rev", CASE, {"Seed": seed, **options.small}) for seed in seeds]
    command = done[0].command + (f", and seeds {seeds[1]} to {seeds[-1]}" if len(seeds) > 1 else "")
    _add_strains(done, results, command)
    slopes = _add_slopes(done, results, command)
    _add_decreases(runs, done, results, options)
    style.save(_draw(done, seeds), options.figures, "creep_seeds")
    return float(np.mean(slopes)), float(np.std(slopes, ddof=1))


def _add_strains(done, results, command):
    for decade in range(FIRST, LAST + 1):
        values = 100 * np.array([sample(run, [10.**decade])[0] for run in done])
        results.add(POINT, f"creep strain at 1e{decade} s, mean", values.mean(), "%", command)
        results.add(POINT, f"creep strain at 1e{decade} s, standard deviation", values.std(ddof=1), "%", command)


def _add_slopes(done, results, command):
    times = make_times(FIRST, LAST, 4)
    slopes = np.array([compute_slope(times, sample(run, times)) for run in done])
    for name, value in (("mean", slopes.mean()), ("standard deviation", slopes.std(ddof=1)), ("least", slopes.min()),
                        ("largest", slopes.max())):
        results.add(POINT, f"slope from 1e{FIRST} to 1e{LAST} s, {name} over {len(done)} seeds", 100 * value,
                    "% per decade", command)
    ends = np.array([sample(run, [10.**FIRST, 10.**(FIRST + 1), 10.**(LAST - 1), 10.**LAST]) for run in done])
    first, last = ends[:, 1] - ends[:, 0], ends[:, 3] - ends[:, 2]
    results.add(POINT, f"growth in the first decade, 1e{FIRST} to 1e{FIRST + 1} s, mean", 100 * first.mean(), "%",
                command)
    results.add(POINT, f"growth in the last decade, 1e{LAST - 1} to 1e{LAST} s, mean", 100 * last.mean(), "%", command)
    results.add(POINT, "last decade's mean slope over the first's", last.mean() / first.mean(), "-", command)
    error = np.sqrt((last.std(ddof=1) / last.mean())**2 + (first.std(ddof=1) / first.mean())**2) / np.sqrt(len(done))
    results.add(POINT, "its standard error from the scatter over seeds", error * last.mean() / first.mean(), "-", command)
    return slopes


def _add_decreases(runs, done, results, options):
    """A strain may only fall as far as the stress that is held wavers, by the modulus of unloading."""
    unloading = runs.run("creep_unloading", "slowsand-rev", CASE,
                         {"Seed": options.seeds[0], **options.small, "Stage 2/Kind": "oedometric",
                          "Stage 2/Stress": UNLOADED * STRESS, "Stage 2/Duration": 0, "Stage 2/Increments": 4})
    modulus = _measure_modulus(unloading)
    results.add(POINT, f"modulus on unloading to {UNLOADED:g} of the stress", modulus / 1e9, "GPa", unloading.command)
    worst, bound = 0., 0.
    for run in done:
        creep = select_creep(run)
        stress = run.get_column("stress_zz_Pa")[run.get_column("stage") == creep.stage]
        worst = max(worst, float(np.max(-np.diff(creep.strain), initial=0.)))
        bound = max(bound, float(np.ptp(stress)) / modulus)
    results.add_below(POINT, "largest decrease of axial strain between two rows of creep, against the wavering of the "
                      "held stress over the modulus", worst, "-", done[0].command, bound)


def _measure_modulus(run):
    """Secant [Pa] from the end of loading to the end of unloading."""
    stage = run.get_column("stage")
    end = np.flatnonzero(stage == 1)[-1]
    stress, strain = run.get_column("stress_zz_Pa"), run.get_column("strain_zz")
    return float((stress[-1] - stress[end]) / (strain[-1] - strain[end]))


def _draw(done, seeds):
    times = make_times(0, LAST, 50)
    curves = 100 * np.array([sample(run, times) for run in done])
    figure, axes = style.new_figure(2.6)
    axes.fill_between(times, np.nanmin(curves, axis=0), np.nanmax(curves, axis=0), step="post", color="0.88",
                      linewidth=0, label="least to largest")
    for seed, curve in zip(seeds, curves):
        axes.step(times, curve, where="post", linewidth=0.7, label=f"seed {seed}")
    axes.step(times, np.nanmedian(curves, axis=0), where="post", color="black", linewidth=1.8, label="median")
    axes.set_xscale("log")
    axes.set_xlabel("time since the start of creep [s]")
    axes.set_ylabel("axial creep strain [%]\n(compression positive)")
    axes.set_ylim(bottom=0)
    axes.legend(loc="upper left", ncols=2)
    return figure

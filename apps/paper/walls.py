"""Figs. 6 to 8 in the paper's box of six rigid walls, beside the periodic cell."""

import dataclasses

import numpy as np

from plotting import style
from plotting.run_folder import select_creep
from plotting.snapshot import read_snapshot

from .chains import RunFailed
from .oedometer import DECADES, LIMIT, compute_slope, find_first, follow_first
from .specimens import creep, find_snapshot, fit_line, pack, run_batch, sample_creep

DEPTH = 0.27e-3  # [m], the largest diameter: nearer to a wall grains lie looser
POINTS = 120  # of the grid along an edge, a fifth of a median diameter apart


def choose_box(is_full):
    """Settings of a box. One of 200 grains is all wall: without friction while it is packed it is the densest there is."""
    return {"Boundary/Kind": "walls", **({} if is_full else {"Packing/Friction": 0})}


def draw_walls(laboratory):
    """Packing, creep and fluctuation of both kinds of REV."""
    box = dataclasses.replace(laboratory, chains=laboratory.chains.vary(choose_box(laboratory.is_full)))
    results, batches = laboratory.results, laboratory.batches
    packed, faults = box.chains.run_seeds(lambda seed: pack(box.chains, seed), box.seeds)
    results.add("walls_void_ratio", [run.get_column("void_ratio")[0] for run in packed], faults)
    results.add_note("walls", "friction while the box is packed", "-", _list_frictions(packed))
    results.add_note("walls", "edge of the box", "mm", [1e3 * _compute_edge(run) for run in packed])
    inside = [compute_void_ratio_inside(read_snapshot(find_snapshot(run, 0)), DEPTH) for run in packed]
    results.add_note("walls", "void ratio of the box 0.27 mm and more away from its walls", "-", inside)
    if laboratory.is_full:
        _add_dense(laboratory, [float(f"{np.mean(inside):.3f}")] if inside else [])
    figure, (upper, middle, lower) = style.new_figure(6.2, 3)
    for kind, name, colour in ((box, "walls", style.VERMILION), (laboratory, "periodic", style.BLUE)):
        slopes, straight, faults = _draw_creep(kind, name, colour, upper)
        fluctuation, more = _draw_fluctuation(kind, name, colour, lower)
        more += _draw_course(kind, name, colour, middle)
        if kind is box:
            usual = fluctuation[laboratory.usual_batch]
            results.add("walls_straight", straight, faults)
            results.add("walls_mean", usual / 1e6, more)
            is_whole = len(usual) == len(fluctuation[batches[-1]])
            results.add("walls_growth", fluctuation[batches[-1]] / usual if is_whole else [], more)
        results.add_note("walls", f"{name}: creep strain per decade from 1e2 to 1e6 s", "% per decade", slopes)
        for batch in batches:
            results.add_note("walls", f"{name}: {batch} broken at once: mean of largest rise and drop", "MPa",
                             fluctuation[batch] / 1e6)
    _finish(upper, middle, lower, batches)
    style.save(figure, laboratory.figures, "walls")


def _add_dense(laboratory, void_ratios):
    """Creep in a periodic cell as dense as the inside of the box."""
    for void_ratio in void_ratios:
        chains = laboratory.chains.vary({"Packing/Void ratio": void_ratio})
        runs, faults = chains.run_seeds(lambda seed: creep(chains, seed), laboratory.seeds)
        laboratory.results.add_note("walls", f"periodic, packed to {void_ratio}: creep strain per decade from 1e2 to 1e6 s",
                                    "% per decade", [100 * compute_slope(run) for run in runs], faults)


def compute_void_ratio_inside(snapshot, depth):
    """Void ratio of a box without what lies nearer than a depth [m] to a wall: points of a grid, inside a grain or not."""
    edges, n = np.diag(snapshot.cell), POINTS
    spacing = (edges - 2 * depth) / n
    axes = [depth + (np.arange(n) + 0.5) * step for step in spacing]
    is_solid = np.zeros((n, n, n), dtype=bool)
    for centre, radius in zip(snapshot.position, snapshot.radius):
        ranges = [slice(*np.searchsorted(axis, (x - radius, x + radius))) for axis, x in zip(axes, centre)]
        squares = [(axis[part] - x)**2 for axis, part, x in zip(axes, ranges, centre)]
        is_solid[tuple(ranges)] |= (squares[0][:, None, None] + squares[1][:, None] + squares[2]) < radius**2
    share = np.mean(is_solid)
    return float(1. / share - 1.)


def _list_frictions(packed):
    name = "packing friction [-]"
    return [run.summary["figures"][name] for run in packed if name in run.summary.get("figures", {})]


def _compute_edge(run):
    return np.cbrt(np.linalg.det(read_snapshot(find_snapshot(run, 0)).cell))


def _draw_creep(laboratory, name, colour, axes):
    """(slopes [% per decade], shares of variance that a line explains, faults)"""
    runs, faults = laboratory.chains.run_seeds(lambda seed: creep(laboratory.chains, seed), laboratory.seeds)
    for k, run in enumerate(runs):
        curve = select_creep(run)
        shown = curve.time > 0
        axes.semilogx(curve.time[shown], 100 * curve.strain[shown], color=colour, linewidth=0.9, label=name if k == 0 else None)
    lines = [fit_line(DECADES, 100 * sample_creep(run, DECADES)) for run in runs]
    known = [line for line in lines if np.isfinite(line[0])]
    return [slope for slope, _ in known], [share for _, share in known], faults


def _draw_fluctuation(laboratory, name, colour, axes):
    """(batch -> mean of largest rise and drop [Pa], one a seed; faults)"""
    found, faults = {}, []
    for batch in laboratory.batches:
        runs, more = laboratory.chains.run_seeds(lambda seed, n=batch: run_batch(laboratory.chains, seed, n), laboratory.seeds)
        found[batch] = np.array([find_first(run, batch)[2] for run in runs])
        faults += more
        axes.plot(np.full(len(runs), batch), found[batch] / 1e6, "o", color=colour, markerfacecolor="none",
                  markeredgewidth=0.6, label=name if batch == laboratory.batches[0] else None)
    return found, faults


def _draw_course(laboratory, name, colour, axes):
    """Axial stress in the first dynamic computation of the first seed; faults."""
    try:
        course, faults = follow_first(laboratory.chains, laboratory.seeds[0], laboratory.usual_batch)
    except RunFailed as error:
        return [str(error)]
    axes.plot(course[:, 0], course[:, 1] / 1e6, "o-", color=colour, linewidth=0.9, label=name)
    return faults


def _finish(upper, middle, lower, batches):
    upper.set_xlabel("time since the start of creep [s]")
    upper.set_ylabel("axial creep strain [%]\n(compression positive)")
    upper.legend(loc="upper left")
    middle.set_xlabel("DEM cycles since the grains broke")
    middle.set_ylabel("axial stress [MPa]")
    lower.axhline(LIMIT, color="0.6", linestyle="--", linewidth=0.6, label="the paper's limit")
    lower.set_xscale("log")
    lower.set_xticks(batches, [str(batch) for batch in batches])
    lower.minorticks_off()
    lower.set_xlabel("grains broken at once [-]")
    lower.set_ylabel("mean of largest rise and drop\nof axial stress [MPa]")
    lower.legend(loc="upper left")

"""Fig. 1: a grain and its siblings. Fig. 2: the REV and its grading."""

import itertools

import numpy as np

from plotting import style
from plotting.rev_picture import make_view, render
from plotting.snapshot import Snapshot, read_identities, read_snapshot

from .specimens import find_snapshot, load, pack

# NE34 as the programs make it (dem/grading.cc) [mm], [%]
GRADING = ((0.10, 0.), (0.15, 9.), (0.18, 24.), (0.21, 50.), (0.23, 65.), (0.25, 85.), (0.27, 100.))
SIBLINGS = 14


def draw_split_grain(laboratory):
    """Fig. 1, of the first seed whose grains broke while it was loaded to 21.7 MPa."""
    runs, faults = laboratory.chains.run_seeds(lambda seed: load(laboratory.chains, seed), laboratory.seeds)
    counts, split = [], None
    for run in runs:
        before, after = (read_snapshot(find_snapshot(run, stage)) for stage in (0, 2))
        broken = run.get_column("broken_instant")[-1] + run.get_column("broken_delayed")[-1]
        if broken > 0:
            counts.append(1 + (len(after.radius) - len(before.radius)) / broken)
            split = split or _find_split(run, before, after)
    laboratory.results.add("siblings", counts, faults)
    if split:
        style.save(_draw_pair(*split), laboratory.figures, "fig1")


def _find_split(run, before, after):
    """(the grain, its siblings) of the broken grain whose siblings lie closest together; None if all split again."""
    ids, _ = read_identities(find_snapshot(run, 0))
    _, parents = read_identities(find_snapshot(run, 2))
    found = []
    for parent in np.unique(parents[after.generation == 1]):
        chosen = np.flatnonzero((parents == parent) & (after.generation == 1))
        if len(chosen) == SIBLINGS and parent in ids:
            i = int(np.flatnonzero(ids == parent)[0])
            siblings = _gather(after, chosen)
            width = np.max(np.linalg.norm(siblings.position, axis=1)) / before.radius[i]
            found.append((width, int(parent), _gather(before, np.array([i])), siblings))
    return min(found, key=lambda entry: entry[:2])[2:] if found else None


def _gather(snapshot, chosen):
    """Some grains alone, as neighbours across the periodic faces, about their centre."""
    cell = snapshot.cell
    fraction = np.linalg.solve(cell, snapshot.position[chosen].T).T
    fraction -= np.round(fraction - fraction[0])
    position = fraction @ cell.T
    return Snapshot(snapshot.path, snapshot.time, cell, position - position.mean(axis=0), snapshot.radius[chosen],
                    snapshot.generation[chosen])


def _draw_pair(grain, siblings):
    figure, axes = style.new_figure(1.9, 1, 2)
    view = make_view(azimuth=-55., elevation=20.)
    half = 1.05 * max(np.max(np.linalg.norm(s.position, axis=1) + s.radius) for s in (grain, siblings))
    for panel, part, title in zip(axes, (grain, siblings), ("grain", f"its {SIBLINGS} siblings, at rest")):
        extent = (-half, half, -half, half)
        panel.imshow(render(part, view, extent), extent=[1e3 * v for v in extent], origin="lower")
        panel.set_title(f"{title}\nlargest diameter {2e3 * part.radius.max():.3g} mm", fontsize=7)
        panel.set_axis_off()
    return figure


def draw_rev(laboratory):
    """Fig. 2."""
    runs, faults = laboratory.chains.run_seeds(lambda seed: pack(laboratory.chains, seed), laboratory.seeds)
    packings = [read_snapshot(find_snapshot(run, 0)) for run in runs]
    results = laboratory.results
    results.add("grains", [len(p.radius) for p in packings], faults)
    results.add("edge", [1e3 * np.cbrt(np.linalg.det(p.cell)) for p in packings], faults)
    results.add("void_ratio", [run.get_column("void_ratio")[0] for run in runs], faults)
    results.add("d50", [1e3 * run.read_table("breakage.csv").get_column("d50_m")[0] for run in runs], faults)
    results.add("d_max", [2e3 * p.radius.max() for p in packings], faults)
    if runs:
        style.save(_draw_rev(packings[0]), laboratory.figures, "fig2")


def _draw_rev(packing):
    figure, (left, right) = style.new_figure(2.3, 1, 2, width_ratios=(1, 1.1))
    view = make_view(azimuth=-55., elevation=20.)
    corners = np.array([packing.cell @ np.array(c) for c in itertools.product((0., 1.), repeat=3)]) @ view.T
    margin = packing.radius.max()
    extent = (corners[:, 0].min() - margin, corners[:, 0].max() + margin, corners[:, 1].min() - margin,
              corners[:, 1].max() + margin)
    left.imshow(render(packing, view, extent), extent=[1e3 * v for v in extent], origin="lower")
    left.set_title(f"{len(packing.radius)} grains", fontsize=7)
    left.set_axis_off()
    diameter = np.sort(2e3 * packing.radius)
    right.plot(*zip(*GRADING), "o-", color="0.6", label="input")
    right.plot(diameter, 100 * np.cumsum(diameter**3) / np.sum(diameter**3), color=style.BLUE, label="REV")
    right.set_xlabel("grain diameter [mm]")
    right.set_ylabel("finer by mass [%]")
    right.set_ylim(0, 100)
    right.legend(loc="upper left")
    return figure

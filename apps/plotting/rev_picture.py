"""A REV as a picture: its grains as spheres, the siblings of broken grains in another colour.

Drawn by a small ray caster (parallel light and view, nearest sphere wins at each pixel): matplotlib alone cannot tell
which of two spheres is in front.
"""

import itertools

import numpy as np
from matplotlib.colors import to_rgb

from . import style
from .snapshot import find_first_and_last

PIXELS = 900  # along the longer side of a picture, which is one inch and three quarters wide
WHOLE, SIBLING = "#C9B18B", style.VERMILION


def draw(run, options):
    """The REV of the run with the most siblings, before and after, in the same view and scale."""
    ends = find_first_and_last(run.find_snapshots())
    name, pair = max(ends.items(), key=lambda item: np.sum(item[1][1].generation > 0))
    figure, axes = style.new_figure(2.3, 1, 2)
    view = make_view(azimuth=-55., elevation=20.)
    extent = _compute_extent(pair, view)
    for panel, snapshot, title in zip(axes, pair, ("before", "after")):
        panel.imshow(render(snapshot, view, extent), extent=[1e3 * v for v in extent], origin="lower",
                     interpolation="antialiased")
        _draw_cell(panel, snapshot.cell, view)
        n_siblings = int(np.sum(snapshot.generation > 0))
        panel.set_title(f"{title}: {len(snapshot.radius)} grains,\n{n_siblings} siblings", fontsize=7)
        panel.set_axis_off()
    edges = 1e3 * np.linalg.norm(pair[1].cell, axis=0)
    figure.supxlabel("{}cell after: {:.3g} x {:.3g} x {:.3g} mm; orange-red: siblings of broken grains".format(
        f"{name}, " if name else "", *edges), fontsize=7)
    return figure


def make_view(azimuth, elevation):
    """Rows: right, up, towards the eye; z is up in the picture. Angles in degrees."""
    a, e = np.radians(azimuth), np.radians(elevation)
    eye = np.array([np.cos(e) * np.cos(a), np.cos(e) * np.sin(a), np.sin(e)])
    right = np.array([-np.sin(a), np.cos(a), 0.])
    return np.vstack([right, np.cross(eye, right), eye])


def render(snapshot, view, extent):
    """Picture (rows, columns, 4) of the grains, transparent elsewhere. `extent` [m]: left, right, low, high."""
    left, right, low, high = extent
    step = max(right - left, high - low) / PIXELS
    width, height = int(np.ceil((right - left) / step)), int(np.ceil((high - low) / step))
    depth, picture = np.full((height, width), -np.inf), np.zeros((height, width, 4))
    centres = snapshot.position @ view.T
    light = np.array([-0.4, 0.5, 0.77])
    for centre, radius, generation in zip(centres, snapshot.radius, snapshot.generation):
        i0, i1 = (int(np.clip((centre[0] + s * radius - left) / step + (s > 0), 0, width)) for s in (-1, 1))
        j0, j1 = (int(np.clip((centre[1] + s * radius - low) / step + (s > 0), 0, height)) for s in (-1, 1))
        if i0 >= i1 or j0 >= j1:
            continue
        x = (left + (np.arange(i0, i1) + 0.5) * step - centre[0]) / radius
        y = ((low + (np.arange(j0, j1) + 0.5) * step - centre[1]) / radius)[:, None]
        inside = 1. - x**2 - y**2
        z = np.sqrt(np.maximum(inside, 0.))
        window = (slice(j0, j1), slice(i0, i1))
        nearer = (inside > 0) & (centre[2] + radius * z > depth[window])
        shade = 0.25 + 0.75 * np.clip(light[0] * x + light[1] * y + light[2] * z, 0., 1.)
        colour = np.array(to_rgb(WHOLE if generation == 0 else SIBLING))
        depth[window][nearer] = (centre[2] + radius * z)[nearer]
        picture[window][nearer, :3] = np.clip(shade[..., None] * colour, 0., 1.)[nearer]
        picture[window][nearer, 3] = 1.
    return picture


def _compute_corners(cell):
    return np.array([cell @ np.array(c) for c in itertools.product((0., 1.), repeat=3)])


def _compute_extent(pair, view):
    """A frame that holds all grains and cells of both states [m]."""
    ends = []
    for snapshot in pair:
        centres, corners = snapshot.position @ view.T, _compute_corners(snapshot.cell) @ view.T
        radius = snapshot.radius[:, None]
        ends += [(centres - radius)[:, :2], (centres + radius)[:, :2], corners[:, :2]]
    points = np.vstack(ends)
    (left, low), (right, high) = points.min(axis=0), points.max(axis=0)
    return left, right, low, high


def _draw_cell(axes, cell, view):
    """The nine edges of the cell that face the eye; the three behind the grains are left out."""
    corners = list(itertools.product((0, 1), repeat=3))
    places = {c: view @ (cell @ np.array(c, dtype=float)) for c in corners}
    farthest = min(corners, key=lambda c: places[c][2])
    for a, b in itertools.combinations(corners, 2):
        if sum(x != y for x, y in zip(a, b)) == 1 and farthest not in (a, b):
            axes.plot(*(1e3 * np.array([places[a], places[b]])[:, :2].T), color="black", linewidth=0.5)

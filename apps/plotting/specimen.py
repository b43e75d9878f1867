"""The specimen: its mesh coloured by a field of the last output."""

import re

import numpy as np
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.colors import Normalize
from matplotlib.tri import Triangulation

from . import style
from .errors import BadInput, NotInThisRun
from .rev_picture import make_view
from .vtu import read_last_fields

PREFERRED = ("void_ratio", "stress_zz", "axial_stress", "stress", "displacement")
FACES = ((0, 1, 2, 3), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7))  # of a VTK hexahedron


def draw(run, options):
    """An axisymmetric mesh as its half section mirrored, a plane one as it is, a solid one as its surface."""
    grid = read_last_fields(run.path)
    name = choose_field(run, grid, options.field)
    values, label = _scale(name, grid.fields[name])
    if grid.is_solid:
        return _draw_solid(grid, values, label)
    return _draw_section(grid, values, label, is_axisymmetric(run))


def choose_field(run, grid, wanted):
    """Name of the field to draw: as asked for, else the first of those that tell most."""
    if wanted is not None:
        if wanted not in grid.fields:
            raise BadInput(f"{run.path / 'fields'}: no field {wanted}; there are {', '.join(grid.fields)}")
        return wanted
    for part in PREFERRED:
        for name in sorted(grid.fields, key=len):  # "void_ratio" before "void_ratio_with_fines"
            if part in re.sub(r"\W+", "_", name.lower()):
                return name
    if not grid.fields:
        raise NotInThisRun(f"no point or cell data in {run.path / 'fields'}")
    return next(iter(grid.fields))


def is_axisymmetric(run):
    """Two-dimensional runs are axisymmetric unless their parameters say plane strain."""
    return not any("plane" in value.lower() for _, _, value in run.parameters)


def _scale(name, values):
    """One number a point and its label: vectors by their length, pascals as MPa, metres as mm."""
    if values.ndim > 1:
        values = np.linalg.norm(values, axis=1)
    text = re.sub(r"[\[<(]?(Pa|m|-|1)[\])>]?$", "", name).replace("_", " ").strip() if re.search(
        r"(_Pa|_m|[\[<(](Pa|m|-|1)[\])>])$", name) else name.replace("_", " ")
    if "stress" in name.lower() or re.search(r"\bPa\b|_Pa", name):
        return values / 1e6, f"{text} [MPa] (compression positive)"
    if "displacement" in name.lower():
        return values * 1e3, f"{text} [mm]"
    if "strain" in name.lower():
        return values, f"{text} [-] (compression positive)"
    return values, f"{text} [-]"


def _make_norm(values):
    """A uniform field keeps one colour: its rounding is not to be drawn as a pattern."""
    low, high = float(np.nanmin(values)), float(np.nanmax(values))
    if high - low < 1e-6 * max(abs(high), abs(low), 1e-300):
        low, high = low - 0.005 * (abs(low) or 1.), high + 0.005 * (abs(high) or 1.)
    return Normalize(low, high)


def _draw_section(grid, values, label, mirrored):
    x, y = 1e3 * grid.points[:, 0], 1e3 * grid.points[:, 1]
    triangles = np.vstack([grid.cells[:, [0, 1, 2]], grid.cells[:, [0, 2, 3]]])
    height = float(np.clip(2.2 * np.ptp(y) / (np.ptp(x) * (2 if mirrored else 1)) + 0.6, 1.8, 4.5))
    figure, axes = style.new_figure(height)
    norm = _make_norm(values)
    for sign in (1, -1) if mirrored else (1,):
        image = axes.tripcolor(Triangulation(sign * x, y, triangles), values, shading="gouraud", norm=norm,
                               cmap="viridis")
        outlines = np.stack([sign * x[grid.cells], y[grid.cells]], axis=-1)
        axes.add_collection(LineCollection([np.vstack([cell, cell[:1]]) for cell in outlines], colors="white",
                                           linewidths=0.5))
    if mirrored:
        axes.axvline(0., color="black", linewidth=0.6, linestyle="-.")
    axes.set_aspect("equal")
    axes.set_xlabel("radius r [mm]" if mirrored else "x [mm]")
    axes.set_ylabel("height z [mm]" if mirrored else "y [mm]")
    if mirrored:
        axes.xaxis.set_major_formatter(style.plt.FuncFormatter(lambda value, _: f"{abs(value):g}"))
    figure.colorbar(image, ax=axes, label=label, shrink=0.9)
    return figure


def find_surface(grid):
    """(faces, 4) indices of the faces that belong to one cell only. Corners of one place count as one point."""
    size = np.ptp(grid.points, axis=0).max()
    places = np.unique(np.round(grid.points / (1e-6 * size)).astype(np.int64), axis=0, return_inverse=True)[1].ravel()
    faces = np.vstack([grid.cells[:, face] for face in FACES])
    _, index, count = np.unique(np.sort(places[faces], axis=1), axis=0, return_index=True, return_counts=True)
    return faces[index[count == 1]]


def _draw_solid(grid, values, label):
    """Faces from the farthest to the nearest, seen from above one corner."""
    faces, points = find_surface(grid), 1e3 * grid.points
    seen = points @ make_view(azimuth=-55., elevation=20.).T
    faces = faces[np.argsort(seen[faces][:, :, 2].mean(axis=1))]
    norm = _make_norm(values)
    figure, axes = style.new_figure(2.8)
    axes.add_collection(PolyCollection(seen[faces][:, :, :2], norm=norm, cmap="viridis",
                                       array=values[faces].mean(axis=1), edgecolors="white", linewidths=0.5))
    axes.set_aspect("equal")
    axes.autoscale_view()
    axes.set_axis_off()
    axes.set_title("{:.3g} x {:.3g} x {:.3g} mm (x, y, z; z upwards)".format(*np.ptp(points, axis=0)), fontsize=7)
    figure.colorbar(axes.collections[0], ax=axes, label=label, shrink=0.8)
    return figure

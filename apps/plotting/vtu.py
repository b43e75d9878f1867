"""Reads what deal.II writes as .pvd, .pvtu and .vtu: unstructured grids with inline arrays, zlib-compressed or ascii.

A reader of its own because Debian's VTK for Python is 50 MB and brings a second MPI; deal.II writes one dialect only.
"""

import base64
import xml.etree.ElementTree as ElementTree
import zlib
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from .errors import BadInput, NotInThisRun

NUMBER_TYPES = {"Float32": "f4", "Float64": "f8", "Int8": "i1", "UInt8": "u1", "Int32": "i4", "UInt32": "u4",
                "Int64": "i8", "UInt64": "u8"}
CORNERS = {9: 4, 12: 8, 70: 4, 72: 8}  # VTK's quadrilateral, hexahedron and their Lagrange kin: corners come first


@dataclass
class Grid:
    """A mesh of quadrilaterals or hexahedra; points are repeated in each cell, as deal.II writes them."""

    points: np.ndarray  # (points, 3) [m]
    cells: np.ndarray  # (cells, 4 or 8) indices of corners
    fields: dict = field(default_factory=dict)  # name -> (points,) or (points, 3)
    time: float = float("nan")  # [s]

    @property
    def is_solid(self):
        return self.cells.shape[1] == 8


def read_last_fields(run_folder):
    """The last time of the run's .pvd, or the last fields/*.pvtu by name where there is no .pvd."""
    records = sorted(Path(run_folder).glob("*.pvd"))
    if records:
        entries = [(float(_get(records[0], e, "timestep")), _get(records[0], e, "file"))
                   for e in _parse(records[0]).iter("DataSet")]
        if not entries:
            raise BadInput(f"{records[0]}: no DataSet")
        time, name = entries[-1]
        grid = read_pvtu(Path(run_folder) / name)
        grid.time = time
        return grid
    files = sorted((Path(run_folder) / "fields").glob("*.pvtu"))
    if not files:
        raise NotInThisRun(f"no fields/*.pvtu in {run_folder}")
    return read_pvtu(files[-1])


def read_pvtu(path):
    """All pieces of a .pvtu as one grid; a .vtu is read as its own only piece."""
    path = Path(path)
    if path.suffix == ".vtu":
        return read_vtu(path)
    pieces = [read_vtu(path.parent / _get(path, piece, "Source")) for piece in _parse(path).iter("Piece")]
    pieces = [piece for piece in pieces if len(piece.cells)]
    if not pieces:
        raise BadInput(f"{path}: no piece with cells")
    offsets = np.cumsum([0] + [len(piece.points) for piece in pieces])
    return Grid(np.vstack([p.points for p in pieces]), np.vstack([p.cells + o for p, o in zip(pieces, offsets)]),
                {name: np.concatenate([p.fields[name] for p in pieces]) for name in pieces[0].fields})


def read_vtu(path):
    """One .vtu file. Cell data are spread to the points of their cell."""
    pieces = list(_parse(path).iter("Piece"))
    if not pieces:
        raise BadInput(f"{path}: no Piece")
    header = "<u8" if _parse(path).get("header_type") == "UInt64" else "<u4"
    arrays = {}
    for group in pieces[0]:
        for element in group.iter("DataArray"):
            name = element.get("Name", "points")
            arrays.setdefault(group.tag, {})[name] = _decode(path, name, element, header)
    try:
        points, cells = arrays["Points"].popitem()[1], arrays["Cells"]
        types, connectivity, offsets = cells["types"], cells["connectivity"], cells["offsets"]
    except KeyError as error:
        raise BadInput(f"{path}: array {error.args[0]} is missing") from None
    grid = Grid(points.astype(float), _collect_corners(path, types, connectivity, offsets))
    grid.fields.update(arrays.get("PointData", {}))
    for name, values in arrays.get("CellData", {}).items():
        at_points = np.zeros((len(points),) + values.shape[1:])
        at_points[grid.cells.ravel()] = np.repeat(values, grid.cells.shape[1], axis=0)
        grid.fields[name] = at_points
    return grid


def _collect_corners(path, types, connectivity, offsets):
    kinds = set(np.unique(types))
    counts = {CORNERS.get(kind) for kind in kinds}
    if not kinds:
        return np.zeros((0, 4), dtype=int)
    if len(counts) != 1 or None in counts:
        raise BadInput(f"{path}: array types holds {sorted(kinds)}; only quadrilaterals or only hexahedra can be drawn")
    starts = np.concatenate(([0], offsets[:-1])).astype(int)
    return connectivity[starts[:, None] + np.arange(counts.pop())].astype(int)


def _decode(path, name, element, header):
    number = NUMBER_TYPES.get(element.get("type"))
    text = "".join((element.text or "").split())
    try:
        if element.get("format") == "ascii":
            values = np.array((element.text or "").split(), dtype=number)
        else:
            values = np.frombuffer(_inflate(text, np.dtype(header)), dtype="<" + number)
    except (ValueError, TypeError, zlib.error, IndexError) as error:
        raise BadInput(f"{path}: array {name} cannot be read ({error})") from None
    n_components = int(element.get("NumberOfComponents", 1))
    return values.reshape(-1, n_components) if n_components > 1 else values


def _inflate(text, header):
    """VTK's inline compressed array: base64 of [blocks, block size, last size, sizes...], then base64 of the blocks."""
    if not text:
        return b""
    first = np.frombuffer(base64.b64decode(text[:_base64_length(header.itemsize)])[:header.itemsize], header)
    length = _base64_length((3 + int(first[0])) * header.itemsize)
    numbers = np.frombuffer(base64.b64decode(text[:length]), header)
    data, position, blocks = base64.b64decode(text[length:]), 0, []
    for size in numbers[3:3 + int(numbers[0])]:
        blocks.append(zlib.decompress(data[position:position + int(size)]))
        position += int(size)
    return b"".join(blocks)


def _base64_length(n_bytes):
    return 4 * ((n_bytes + 2) // 3)


def _parse(path):
    try:
        return ElementTree.parse(path).getroot()
    except FileNotFoundError:
        raise BadInput(f"{path}: no such file") from None
    except ElementTree.ParseError as error:
        raise BadInput(f"{path}: not XML ({error})") from None


def _get(path, element, name):
    value = element.get(name)
    if value is None:
        raise BadInput(f"{path}: attribute {name} of {element.tag} is missing")
    return value

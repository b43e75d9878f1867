"""Snapshots of REVs: grains and cell out of snapshots/*.h5, and which are the first and the last of each REV."""

import re
from dataclasses import dataclass
from pathlib import Path

import h5py
import numpy as np

from .errors import BadInput


@dataclass
class Snapshot:
    """What the figures need of a REV."""

    path: Path
    time: float  # [s]
    cell: np.ndarray  # 3x3, columns are the edges [m]
    position: np.ndarray  # (grains, 3) [m]
    radius: np.ndarray  # [m]
    generation: np.ndarray  # 0 for the grains of the packing, 1 for their siblings, ...

    def compute_solid_volume(self):
        """Volume of the grains [m3], fines not counted."""
        return float(np.sum(4. / 3. * np.pi * self.radius**3))


def read_snapshot(path):
    """Reads one snapshot; raises BadInput naming file and dataset."""
    try:
        with h5py.File(path, "r") as file:
            if _text(file.attrs.get("format")) != "slowsand-rev":
                raise BadInput(f"{path}: attribute format is not 'slowsand-rev'")
            if "time_s" not in file.attrs:
                raise BadInput(f"{path}: attribute time_s is missing")
            snapshot = Snapshot(Path(path), float(np.ravel(file.attrs["time_s"])[0]),
                                _read_dataset(file, path, "/cell/matrix", (3, 3)),
                                _read_dataset(file, path, "/grains/position", (None, 3)),
                                _read_dataset(file, path, "/grains/radius", (None,)),
                                _read_dataset(file, path, "/grains/generation", (None,)))
    except OSError as error:
        raise BadInput(f"{path}: not a readable HDF5 file ({_first_line(error)})") from None
    n_grains = len(snapshot.radius)
    for name in ("position", "generation"):
        if len(getattr(snapshot, name)) != n_grains:
            raise BadInput(f"{path}: dataset /grains/{name} is not as long as /grains/radius ({n_grains})")
    if n_grains == 0 or not np.all(snapshot.radius > 0):
        raise BadInput(f"{path}: dataset /grains/radius is empty or holds a radius that is not positive")
    return snapshot


@dataclass
class Cracks:
    """The cracks of a REV, one entry a grain."""

    id: np.ndarray
    radius: np.ndarray  # [m]
    half_length: np.ndarray  # [m]
    velocity: np.ndarray  # [m/s]


def read_cracks(path):
    """Reads the cracks of one snapshot; raises BadInput naming file and dataset."""
    return Cracks(*_read_grains(path, ("id", "radius", "crack_half_length", "crack_velocity")))


def read_identities(path):
    """(id, id of the grain that it is a sibling of) of each grain; raises BadInput naming file and dataset."""
    return _read_grains(path, ("id", "parent"))


def read_stresses(path):
    """(strength, largest contact stress) of each grain [Pa], compression-positive; raises BadInput naming file and dataset."""
    return _read_grains(path, ("strength", "largest_contact_stress"))


def _read_grains(path, names):
    """Datasets of /grains, one value a grain."""
    try:
        with h5py.File(path, "r") as file:
            values = [_read_dataset(file, path, f"/grains/{name}", (None,)) for name in names]
    except OSError as error:
        raise BadInput(f"{path}: not a readable HDF5 file ({_first_line(error)})") from None
    if len({len(array) for array in values}) > 1:
        raise BadInput(f"{path}: datasets /grains/{', '.join(names)} differ in length")
    return values


def _read_dataset(file, path, name, shape):
    if name not in file:
        raise BadInput(f"{path}: dataset {name} is missing")
    try:
        values = file[name][()]
    except (OSError, RuntimeError, KeyError) as error:
        raise BadInput(f"{path}: dataset {name} cannot be read ({_first_line(error)})") from None
    if values.ndim != len(shape) or any(n is not None and n != m for n, m in zip(shape, values.shape)):
        raise BadInput(f"{path}: dataset {name} has the shape {values.shape}")
    return values


def _first_line(error):
    return str(error).splitlines()[0]


def _text(value):
    """An attribute as text: HDF5 strings of fixed length come as bytes, padded."""
    if isinstance(value, np.ndarray) and value.size == 1:
        value = value.ravel()[0]
    if isinstance(value, bytes):
        return value.rstrip(b"\0").decode("utf-8", "replace")
    return str(value)


def find_first_and_last(files):
    """(first, last) snapshot of each REV, by REV name. A file POINT_WHAT.h5 with POINT = point_N belongs to REV POINT,
    any other file to the only REV there is.

    Loading takes no physical time in scaled runs, so snapshots of one time are put in order by the volume of grains
    left: breakage only ever takes from it. Equal in both, the file's name decides.
    """
    groups = {}
    for file in files:
        match = re.match(r"(point_\d+)(?:_|$)", file.stem)
        groups.setdefault(match.group(1) if match else "", []).append(read_snapshot(file))
    ends = {}
    for name, group in groups.items():
        group.sort(key=lambda s: (s.time, -s.compute_solid_volume(), s.path.name))
        ends[name] = (group[0], group[-1])
    return ends

"""A run folder as slowsand-rev and slowsand-bvp leave it: history, parameters, snapshots, fields.

Everything here is compression-positive, as the history file is. Times [s], stresses [Pa], strains [-].
"""

import csv
import re
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from .errors import BadInput, NotInThisRun

TEXT_COLUMNS = {"kind", "cause", "outcome"}


class Table:
    """A table of a run folder beside its history."""

    def __init__(self, path):
        self.path = path
        self.columns = read_history(path, may_be_empty=True)

    def get_column(self, name):
        """Values of one column, one a row."""
        if name not in self.columns:
            raise BadInput(f"{self.path}: column {name} is missing")
        return self.columns[name]


class RunFolder:
    """One run; reads history.csv and parameters.prm at once, the large files only when asked."""

    def __init__(self, path):
        self.path = Path(path)
        if not self.path.is_dir():
            raise BadInput(f"{self.path}: no such folder")
        if not (self.path / "history.csv").is_file():
            raise BadInput(f"{self.path}: not a run folder, history.csv is missing")
        self.history = read_history(self.path / "history.csv")
        self.parameters = read_parameters(self.path / "parameters.prm")

    @property
    def name(self):
        return self.path.resolve().name

    def get_column(self, name):
        """Values of one column of history.csv, one a row."""
        if name not in self.history:
            raise BadInput(f"{self.path / 'history.csv'}: column {name} is missing")
        return self.history[name]

    def read_table(self, name):
        """The table of that file name, as slowsand-rev writes them."""
        if not (self.path / name).is_file():
            raise NotInThisRun(f"no {name} in {self.path}")
        return Table(self.path / name)

    def is_rev(self):
        """True for a REV alone (slowsand-rev), False for a boundary-value problem (slowsand-bvp)."""
        if "stress_zz_Pa" in self.history:
            return True
        if "newton_iterations" in self.history:
            return False
        raise BadInput(f"{self.path / 'history.csv'}: column stress_zz_Pa (slowsand-rev) or newton_iterations "
                       "(slowsand-bvp) is missing")

    def get_probes(self):
        """Names of the probe points of a boundary-value problem, in the order of the columns."""
        matches = (re.fullmatch(r"(.+)_stress_zz_Pa", column) for column in self.history)
        return [match.group(1) for match in matches if match]

    def get_tensor(self, quantity, probe=None):
        """Rows of `stress` [Pa] or `strain` [-] as (rows, 6) in the order xx, yy, zz, xy, yz, xz."""
        unit = "_Pa" if quantity == "stress" else ""
        prefix = f"{probe}_" if probe else ""
        return np.column_stack([self.get_column(f"{prefix}{quantity}_{c}{unit}") for c in
                                ("xx", "yy", "zz", "xy", "yz", "xz")])

    def find_snapshots(self):
        files = sorted((self.path / "snapshots").glob("*.h5"))
        if not files:
            raise NotInThisRun(f"no snapshots/*.h5 in {self.path}")
        return files

    def find_parameter(self, pattern):
        """First (section, name, value) whose name matches the pattern, or None."""
        for section, name, value in self.parameters:
            if re.search(pattern, name, re.IGNORECASE):
                return section, name, value
        return None


@dataclass
class Creep:
    """The part of a history that is creep."""

    time: np.ndarray  # [s] since the start of the creep stage
    strain: np.ndarray  # axial, since the start of the creep stage [-], compression positive
    broken_instant: np.ndarray  # grains since the start of the creep stage
    broken_delayed: np.ndarray
    stage: int


def read_history(path, may_be_empty=False):
    """Columns of a history file by name. Text columns as lists, the others as arrays of numbers."""
    with open(path, newline="", encoding="utf-8", errors="replace") as file:
        rows = list(csv.reader(file))
    if len(rows) < (1 if may_be_empty else 2):
        raise BadInput(f"{path}: no rows")
    header, body = [name.strip() for name in rows[0]], [row for row in rows[1:] if row]
    for line, row in enumerate(body, start=2):
        if len(row) != len(header):
            raise BadInput(f"{path}, line {line}: {len(row)} values for {len(header)} columns")
    return {name: _convert_column(path, name, [row[i] for row in body]) for i, name in enumerate(header)}


def _convert_column(path, name, texts):
    if name in TEXT_COLUMNS:
        return texts
    values = np.empty(len(texts))
    for i, text in enumerate(texts):
        try:
            values[i] = float(text)
        except ValueError:
            raise BadInput(f"{path}, line {i + 2}, column {name}: '{text}' is not a number") from None
    return values


def read_parameters(path):
    """(section, name, value) of every entry of a .prm file; sections are joined with '/'. Empty without a file."""
    if not path.is_file():
        return []
    entries, sections = [], []
    for line in path.read_text(encoding="utf-8", errors="replace").splitlines():
        line = line.split("#")[0].strip()
        if line.startswith("subsection "):
            sections.append(line[len("subsection "):].strip())
        elif line == "end" and sections:
            sections.pop()
        elif line.startswith("set ") and "=" in line:
            name, value = line[len("set "):].split("=", 1)
            entries.append(("/".join(sections), name.strip(), value.strip()))
    return entries


def find_creep_stage(run):
    """Number of the stage that is creep: the last one called so in parameters.prm, else the longest in time.

    Loading takes no or little physical time, so the longest stage is the creep stage of an ordinary run.
    """
    stages = run.get_column("stage").astype(int)
    named = [int(match.group(1)) for section, _, value in run.parameters
             if (match := re.search(r"Stage (\d+)$", section)) and value.lower() in ("creep", "hold", "hold stress")]
    named = [stage for stage in named if stage in stages]
    if named:
        return named[-1]
    time = run.get_column("time_s")
    starts = {stage: time[np.flatnonzero(stages == stage)[0]] for stage in np.unique(stages)}
    lengths = {stage: time[stages == stage].max() - start for stage, start in starts.items()}
    return max(lengths, key=lengths.get)


def compute_axial_strain(run):
    """Axial strain of each row: of the REV, or the mean over the probe points of a boundary-value problem."""
    if run.is_rev():
        return run.get_column("strain_zz")
    probes = run.get_probes()
    if not probes:
        raise BadInput(f"{run.path / 'history.csv'}: no probe columns (POINT_stress_zz_Pa, POINT_strain_zz)")
    return np.mean([run.get_column(f"{probe}_strain_zz") for probe in probes], axis=0)


def select_creep(run, stage=None, strain=None):
    """The creep stage with time, strain and counters starting at zero: its origin is the last row before the stage."""
    stage = find_creep_stage(run) if stage is None else stage
    rows = np.flatnonzero(run.get_column("stage").astype(int) == stage)
    if rows.size == 0:
        raise BadInput(f"{run.path / 'history.csv'}: column stage holds no stage {stage}")
    origin = max(rows[0] - 1, 0)
    rows = np.concatenate(([origin], rows[rows > origin]))
    strain = compute_axial_strain(run) if strain is None else strain

    def since(values):
        return values[rows] - values[origin]

    return Creep(since(run.get_column("time_s")), since(strain), since(run.get_column("broken_instant")),
                 since(run.get_column("broken_delayed")), stage)

"""What the paper says and what came out: apps/cases/paper/statements.csv beside the runs' numbers."""

import csv
import math
from dataclasses import dataclass, field

import numpy as np

NOT_JUDGED, FAILED = "-", "no result"


@dataclass
class Statement:
    """One statement of the paper. Bounds are in its unit; without bounds there is nothing to agree with."""

    key: str
    figure: str
    text: str
    paper: str
    unit: str
    low: float
    high: float
    is_of_full_size: bool  # means nothing for a REV of a few hundred grains
    reason: str  # of the bounds


@dataclass
class Row:
    """A statement with what came out."""

    statement: Statement
    values: list  # one a seed
    faults: list

    @property
    def ours(self):
        return float(np.mean(self.values)) if self.values else math.nan

    @property
    def scatter(self):
        """Standard deviation over the seeds; nan for fewer than two."""
        return float(np.std(self.values, ddof=1)) if len(self.values) > 1 else math.nan


@dataclass
class Results:
    """Rows in the order of the statements, and further tables that the paper has no number for."""

    statements: dict
    is_full: bool
    rows: dict = field(default_factory=dict)
    notes: list = field(default_factory=list)  # rows

    def add(self, key, values, faults=()):
        """@param values  one a seed; empty if no run gave one"""
        self.rows[key] = Row(self.statements[key], [float(v) for v in values], list(faults))

    def add_note(self, figure, quantity, unit, values, faults=()):
        """A number beyond the paper's statements; no row with neither values nor faults."""
        if len(values) or faults:
            self.notes.append(Row(Statement("", figure, quantity, "", unit, math.nan, math.nan, False, ""),
                                  [float(v) for v in values], list(faults)))

    def sort_rows(self):
        """Rows figure by figure, those of the paper first."""
        order = list(dict.fromkeys(s.figure for s in self.statements.values()))
        rows = [self.rows[key] for key in self.statements if key in self.rows]
        return sorted(rows + self.notes, key=lambda row: order.index(row.statement.figure))

    def list_faults(self):
        """What went wrong, each once."""
        return list(dict.fromkeys(fault for row in self.sort_rows() for fault in row.faults))

    def judge(self, row):
        """yes, no, or why there is no verdict."""
        statement = row.statement
        if not row.values:
            return FAILED
        if math.isnan(statement.low) or (statement.is_of_full_size and not self.is_full):
            return NOT_JUDGED
        return "yes" if statement.low <= row.ours <= statement.high else "no"


def read_statements(path):
    """Statement by key, in the file's order."""
    with open(path, newline="", encoding="utf-8") as stream:
        return {row["key"]: Statement(row["key"], row["figure"], row["statement"], row["paper"], row["unit"],
                                      float(row["low"] or "nan"), float(row["high"] or "nan"),
                                      row["full_only"] == "yes", row["reason"]) for row in csv.DictReader(stream)}


def format_number(value):
    """Four significant digits, more would be noise; whole numbers (counts) in full."""
    if math.isnan(value):
        return ""
    return f"{value:.0f}" if value == round(value) and abs(value) < 1e9 else f"{value:.4g}"

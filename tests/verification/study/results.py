"""The report's numbers: collected while the studies run, written as results.csv and as tables in results.md."""

import csv
import math
from dataclasses import dataclass, field

from runs import RunFailed

FAILURE = "a run failed"
COLUMNS = ("point", "quantity", "value", "unit", "bound", "holds", "command")


@dataclass
class Results:
    """Rows in the order of the report. A row without a bound informs; one with a bound holds or does not."""

    rows: list = field(default_factory=list)

    def add(self, point, quantity, value, unit, command, bound="", holds=None):
        """@param value  a number, or text that says why there is none"""
        text = value if isinstance(value, str) else format_number(value)
        verdict = "" if holds is None else ("yes" if holds else "no")
        self.rows.append((point, quantity, text, unit, bound, verdict, command))

    def add_below(self, point, quantity, value, unit, command, limit):
        """A value that must not exceed a limit; NaN does."""
        self.add(point, quantity, value, unit, command, f"<= {format_number(limit)}", value <= limit)

    def add_failure(self, point, error):
        self.add(point, FAILURE, str(error), "", error.command if isinstance(error, RunFailed) else "",
                 "every run finishes", False)

    def write_csv(self, file):
        with open(file, "w", newline="", encoding="utf-8") as stream:
            writer = csv.writer(stream, lineterminator="\n")
            writer.writerow(COLUMNS)
            writer.writerows(self.rows)

    def write_markdown(self, file, heading):
        """A table for each point, commands numbered below it."""
        lines = [heading, ""]
        for point in dict.fromkeys(row[0] for row in self.rows):
            rows = [row for row in self.rows if row[0] == point]
            commands = list(dict.fromkeys(row[6] for row in rows if row[6]))
            lines += [f"## {point}", "", "| quantity | value | unit | bound | holds | run |", "|---|---|---|---|---|---|"]
            for _, quantity, value, unit, bound, holds, command in rows:
                number = str(commands.index(command) + 1) if command else ""
                lines.append(f"| {quantity} | {value} | {unit} | {bound} | {holds} | {number} |".replace("<", "&lt;"))
            lines.append("")
            lines += [f"{number}. `{command}`" for number, command in enumerate(commands, start=1)] + [""]
        file.write_text("\n".join(lines), encoding="utf-8")

    def count_failures(self):
        return sum(row[1] == FAILURE for row in self.rows)

    def count_broken_bounds(self):
        return sum(row[5] == "no" for row in self.rows)


def format_number(value):
    """Four significant digits: more would be noise."""
    if isinstance(value, float) and not math.isfinite(value):
        return "nan"
    return f"{value:.4g}"

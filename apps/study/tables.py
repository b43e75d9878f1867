"""The tables of a study: table.csv with a row a run, summary.csv with a row a set of values."""

import csv
import io
import math

import numpy as np

from .run_plan import list_sets
from .study_folder import write_text_file

STATISTICS = ("median", "mean", "deviation", "quartile_low", "quartile_high", "least", "largest", "runs")
NOT_RUN = "not run"


def write_tables(folder, study, rows):
    """@param rows  of all runs: (PlannedRun, Outcome or None, results or [])"""
    labels = [parameter.label for parameter in study.parameters]
    columns = [column for result in study.results for column in result.columns]
    write_text_file(folder / "table.csv", _format(
        ["run", *labels, "seed", "status", "exit_status", "seconds", "resumed", "message", *columns],
        [_make_row(run, outcome, results, len(columns)) for run, outcome, results in rows]))
    write_text_file(folder / "summary.csv", _format(
        [*labels, "seeds", "finished", *(f"{column}_{name}" for column in columns for name in STATISTICS)],
        [_summarise(values, rows, len(columns)) for values in list_sets(study)]))


def compute_statistics(values):
    """In the order of STATISTICS, over those that are finite; NaN where there is none.

    The deviation is that of a sample (divided by n - 1), NaN of one value. Quartiles are interpolated linearly.
    """
    values = np.array([value for value in values if not isinstance(value, str)], dtype=float)
    values = values[np.isfinite(values)]
    n = len(values)
    if n == 0:
        return [math.nan] * (len(STATISTICS) - 1) + [0]
    deviation = float(np.std(values, ddof=1)) if n > 1 else math.nan
    low, median, high = np.percentile(values, (25, 50, 75))
    return [median, values.mean(), deviation, low, high, values.min(), values.max(), n]


def _make_row(run, outcome, results, n_columns):
    ended = (NOT_RUN, "", "", "", "") if outcome is None else (
        outcome.status, outcome.exit_status, round(outcome.seconds, 3), int(outcome.resumed), outcome.message)
    return [run.name, *run.values, run.seed, *ended, *(results or [""] * n_columns)]


def _summarise(values, rows, n_columns):
    """Failed runs have no results and count among the seeds alone."""
    seeds = [results for run, _, results in rows if run.values == values]
    finished = [results for results in seeds if results]
    cells = [cell for k in range(n_columns) for cell in compute_statistics([results[k] for results in finished])]
    return [*values, len(seeds), len(finished), *cells]


def _format(header, rows):
    stream = io.StringIO()
    writer = csv.writer(stream, lineterminator="\n")
    writer.writerow(header)
    writer.writerows([[_show(cell) for cell in row] for row in rows])
    return stream.getvalue()


def _show(cell):
    if isinstance(cell, (float, np.floating)):
        return f"{cell:.10g}"  # as the histories
    return " ".join(cell.split()) if isinstance(cell, str) else cell

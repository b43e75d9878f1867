"""What of a finished run goes into the table: keys of summary.json and values out of its CSV files."""

import json
import math
from dataclasses import dataclass, field

import numpy as np

from plotting.curves import fit_slope, sample_steps
from plotting.errors import BadInput
from plotting.run_folder import read_history

from .json_text import is_integer, is_number, join, show

KEYS = ("name", "summary", "file", "column", "stage", "change", "take", "times_s")
TAKES = ("last", "first", "largest", "smallest", "mean", "at", "slope")
HISTORY, TIME, STAGE = "history.csv", "time_s", "stage"


@dataclass
class Result:
    """One entry of "results": one column of the table, or one for each of several times."""

    place: str  # in the study file
    columns: list  # names in the table
    summary: str = ""  # key of summary.json, inner ones behind a slash; empty for a value out of a CSV file
    file: str = HISTORY
    column: str = ""
    stage: int = 0  # 0: all rows
    is_change: bool = False  # since the last row before the stage
    take: str = "last"
    times: list = field(default_factory=list)  # [s] since the last row before the stage, or as the file has them

    def read(self, folder, tables):
        """The result's values in a run folder. @p tables: file -> columns, those read already."""
        if self.summary:
            return [_read_summary_key(folder / "summary.json", self.summary)]
        path = folder / self.file
        if self.file not in tables:
            if not path.is_file():
                raise BadInput(f"{path}: no such file")
            tables[self.file] = read_history(path)
        time, values = self._select(path, tables[self.file])
        return [float(value) for value in self._reduce(time, values)]

    def _select(self, path, table):
        """Times (None where the take needs none) and values of the rows wanted."""
        values, time = _get_column(path, table, self.column), None
        if self.times:
            time = _get_column(path, table, TIME)
        if not self.stage:
            return time, values
        rows = np.flatnonzero(_get_column(path, table, STAGE) == self.stage)
        if rows.size == 0:
            raise BadInput(f"{path}: column {STAGE} holds no stage {self.stage}")
        origin = max(rows[0] - 1, 0)
        if self.times:  # the origin is a row too: the state at time zero
            rows = np.concatenate(([origin], rows[rows > origin]))
            time = time[rows] - time[origin]
        return time, values[rows] - (values[origin] if self.is_change else 0.)

    def _reduce(self, time, values):
        if self.take == "at":
            return sample_steps(time, values, self.times)
        if self.take == "slope":
            return [fit_slope(time, values, *np.log10(self.times))[1]]
        return [{"last": lambda: values[-1], "first": lambda: values[0], "largest": lambda: np.max(values),
                 "smallest": lambda: np.min(values), "mean": lambda: np.mean(values)}[self.take]()]


def read_results(text, results):
    """The list "results" of a study file, checked. @p text: JsonText"""
    if not isinstance(results, list) or not results:
        text.reject("results", f"{show(results)} is not a list [...] of at least one result")
    return [_read_result(text, f"results[{i}]", result) for i, result in enumerate(results)]


def _read_result(text, place, content):
    text.check_keys(place, content, KEYS)
    for key in ("name", "summary", "file", "column"):
        if key in content and (not isinstance(content[key], str) or not content[key] or "\n" in content[key]):
            text.reject(join(place, key), f"{show(content[key])} is not a name")
    if ("summary" in content) == ("column" in content):
        text.reject(place, "a result has either a key \"summary\" or a key \"column\"")
    if "summary" in content:
        text.check_keys(place, content, ("name", "summary"))
        return Result(place, [content.get("name", content["summary"])], content["summary"])
    if "/" in content.get("file", "") or not content.get("file", ".csv").endswith(".csv"):
        text.reject(join(place, "file"), f"{show(content['file'])} is not a file NAME.csv of the run folder")
    result = Result(place, [], "", content.get("file", HISTORY), content["column"], _read_stage(text, place, content),
                    _read_change(text, place, content), content.get("take", "last"))
    if result.take not in TAKES:
        text.reject(join(place, "take"), f"{show(result.take)} is not one of {', '.join(TAKES)}")
    result.times = _read_times(text, place, content, result.take)
    result.columns = _name_columns(content, result)
    return result


def _read_stage(text, place, content):
    stage = content.get("stage", 0)
    if "stage" in content and (not is_integer(stage) or stage < 1):
        text.reject(join(place, "stage"), f"{show(stage)} is not an integer >= 1")
    return stage


def _read_change(text, place, content):
    change = content.get("change", False)
    if not isinstance(change, bool):
        text.reject(join(place, "change"), f"{show(change)} is neither true nor false")
    if change and "stage" not in content:
        text.reject(join(place, "change"), "a change is since the beginning of a stage: give \"stage\"")
    return change


def _read_times(text, place, content, take):
    """[s]; of "at" at least one, of "slope" two that rise from above zero, else none."""
    here = join(place, "times_s")
    if take not in ("at", "slope"):
        if "times_s" in content:
            text.reject(here, f"times go with \"take\": \"at\" or \"slope\", not with \"{take}\"")
        return []
    if "times_s" not in content:
        text.reject(place, f"\"take\": \"{take}\" needs the key 'times_s'")
    times = content["times_s"]
    if not isinstance(times, list) or not times or not all(is_number(t) and t >= 0 for t in times):
        text.reject(here, f"{show(times)} is not a list [...] of numbers >= 0 [s]")
    if take == "slope" and (len(times) != 2 or not 0 < times[0] < times[1]):
        text.reject(here, f"{show(times)} is not [FROM, TO] with 0 < FROM < TO [s]")
    return times


def _name_columns(content, result):
    name = content.get("name", content["column"])
    if result.take == "at" and ("name" not in content or len(result.times) > 1):
        return [f"{name}_at_{time:g}_s" for time in result.times]
    if "name" in content or result.take == "last":
        return [name]
    return [f"{name}_{result.take}"]


def _get_column(path, table, name):
    if name not in table:
        raise BadInput(f"{path}: column {name} is missing")
    if isinstance(table[name], list):
        raise BadInput(f"{path}: column {name} holds text")
    return table[name]


def _read_summary_key(path, key):
    """A number or a text; keys of inner objects are given as OUTER/INNER."""
    try:
        value = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise BadInput(f"{path}: cannot be read: {error}") from None
    for part in key.split("/", 1) if isinstance(value, dict) and key not in value else [key]:
        if not isinstance(value, dict) or part not in value:
            raise BadInput(f"{path}: key {key} is missing")
        value = value[part]
    if isinstance(value, (dict, list)):
        raise BadInput(f"{path}: key {key} is neither a number nor a text")
    if value is None:
        return math.nan  # what JSON writes for it
    return float(value) if isinstance(value, float) else int(value) if isinstance(value, bool) else value

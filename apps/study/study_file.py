"""The study file: which case at which values and seeds, and what of each run goes into the table."""

from dataclasses import dataclass
from pathlib import Path

from plotting.errors import BadInput

from .json_text import JsonText, is_integer, is_number, join, show
from .run_results import read_results

KEYS = ("case", "program", "settings", "parameters", "combine", "seeds", "results", "timeout_s")
PROGRAMS = ("slowsand-rev", "slowsand-bvp")
RESERVED = ("run", "seed", "status", "exit_status", "seconds", "resumed", "message")
LARGEST_SEED = 2**31 - 1  # deal.II reads integers of this size
SEED = "Seed"
MAY_CHANGE = ("results", "timeout_s")  # when a study is resumed: they change no run


@dataclass
class Parameter:
    """One parameter that is varied."""

    path: str  # Section/Name
    label: str  # its column in the tables, its part of a run's name
    values: list  # as text, as --set takes them
    place: str  # in the study file


@dataclass
class Study:
    text: JsonText
    case: Path
    program: str
    settings: dict  # Section/Name -> value as text, the same for all runs
    parameters: list
    is_zip: bool  # values side by side instead of each with each
    seeds: list
    results: list
    timeout: float  # [s] of each run

    def define_runs(self):
        """What of the file makes the runs what they are."""
        return {key: value for key, value in self.text.value.items() if key not in MAY_CHANGE + ("case",)}


def read_study(path, case=None):
    """Reads and checks a study file. @p case: a copy to be taken instead of the file's own (resumed studies).

    Raises BadInput naming file, line, key, value and what is allowed.
    """
    text = JsonText(Path(path))
    content = text.value
    text.check_keys("", content, KEYS, ("case", "seeds", "results"))
    parameters = _read_parameters(text, content.get("parameters", []))
    study = Study(text, case or _find_case(text, content["case"]),
                  _read_choice(text, "program", content.get("program", PROGRAMS[0]), PROGRAMS),
                  _read_settings(text, content.get("settings", {})), parameters,
                  _read_choice(text, "combine", content.get("combine", "grid"), ("grid", "zip")) == "zip",
                  _read_seeds(text, content["seeds"]), read_results(text, content["results"]),
                  _read_timeout(text, content.get("timeout_s", 86400)))
    _check_parameters(study)
    _check_columns(study)
    return study


def format_value(value):
    """A parameter's value as --set takes it; 15 digits where they are enough to get the same number back."""
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, float):
        return f"{value:.15g}" if float(f"{value:.15g}") == value else repr(value)
    return str(value)


def _find_case(text, name):
    if not isinstance(name, str) or not name:
        text.reject("case", f"{show(name)} is not the name of a parameter file")
    case = text.path.parent / name
    if not case.is_file():
        text.reject("case", f"{case}: no such file (names are relative to the study file)")
    return case


def _read_choice(text, key, value, allowed):
    if value not in allowed:
        text.reject(key, f"{show(value)} is not one of {', '.join(allowed)}")
    return value


def _read_value(text, place, value):
    if not (is_number(value) or isinstance(value, (bool, str))) or value == "":
        text.reject(place, f"{show(value)} is neither a number, a text, true nor false")
    if isinstance(value, str) and "\n" in value:
        text.reject(place, "a value has one line")
    return format_value(value)


def _check_path(text, place, path):
    if not isinstance(path, str) or not path.strip() or "=" in path or "\n" in path:
        text.reject(place, f"{show(path)} is not a parameter, written Section/Name")
    if path == SEED:
        text.reject(place, f"'{SEED}' is what \"seeds\" sets")


def _read_settings(text, settings):
    text.check_keys("settings", settings, settings if isinstance(settings, dict) else ())
    for path in settings:
        _check_path(text, join("settings", path), path)
    return {path: _read_value(text, join("settings", path), value) for path, value in settings.items()}


def _read_parameters(text, parameters):
    if not isinstance(parameters, list):
        text.reject("parameters", f"{show(parameters)} is not a list [...]")
    return [_read_parameter(text, f"parameters[{i}]", parameter) for i, parameter in enumerate(parameters)]


def _read_parameter(text, place, parameter):
    text.check_keys(place, parameter, ("name", "values", "label"), ("name", "values"))
    path, values = parameter["name"], parameter["values"]
    _check_path(text, f"{place}.name", path)
    if not isinstance(values, list) or not values:
        text.reject(f"{place}.values", f"{show(values)} is not a list [...] of at least one value")
    texts = []
    for i, value in enumerate(values):
        texts.append(_read_value(text, f"{place}.values[{i}]", value))
    label = parameter.get("label", path.rsplit("/", 1)[-1].lower().replace(" ", "_"))
    if not isinstance(label, str) or not label or any(c in label for c in ",\n\"/"):
        text.reject(f"{place}.label", f"{show(label)} is not a name without commas, quotes and slashes")
    return Parameter(path, label, texts, place)


def _read_seeds(text, seeds):
    if isinstance(seeds, dict):
        text.check_keys("seeds", seeds, ("first", "count"), ("first", "count"))
        first, count = seeds["first"], seeds["count"]
        if not is_integer(count) or not 1 <= count <= 100000:
            text.reject("seeds.count", f"{show(count)} is not an integer from 1 to 100000")
        _check_seed(text, "seeds.first", first, LARGEST_SEED - count + 1)
        return list(range(first, first + count))
    if not isinstance(seeds, list) or not seeds:
        text.reject("seeds", f"{show(seeds)} is neither a list [...] of at least one seed nor "
                    "{\"first\": .., \"count\": ..}")
    for i, seed in enumerate(seeds):
        _check_seed(text, f"seeds[{i}]", seed, LARGEST_SEED)
        if seed in seeds[:i]:
            text.reject(f"seeds[{i}]", f"seed {seed} is given twice")
    return seeds


def _check_seed(text, place, seed, largest):
    if not is_integer(seed) or not 0 <= seed <= largest:
        text.reject(place, f"{show(seed)} is not an integer from 0 to {largest}")


def _read_timeout(text, timeout):
    if not is_number(timeout) or timeout <= 0:
        text.reject("timeout_s", f"{show(timeout)} is not a number > 0 [s]")
    return timeout


def _check_parameters(study):
    """No parameter twice; of zip, lists of one length; of grid, no value twice."""
    text, seen = study.text, {}
    for parameter in study.parameters:
        if parameter.path in study.settings:
            text.reject(f"{parameter.place}.name", f"'{parameter.path}' is among the settings too")
        if parameter.path in seen:
            text.reject(f"{parameter.place}.name", f"'{parameter.path}' is varied by {seen[parameter.path]} too")
        seen[parameter.path] = parameter.place
        n, first = len(parameter.values), len(study.parameters[0].values)
        if study.is_zip and n != first:
            text.reject(f"{parameter.place}.values", f"{n} values, but parameters[0] has {first}: \"combine\": \"zip\" "
                        "takes them side by side")
        for i, value in enumerate(parameter.values):
            if not study.is_zip and value in parameter.values[:i]:
                text.reject(f"{parameter.place}.values[{i}]", f"value {value} is given twice")


def _check_columns(study):
    """The table's columns have different names."""
    seen = dict.fromkeys(RESERVED, "the table itself")
    columns = [(parameter.label, parameter.place) for parameter in study.parameters]
    columns += [(column, result.place) for result in study.results for column in result.columns]
    for column, place in columns:
        if column in seen:
            study.text.reject(place, f"the table has a column '{column}' already, of {seen[column]}; give this one "
                              f"another \"{'label' if place.startswith('parameters') else 'name'}\"")
        seen[column] = place


def compare_studies(study, kept):
    """Raises BadInput if the study's runs are not those of the one that its folder keeps."""
    new, old = study.define_runs(), kept.define_runs()
    for key in KEYS:
        if new.get(key) != old.get(key):
            study.text.reject(key, f"{show(new.get(key))} differs from {show(old.get(key))} in {kept.text.path}: a study "
                              f"is resumed with the runs it was begun with, only {' and '.join(MAY_CHANGE)} may change")
    if study.case.read_bytes() != kept.case.read_bytes():
        raise BadInput(f"{study.case}: differs from {kept.case}, with which the study was begun")

"""Which runs a study consists of: every set of values with every seed."""

import hashlib
import itertools
import re
from dataclasses import dataclass

from .study_file import SEED, format_value

LONGEST_NAME = 150  # of a folder; file systems take 255


@dataclass
class PlannedRun:
    name: str  # of its folder, made from its values
    values: tuple  # of the parameters, as text
    seed: int
    settings: list  # (Section/Name, value) for --set


def list_sets(study):
    """Values of each set, as text in the order of the parameters; one empty set if nothing is varied."""
    lists = [parameter.values for parameter in study.parameters]
    if study.is_zip:
        return list(zip(*lists)) if lists else [()]
    return list(itertools.product(*lists))


def plan_runs(study):
    """All runs, set by set and in each seed by seed. Raises BadInput if two would share a folder."""
    runs, seen = [], {}
    for values in list_sets(study):
        for seed in study.seeds:
            run = PlannedRun(_name_run(study, values, seed), values, seed, make_settings(study, values, seed))
            if run.name in seen:
                study.text.reject("parameters", f"two runs would be called {run.name}: their values are equal, or differ "
                                  "only in signs that no folder can be named with")
            seen[run.name] = run
            runs.append(run)
    return runs


def make_settings(study, values, seed):
    varied = [(parameter.path, value) for parameter, value in zip(study.parameters, values)]
    return list(study.settings.items()) + varied + [(SEED, format_value(seed))]


def _name_run(study, values, seed):
    parts = [f"{parameter.label}_{value}" for parameter, value in zip(study.parameters, values)] + [f"seed_{seed}"]
    name = "-".join(re.sub(r"[^A-Za-z0-9.+_-]+", "_", part) for part in parts)
    if len(name) <= LONGEST_NAME:
        return name
    return f"{name[:LONGEST_NAME - 17]}-{hashlib.sha256(name.encode()).hexdigest()[:16]}"

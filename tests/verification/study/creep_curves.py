"""Creep curves of several runs, read at the same times."""

import numpy as np

from runs import RunFolder  # noqa: F401 (puts apps/ on the path)
from plotting.curves import sample_steps
from plotting.run_folder import select_creep


def sample(run, times, strain=None):
    """Axial creep strain [-] at times [s] since the start of creep, step by step."""
    creep = select_creep(run, strain=strain)
    return sample_steps(creep.time, creep.strain, times)


def make_times(first_decade, last_decade, points_per_decade):
    """10^first to 10^last s."""
    return np.logspace(first_decade, last_decade, (last_decade - first_decade) * points_per_decade + 1)


def compute_slope(times, strains):
    """Least-squares slope of strain over log10 of time [- per decade]."""
    return float(np.polyfit(np.log10(times), strains, 1)[0])

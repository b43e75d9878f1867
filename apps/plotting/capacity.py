"""Capacity of a pile against its age, and the curves of the load tests it was read from."""

import numpy as np

from . import style
from .errors import NotInThisRun


def draw(run, options):
    """Left: load tests, force through the shaft against the head's way. Right: shaft capacity against age."""
    table = run.read_table("capacity.csv")
    ages, shaft = table.get_column("age_s"), table.get_column("shaft_capacity_N")
    if not len(ages):
        raise NotInThisRun(f"no load test in {table.path}")
    figure, (left, right) = style.new_figure(4.4, 2)
    for i, age in enumerate(ages):
        curve = run.read_table(f"load_tests/{age:g}_s.csv")
        left.plot(1e3 * curve.get_column("head_displacement_m"), curve.get_column("shaft_force_N") / 1e6,
                  color=style.CYCLE[i % len(style.CYCLE)], label=f"{age:g} s")
    left.set_xlabel("displacement of the head [mm]")
    left.set_ylabel("force through the shaft [MN]")
    left.legend(loc="best", title="age")
    at = np.where(ages > 0, ages, np.min(ages[ages > 0], initial=1.) / 10)  # age 0 has no place on a logarithmic axis
    right.semilogx(at, shaft / 1e6, "o-", color=style.BLUE)
    for x, y, age in zip(at, shaft / 1e6, ages):
        if age == 0:
            right.annotate("age 0", (x, y), textcoords="offset points", xytext=(4, 4), fontsize=7)
    right.set_ylim(bottom=0)
    right.set_xlabel("age [s]")
    right.set_ylabel("shaft capacity [MN]")
    return figure


def print_growth(runs, options):
    """CSV on standard output: each load test of every run, with the growth per tenfold age since the one before."""
    print("run,age_s,shaft_capacity_N,base_capacity_N,is_peak,shaft_growth_per_decade")
    for run in runs:
        table = run.read_table("capacity.csv")
        columns = [table.get_column(name) for name in ("age_s", "shaft_capacity_N", "base_capacity_N", "is_peak",
                                                       "shaft_growth_per_decade")]
        for age, shaft, base, is_peak, growth in zip(*columns):
            print(f"{run.name},{age:g},{shaft:.6g},{base:.6g},{int(is_peak)},{growth:.6g}")

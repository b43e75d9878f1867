"""Breakage against time: relative breakage after Hardin and Einav, without and with the fines."""

from . import style
from .errors import NotInThisRun

MEASURES = (("hardin", style.BLUE, "Hardin"), ("einav", style.VERMILION, "Einav"))


def draw(run, options):
    """Lines: without fines; broken lines: with fines. The time is that of the run, on a logarithmic axis."""
    table = run.read_table("breakage.csv")
    time = table.get_column("time_s")
    shown = time > 0
    if not shown.any():
        raise NotInThisRun(f"no time passes in {table.path}")
    figure, axes = style.new_figure(2.6)
    for name, colour, label in MEASURES:
        for suffix, line, fines in (("", "-", "without fines"), ("_with_fines", "--", "with fines")):
            values = table.get_column(f"relative_breakage_{name}{suffix}")
            axes.semilogx(time[shown], values[shown], line, drawstyle="steps-post", color=colour,
                          label=f"{label}, {fines}")
    axes.set_xlabel("time [s]")
    axes.set_ylabel("relative breakage [-]")
    axes.set_ylim(bottom=0)
    axes.legend(loc="upper left")
    return figure

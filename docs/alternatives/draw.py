"""Figures and tables of docs/alternatives.md from the studies that run.sh made. Usage: draw.py RUNS OUTPUT"""

import sys
from pathlib import Path

sys.dont_write_bytecode = True
sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "apps"))

import numpy as np  # noqa: E402
from plotting import style  # noqa: E402
from plotting.curves import sample_steps  # noqa: E402
from plotting.run_folder import select_creep  # noqa: E402
from plotting.study_bands import read_sets  # noqa: E402

LAWS = {"delayed fracture": style.BLUE, "scaled time": style.ORANGE, "rate process": style.GREEN,
        "burgers": style.VERMILION}
LABELS = {"kind": "", "step_share": "eps = {}", "activation_energy": "dF = {} J/mol", "bonds_per_force": "n1 = {}/N",
          "normal_viscosity": "Cm = {} N s/m", "normal_retarded_stiffness": "Kk = {} N/m"}
DEFAULTS = {"step_share": "0.005", "activation_energy": "105000", "bonds_per_force": "1e+09", "normal_viscosity": "1e+12",
            "normal_retarded_stiffness": "1e+06"}


def read_curves(runs):
    """Time [s] since the creep began and strain [-] of each seed."""
    return [(creep.time, creep.strain) for creep in (select_creep(run) for run in runs)]


def sample(curves, times):
    """Strain [%] of each seed at these times; NaN beyond its last row."""
    values = 100 * np.array([sample_steps(time, strain, times) for time, strain in curves])
    for k, (time, _) in enumerate(curves):
        values[k, times > time[-1] * (1 + 1e-9)] = np.nan
    return values


def draw(sets, colours, name, output):
    """Median over the seeds, and each of them thin."""
    figure, axes = style.new_figure(2.6)
    for (title, runs), colour in zip(sets.items(), colours):
        curves = read_curves(runs)
        times = np.geomspace(1., max(time[-1] for time, _ in curves), 400)
        values = sample(curves, times)
        for row in values:
            axes.plot(times, row, color=colour, alpha=0.3, linewidth=0.6)
        axes.plot(times, np.median(values, axis=0), color=colour, label=title)
    axes.set_xscale("log")
    axes.set_xlabel("time since creep began [s]")
    axes.set_ylabel("axial creep strain [%]")
    axes.legend(loc="upper left")
    return style.save(figure, output / "figures", name)


def make_table(sets, times):
    """Median and range over the seeds at some times [s]."""
    lines = ["| | " + " | ".join(f"{time:.0e} s" for time in times) + " | seeds at the end |",
             "|---|" + "---|" * (len(times) + 1)]
    for title, runs in sets.items():
        values = sample(read_curves(runs), np.array(times))
        cells = [f"{np.median(column):.3f} ({column.min():.3f}-{column.max():.3f})" for column in values.T]
        lines.append(f"| {title} | " + " | ".join(cells) + f" | {int(np.isfinite(values[:, -1]).sum())} of {len(runs)} |")
    return lines


def make_disturbance_table(sets):
    """What grains that break do to the axial stress [MPa] and, from one row to the next, to the strain [%]."""
    lines = ["| | largest drop of the axial stress [MPa] | largest strain from row to row [%] |", "|---|---|---|"]
    for title, runs in sets.items():
        drops, strains = [], []
        for run in runs:
            jumps = run.read_table("jumps.csv")
            is_creep = jumps.get_column("stage") == 2
            drops.append(-np.min(jumps.get_column("smallest_deviation_zz_Pa")[is_creep]) / 1e6)
            strains.append(100 * np.max(np.abs(jumps.get_column("strain_change_zz")[is_creep])))
        lines.append(f"| {title} | {np.median(drops):.2f} ({min(drops):.2f}-{max(drops):.2f}) "
                     f"| {np.median(strains):.3f} ({min(strains):.3f}-{max(strains):.3f}) |")
    return lines


def read_title(title):
    """The parameters of a set of runs by their labels."""
    return dict(part.split(" = ") for part in title.split(", "))


def shorten(title):
    """The law, and what differs from its default."""
    values = read_title(title)
    changed = [LABELS[name].format(value) for name, value in values.items()
               if name != "kind" and value != DEFAULTS[name]]
    return f"{values['kind']}, {' '.join(changed).strip() or 'as it is'}"


def rename(sets, name):
    return {name(title): runs for title, runs in sets.items()}


def main():
    runs, output = Path(sys.argv[1]), Path(sys.argv[2])
    laws = rename(read_sets(runs / "study_creep_laws"), lambda title: read_title(title)["kind"])
    scales = rename(read_sets(runs / "study_time_scale"), lambda title: f"{read_title(title)['time_scale']} s a cycle")
    scales["jumps"] = laws["delayed fracture"]
    parameters = rename(read_sets(runs / "study_parameters"), shorten)
    draw(laws, [LAWS[law] for law in laws], "laws", output)
    draw(scales, style.CYCLE, "time_scale", output)
    lines = ["Made by `bash docs/alternatives/run.sh`; do not edit. Axial creep strain [%], median (least-largest) over seeds.",
             "", "## Laws", "", *make_table(laws, (1e3, 1e4, 1e5, 1e6, 1e7)), "", "## Time scale", "",
             *make_table(scales, (1e2, 1e3, 1e4, 1e5)), "", *make_disturbance_table(scales), "", "## Parameters", "",
             *make_table(parameters, (1e4, 1e6, 1e7))]
    (output / "results.md").write_text("\n".join(lines) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()

"""What the REVs beside a shaft went through: means over the height of the shaft at each distance from the axis."""

import csv

import numpy as np
from plotting import style

NUMBERS = ("stress_xx_Pa", "stress_yy_Pa", "stress_zz_Pa", "void_ratio", "broken_at_once", "broken_delayed")
COLUMNS = ("series", "seed", "age_s", "radius_m", "points", "radial_stress_Pa", "hoop_stress_Pa", "vertical_stress_Pa", "void_ratio",
           "broken_at_once", "broken_delayed")
AGES = (0., 1e4, 1e7)  # of the rows [s]: when creep begins, and those of the load tests
CONE_TOP = -4.6  # [m]: points beside the cone are left out


def read_states(file):
    """Points of the ground beside the shaft at each output: {(stage, step, age): rows}, in the order of the file."""
    states = {}
    with open(file, encoding="utf-8", newline="") as stream:
        for row in csv.DictReader(stream):
            if row["void_ratio"] != "nan" and float(row["z_m"]) > CONE_TOP:
                states.setdefault((int(row["stage"]), int(row["step"]), float(row["time_s"])), []).append(row)
    return states


def find_state(states, age):
    """Key of the last state of an age."""
    return max((key for key in states if np.isclose(key[2], age, rtol=1e-6, atol=0.)), default=None)


def collect(runs):
    """Rows of rings.csv for each run that has points.csv."""
    rows = []
    for series, seed, folder in runs:
        if not (folder / "points.csv").is_file():
            continue
        states = read_states(folder / "points.csv")
        for age in AGES:
            key = find_state(states, age)
            if key is None:
                continue
            rings = {}
            for point in states[key]:
                rings.setdefault(round(float(point["x_m"]), 3), []).append([float(point[name]) for name in NUMBERS])
            for radius in sorted(rings):
                means = np.mean(rings[radius], axis=0)
                rows.append(dict(zip(COLUMNS, (series.name, seed, f"{age:g}", f"{radius:.4g}", len(rings[radius]),
                                               *(f"{value:.4g}" for value in means)))))
    return rows


def draw(rows, names, folder):
    """Radial and hoop stress against the distance from the axis, mean over seeds, at the first and the last age."""
    figure, all_axes = style.new_figure(2.6, columns=len(names), sharey=True)
    for axes, name in zip(np.atleast_1d(all_axes), names):
        own = [row for row in rows if row["series"] == name]
        for column, colour, label in (("radial_stress_Pa", style.CYCLE[0], "radial"), ("hoop_stress_Pa", style.CYCLE[1], "hoop")):
            for age, line in ((AGES[0], "--"), (AGES[-1], "-")):
                now = [row for row in own if float(row["age_s"]) == age]
                radii = sorted({float(row["radius_m"]) for row in now})
                means = [np.mean([float(row[column]) for row in now if float(row["radius_m"]) == radius]) / 1e6 for radius in radii]
                axes.loglog(radii, means, line, color=colour, label=f"{label}, {age:g} s")
        axes.set_title(name)
        axes.set_xlabel("initial r [m]")
    np.atleast_1d(all_axes)[0].set_ylabel("stress [MPa]")
    np.atleast_1d(all_axes)[0].legend(loc="best", fontsize=6)
    print(style.save(figure, folder, "rings"))

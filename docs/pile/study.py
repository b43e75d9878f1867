"""Runs the piles of docs/pile.md one after another and makes its tables and figures of what has finished."""

import argparse
import csv
import json
import math
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

sys.dont_write_bytecode = True
sys.path[:0] = [str(Path(__file__).resolve().parents[2] / "apps"), str(Path(__file__).resolve().parent)]

import numpy as np  # noqa: E402
import pile_runs  # noqa: E402
import rings  # noqa: E402
from plotting import shaft, style  # noqa: E402
from plotting.run_folder import RunFolder  # noqa: E402

COLUMNS = ("series", "seed", "age_s", "shaft_capacity_N", "base_capacity_N", "head_displacement_m", "outcome", "is_peak",
           "shaft_growth_per_decade", "radial_stress_Pa")


def parse_arguments():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--programs", default="build/release", help="folder of slowsand-bvp (default: build/release)")
    parser.add_argument("--output", default="runs/pile", help="where the runs are kept (default: runs/pile)")
    parser.add_argument("--documents", default=str(Path(__file__).parent), help="where tables and figures go")
    parser.add_argument("--processes", type=int, default=1, help="runs at a time (default: 1)")
    parser.add_argument("--only", nargs="+", metavar="NAME", help="of: " + ", ".join(
        series.name for series in pile_runs.SERIES))
    parser.add_argument("--draw", action="store_true", help="run nothing, draw what there is")
    return parser.parse_args()


def find_radial_stress(run, age):
    """Mean radial stress on the shaft [Pa] at an age; NaN where no row of shaft.csv has it."""
    ages, _, means = shaft.compute_means(run.read_table("shaft.csv"), "radial_stress_Pa")
    rows = np.flatnonzero(np.isclose(ages, age, rtol=1e-6, atol=0.))
    return means[rows[-1]] if rows.size else math.nan


def collect_capacities(runs):
    """Rows of capacities.csv: each load test of each run that has any."""
    rows = []
    for series, seed, folder in runs:
        if not (folder / "capacity.csv").is_file():
            continue
        run = RunFolder(folder)
        with open(folder / "capacity.csv", encoding="utf-8", newline="") as stream:
            for row in csv.DictReader(stream):
                row.update(series=series.name, seed=seed,
                           radial_stress_Pa=f"{find_radial_stress(run, float(row['age_s'])):.6g}")
                rows.append({name: row[name] for name in COLUMNS})
    return rows


def summarise(capacities):
    """Rows of series.csv: what came of each series, mean and standard deviation over its seeds."""
    rows = []
    for name in dict.fromkeys(row["series"] for row in capacities):
        runs = {}
        for row in capacities:
            if row["series"] == name:
                runs.setdefault(row["seed"], []).append(row)
        known = [[row for row in run if row["outcome"] == "finished" or row["is_peak"] == "1"] for run in runs.values()]
        figures = {
            "first_shaft_capacity_MN": [float(run[0]["shaft_capacity_N"]) / 1e6 for run in known if run],
            "growth_per_decade": [float(run[-1]["shaft_growth_per_decade"]) for run in runs.values()],
            "base_growth": [float(run[-1]["base_capacity_N"]) / float(run[0]["base_capacity_N"]) - 1. for run in known if len(run) > 1],
            "radial_stress_change": [float(run[-1]["radial_stress_Pa"]) / float(run[0]["radial_stress_Pa"]) - 1.
                                     for run in runs.values()]}
        row = {"series": name, "seeds": len(runs), "tests": sum(map(len, runs.values())), "tests_that_ended_early": sum(
            one["outcome"] != "finished" for run in runs.values() for one in run)}
        for figure, values in figures.items():
            values = [value for value in values if not math.isnan(value)]
            row[figure] = f"{np.mean(values):.4g}" if values else "nan"
            row[f"{figure}_deviation"] = f"{np.std(values, ddof=1):.4g}" if len(values) > 1 else "nan"
        rows.append(row)
    return rows


def count_fractures(runs):
    """Rows of fractures.csv: grains broken by the end of consolidation, of each later stage, and how many there were."""
    rows = []
    for series, seed, folder in runs:
        if not (folder / "history.csv").is_file():
            continue
        run = RunFolder(folder)
        stages = run.get_column("stage").astype(int)
        names = {0: "consolidation"}
        for section, name, value in run.parameters:
            if section.startswith("Loading/Stage ") and name == "Name":
                names[int(section.split()[-1])] = value
        for stage in np.unique(stages):
            last = np.flatnonzero(stages == stage)[-1]
            rows.append({"series": series.name, "seed": seed, "stage": names.get(stage, stage),
                         "grains": int(run.get_column("grains")[0]),
                         "broken_instant": int(run.get_column("broken_instant")[last]),
                         "broken_delayed": int(run.get_column("broken_delayed")[last])})
    return rows


def write_table(file, rows):
    if not rows:
        return
    with open(file, "w", encoding="utf-8", newline="") as stream:
        writer = csv.DictWriter(stream, rows[0].keys(), lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)
    print(file)


def write_legend(axes):
    """Below the axes, since a dozen series leave no room in them."""
    axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.22), ncol=2, fontsize=6, handlelength=3.)


def draw_capacities(rows, folder):
    """Shaft capacity over that of the same pile at its first age, against age; thin: each seed."""
    figure, axes = style.new_figure(3.8)
    for i, name in enumerate(dict.fromkeys(row["series"] for row in rows)):
        colour = style.CYCLE[i % len(style.CYCLE)]
        own = [row for row in rows if row["series"] == name]
        for k, seed in enumerate(dict.fromkeys(row["seed"] for row in own)):
            known = [row for row in own if row["seed"] == seed and (row["outcome"] == "finished" or row["is_peak"] == "1")]
            if len(known) < 2:
                continue
            ages = [max(float(row["age_s"]), 1e2) for row in known]  # age 0 has no place on a logarithmic axis
            values = [float(row["shaft_capacity_N"]) / float(known[0]["shaft_capacity_N"]) for row in known]
            axes.semilogx(ages, values, "o", color=colour, label=name if k == 0 else None,
                          linestyle="-" if i < len(style.CYCLE) else "--")
    axes.set_xlabel("age [s] (age 0 drawn at 100 s)")
    axes.set_ylabel("shaft capacity over that at age 0 [-]")
    axes.axhline(1., color=style.GREY, linewidth=0.6)
    write_legend(axes)
    print(style.save(figure, folder, "capacity"))


def draw_radial_stress(runs, folder):
    """Mean radial stress on the shaft against age, of each run."""
    figure, axes = style.new_figure(3.8)
    names = list(dict.fromkeys(series.name for series, _, _ in runs))
    drawn = set()
    for series, _, run_folder in runs:
        if not (run_folder / "shaft.csv").is_file():
            continue
        ages, _, means = shaft.compute_means(RunFolder(run_folder).read_table("shaft.csv"), "radial_stress_Pa")
        i = names.index(series.name)
        axes.semilogx(ages[ages > 0], means[ages > 0] / 1e6, color=style.CYCLE[i % len(style.CYCLE)],
                      linestyle="-" if i < len(style.CYCLE) else "--",
                      label=None if series.name in drawn else series.name)
        drawn.add(series.name)
    axes.set_xlabel("age [s]")
    axes.set_ylabel("mean radial stress on the shaft [MPa]")
    axes.set_yscale("log")
    write_legend(axes)
    print(style.save(figure, folder, "radial_stress"))


def main():
    options = parse_arguments()
    chosen = [series for series in pile_runs.SERIES if not options.only or series.name in options.only]
    unknown = set(options.only or []) - {series.name for series in pile_runs.SERIES}
    if unknown:
        sys.exit(f"study.py: --only: no series {', '.join(sorted(unknown))}")
    runs = [(series, seed, Path(options.output).resolve() / name) for series in chosen
            for name, seed in pile_runs.list_runs(series)]
    if not options.draw:
        with ThreadPoolExecutor(options.processes) as pool:  # threads that wait for processes
            list(pool.map(lambda one: pile_runs.run(options.programs, *one), runs))
    documents = Path(options.documents)
    capacities = collect_capacities(runs)
    write_table(documents / "capacities.csv", capacities)
    write_table(documents / "series.csv", summarise(capacities))
    write_table(documents / "fractures.csv", count_fractures(runs))
    ring_rows = rings.collect(runs)
    write_table(documents / "rings.csv", ring_rows)
    drawn = [name for name in ("installed", "withdrawn") if any(row["series"] == name for row in ring_rows)]
    if drawn:
        rings.draw(ring_rows, drawn, documents / "figures")
    if capacities:
        draw_capacities(capacities, documents / "figures")
        draw_radial_stress(runs, documents / "figures")
    (documents / "state.json").write_text(json.dumps(
        {name: pile_runs.is_finished(folder) for _, _, folder in runs for name in [folder.name]}, indent=1) + "\n",
        encoding="utf-8")


if __name__ == "__main__":
    sys.exit(main())

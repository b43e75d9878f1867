"""What has been made so far: rows.csv and results.csv of one size, and docs/paper.md with tables and figures of both.

An experiment that is made again replaces its own rows and leaves those of the others.
"""

import csv

from .statements import NOT_JUDGED, format_number

TITLES = {"fig1": "Fig. 1: the split grain", "fig2": "Fig. 2: the REV and its grading",
          "fig3": "Fig. 3: crack velocities against normalised stress",
          "fig5": "Fig. 5: sorted times to fracture", "fig6": "Fig. 6: creep in the oedometer at 21.7 MPa",
          "fig7": "Fig. 7: the first dynamic computation",
          "fig8": "Fig. 8: fluctuation against the number of grains broken at once",
          "triaxial": "Triaxial compression from 10 MPa", "fig9": "Fig. 9: triaxial creep",
          "fig10": "Fig. 10: fluctuation in triaxial creep", "fig11": "Fig. 11: deviations in all dynamic computations",
          "walls": "Figs. 6 to 8 between rigid walls", "compression": "Beyond the paper: compression to 60 MPa",
          "waiting": "Beyond the paper: creep beside compression", "sensitivity": "Beyond the paper: what choices do to creep"}
SHORT = ("figure", "statement", "paper", "ours", "scatter", "agrees")  # results.csv
TABLE = (*SHORT[1:], "seeds", "bounds")  # of the page
COLUMNS = ("figure", *TABLE, "made with", "faults")  # rows.csv


def write_rows(folder, results, version):
    """Adds the rows to those that the folder has of other figures; returns all."""
    made = [_make_line(row, results, version) for row in results.sort_rows()]
    rows = made + [row for row in read_rows(folder) if row["figure"] not in {line["figure"] for line in made}]
    rows.sort(key=lambda row: list(TITLES).index(row["figure"]))
    for name, columns in (("rows.csv", COLUMNS), ("results.csv", SHORT)):
        with open(folder / name, "w", newline="", encoding="utf-8") as stream:
            writer = csv.DictWriter(stream, columns, extrasaction="ignore", lineterminator="\n")
            writer.writeheader()
            writer.writerows(rows)
    return rows


def read_rows(folder):
    """rows.csv, none if there is no such file."""
    if not (folder / "rows.csv").is_file():
        return []
    with open(folder / "rows.csv", newline="", encoding="utf-8") as stream:
        return list(csv.DictReader(stream))


def _make_line(row, results, version):
    statement = row.statement
    unit = f" [{statement.unit}]" if statement.unit != "-" else ""
    bounds = f"{statement.low:g} to {statement.high:g}: " if statement.low == statement.low else ""
    return {"figure": statement.figure, "statement": statement.text + unit, "paper": statement.paper,
            "ours": format_number(row.ours), "scatter": format_number(row.scatter), "agrees": results.judge(row),
            "seeds": len(row.values), "bounds": bounds + statement.reason, "made with": version,
            "faults": "; ".join(row.faults)}


def write_document(file, introduction, parts):
    """@param parts  (heading, folder of write_rows, size); links to figures are relative to the document"""
    lines = [introduction.strip(), ""]
    for heading, folder, size in parts:
        lines += [f"## {heading}", ""]
        rows = read_rows(folder)
        missing = [TITLES[figure] for figure in TITLES if figure not in {row["figure"] for row in rows}]
        if missing:
            lines += [f"Not made yet: {'; '.join(missing)}.", ""]
        for figure in dict.fromkeys(row["figure"] for row in rows):
            lines += _describe_figure(figure, [row for row in rows if row["figure"] == figure], size)
            picture = folder / "figures" / f"{figure}.png"
            if picture.is_file():
                lines += [f"![{TITLES[figure]}]({picture.relative_to(file.parent)})", ""]
    file.write_text("\n".join(lines), encoding="utf-8")


def _describe_figure(figure, rows, size):
    lines = [f"### {TITLES[figure]} ({size})", "",
             f"`bash apps/cases/paper/run.sh {size} {figure}`, made with {rows[0]['made with']}", "",
             f"| {' | '.join(TABLE)} |", f"|{'---|' * len(TABLE)}"]
    lines += ["| " + " | ".join(row[name] or NOT_JUDGED for name in TABLE) + " |" for row in rows]
    faults = dict.fromkeys(row["faults"] for row in rows if row["faults"])
    return lines + [""] + [f"- Not finished: {fault}" for fault in faults] + ([""] if faults else [])

"""docs/paper.md: the table of statements with figures, made from the rows of one or two sizes."""

import csv

from .statements import NOT_JUDGED, format_number

TITLES = {"fig1": "Fig. 1: the split grain", "fig2": "Fig. 2: the REV and its grading",
          "fig3": "Fig. 3: crack velocities against normalised stress",
          "fig5": "Fig. 5: sorted times to fracture", "fig6": "Fig. 6: creep in the oedometer at 21.7 MPa",
          "fig7": "Fig. 7: the first dynamic computation",
          "fig8": "Fig. 8: fluctuation against the number of grains broken at once",
          "triaxial": "Triaxial compression from 10 MPa", "fig9": "Fig. 9: triaxial creep",
          "fig10": "Fig. 10: fluctuation in triaxial creep", "fig11": "Fig. 11: deviations in all dynamic computations"}
TABLE = ("statement", "paper", "ours", "scatter", "agrees", "seeds", "bounds")


def write_part(folder, results, size, seeds, version):
    """part.md and rows.csv in the folder of one size: what the document shows of it."""
    rows = results.sort_rows()
    with open(folder / "rows.csv", "w", newline="", encoding="utf-8") as stream:
        writer = csv.writer(stream, lineterminator="\n")
        writer.writerow(("figure", *TABLE))
        for row in rows:
            s = row.statement
            text = s.text + (f" [{s.unit}]" if s.unit != "-" else "")
            writer.writerow((s.figure, text, s.paper, format_number(row.ours), format_number(row.scatter),
                             results.judge(row), len(row.values), _describe_bounds(s)))
    lines = [f"Made with {version}; seeds {', '.join(map(str, seeds))}.", ""]
    lines += [f"- Not finished: {fault}" for fault in results.list_faults()]
    (folder / "part.md").write_text("\n".join(lines) + "\n", encoding="utf-8")


def _describe_bounds(statement):
    if statement.low != statement.low:
        return statement.reason
    return f"{statement.low:g} to {statement.high:g}: {statement.reason}"


def write_document(file, introduction, parts):
    """@param parts  (heading, folder of write_part, size); links to figures are relative to the document"""
    lines = [introduction.strip(), ""]
    for heading, folder, size in parts:
        lines += [f"## {heading}", "", (folder / "part.md").read_text(encoding="utf-8").strip(), ""]
        with open(folder / "rows.csv", newline="", encoding="utf-8") as stream:
            rows = list(csv.DictReader(stream))
        for figure in dict.fromkeys(row["figure"] for row in rows):
            lines += [f"### {TITLES[figure]} ({size})", "", f"`bash apps/cases/paper/run.sh {size} {figure}`", "",
                      f"| {' | '.join(TABLE)} |", f"|{'---|' * len(TABLE)}"]
            lines += ["| " + " | ".join(row[name] or NOT_JUDGED for name in TABLE) + " |"
                      for row in rows if row["figure"] == figure]
            picture = folder / "figures" / f"{figure}.png"
            if picture.is_file():
                lines += ["", f"![{TITLES[figure]}]({picture.relative_to(file.parent)})"]
            lines.append("")
    file.write_text("\n".join(lines), encoding="utf-8")

"""Law: with the macro problem distributed over the ranks and solved iteratively, the history is that of the direct
solver on every rank, to the linear solver's tolerance, until the first fracture.

Grains slide here (Table 1's friction, rest by the default criterion): a REV answers strains that differ by rounding with the
same bits, and nearly dependent secant pairs are left out, so that neither makes much of the last digits.
"""

import argparse
import csv
import sys
import tempfile
from pathlib import Path

sys.dont_write_bytecode = True
sys.path.insert(0, str(Path(__file__).resolve().parent))

import small_case  # noqa: E402

# The linear solver stops at 1e-10 of its right-hand side; the table has ten digits.
TOLERANCE = 1e-9


def write_case(folder):
    case = Path(folder) / "two_elements.prm"
    text = small_case.CASE.replace("set Height = 0.02", "set Height = 0.02\n  set Cells = 1, 1, 2")
    text += "subsection Strength\n  set Reference strength = 8e9\nend\n"  # several increments without a fracture
    case.write_text(text, encoding="utf-8")
    return case


def read_until_fracture(output):
    """Rows of history.csv before a grain broke, as numbers."""
    with open(output / "history.csv", newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    whole = [row for row in rows if int(row["broken_instant"]) + int(row["broken_delayed"]) == 0]
    return whole, len(rows)


def compare(first, second):
    """Largest difference of a column over the column's size, and its name."""
    worst, name = 0.0, ""
    for column in first[0]:
        if not any(part in column for part in ("force", "displacement", "stress", "strain", "void_ratio")):
            continue
        pairs = [(float(a[column]), float(b[column])) for a, b in zip(first, second) if float(a["time_s"]) >= 0]
        pairs = [(a, b) for a, b in pairs if a == a]  # forces before the first step are not a number
        unit = "strain" if "strain" in column else column.split("_")[-1]
        size = max((abs(float(row[other])) for row in first for other in row
                    if ("strain" in other if unit == "strain" else other.endswith(unit)) and row[other] != "nan"),
                   default=0.0)
        difference = max((abs(a - b) for a, b in pairs), default=0.0)
        if size > 0 and difference / size > worst:
            worst, name = difference / size, column
    return worst, name


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--source")
    parser.add_argument("--build", required=True)
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        case = write_case(folder)
        replicated, distributed = Path(folder) / "replicated", Path(folder) / "distributed"
        small_case.run(options.build, 1, case, "--output", replicated)
        small_case.run(options.build, 2, case, "--set", "Problem/Is distributed=true", "--output", distributed)
        (one, n_rows), (two, _) = read_until_fracture(replicated), read_until_fracture(distributed)
        if len(one) < 3 or len(one) == n_rows:
            raise AssertionError(f"{len(one)} of {n_rows} rows before the first fracture: nothing to compare")
        if len(one) != len(two):
            raise AssertionError(f"first fracture after {len(one)} rows and after {len(two)}")
        worst, name = compare(one, two)
        print(f"until the first fracture, {len(one)} rows: {worst:.1e} at most ({name or 'no column'})")
        if not 0 <= worst <= TOLERANCE:
            raise AssertionError(f"more than {TOLERANCE:g}")


if __name__ == "__main__":
    main()

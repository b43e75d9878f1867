"""Law: docs/parameters.md is what the programs' templates say. Exit status 77: the programs have not been built.

With --write it is written anew.
"""

import argparse
import re
import subprocess
import sys
from pathlib import Path

PROGRAMS = {"slowsand-rev": "One REV through a laboratory test.",
            "slowsand-bvp": "A boundary-value problem with a REV at each Gauss point. The sections of the REV are those of "
                            "slowsand-rev."}
HEADING = """# Parameters

Made by `bash docs/parameters.sh` from the programs' templates; do not edit. Sections are written `Section/Name`, as
`--set "Section/Name=value"` takes them. Stages and conditions are shown once: `Stage 2` and so on take the same names.
"""
REPEATED = re.compile(r"(Stage|Condition) ([2-9]|\d\d+)$")


def read_template(text):
    """(path of sections, name, default, text with units and range) of each parameter."""
    sections, comment, parameters = [], [], []
    for line in (line.strip() for line in text.splitlines()):
        if line.startswith("#"):
            comment.append(line.lstrip("# "))
        elif line.startswith("subsection "):
            sections.append(line[len("subsection "):])
            comment = []
        elif line == "end":
            sections.pop()
        elif line.startswith("set "):
            name, default = (part.strip() for part in line[len("set "):].split("=", 1))
            parameters.append(("/".join(sections), name, default, " ".join(comment)))
            comment = []
    return [(section, name, default, clean(comment)) for section, name, default, comment in parameters
            if not any(REPEATED.match(part) for part in section.split("/"))]


def clean(comment):
    return comment.replace("Listing of Parameters ---------------------", "").strip()


def make_tables(program, parameters):
    lines = [f"## {program}", "", PROGRAMS[program], ""]
    for section in dict.fromkeys(parameter[0] for parameter in parameters):
        lines += [f"### {section or 'At the top'}", "", "| name | default | meaning, units, range |", "|---|---|---|"]
        for _, name, default, text in (parameter for parameter in parameters if parameter[0] == section):
            cells = (name, f"`{default}`" if default else "", text)
            lines.append("| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |")
        lines.append("")
    return lines


def find_program(build, name):
    return next((path for path in (build / name, build / "apps" / name) if path.is_file()), None)


def make_document(build):
    """The document, or None if a program is missing."""
    lines = [HEADING]
    for name in PROGRAMS:
        program = find_program(build, name)
        if program is None:
            return None
        template = subprocess.run([str(program), "--template"], capture_output=True, text=True, timeout=60, check=True)
        lines += make_tables(name, read_template(template.stdout))
    return "\n".join(lines)


def check_self():
    """A parameter of a section, with a text of two lines, comes out whole; a second stage does not."""
    text = ("# Of all. Units: [-].\nset Seed = 1\nsubsection A\n  subsection Stage 1\n    # Long\n    # text.\n"
            "    set B = 2, 3\n  end\n  subsection Stage 2\n    set B = 4\n  end\nend\n")
    expected = [("", "Seed", "1", "Of all. Units: [-]."), ("A/Stage 1", "B", "2, 3", "Long text.")]
    return [] if read_template(text) == expected else [f"self-test: {read_template(text)}"]


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--source", type=Path, required=True)
    parser.add_argument("--build", type=Path, required=True)
    parser.add_argument("--write", action="store_true")
    options = parser.parse_args()
    faults = check_self()
    document = make_document(options.build.resolve())
    file = options.source.resolve() / "docs" / "parameters.md"
    if document is None:
        print(f"skipped: no slowsand-rev and slowsand-bvp in {options.build}")
        return 1 if faults or options.write else 77
    if options.write:
        file.write_text(document, encoding="utf-8")
    elif not file.is_file() or file.read_text(encoding="utf-8") != document:
        faults.append("docs/parameters.md is not what the programs' templates say: bash docs/parameters.sh")
    print("\n".join(faults) or f"{file} is up to date")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())

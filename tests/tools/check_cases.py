"""Law: the programs accept every case they are shipped with, and refuse it with one parameter misspelt.

A case named rev_*.prm belongs to slowsand-rev, bvp_*.prm to slowsand-bvp. Exit status 77: no program has been built.
"""

import argparse
import subprocess
import sys
import tempfile
from pathlib import Path

PROGRAMS = {"rev": "slowsand-rev", "bvp": "slowsand-bvp"}


def run_check(program, case, root):
    """Exit status and messages of PROGRAM --check CASE, run where the README runs it."""
    done = subprocess.run([str(program), "--check", str(case)], cwd=root, capture_output=True, text=True, timeout=120)
    return done.returncode, (done.stdout + done.stderr).strip()


def misspell(text):
    """The case with the first parameter's name misspelt, or None if there is no parameter."""
    lines = text.splitlines()
    for i, line in enumerate(lines):
        if line.strip().startswith("set ") and "=" in line:
            lines[i] = line.replace("=", "misspelt =", 1)
            return "\n".join(lines) + "\n"
    return None


def check_case(program, case, root):
    """What is wrong with one case."""
    status, messages = run_check(program, case, root)
    if status != 0:
        return [f"{case.name}: {program.name} --check gives {status}\n{messages}"]
    wrong = misspell(case.read_text(encoding="utf-8"))
    if wrong is None:
        return [f"{case.name}: sets no parameter"]
    with tempfile.TemporaryDirectory() as folder:
        copy = Path(folder) / case.name
        copy.write_text(wrong, encoding="utf-8")
        status, messages = run_check(program, copy, root)
    return [] if status == 2 else [
        f"{case.name}: misspelt, {program.name} --check gives {status} instead of 2\n{messages}"]


def find_program(build, name):
    """Where the build put a program, or None."""
    return next((path for path in (build / name, build / "apps" / name) if path.is_file()), None)


def check_folder(folder, build, root):
    """(what is wrong, what was skipped, number of cases checked)."""
    faults, skipped, n_checked = [], [], 0
    if not any(folder.glob("*.prm")):
        faults.append(f"{folder}: no cases")
    for case in sorted(folder.glob("*.prm")):
        name = PROGRAMS.get(case.stem.split("_")[0])
        if name is None:
            faults.append(f"{case.name}: a case is named after its program, rev_*.prm or bvp_*.prm")
            continue
        program = find_program(build, name)
        if program is None:
            skipped.append(f"{case.name}: not checked, {name} has not been built in {build}")
            continue
        faults += check_case(program, case, root)
        n_checked += 1
    return faults, skipped, n_checked


FAKE_PROGRAM = """#!/bin/bash
grep -q misspelt "$2" && exit {on_misspelt}
grep -q wrong "$2" && exit 2
exit 0
"""


def check_self():
    """A case that is refused, one named after no program and a program that accepts a misspelling are all found."""
    faults = []
    with tempfile.TemporaryDirectory() as folder:
        build = Path(folder)
        for name, on_misspelt in (("slowsand-rev", 2), ("slowsand-bvp", 0)):
            (build / name).write_text(FAKE_PROGRAM.format(on_misspelt=on_misspelt), encoding="utf-8")
            (build / name).chmod(0o755)
        for name, text in (("rev_good", "set A = 1\n"), ("rev_bad", "set A = wrong\n"), ("bvp_lenient", "set A = 1\n"),
                           ("other", "set A = 1\n"), ("rev_empty", "\n")):
            (build / f"{name}.prm").write_text(text, encoding="utf-8")
        found = {fault.split(".prm")[0] for fault in check_folder(build, build, build)[0]}
    for name in {"rev_bad", "bvp_lenient", "other", "rev_empty"} ^ found:
        faults.append(f"self-test: {name} was judged wrongly")
    return faults


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--source", type=Path, required=True)
    parser.add_argument("--build", type=Path, required=True)
    options = parser.parse_args()
    source = options.source.resolve()
    faults, skipped, n_checked = check_self(), [], 0
    for folder in ("apps/cases", "apps/cases/paper"):
        found = check_folder(source / folder, options.build.resolve(), source)
        faults, skipped, n_checked = faults + found[0], skipped + found[1], n_checked + found[2]
    print("\n".join(faults + skipped + [f"{n_checked} cases checked"]))
    if faults:
        return 1
    return 0 if n_checked else 77


if __name__ == "__main__":
    sys.exit(main())

"""Law: files stay short and named by the noun they own; headers are guarded and open no namespace."""

import re
import sys

sys.dont_write_bytecode = True

import source_tree  # noqa: E402

CODE = (".cc", ".h", ".py", ".sh", ".cmake", ".txt")
LONGEST_FILE = 400  # lines; aim at 80-200
LONGEST_MAIN = 100  # lines of a program's own file in apps/: a main only reads, calls and reports
FORBIDDEN = {"src", "include", "core", "utils", "util", "helpers", "helper", "common", "misc", "manager", "legacy"}
PARTS = {"utils", "util", "helpers", "helper", "misc", "manager", "legacy"}  # forbidden inside a name too


def check_name(path):
    """Forbidden words among the folders and in the file's name."""
    for part in list(path.parts[:-1]) + [path.name.split(".")[0]]:
        words = re.split(r"[_-]", part.lower())
        if part.lower() in FORBIDDEN or PARTS & set(words) or part.startswith("new_") or re.search(r"_v\d+$", part):
            yield f"{path}: the name '{part}' says nothing about what the file owns"


def check_text(path, text):
    """Length of any file; guard and namespaces of headers."""
    n_lines = text.count("\n")
    is_main = path.parts[0] == "apps" and re.fullmatch(r"slowsand[-_]\w+\.cc", path.name)
    limit = LONGEST_MAIN if is_main else LONGEST_FILE
    if n_lines > limit:
        yield f"{path}: {n_lines} lines, at most {limit}"
    if path.suffix == ".h":
        if "#pragma once" not in text.splitlines():
            yield f"{path}: #pragma once is missing"
        for number, line in enumerate(text.splitlines(), start=1):
            if re.match(r"\s*using\s+namespace\b", line):
                yield f"{path}:{number}: 'using namespace' in a header reaches everybody who includes it"


def is_code(root, path):
    """Code by its ending, or a script without one."""
    return path.suffix in CODE or (path.suffix == "" and (root / path).read_bytes()[:2] == b"#!")


def check_tree(root):
    faults, n_files = [], 0
    for path in source_tree.list_files(root):
        faults += check_name(path)
        if is_code(root, path):
            n_files += 1
            faults += check_text(path, (root / path).read_text(encoding="utf-8"))
    return faults, n_files


PLANTED = {  # file -> (text, is it a fault?)
    "dem/long.cc": ("x\n" * 401, True), "dem/just.cc": ("x\n" * 400, False),
    "apps/slowsand-rev.cc": ("x\n" * 101, True),
    "apps/long_script": ("#!/bin/bash\n" + "x\n" * 400, True), "docs/long.md": ("x\n" * 900, False),
    "src/a.cc": ("", True), "dem/utils.h": ("#pragma once\n", True), "dem/rev_manager.cc": ("", True),
    "fem/new_solver.cc": ("", True), "fem/solver_v2.cc": ("", True), "fem/solver.cc": ("", False),
    "dem/no_guard.h": ("int i;\n", True), "dem/guarded.h": ("#pragma once\n", False),
    "dem/opens.h": ("#pragma once\n  using namespace std;\n", True),
    "dem/opens.cc": ("using namespace std;\n", False), "legacy/notes.md": ("", True),
}


if __name__ == "__main__":
    sys.exit(source_tree.run_check(__doc__, check_tree, PLANTED, "keep the house's style"))

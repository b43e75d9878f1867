"""Law: no room includes what it must not know. dem: Eigen, Random123, HDF5 in one file; fem: no grains; apps: all.

Debian puts every library under /usr/include, so the compiler would accept a wrong include.
"""

import re
import sys

sys.dont_write_bytecode = True

import source_tree  # noqa: E402

INCLUDE = re.compile(r'^\s*#\s*include\s*([<"])([^>"]+)[>"]')

STANDARD = set("""
algorithm any array atomic barrier bit bitset cassert cctype cerrno cfenv cfloat charconv chrono cinttypes climits
clocale cmath codecvt compare complex concepts condition_variable coroutine csetjmp csignal cstdarg cstddef cstdint
cstdio cstdlib cstring ctime cuchar cwchar cwctype deque exception execution filesystem format forward_list fstream
functional future initializer_list iomanip ios iosfwd iostream istream iterator latch limits list locale map memory
memory_resource mutex new numbers numeric optional ostream queue random ranges ratio regex scoped_allocator
semaphore set shared_mutex source_location span sstream stack stdexcept stop_token streambuf string string_view
syncstream system_error thread tuple type_traits typeindex typeinfo unordered_map unordered_set utility valarray
variant vector version
""".split())

DEAL_II = ("deal.II/", "mpi.h", "Epetra", "Amesos", "Teuchos", "ml_")
POSIX = ("unistd.h", "sys/", "fcntl.h", "signal.h")
ROOMS = {  # room -> the rooms whose files it may include, the libraries it may include
    "dem": (("dem",), ("Eigen/", "Random123/")),
    "fem": (("fem",), DEAL_II + ("fmt/",)),
    "coupling": (("coupling", "dem", "fem"), DEAL_II + ("Eigen/", "fmt/")),
    "apps": (("apps", "coupling", "dem", "fem"), DEAL_II + ("Eigen/", "fmt/", "CLI/", "nlohmann/") + POSIX),
}
# The one file of a room that knows HDF5; it also flushes to disk before a file gets its name.
HDF5 = ("hdf5.h", "hdf5_hl.h", "unistd.h", "fcntl.h", "sys/stat.h")
LANES = ("immintrin.h",)  # the compiler's own vector instructions
EXCEPTIONS = {"dem/snapshot.cc": HDF5, "fem/hdf5_file.cc": HDF5,
              "dem/large_pages.cc": ("sys/mman.h",), "dem/lanes.h": LANES,
              "dem/single_lanes.h": LANES, "dem/pair_seeker.cc": LANES}
TEST_LIBRARIES = ("gtest/", "benchmark/", "hdf5.h")


def find_rule(path):
    """(rooms, libraries) allowed in a file, or None where there is no rule. Tests know what their room knows."""
    parts = path.parts
    if parts[0] in ROOMS:
        rooms, libraries = ROOMS[parts[0]]
        return rooms, libraries + EXCEPTIONS.get(path.as_posix(), ())
    if parts[0] != "tests":
        return None
    if len(parts) > 2 and parts[2] in ROOMS:
        rooms, libraries = ROOMS[parts[2]]
        return rooms + ("tests",), libraries + TEST_LIBRARIES + POSIX
    rooms, libraries = ROOMS["apps"]
    return rooms + ("tests",), libraries + TEST_LIBRARIES


def check_include(root, path, bracket, name, rule):
    """What is wrong with one include, or None."""
    rooms, libraries = rule
    if name.split("/")[0] in set(ROOMS) | {"tests"} and "/" in name:
        if bracket == "<":
            return f"own file in angle brackets: <{name}>"
        if name.split("/")[0] not in rooms:
            return f"'{path.parts[0]}' must not know '{name.split('/')[0]}': \"{name}\""
        return None if (root / name).is_file() else f'no such file: "{name}"'
    if bracket == '"':
        return f'own files are included by their path from the root: "{name}"'
    if name in STANDARD or any(name.startswith(library) for library in libraries):
        return None
    return f"library not allowed here: <{name}>"


def check_tree(root):
    """All wrong includes as 'file:line: what'."""
    faults, n_files = [], 0
    for path in source_tree.list_files(root):
        if path.suffix not in (".cc", ".h"):
            continue
        rule = find_rule(path)
        if rule is None:
            continue
        n_files += 1
        for number, line in enumerate((root / path).read_text(encoding="utf-8").splitlines(), start=1):
            match = INCLUDE.match(line)
            fault = match and check_include(root, path, match.group(1), match.group(2), rule)
            if fault:
                faults.append(f"{path}:{number}: {fault}")
    return faults, n_files


PLANTED = {  # file -> (include line, is it a fault?)
    "dem/a.cc": ("#include <deal.II/base/tensor.h>", True), "dem/b.cc": ("#include <hdf5.h>", True),
    "dem/c.h": ("#  include <mpi.h>", True), "dem/d.cc": ('#include "fem/x.h"', True),
    "dem/e.cc": ('#include "x.h"', True), "dem/f.cc": ("#include <fmt/format.h>", True),
    "dem/g.cc": ('#include "dem/absent.h"', True), "dem/h.cc": ("#include <dem/x.h>", True),
    "dem/large_pages.cc": ("#include <sys/mman.h>", False), "dem/pages.cc": ("#include <sys/mman.h>", True),
    "dem/snapshot.cc": ("#include <hdf5.h>", False), "dem/i.cc": ("#include <Eigen/Sparse>", False),
    "dem/j.cc": ("#include <vector>", False), "dem/k.cc": ('#include "dem/x.h"', False), "dem/x.h": ("", False),
    "fem/a.cc": ('#include "dem/x.h"', True), "fem/b.cc": ('#include "coupling/x.h"', True),
    "fem/c.cc": ("#include <Eigen/Dense>", True), "fem/d.cc": ("#include <deal.II/base/tensor.h>", False),
    "fem/x.h": ("", False), "fem/e.cc": ("#include <hdf5.h>", True),
    "fem/hdf5_file.cc": ("#include <hdf5.h>", False), "coupling/x.h": ('#include "dem/x.h"', False),
    "coupling/a.cc": ('#include "apps/x.h"', True), "coupling/b.cc": ("#include <hdf5.h>", True),
    "apps/x.h": ('#include "coupling/x.h"', False), "apps/a.cc": ("#include <CLI/CLI.hpp>", False),
    "tests/unit/dem/a.cc": ('#include "fem/x.h"', True), "tests/unit/dem/b.cc": ("#include <gtest/gtest.h>", False),
    "tests/unit/fem/a.cc": ('#include "coupling/x.h"', True), "tests/unit/coupling/a.cc": ('#include "dem/x.h"', False),
}


if __name__ == "__main__":
    planted = {name: (f"// first line\n{line}\n", is_fault) for name, (line, is_fault) in PLANTED.items()}
    sys.exit(source_tree.run_check(__doc__, check_tree, planted, "include only what their room may know"))

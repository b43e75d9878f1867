"""Packings as text: "# cell Lx Ly Lz" [m], then "x y z radius" [m] a line; and as the data files of LAMMPS's family."""

from dataclasses import dataclass


@dataclass
class Packing:
    edges: list  # [m]
    grains: list  # (x, y, z, radius) [m]


def read_packing(path):
    """Throws ValueError with the file's name where the cell is missing or a line is none of four numbers."""
    edges, grains = None, []
    for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), start=1):
        words = line.split()
        if words[:2] == ["#", "cell"]:
            edges = [float(word) for word in words[2:5]]
        elif words and words[0][0] != "#":
            if len(words) != 4:
                raise ValueError(f"{path}:{number}: not 'x y z radius'")
            grains.append(tuple(float(word) for word in words))
    if edges is None:
        raise ValueError(f"{path}: no line '# cell Lx Ly Lz'")
    return Packing(edges, grains)


def write_packing(path, packing):
    lines = ["# cell " + " ".join(repr(edge) for edge in packing.edges)]
    lines += [" ".join(repr(value) for value in grain) for grain in packing.grains]
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")


def replicate(packing, times):
    """The same packing several times side by side along each axis: the same forces, more grains."""
    grains = [tuple(place + edge * shift for place, edge, shift in zip(grain, packing.edges, (i, j, k))) + (grain[3],)
              for i in range(times[0]) for j in range(times[1]) for k in range(times[2]) for grain in packing.grains]
    return Packing([edge * n for edge, n in zip(packing.edges, times)], grains)


def write_data_file(path, packing, density):
    """For read_data of LAMMPS (atom_style sphere) and LIGGGHTS (granular); density [kg/m3]."""
    head = ["periodic packing", "", f"{len(packing.grains)} atoms", "1 atom types", ""]
    head += [f"0 {edge!r} {axis}lo {axis}hi" for axis, edge in zip("xyz", packing.edges)]
    atoms = [f"{i} 1 {2 * r!r} {density!r} {x % packing.edges[0]!r} {y % packing.edges[1]!r} {z % packing.edges[2]!r}"
             for i, (x, y, z, r) in enumerate(packing.grains, start=1)]
    path.write_text("\n".join(head + ["", "Atoms", ""] + atoms) + "\n", encoding="utf-8")

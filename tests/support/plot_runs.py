"""Run folders of the documented format with known content, for the tests of slowsand-plot."""

import csv
import shutil
from pathlib import Path

import h5py
import numpy as np

COMPONENTS = ("xx", "yy", "zz", "xy", "yz", "xz")
SLOPE = 0.0025  # axial creep strain per decade of time [-]
CREEP_START = 37.  # [s]
AXIAL, LATERAL = 21.7e6, 9.0e6  # stresses during creep [Pa]
CRACK_VELOCITY = 1e-8  # [m/s]
PARAMETERS = """set Seed = 1
subsection Grains
  set Comminution limit = 1.16e-4
end
subsection Loading
  set Number of stages = 2
  subsection Stage 1
    set Kind = oedometric
  end
  subsection Stage 2
    set Kind = creep
  end
end
"""


def make_history(slope=SLOPE, scatter=0.):
    """Loading to the creep stress in stage 1, then strain = slope * log10(1 + t / 1 s), no strain at t = 0."""
    loading = np.linspace(0.02, 1., 25)
    creep_time = np.concatenate(([0.], np.logspace(-1, 6, 141)))
    n = len(creep_time)
    noise = scatter * np.random.default_rng(5).standard_normal(n) * (creep_time > 0)
    creep_strain = np.where(creep_time > 0, slope * np.log10(np.maximum(creep_time, 1e-300)) + 2 * slope, 0.) + noise
    broken = np.floor(0.8 * np.arange(n) ** 1.1).astype(int)
    return {"time": np.concatenate((loading * CREEP_START, CREEP_START + creep_time)),
            "stage": np.concatenate((np.full(25, 1), np.full(n, 2))),
            "axial": np.concatenate((0.08 * loading**0.7, 0.08 + creep_strain)),
            "axial_stress": np.concatenate((AXIAL * loading, np.full(n, AXIAL))),
            "lateral_stress": np.concatenate((LATERAL * loading, np.full(n, LATERAL))),
            "instant": np.concatenate((np.floor(30 * np.maximum(loading - 0.6, 0)), 12 + broken // 9)).astype(int),
            "delayed": np.concatenate((np.zeros(25), broken)).astype(int)}


def _tensors(history, share=1.):
    """Columns strain_xx .. stress_xz_Pa of an oedometer; `share` scales the strain of one Gauss point."""
    zero = np.zeros_like(history["time"])
    strain = [zero, zero, share * history["axial"], zero, zero, zero]
    stress = [history["lateral_stress"]] * 2 + [history["axial_stress"], zero, zero, zero]
    return [(f"strain_{c}", v) for c, v in zip(COMPONENTS, strain)] + [
        (f"stress_{c}_Pa", v) for c, v in zip(COMPONENTS, stress)]


def _write_csv(path, columns):
    with open(path, "w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow([name for name, _ in columns])
        writer.writerows(zip(*[[v if isinstance(v, str) else repr(float(v)) for v in values] for _, values in columns]))


def write_rev_run(folder, **options):
    """A run of slowsand-rev: history, parameters, first and last snapshot."""
    folder = Path(folder)
    folder.mkdir(parents=True)
    history = make_history(**options)
    n = len(history["time"])
    with_fines = 1.65 * np.exp(-history["axial"]) - 1.
    kind = ["load"] * 25 + ["ageing" if i % 2 else "load" for i in range(n - 25)]
    _write_csv(folder / "history.csv", [("time_s", history["time"]), ("stage", history["stage"]), ("kind", kind),
                                        ("cycles", 1000. * np.arange(n))] + _tensors(history) + [
        ("void_ratio", (1 + with_fines) / (1 - 2e-4 * (history["instant"] + history["delayed"])) - 1.),
        ("void_ratio_with_fines", with_fines), ("grains", np.full(n, 216)), ("broken_instant", history["instant"]),
        ("broken_delayed", history["delayed"]), ("coordination", np.full(n, 6.)),
        ("unbalanced_ratio", np.full(n, 1e-5))])
    (folder / "parameters.prm").write_text(PARAMETERS, encoding="utf-8")
    (folder / "summary.json").write_text("{}", encoding="utf-8")
    write_snapshot(folder / "snapshots" / "initial.h5", 0., broken=())
    write_snapshot(folder / "snapshots" / "final.h5", 1e6, broken=(5, 50, 95, 126, 155, 200, 215))
    write_tables(folder)
    return folder


def write_bvp_run(folder, samples, mesh="two", points=8):
    """A run of slowsand-bvp with a probe at each Gauss point; fields are deal.II's own from `samples`."""
    folder = Path(folder)
    (folder / "fields").mkdir(parents=True)
    history = make_history()
    n = len(history["time"])
    columns = [("time_s", history["time"]), ("stage", history["stage"]), ("step", np.arange(n)),
               ("newton_iterations", np.full(n, 2)), ("rev_evaluations", np.full(n, 24)),
               ("broken_instant", history["instant"]), ("broken_delayed", history["delayed"]),
               ("top_force_z_N", -history["axial_stress"] * np.pi * 0.01**2),
               ("top_displacement_z_m", -0.02 * history["axial"])]
    shares = 1. + 0.1 * np.linspace(-1., 1., points)  # their mean is 1: the mean slope stays the known one
    for i, share in enumerate(shares):
        columns += [(f"point_{i}_{name}", values * (share if name.startswith("stress") and "xx" in name else 1.))
                    for name, values in _tensors(history, share)]
        write_snapshot(folder / "snapshots" / f"point_{i}_initial.h5", 0., broken=())
        write_snapshot(folder / "snapshots" / f"point_{i}_final.h5", 1e6, broken=range(i))
    _write_csv(folder / "history.csv", columns)
    (folder / "parameters.prm").write_text(PARAMETERS, encoding="utf-8")
    for file in Path(samples).glob(f"{mesh}_*"):
        shutil.copy(file, folder / "fields")
    record = (Path(samples) / f"{mesh}.pvd").read_text(encoding="utf-8")
    (folder / "fields.pvd").write_text(record.replace('file="', 'file="fields/'), encoding="utf-8")
    return folder


# Three dynamic computations after fractures: grains, rise and drop of the axial stress [Pa]. An output of no grain and a
# disturbance without a controlled stress stand between them.
DISTURBANCES = ((30, 0.2e6, -0.6e6), (5, 0.02e6, -0.1e6), (1, 0., -0.04e6))


def write_tables(folder):
    """breakage.csv, jumps.csv, fractures.csv with known content."""
    time = np.concatenate(([0., 0.], np.logspace(0, 6, 25)))
    decades = np.log10(np.maximum(time, 1.))
    columns = [("time_s", time), ("stage", np.full(27, 2))]
    for name, scale in (("hardin", 0.01), ("hardin_with_fines", 0.02), ("einav", 0.005), ("einav_with_fines", 0.01)):
        measure, _, fines = name.partition("_")
        columns.append((f"relative_breakage_{measure}{'_' + fines if fines else ''}", scale * decades))
    _write_csv(folder / "breakage.csv", columns)
    nothing = [float("nan")] * 5
    rows = [(30, "delayed", *DISTURBANCES[0][1:]), (0, "none", 0., 0.), (5, "instant", *DISTURBANCES[1][1:]),
            (8, "instant", float("nan"), float("nan")), (1, "delayed", *DISTURBANCES[2][1:])]
    columns = [("jump", np.arange(1, 6)), ("stage", [2] * 5), ("broken", [row[0] for row in rows]),
               ("cause", [row[1] for row in rows])]
    for index, name in ((2, "largest"), (3, "smallest")):
        columns += [(f"{name}_deviation_{c}_Pa", [row[index] for row in rows] if c == "zz" else nothing)
                    for c in COMPONENTS]
    _write_csv(folder / "jumps.csv", columns)
    _write_csv(folder / "fractures.csv", [
        ("time_s", [1., 1., 2., 3.]), ("cause", ["delayed", "delayed", "instant", "instant"]),
        ("generation", [0, 0, 0, 1]), ("diameter_m", [0.27e-3, 0.2e-3, 0.27e-3, 0.12e-3])])


def make_siblings(centre, radius):
    """Centres and radii of the fourteen siblings: six large at an octahedron's corners, eight small on diagonals."""
    axes = np.vstack([np.eye(3), -np.eye(3)])
    diagonals = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]) / np.sqrt(3.)
    centres = np.vstack([(2 - np.sqrt(2)) * radius * axes, 0.769907 * radius * diagonals]) + centre
    return centres, np.concatenate((np.full(6, (np.sqrt(2) - 1) * radius), np.full(8, 0.230093 * radius)))


def write_snapshot(path, time, broken):
    """A cubic packing of 216 grains of four sizes in a cell of 1.5 mm; the grains `broken` are split."""
    path.parent.mkdir(exist_ok=True)
    spacing = 0.25e-3
    position = (np.stack(np.meshgrid(*[np.arange(6)] * 3, indexing="ij"), axis=-1).reshape(-1, 3) + 0.5) * spacing
    radius = np.resize([0.135e-3, 0.125e-3, 0.115e-3, 0.1e-3, 0.12e-3], 216)
    generation = np.zeros(216, dtype=int)
    whole = np.setdiff1d(np.arange(216), list(broken))
    parts = [make_siblings(position[i], radius[i]) for i in broken]
    position = np.vstack([position[whole]] + [p for p, _ in parts])
    radius = np.concatenate([radius[whole]] + [r for _, r in parts])
    generation = np.concatenate([generation[whole]] + [np.ones(14, dtype=int) for _ in parts])
    with h5py.File(path, "w") as file:
        file.attrs["format"] = np.string_("slowsand-rev")
        file.attrs["format_version"], file.attrs["time_s"], file.attrs["seed"] = 1, time, 1
        file["/cell/matrix"] = 6 * spacing * np.eye(3)
        file["/cell/matrix"].attrs["kind"] = "periodic"
        # Cracks that grow at one velocity from a tenth of the radius on; siblings' stand still.
        velocity = np.where(generation == 0, CRACK_VELOCITY, 0.)
        for name, values in (("position", position), ("radius", radius), ("generation", generation),
                             ("id", np.arange(len(radius))), ("crack_half_length", 0.1 * radius),
                             ("crack_velocity", velocity)):
            file[f"/grains/{name}"] = values
    return path

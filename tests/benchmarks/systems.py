"""The DEM codes of the comparison: how each is given the one protocol, and what it says of its own loop."""

import json
import os
import re
import resource
import subprocess
from dataclasses import dataclass, field
from pathlib import Path

from packing_text import read_packing, write_data_file

PEERS = Path(__file__).resolve().parent / "peers"

# Table 1 of the time-to-fracture paper, as dem's GrainMaterial has it, and the protocol of engine_protocol.h.
SHEAR_MODULUS, POISSON, FRICTION, DENSITY = 32e9, 0.19, 0.275, 2650.0  # [Pa], [-], [-], [kg/m3]
TIME_STEP, STRAIN_RATE = 1.2e-8, 20.0  # [s], [1/s]
# Of LAMMPS's and LIGGGHTS's neighbour lists [m], about an eighth of the mean diameter: the best of 10 to 60 um.
SKIN = 2e-5

# The same law in each code's own constants. Ours: N = 4/3 E* sqrt(R*) d^1.5 with E* = G/(1 - nu), kn = dN/dd, and
# kt = 2 (1 - nu)/(2 - nu) kn = 4 G/(2 - nu) sqrt(R* d). LAMMPS writes N = Kn d sqrt(R* d) and kt = Kt sqrt(R* d).
# YADE and LIGGGHTS compute both from Young's modulus and Poisson's ratio.
NORMAL_CONSTANT = 4.0 / 3.0 * SHEAR_MODULUS / (1.0 - POISSON)
TANGENTIAL_CONSTANT = 4.0 * SHEAR_MODULUS / (2.0 - POISSON)
YOUNG = 2.0 * SHEAR_MODULUS * (1.0 + POISSON)

ENVIRONMENT = dict(os.environ, OMPI_ALLOW_RUN_AS_ROOT="1", OMPI_ALLOW_RUN_AS_ROOT_CONFIRM="1",
                   OMPI_MCA_rmaps_base_oversubscribe="1", OMPI_MCA_hwloc_base_binding_policy="none",
                   OPENBLAS_NUM_THREADS="1", OMP_NUM_THREADS="1")

CLOCKS = ("wall", "cpu")
CLOCK_HELP = "cpu: loop time by the share of its cores that the program got, for one core on a machine in use"


@dataclass
class Run:
    seconds: float  # of the steps alone, wall time [s]
    stress_before: float  # mean normal stress [Pa], compression-positive
    stress_after: float  # [Pa]
    core_share: float  # CPU time of the steps over wall time and cores; well below 1: others used the machine


@dataclass
class Case:
    """A packing on its way to all codes."""
    packing: Path
    n_steps: int
    benchmark: Path  # engine_benchmark
    work: Path  # folder for the next
    data: Path = field(init=False)  # the same packing for LAMMPS and LIGGGHTS
    n_grains: int = field(init=False)

    def __post_init__(self):
        packing = read_packing(self.packing)
        self.n_grains = len(packing.grains)
        self.data = self.work / (self.packing.stem + ".data")
        write_data_file(self.data, packing, DENSITY)


def run_program(command):
    """Its output and CPU time [s]. Throws RuntimeError with the end of what it said when it fails."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    done = subprocess.run([str(word) for word in command], capture_output=True, text=True, env=ENVIRONMENT)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    if done.returncode != 0:
        raise RuntimeError(f"{command[0]} failed ({done.returncode}):\n{(done.stdout + done.stderr)[-2000:]}")
    return done.stdout, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def find_number(pattern, text):
    return float(re.search(pattern, text, re.M).group(1))


def run_lammps_like(launcher, script, constants, case, n_steps):
    """Output and CPU time of LAMMPS or LIGGGHTS."""
    variables = {"data": case.data, "steps": n_steps, "dt": TIME_STEP, "rate": STRAIN_RATE,
                 "friction": FRICTION, "skin": SKIN, **constants}
    options = [word for name, value in variables.items() for word in ("-var", name, value)]
    return run_program([*launcher, "-in", PEERS / script, "-log", "none", *options])


def read_lammps_run(text, n_steps, core_share):
    seconds = find_number(rf"^Loop time of (\S+) on \d+ procs for {n_steps} steps", text)
    return Run(seconds, find_number(r"^before (\S+)", text), find_number(r"^after (\S+)", text), core_share)


def run_lammps(case, cores=1):
    launcher = ["mpirun", "-n", cores, "lmp"] if cores > 1 else ["lmp"]
    text, _ = run_lammps_like(launcher, "lammps.in", {"kn": NORMAL_CONSTANT, "kt": TANGENTIAL_CONSTANT}, case,
                              case.n_steps)
    return read_lammps_run(text, case.n_steps, find_number(r"^([\d.]+)% CPU use", text) / 100.0)


def run_liggghts(case):
    constants = {"young": YOUNG, "poisson": POISSON}
    text, cpu = run_lammps_like(["liggghts"], "liggghts.in", constants, case, case.n_steps)
    run = read_lammps_run(text, case.n_steps, float("nan"))
    _, setup = run_lammps_like(["liggghts"], "liggghts.in", constants, case, 1)  # it does not say its CPU time
    run.core_share = (cpu - setup) / run.seconds
    return run


def read_run(text, cores):
    """From the line of JSON that engine_benchmark and peers/yade_run.py end with."""
    result = json.loads(text.splitlines()[-1])
    return Run(result["seconds"], result["stress_before"], result["stress_after"],
               result["cpu_seconds"] / max(1e-9, result["seconds"]) / cores)


def run_yade(case):
    protocol = {"young": YOUNG, "poisson": POISSON, "density": DENSITY, "friction": FRICTION, "dt": TIME_STEP,
                "rate": STRAIN_RATE, "steps": case.n_steps}
    return read_run(run_program(["yade", "-n", "-x", "-j1", PEERS / "yade_run.py", case.packing,
                                 json.dumps(protocol)])[0], 1)


def run_slowsand(case, cores=1, options=()):
    return read_run(run_program([case.benchmark, "run", case.packing, "--steps", case.n_steps, "--threads", cores,
                                 *options])[0], cores)


def measure(run, case, clock):
    """One run of a system by the chosen clock."""
    result = run(case)
    if clock == "cpu":
        result.seconds *= result.core_share
    return result


def count_contacts(case):
    """Touching pairs of the packing."""
    text, _ = run_program([case.benchmark, "run", case.packing, "--steps", 0])
    return json.loads(text)["contacts"]


def can_thread(case):
    """Whether ours runs one packing on two threads."""
    return subprocess.run([str(case.benchmark), "run", str(case.packing), "--steps", "0", "--threads", "2"],
                          capture_output=True).returncode == 0

"""Compresses a rough-ended specimen with YADE's own FEMxDEM (package yade.FEMxDEM: Newton's method in Escript, a YADE scene at
each Gauss point) and tells what it cost. Arguments: packing file, JSON of the protocol (SI units, compression-positive)."""

import json
import os
import sys
import time
import types
from math import atan

import yade
from yade import Matrix3, O, Omega, Vector3, utils
from yade import (Bo1_Sphere_Aabb, ForceResetter, FrictMat, Ig2_Sphere_Sphere_ScGeom, InsertionSortCollider,
                  InteractionLoop, Ip2_FrictMat_FrictMat_MindlinPhys, Law2_ScGeom_MindlinPhys_Mindlin,
                  NewtonIntegrator, PeriTriaxController)

from esys.escript import Function, FunctionOnBoundary, inf, sup, whereZero
from esys.finley import Brick

packing, protocol = sys.argv[-2], json.loads(sys.argv[-1])
PRESSURE = protocol["pressure"]


class TimedOmega:
    """YADE's simulation, with a watch on its cycles."""

    def __init__(self):
        self.seconds, self.n_cycles, self.n_runs = 0.0, 0, 0

    def __call__(self):
        return self

    def __getattr__(self, name):
        return getattr(O, name)

    def run(self, n_cycles, wait):
        start = time.process_time()
        O.run(n_cycles, wait)
        self.seconds += time.process_time() - start
        self.n_cycles += n_cycles
        self.n_runs += 1


class SerialPool:
    """In place of processes: what is measured is processor time."""

    @staticmethod
    def map(work, items):
        return [work(item) for item in items]

    def close(self):
        pass


def read_grains():
    with open(packing, encoding="utf-8") as file:
        lines = [line.split() for line in file if line.strip()]
    edges = next([float(word) for word in words[2:5]] for words in lines if words[:2] == ["#", "cell"])
    return edges, [[float(word) for word in words] for words in lines if words[0][0] != "#"]


def make_rev():
    """The packing at rest under the pressure, as YADE stores a scene."""
    edges, grains = read_grains()
    O.periodic = True
    O.cell.hSize = Matrix3(edges[0], 0, 0, 0, edges[1], 0, 0, 0, edges[2])
    material = O.materials.append(FrictMat(young=protocol["young"], poisson=protocol["poisson"],
                                           density=protocol["density"], frictionAngle=atan(protocol["friction"])))
    for x, y, z, radius in grains:
        O.bodies.append(utils.sphere(Vector3(x, y, z), radius, material=material))
    loop = [ForceResetter(), InsertionSortCollider([Bo1_Sphere_Aabb()]),
            InteractionLoop([Ig2_Sphere_Sphere_ScGeom()], [Ip2_FrictMat_FrictMat_MindlinPhys()],
                            [Law2_ScGeom_MindlinPhys_Mindlin()])]
    newton = NewtonIntegrator(damping=protocol["damping"])
    servo = PeriTriaxController(dynCell=True, goal=Vector3(-PRESSURE, -PRESSURE, -PRESSURE), stressMask=7,
                                relStressTol=1e-3, maxUnbalanced=1e-4, maxStrainRate=Vector3(10.0, 10.0, 10.0))
    O.engines = loop + [servo, newton]
    O.dt = protocol["time_step_share"] * utils.PWaveTimeStep()
    for _ in range(protocol["preparation_cycles"] // 1000):
        O.run(1000, True)
        if utils.unbalancedForce() < 1e-4 and abs(utils.getStress().trace() / 3.0 + PRESSURE) < 1e-3 * PRESSURE:
            break
    O.engines = loop + [newton]
    O.cell.velGrad = Matrix3.Zero
    O.cell.trsf = Matrix3.Identity
    for body in O.bodies:
        body.state.vel = body.state.angVel = Vector3.Zero
    return O.sceneToString()


def import_peer(scene, watch):
    """The package's modules as they are; they expect names that this driver gives them."""
    yadeimport = types.ModuleType("yadeimport")
    yadeimport.Omega, yadeimport.utils = Omega, utils
    sys.modules["yadeimport"] = yadeimport
    sys.path.insert(0, os.path.join(os.path.dirname(yade.__file__), "FEMxDEM"))
    import simDEM

    def load(point):
        O.stringToScene(scene)
        O.tags["id"] = str(point)
        return O.sceneToString()

    simDEM.Omega, simDEM.initLoad = watch, load
    simDEM.shear, simDEM.getStressAndTangent = simDEM.shear3D, simDEM.getStressAndTangent3D
    import msFEM3D

    msFEM3D.get_pool = lambda mpi, threads: SerialPool()
    return msFEM3D


def compute_mean_deviator(stress):
    """Axial less mean lateral stress over the Gauss points [Pa], compression-positive."""
    values = stress.toListOfTuples()
    return -sum(s[2][2] - 0.5 * (s[0][0] + s[1][1]) for s in values) / len(values)


def compute_unbalanced_ratios(problem):
    """Mean resultant over mean contact force of each REV as it stands after the step."""
    ratios = []
    for scene in problem._MultiScale__scenes:
        O.stringToScene(scene)
        O.cell.velGrad = Matrix3.Zero
        O.run(1, True)  # a scene is stored without its forces
        ratios.append(utils.unbalancedForce())
    return ratios


def relax(problem):
    """Mean deviator [Pa] after each REV has come to rest at held strain, which the package itself never waits for."""
    if protocol["relaxation_cycles"] == 0:
        return None
    axial_less_lateral = []
    for scene in problem._MultiScale__scenes:
        O.stringToScene(scene)
        O.cell.velGrad = Matrix3.Zero
        for _ in range(protocol["relaxation_cycles"] // 100):
            O.run(100, True)
            if utils.unbalancedForce() < protocol["rest_ratio"]:
                break
        stress = utils.getStress()
        axial_less_lateral.append(-stress[2, 2] + 0.5 * (stress[0, 0] + stress[1, 1]))
    return sum(axial_less_lateral) / len(axial_less_lateral)


def run():
    watch = TimedOmega()
    peer = import_peer(make_rev(), watch)
    nx, ny, nz = protocol["cells"]
    lx, ly, lz = protocol["size"]
    domain = Brick(l0=lx, l1=ly, l2=lz, n0=nx, n1=ny, n2=nz, order=2, integrationOrder=2)
    n_points = len(Function(domain).getX().toListOfTuples())
    problem = peer.MultiScale(domain=domain, ng=n_points, np=1, rtol=protocol["tolerance"])
    x, face = domain.getX(), FunctionOnBoundary(domain).getX()
    ends = whereZero(x[2]) + whereZero(x[2] - lz)
    held, moved = ends * [1, 1, 1], whereZero(x[2] - lz) * [0, 0, -protocol["strain_step"] * lz]
    # On the faces as they were at first: where ends are rough, sides bulge.
    load = sum((whereZero(face[axis] - inf(face[axis])) - whereZero(face[axis] - sup(face[axis])))
               * [PRESSURE if axis == 0 else 0.0, PRESSURE if axis == 1 else 0.0, 0.0] for axis in (0, 1))
    cpu, cycles_s, n_cycles, n_runs, ratios = 0.0, watch.seconds, watch.n_cycles, watch.n_runs, []
    for step in range(protocol["steps"]):
        start = time.process_time()
        problem.initialize(f=load, specified_u_mask=held, specified_u_val=moved)
        problem.solve(iter_max=protocol["most_iterations"])
        cpu += time.process_time() - start
        ratios += compute_unbalanced_ratios(problem)
        print(f"step {step + 1}: {cpu:.1f} s, q = {compute_mean_deviator(problem.getCurrentStress()):.6g} Pa, "
              f"unbalanced {max(ratios[-n_points:]):.2g}", file=sys.stderr, flush=True)
    n_runs, n_cycles = watch.n_runs - n_runs, watch.n_cycles - n_cycles
    ratios.sort()
    print(json.dumps({
        "revs": n_points, "steps": protocol["steps"], "cpu_s": cpu, "cycles_s": watch.seconds - cycles_s,
        "evaluations": n_runs, "cycles": n_cycles, "unbalanced_median": ratios[len(ratios) // 2],
        "unbalanced_largest": ratios[-1], "deviator_Pa": compute_mean_deviator(problem.getCurrentStress()),
        "deviator_at_rest_Pa": relax(problem)}), flush=True)


run()

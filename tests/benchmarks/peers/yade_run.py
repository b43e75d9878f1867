"""Strains a periodic packing in YADE's default loop. Arguments: packing file, JSON of the protocol (SI units)."""

import json
import sys
import time
from math import atan

from yade import Matrix3, O, Vector3, utils
from yade import (Bo1_Sphere_Aabb, ForceResetter, FrictMat, Ig2_Sphere_Sphere_ScGeom, InsertionSortCollider,
                  InteractionLoop, Ip2_FrictMat_FrictMat_MindlinPhys, Law2_ScGeom_MindlinPhys_Mindlin,
                  NewtonIntegrator)

packing, protocol = sys.argv[-2], json.loads(sys.argv[-1])
with open(packing, encoding="utf-8") as file:
    lines = [line.split() for line in file if line.strip()]
edges = next([float(word) for word in words[2:]] for words in lines if words[:2] == ["#", "cell"])
grains = [[float(word) for word in words] for words in lines if words[0][0] != "#"]

O.periodic = True
O.cell.hSize = Matrix3(edges[0], 0, 0, 0, edges[1], 0, 0, 0, edges[2])
material = O.materials.append(FrictMat(young=protocol["young"], poisson=protocol["poisson"],
                                       density=protocol["density"], frictionAngle=atan(protocol["friction"])))
for x, y, z, radius in grains:
    O.bodies.append(utils.sphere(Vector3(x, y, z), radius, material=material))
O.engines = [
    ForceResetter(),
    InsertionSortCollider([Bo1_Sphere_Aabb()]),
    InteractionLoop([Ig2_Sphere_Sphere_ScGeom()], [Ip2_FrictMat_FrictMat_MindlinPhys()],
                    [Law2_ScGeom_MindlinPhys_Mindlin()]),
    NewtonIntegrator(damping=0),  # none has any: the codes' kinds of damping have nothing in common but zero
]
O.dt = protocol["dt"]
O.cell.velGrad = Matrix3(0, 0, 0, 0, 0, 0, 0, 0, -protocol["rate"])


def compute_pressure():
    """Mean normal stress of the last forces [Pa], compression-positive."""
    return -utils.getStress().trace() / 3.0


O.run(1, True)  # forces at the places of the packing, then the first motion
before = compute_pressure()
start, cpu_start = time.perf_counter(), time.process_time()
O.run(protocol["steps"], True)  # the last forces are those after as many motions
seconds, cpu_seconds = time.perf_counter() - start, time.process_time() - cpu_start
print(json.dumps({"seconds": seconds, "cpu_seconds": cpu_seconds, "stress_before": before,
                  "stress_after": compute_pressure()}))

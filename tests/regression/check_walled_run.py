"""Law: a REV between rigid walls reports the stress on them beside that of its contacts, the two agree at rest, and a
resumption changes no byte."""

import argparse
import csv
import json
import signal
import subprocess
import sys
import tempfile
import time
import unittest
from pathlib import Path

import h5py
import numpy as np

SKIPPED = 77  # CTest's SKIP_RETURN_CODE

CASE = """set Seed = 7
set Number of stages = 3
subsection Packing
  set Grains = 200
  set Friction = 0.1
end
subsection Laboratory
  set Checkpoint interval = 0
end
subsection Boundary
  set Kind = walls
end
subsection Stage 1
  set Kind = isotropic
  set Stress = 1e6
  set Increments = 3
end
subsection Stage 2
  set Kind = oedometric
  set Stress = 21.7e6
  set Increments = 10
end
subsection Stage 3
  set Kind = creep
  set Duration = 1e5
end
"""

AXES = ("xx", "yy", "zz")


class WalledRun(unittest.TestCase):
    build = Path()

    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.folder.cleanup)
        cls.case = Path(cls.folder.name) / "case.prm"
        cls.case.write_text(CASE)
        cls.run_folder = Path(cls.folder.name) / "whole"
        cls.run_program(cls.case, "--output", cls.run_folder)

    @classmethod
    def run_program(cls, *arguments):
        command = [str(cls.build / "slowsand-rev"), *map(str, arguments), "--quiet"]
        return subprocess.run(command, check=True, timeout=200)

    def read_history(self):
        with open(self.run_folder / "history.csv", newline="") as file:
            return list(csv.DictReader(file))

    def test_walls_bear_what_the_stages_hold(self):
        # A stage holds the stress on the walls within the servo's tolerance of 2e-3.
        rows = self.read_history()
        self.assertEqual(list(rows[0])[-3:], [f"wall_stress_{axis}_Pa" for axis in AXES])
        last_isotropic = [row for row in rows if row["stage"] == "1"][-1]
        for axis in AXES:
            self.assertAlmostEqual(float(last_isotropic[f"wall_stress_{axis}_Pa"]) / 1e6, 1., delta=2e-3)
        for row in rows:
            if row["kind"] == "dynamic":
                self.assertAlmostEqual(float(row["wall_stress_zz_Pa"]) / 21.7e6, 1., delta=2e-3)
                self.assertEqual(row["strain_xx"], last_isotropic["strain_xx"])

    def test_both_stresses_agree_at_rest(self):
        # They differ by at most L/(2V) sum |resultant| (docs/theory.md, section 2.1), which is n r N / (2 W) of them for n
        # grains, unbalanced ratio r, mean contact force N and the force W on a wall: some ten contacts, N less than W/10.
        n_at_rest = 0
        for row in self.read_history():
            if row["kind"] not in ("load", "dynamic"):
                continue
            n_at_rest += 1
            bound = int(row["grains"]) * float(row["unbalanced_ratio"]) / 20
            for axis in AXES:
                on_walls, of_contacts = float(row[f"wall_stress_{axis}_Pa"]), float(row[f"stress_{axis}_Pa"])
                self.assertAlmostEqual(of_contacts / on_walls, 1., delta=bound)
        self.assertGreater(n_at_rest, 10)

    def test_summary_reports_both(self):
        findings = json.loads((self.run_folder / "summary.json").read_text())
        last = self.read_history()[-1]
        for axis in AXES:
            for name in (f"wall_stress_{axis}_Pa", f"stress_{axis}_Pa"):
                self.assertAlmostEqual(findings[name] / float(last[name]), 1., delta=1e-9)  # ten digits

    def test_snapshot_names_walls_and_their_forces_balance(self):
        with h5py.File(self.run_folder / "snapshots" / "stage_3.h5") as file:
            cell, position = file["cell/matrix"][...], file["grains/position"][...]
            self.assertEqual(file["cell/matrix"].attrs["kind"], "rigid")
            place = {number: i for i, number in enumerate(file["grains/id"][...])}
            partner = file["contacts/grain_b"][...]
            normal = file["contacts/normal"][...]
            force = file["contacts/shear_force"][...] - file["contacts/normal_force"][...][:, None] * normal
            a = np.array([place[number] for number in file["contacts/grain_a"][...]])
            stress = file["state/stress"][...]
        self.assertTrue(np.all((position > 0.) & (position < np.diag(cell))))
        self.assertEqual(set(partner[partner < 0]), {-1, -2, -3, -4, -5, -6})
        branch = np.empty_like(normal)
        for k, number in enumerate(partner):
            if number < 0:
                axis = (-number - 1) // 2
                depth = position[a[k], axis] if number % 2 else cell[axis, axis] - position[a[k], axis]
                branch[k] = depth * normal[k]
            else:
                branch[k] = position[place[number]] - position[a[k]]
        volume = np.linalg.det(cell)
        np.testing.assert_allclose(force.T @ branch / volume, stress, atol=1e-9 * 21.7e6)
        last = self.read_history()[-1]
        for axis in range(3):
            on_walls = sum(abs(force[partner == -1 - 2 * axis - side, axis].sum()) for side in (0, 1))
            area = volume / cell[axis, axis]
            self.assertAlmostEqual(on_walls / 2 / area / float(last[f"wall_stress_{AXES[axis]}_Pa"]), 1., delta=1e-9)

    def test_killed_and_resumed_leaves_the_same_bytes(self):
        killed = Path(self.folder.name) / "killed"
        process = subprocess.Popen([str(self.build / "slowsand-rev"), str(self.case), "--output", str(killed), "--quiet"])
        history = killed / "history.csv"
        while process.poll() is None and not (history.is_file() and history.read_bytes().count(b"\n") > 8):
            time.sleep(0.001)
        process.kill()
        self.assertEqual(process.wait(), -signal.SIGKILL, "the run was over before it could be killed")
        self.run_program("--resume", killed)
        self.assertEqual((killed / "history.csv").read_bytes(), (self.run_folder / "history.csv").read_bytes())


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--source", required=True)
    parser.add_argument("--build", required=True)
    options, rest = parser.parse_known_args()
    WalledRun.build = Path(options.build).resolve()
    if not (WalledRun.build / "slowsand-rev").exists():
        print("skipped: slowsand-rev has not been built")
        sys.exit(SKIPPED)
    unittest.main(argv=[sys.argv[0], *rest])


if __name__ == "__main__":
    main()

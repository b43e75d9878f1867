"""Law: a run folder of slowsand-rev holds the documented columns and datasets, they agree with one another, and a run
killed in mid-creep and resumed leaves the bytes of an undisturbed one."""

import argparse
import csv
import os
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
set Number of stages = 2
subsection Packing
  set Grains = 120
  set Friction = 0.1
end
subsection Laboratory
  set Checkpoint interval = 0
end
subsection Stage 1
  set Kind = oedometric
  set Stress = 21.7e6
  set Increments = 20
end
subsection Stage 2
  set Kind = creep
  set Duration = 1e6
end
"""

COMPONENTS = ("xx", "yy", "zz", "xy", "yz", "xz")
COLUMNS = (["time_s", "stage", "kind", "cycles"] + [f"strain_{c}" for c in COMPONENTS]
           + [f"stress_{c}_Pa" for c in COMPONENTS]
           + ["void_ratio", "void_ratio_with_fines", "grains", "broken_instant", "broken_delayed", "coordination",
              "unbalanced_ratio"])
GRAINS = {"id", "parent", "generation", "position", "velocity", "spin", "radius", "strength", "crack_half_length",
          "crack_velocity", "largest_contact_stress"}
CONTACTS = {"grain_a", "grain_b", "normal", "overlap", "normal_force", "shear_force"}


class RevRun(unittest.TestCase):
    build = Path()

    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.folder.cleanup)
        cls.case = Path(cls.folder.name) / "case.prm"
        cls.case.write_text(CASE)
        cls.run_folder = Path(cls.folder.name) / "whole"
        subprocess.run(cls.make_command(cls.case, "--output", cls.run_folder), check=True, timeout=120)

    @classmethod
    def make_command(cls, *arguments):
        return [str(cls.build / "slowsand-rev"), *map(str, arguments), "--quiet"]

    def read_history(self):
        with open(self.run_folder / "history.csv", newline="") as file:
            return list(csv.DictReader(file))

    def test_history_has_the_documented_columns(self):
        with open(self.run_folder / "history.csv") as file:
            self.assertEqual(file.readline().strip().split(","), COLUMNS)

    def test_history_tells_a_creep_under_held_stress(self):
        rows = self.read_history()
        creep = [row for row in rows if row["stage"] == "2" and row["kind"] == "dynamic"]
        self.assertEqual(float(rows[-1]["time_s"]), 1e6)
        self.assertTrue({row["kind"] for row in rows} <= {"load", "dynamic", "ageing", "relaxed"})
        for row in creep:  # the servo's tolerance is 2e-3
            self.assertAlmostEqual(float(row["stress_zz_Pa"]) / 21.7e6, 1.0, delta=2e-3)
            self.assertEqual(float(row["strain_xx"]), 0.0)
        self.assertGreater(int(rows[-1]["broken_delayed"]), 0)
        self.assertGreater(float(creep[-1]["strain_zz"]), float(creep[0]["strain_zz"]))
        # Each grain that broke left 14 siblings in its place.
        broken = int(rows[-1]["broken_instant"]) + int(rows[-1]["broken_delayed"])
        self.assertEqual(int(rows[-1]["grains"]), 120 + 13 * broken)

    def test_snapshot_has_the_documented_datasets(self):
        with h5py.File(self.run_folder / "snapshots" / "stage_2.h5") as file:
            self.assertEqual(file.attrs["format"], "slowsand-rev")
            for name in ("format_version", "time_s", "seed"):
                self.assertIn(name, file.attrs)
            self.assertEqual(file["cell/matrix"].attrs["kind"], "periodic")
            self.assertLessEqual(GRAINS, set(file["grains"]))
            self.assertLessEqual(CONTACTS, set(file["contacts"]))
            file.visititems(lambda name, item: self.assertIn("unit", item.attrs, name)
                            if isinstance(item, h5py.Dataset) else None)

    def test_stress_of_a_snapshot_is_that_of_its_contacts(self):
        with h5py.File(self.run_folder / "snapshots" / "stage_2.h5") as file:
            cell = file["cell/matrix"][...]
            position = file["grains/position"][...]
            place = {number: i for i, number in enumerate(file["grains/id"][...])}
            a = [place[number] for number in file["contacts/grain_a"][...]]
            b = [place[number] for number in file["contacts/grain_b"][...]]
            normal, shear = file["contacts/normal"][...], file["contacts/shear_force"][...]
            force = shear - file["contacts/normal_force"][...][:, None] * normal
            fraction = np.linalg.solve(cell, (position[b] - position[a]).T)
            branch = (cell @ (fraction - np.rint(fraction))).T
            stress = force.T @ branch / np.linalg.det(cell)
            # Forces here come from the scalar law, the state's stress from the vectorised one: rounding apart the same.
            np.testing.assert_allclose(stress, file["state/stress"][...], atol=1e-9 * 21.7e6)

    def test_killed_and_resumed_leaves_the_same_bytes(self):
        killed = Path(self.folder.name) / "killed"
        process = subprocess.Popen(self.make_command(self.case, "--output", killed))
        history = killed / "history.csv"
        wanted = len(self.read_history()) * 3 // 4
        while process.poll() is None and not (history.is_file() and history.read_bytes().count(b"\n") > wanted):
            time.sleep(0.001)
        os.kill(process.pid, signal.SIGKILL)
        process.wait()
        self.assertEqual(process.returncode, -signal.SIGKILL, "the run was over before it could be killed")
        subprocess.run(self.make_command("--resume", killed), check=True, timeout=120)
        self.assertEqual(history.read_bytes(), (self.run_folder / "history.csv").read_bytes())


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--source", required=True)
    parser.add_argument("--build", required=True)
    options, rest = parser.parse_known_args()
    RevRun.build = Path(options.build).resolve()
    if not (RevRun.build / "slowsand-rev").exists():
        print("skipped: slowsand-rev has not been built")
        sys.exit(SKIPPED)
    unittest.main(argv=[sys.argv[0], *rest])


if __name__ == "__main__":
    main()

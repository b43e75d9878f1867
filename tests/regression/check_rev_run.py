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
JUMP_COLUMNS = (["jump", "stage", "time_s", "length_s", "broken", "cause", "cycles"]
                + [f"largest_deviation_{c}_Pa" for c in COMPONENTS] + [f"smallest_deviation_{c}_Pa" for c in COMPONENTS]
                + [f"strain_change_{c}" for c in COMPONENTS])
MEASURES = [f"{name}{suffix}{unit}" for suffix in ("", "_with_fines")
            for name, unit in (("relative_breakage_hardin", ""), ("relative_breakage_einav", ""), ("d10", "_m"),
                               ("d50", "_m"), ("d90", "_m"))]
TABLES = {"history.csv": COLUMNS, "jumps.csv": JUMP_COLUMNS,
          "breakage.csv": ["time_s", "stage", "broken_instant", "broken_delayed", "fines_share"] + MEASURES
          + ["whole_grains", "whole_strength_mean", "whole_strength_deviation", "whole_strength_smallest"],
          "fractures.csv": ["time_s", "stage", "cause", "grain", "generation", "diameter_m", "strength_Pa"]}
COMMINUTION_LIMIT = 0.1155e-3  # the default [m]
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

    def read_table(self, name):
        with open(self.run_folder / name, newline="") as file:
            return list(csv.DictReader(file))

    def read_history(self):
        return self.read_table("history.csv")

    def test_tables_have_the_documented_columns(self):
        for table, columns in TABLES.items():
            with open(self.run_folder / table) as file:
                self.assertEqual(file.readline().strip().split(","), columns, table)

    def test_breakage_is_that_of_the_snapshots(self):
        # Hardin's measure once more, from the first and the last snapshot: sums in another order, ten digits written.
        rows, mean = self.read_table("breakage.csv"), []
        for name in ("initial", "stage_2"):
            with h5py.File(self.run_folder / "snapshots" / f"{name}.h5") as file:
                diameter = 2 * file["grains/radius"][...]
                generation, strength = file["grains/generation"][...], file["grains/strength"][...]
            weight = diameter**3
            mean.append((np.sum(weight * np.maximum(0., np.log(diameter / 0.074e-3))), np.sum(weight)))
        first, last = rows[0], rows[-1]
        for name in MEASURES[:2] + MEASURES[5:7] + ["fines_share"]:
            self.assertEqual(float(first[name]), 0., name)
            self.assertGreater(float(last[name]), 0., name)
        (potential, total), (left, kept) = mean
        self.assertAlmostEqual(float(last["relative_breakage_hardin"]), 1 - left / kept / (potential / total),
                               delta=1e-9)
        reach = np.log(COMMINUTION_LIMIT / 0.074e-3)  # fines: log-uniform over the decade that ends at the limit
        left += (total - kept) * reach**2 / (2 * np.log(10))
        self.assertAlmostEqual(float(last["relative_breakage_hardin_with_fines"]), 1 - left / potential, delta=1e-9)
        self.assertAlmostEqual(float(last["fines_share"]), 1 - kept / total, delta=1e-9)
        whole = (generation == 0) & (diameter >= COMMINUTION_LIMIT)
        factor = strength[whole] / (3.75e9 * (diameter[whole] / 2e-3)**(-3 / 12))
        self.assertEqual(int(last["whole_grains"]), whole.sum())
        for name, value in (("mean", factor.mean()), ("deviation", factor.std()), ("smallest", factor.min())):
            self.assertAlmostEqual(float(last[f"whole_strength_{name}"]), value, delta=1e-9)
        self.assertGreater(float(last["whole_strength_mean"]), float(first["whole_strength_mean"]))  # the weak broke

    def test_fractures_are_those_counted(self):
        rows, last = self.read_table("fractures.csv"), self.read_history()[-1]
        for cause in ("instant", "delayed"):
            self.assertEqual(sum(row["cause"] == cause for row in rows), int(last[f"broken_{cause}"]))
        self.assertEqual(len({row["grain"] for row in rows}), len(rows))  # none breaks twice
        with h5py.File(self.run_folder / "snapshots" / "initial.h5") as file:
            grains = zip(file["grains/radius"][...], file["grains/strength"][...])
            of_packing = dict(zip(file["grains/id"][...], grains))
        for row in rows:
            self.assertEqual(row["generation"], "0")  # the largest sibling lies below the comminution limit
            radius, strength = of_packing[int(row["grain"])]
            self.assertAlmostEqual(float(row["diameter_m"]) / (2 * radius), 1., delta=1e-9)  # ten digits
            self.assertAlmostEqual(float(row["strength_Pa"]) / strength, 1., delta=1e-9)

    def test_jumps_make_up_the_creep(self):
        jumps, rows = self.read_table("jumps.csv"), self.read_history()
        creep = [row for row in rows if row["stage"] == "2"]
        before = [row for row in rows if row["stage"] == "1"][-1]
        self.assertEqual([row["jump"] for row in jumps], [str(i) for i in range(1, len(jumps) + 1)])
        self.assertEqual({row["stage"] for row in jumps}, {"2"})  # the load stands for no time
        self.assertAlmostEqual(sum(float(row["length_s"]) for row in jumps), 1e6, delta=1e-3)  # ten digits
        self.assertEqual(len(jumps), sum(row["kind"] == "dynamic" for row in creep))
        for cause in ("instant", "delayed"):
            self.assertEqual(sum(int(row["broken"]) for row in jumps if row["cause"] == cause),
                             int(rows[-1][f"broken_{cause}"]) - int(before[f"broken_{cause}"]))
        self.assertEqual(sum(int(row["cycles"]) for row in jumps), int(rows[-1]["cycles"]) - int(before["cycles"]))
        self.assertAlmostEqual(sum(float(row["strain_change_zz"]) for row in jumps),
                               float(rows[-1]["strain_zz"]) - float(before["strain_zz"]), delta=1e-9)
        for row in jumps:
            self.assertEqual(row["cause"] == "none", row["broken"] == "0")
            self.assertEqual((row["largest_deviation_xx_Pa"], row["smallest_deviation_yz_Pa"]), ("nan", "nan"))
            self.assertGreaterEqual(float(row["largest_deviation_zz_Pa"]), 0.)
            self.assertLessEqual(float(row["smallest_deviation_zz_Pa"]), 0.)
        # Grains that break take load off the sample.
        self.assertLess(min(float(row["smallest_deviation_zz_Pa"]) for row in jumps), -1e3)

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
        for table in TABLES:
            self.assertEqual((killed / table).read_bytes(), (self.run_folder / table).read_bytes(), table)


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

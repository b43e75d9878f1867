"""Law: a creep that ruptures is a result, exit status 0, with its time in summary.json and history.csv; a stage that cannot
be finished is exit status 1, one message with cause and remedy, and a checkpoint from which the run goes on."""

import argparse
import csv
import json
import shutil
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import h5py

SKIPPED = 77  # CTest's SKIP_RETURN_CODE

# By 1e18 s cracks break what twice the contact stress would break in the first second: no packing bears that at 0.99 q_max.
RUPTURE = """set Number of stages = 4
subsection Packing
  set Grains = 250
  set Friction = 0.08
end
subsection Stage 1
  set Kind = isotropic
  set Stress = 2e6
  set Increments = 8
end
subsection Stage 2
  set Kind = strength search
  set Axial strain = 0.12
  set Increments = 30
end
subsection Stage 3
  set Kind = triaxial
  set Share of q_max = 0.99
  set Increments = 12
end
subsection Stage 4
  set Kind = creep
  set Held stresses = all normal
  set Duration = 1e18
  set Points per decade = 1
end
"""

RESTLESS = """set Number of stages = 1
subsection Packing
  set Grains = 60
  set Friction = 0.1
end
subsection Equilibrium
  set Cycle cap = 30
end
subsection Stage 1
  set Kind = isotropic
  set Stress = 1e6
  set Increments = 2
end
"""

# A stage, and one behind it that cannot be done: what is asked, words of the message, settings.
SOUND = """set Number of stages = 1
subsection Packing
  set Grains = 60
  set Friction = 0.1
end
subsection Stage 1
  set Kind = isotropic
  set Stress = 1e6
  set Increments = 2
end
"""
IMPOSSIBLE = {
    "a deviator of forty times the mean stress": (
        ("is not reached", "ask for less stress"),
        {"Stage 2/Kind": "triaxial", "Stage 2/Deviatoric stress": 40e6, "Stage 2/Increments": 4, "Fracture/Grains break": "false",
         "Laboratory/Largest strain": 0.1}),  # some packings bear much, and would be strained until the cell is too narrow
    "less than two largest diameters of height": (
        ("collapsed", "Packing/Grains"),
        {"Stage 2/Kind": "strain path", "Stage 2/Strain": "-0.45, -0.45, 1, 0, 0, 0", "Stage 2/Increments": 20}),
    "a servo that takes away five times the error": (
        ("the servo is unstable", "lower Equilibrium/Servo gain"),
        {"Stage 2/Kind": "isotropic", "Stage 2/Stress": 4e6, "Stage 2/Increments": 1, "Equilibrium/Servo gain": 5,
         "Equilibrium/Strain per cycle": 1e-3, "Equilibrium/Cycle cap": 3000, "Laboratory/Smallest share": 1})}


class StageEnds(unittest.TestCase):
    build = Path()

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)
        self.run_folder = self.folder / "run"

    def run_program(self, *arguments):
        return subprocess.run([self.build / "slowsand-rev", *map(str, arguments), "--quiet"], capture_output=True,
                              text=True, timeout=280)

    def start(self, text):
        case = self.folder / "case.prm"
        case.write_text(text)
        return self.run_program(case, "--output", self.run_folder)

    def test_rupture_is_a_result(self):
        result = self.start(RUPTURE)
        self.assertEqual(result.returncode, 0, result.stderr)
        summary = json.loads((self.run_folder / "summary.json").read_text())
        self.assertEqual(summary["status"], "ruptured")
        self.assertTrue(summary["rupture_criterion"])
        self.assertGreater(summary["q_max_Pa"], 2e6)
        history = self.run_folder / "history.csv"
        with open(history, newline="") as file:
            rows = list(csv.DictReader(file))
        self.assertEqual((rows[-1]["kind"], rows[-1]["stage"]), ("rupture", "4"))
        self.assertAlmostEqual(float(rows[-1]["time_s"]) / summary["rupture_time_s"], 1.0, delta=1e-9)  # of a table with ten digits
        self.assertTrue((self.run_folder / "snapshots" / "stage_4.h5").is_file())
        before = history.read_bytes()
        self.assertEqual(self.run_program("--resume", self.run_folder).returncode, 0)
        self.assertEqual(history.read_bytes(), before)

    def test_impossible_stage_says_why_and_keeps_its_state(self):
        result = self.start(RESTLESS)
        self.assertEqual(result.returncode, 1)
        self.assertEqual(len(result.stderr.strip().splitlines()), 1, result.stderr)
        for word in ("stage 1", "no equilibrium", "cap of cycles", "Increments", "checkpoint.h5", "--resume"):
            self.assertIn(word, result.stderr)
        resumed = self.run_program("--resume", self.run_folder, "--set", "Equilibrium/Cycle cap=200000")
        self.assertEqual(resumed.returncode, 0, resumed.stderr)

    def test_each_cause_is_named_and_the_state_before_is_kept(self):
        self.assertEqual(self.start(SOUND).returncode, 0)
        whole = self.run_folder
        for name, (words, settings) in IMPOSSIBLE.items():
            with self.subTest(name):
                self.run_folder = self.folder / words[0].replace(" ", "_")
                shutil.copytree(whole, self.run_folder)
                result = self.run_program("--resume", self.run_folder, "--set", "Number of stages=2",
                                          *(part for key, value in settings.items() for part in ("--set", f"{key}={value}")))
                self.assertEqual(result.returncode, 1, result.stderr)
                self.assertEqual(len(result.stderr.strip().splitlines()), 1, result.stderr)
                for word in ("stage 2", "checkpoint.h5", "--resume", *words):
                    self.assertIn(word, result.stderr)
                with h5py.File(self.run_folder / "checkpoint.h5") as file:
                    self.assertLess(file.attrs["unbalanced_ratio"], 1e-4)  # the default criterion of rest


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--source", required=True)
    parser.add_argument("--build", required=True)
    options, rest = parser.parse_known_args()
    StageEnds.build = Path(options.build).resolve()
    if not (StageEnds.build / "slowsand-rev").exists():
        print("skipped: slowsand-rev has not been built")
        sys.exit(SKIPPED)
    unittest.main(argv=[sys.argv[0], *rest])


if __name__ == "__main__":
    main()

"""Law: every Python block of docs/cookbook.md runs on what the programs leave, and its numbers are those of the run."""

import argparse
import csv
import json
import os
import re
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import numpy as np

sys.dont_write_bytecode = True
SKIPPED = 77  # CTest's SKIP_RETURN_CODE
CASE = """set Seed = 7
set Number of stages = 2
subsection Packing
  set Grains = 80
  set Friction = 0.1
end
subsection Stage 1
  set Kind = oedometric
  set Stress = 21.7e6
  set Increments = 15
end
subsection Stage 2
  set Kind = creep
  set Duration = 1e6
end
"""
STUDY = {"case": "case.prm", "seeds": [1, 2], "parameters": [{"name": "Stage 1/Stress", "values": [5e6, 10e6]}],
         "results": [{"name": "slope_per_decade", "column": "strain_zz", "stage": 2, "take": "slope",
                      "times_s": [1, 1e6]}]}


def read_blocks(path):
    """(line, text) of each Python block."""
    text = path.read_text(encoding="utf-8")
    return [(text.count("\n", 0, match.start(1)), match.group(1))
            for match in re.finditer(r"^```python\n(.*?)^```$", text, re.MULTILINE | re.DOTALL)]


class Cookbook(unittest.TestCase):
    source, build = Path(), Path()

    @classmethod
    def setUpClass(cls):
        cls.folder = Path(cls.enterClassContext(tempfile.TemporaryDirectory()))
        (cls.folder / "case.prm").write_text(CASE, encoding="utf-8")
        (cls.folder / "study.json").write_text(json.dumps(STUDY), encoding="utf-8")
        for command in ([cls.build / "slowsand-rev", "case.prm", "--output", "runs/my_rev", "--quiet"],
                        ["/usr/bin/python3", cls.source / "apps" / "slowsand-study", "study.json", "--programs", cls.build,
                         "--output", "runs/my_study", "--quiet"]):
            subprocess.run([*map(str, command)], cwd=cls.folder, check=True, timeout=300)
        os.chdir(cls.folder)
        cls.names = {}  # of all blocks together: what they computed
        cls.faults = []
        for line, block in read_blocks(cls.source / "docs" / "cookbook.md"):
            own = {}
            try:
                exec(compile(block, "cookbook.md", "exec"), own)  # each block alone: it has its own imports
            except Exception as error:
                cls.faults.append(f"docs/cookbook.md, block in line {line}: {type(error).__name__}: {error}")
            cls.names.update(own)

    def test_every_block_runs(self):
        self.assertEqual(self.faults, [])

    def test_stress_is_the_programs(self):
        # Forces of a snapshot come from the scalar law, the state's stress from the vectorised one: rounding apart the same.
        np.testing.assert_allclose(self.names["stress"], self.names["expected"], atol=1e-9 * 21.7e6)
        self.assertAlmostEqual(-self.names["stress"][2, 2] / 21.7e6, 1., delta=2e-3)  # the servo's tolerance

    def test_coordination_is_the_historys(self):
        with open("runs/my_rev/history.csv", newline="", encoding="utf-8") as file:
            last = list(csv.DictReader(file))[-1]
        self.assertAlmostEqual(self.names["coordination"], float(last["coordination"]), delta=1e-8)  # ten digits
        self.assertGreater(self.names["without_rattlers"], self.names["coordination"])

    def test_grading_and_breakage_count_all_grains(self):
        self.assertEqual(len(self.names["grains"]), len(self.names["radius"]))
        broken = int(self.names["broken_by_stage"].to_numpy().sum())
        self.assertEqual(len(self.names["grains"]), 80 + 13 * broken)  # fourteen siblings in place of one
        self.assertAlmostEqual(self.names["finer"][-1], 1., delta=1e-12)
        self.assertEqual(self.names["units"]["radius"], "m")

    def test_creep_is_that_of_the_history(self):
        strains = self.names["creep_at_decades"].strain
        self.assertTrue(strains.notna().all())
        self.assertEqual(strains.iloc[-1], self.names["creep"].strain.iloc[-1])  # the run lasts 1e6 s

    def test_study_has_its_sets_and_seeds(self):
        self.assertEqual(list(self.names["scatter"]["count"]), [2, 2])
        self.assertEqual(set(self.names["histories"].stress), {5e6, 10e6})


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--source", type=Path, required=True)
    parser.add_argument("--build", type=Path, required=True)
    options, rest = parser.parse_known_args()
    Cookbook.source, Cookbook.build = options.source.resolve(), options.build.resolve()
    if not (Cookbook.build / "slowsand-rev").exists():
        print("skipped: slowsand-rev has not been built")
        sys.exit(SKIPPED)
    unittest.main(argv=[sys.argv[0], *rest])


if __name__ == "__main__":
    main()

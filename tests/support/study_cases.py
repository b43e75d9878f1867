"""A study small enough to run many times, for the tests of slowsand-study, and how to run it."""

import argparse
import json
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

SKIPPED = 77  # CTest's SKIP_RETURN_CODE
PATIENCE = 300  # [s] for what takes ten on an idle machine

CASE = """set Number of stages = 2
subsection Packing
  set Grains = 60
  set Friction = 0.1
end
subsection Laboratory
  set Checkpoint interval = 0
end
subsection Stage 1
  set Kind = oedometric
  set Stress = 10e6
  set Increments = 10
end
subsection Stage 2
  set Kind = creep
  set Duration = 1e6
end
"""
STUDY = {"case": "small.prm", "seeds": [1, 2],
         "results": [{"column": "void_ratio"}, {"summary": "cycles"}]}
STRESS = {"name": "Stage 1/Stress", "values": [5e6, 10e6]}


class StudyTest(unittest.TestCase):
    source, build = Path(), Path()

    def setUp(self):
        self.folder = Path(self.enterContext(tempfile.TemporaryDirectory()))
        (self.folder / "small.prm").write_text(CASE, encoding="utf-8")
        self.output = self.folder / "out"

    def write_study(self, **changes):
        path = self.folder / "study.json"
        path.write_text(json.dumps({**STUDY, **changes}, indent=1), encoding="utf-8")
        return path

    def make_command(self, *arguments):
        return ["/usr/bin/python3", str(self.source / "apps" / "slowsand-study"), "--programs", str(self.build),
                *map(str, arguments)]

    def run_study(self, *arguments, status=0):
        done = subprocess.run(self.make_command(*arguments), capture_output=True, text=True, timeout=PATIENCE)
        self.assertEqual(done.returncode, status, done.stdout + done.stderr)
        return done


def run_tests(law):
    """What the test's script does: --source and --build, then its tests."""
    parser = argparse.ArgumentParser(description=law)
    parser.add_argument("--source", type=Path, required=True)
    parser.add_argument("--build", type=Path, required=True)
    options, rest = parser.parse_known_args()
    StudyTest.source, StudyTest.build = options.source.resolve(), options.build.resolve()
    if not (StudyTest.build / "slowsand-rev").exists():
        print("skipped: slowsand-rev has not been built")
        sys.exit(SKIPPED)
    unittest.main(argv=[sys.argv[0], *rest])

"""Law: a finished run whose last creep is given more time goes on from its end, and what it had written stays; a load that
has ended is given none."""

import argparse
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

sys.dont_write_bytecode = True
sys.path.insert(0, str(Path(__file__).resolve().parent))

import check_bad_input  # noqa: E402

# Both cases load in stage 1 and creep for 100 s in stage 2.
CASES = {"slowsand-rev": (check_bad_input.CASE, ""), "slowsand-bvp": (check_bad_input.BVP_CASE, "Loading/")}


def drop_creep(text):
    begin = text.index("subsection Stage 2")
    end = text.index("end\n", begin) + len("end\n")
    return (text[:begin] + text[end:]).replace("Number of stages = 2", "Number of stages = 1")


class ProlongedRun(unittest.TestCase):
    build = Path()

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)

    def run_program(self, program, *arguments):
        return subprocess.run([self.build / program, *map(str, arguments), "--quiet"], capture_output=True, text=True,
                              timeout=120)

    def start(self, program, text):
        case, run = self.folder / f"{program}.prm", self.folder / program
        case.write_text(text)
        result = self.run_program(program, case, "--output", run, "--overwrite")
        self.assertEqual(result.returncode, 0, result.stderr)
        return run

    def resume(self, program, run, *overrides):
        options = [option for override in overrides for option in ("--set", CASES[program][1] + override)]
        return self.run_program(program, "--resume", run, *options)

    def expect_to_go_on(self, end, *overrides):
        for program in CASES:
            run = self.start(program, CASES[program][0])
            before = (run / "history.csv").read_text()
            result = self.resume(program, run, *overrides)
            self.assertEqual(result.returncode, 0, result.stderr)
            after = (run / "history.csv").read_text()
            self.assertTrue(after.startswith(before), program)
            times = [float(line.split(",")[0]) for line in after.splitlines()[1:]]
            self.assertEqual(times, sorted(times), program)
            self.assertEqual((float(before.splitlines()[-1].split(",")[0]), times[-1]), (100, end), program)

    def test_creep_goes_on(self):
        self.expect_to_go_on(1000, "Stage 2/Duration=1000")

    def test_stage_is_added(self):
        self.expect_to_go_on(150, "Number of stages=3", "Stage 3/Kind=creep", "Stage 3/Duration=50")

    def test_prolonged_is_undisturbed(self):
        # 100 s is an output in both, and no grain depends on the last bit: the same rows and the same list of fields.
        found = []
        for first in ("100", "1000"):
            text = CASES["slowsand-bvp"][0].replace("Duration = 100", f"Duration = {first}")
            run = self.start("slowsand-bvp", text)
            self.assertEqual(self.resume("slowsand-bvp", run, "Stage 2/Duration=1000").returncode, 0)
            fields = [line for line in (run / "fields.pvd").read_text().splitlines() if "<DataSet" in line]
            found.append(((run / "history.csv").read_text().splitlines(), fields))
        self.assertEqual(found[0], found[1])

    def test_load_is_not_prolonged(self):
        for program in CASES:
            run = self.start(program, drop_creep(CASES[program][0]))
            before = (run / "parameters.prm").read_bytes()
            result = self.resume(program, run, "Stage 1/Duration=10")
            self.assertEqual(result.returncode, 2, result.stderr)
            for word in ("checkpoint.h5", "stage 1", "more time", "add a stage"):
                self.assertIn(word, result.stderr)
            self.assertEqual((run / "parameters.prm").read_bytes(), before, program)


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--source", required=True)
    parser.add_argument("--build", required=True)
    options, rest = parser.parse_known_args()
    ProlongedRun.build = Path(options.build).resolve()
    if not all((ProlongedRun.build / program).exists() for program in CASES):
        print("skipped: the programs have not been built")
        sys.exit(check_bad_input.SKIPPED)
    unittest.main(argv=[sys.argv[0], *rest])


if __name__ == "__main__":
    main()

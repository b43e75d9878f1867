"""Law: slowsand-plot draws what a run can give; bad input gets one line that names file and place, and status 2."""

import argparse
import re
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import h5py

sys.dont_write_bytecode = True
ARGUMENTS = argparse.ArgumentParser()
ARGUMENTS.add_argument("--source", type=Path, default=Path(__file__).resolve().parents[2])
ARGUMENTS.add_argument("--build", type=Path)
SOURCE = ARGUMENTS.parse_known_args()[0].source
sys.path.insert(0, str(SOURCE / "tests" / "support"))

import plot_runs  # noqa: E402

SAMPLES = SOURCE / "tests" / "regression" / "deal_ii_fields"


def run_plot(*arguments):
    return subprocess.run(["/usr/bin/python3", str(SOURCE / "apps" / "slowsand-plot"), *map(str, arguments)],
                          capture_output=True, text=True)


class PlotTest(unittest.TestCase):
    def setUp(self):
        self.folder = Path(self.enterContext(tempfile.TemporaryDirectory()))

    def assert_drawn(self, done, names):
        """Exactly these figures were written, at the paths printed, each a PNG one journal column wide."""
        self.assertEqual(done.returncode, 0, done.stderr)
        paths = [Path(line) for line in done.stdout.splitlines()]
        self.assertEqual([path.stem for path in paths], names)
        for path in paths:
            header = path.read_bytes()[:24]
            self.assertEqual(header[:8], b"\x89PNG\r\n\x1a\n")
            width = int.from_bytes(header[16:20], "big") / 300 * 25.4
            self.assertTrue(55. < width < 95., f"{path.name}: {width} mm")  # cropped to what is drawn, 90 mm at most

    def assert_refused(self, done, *words):
        self.assertEqual(done.returncode, 2, done.stdout + done.stderr)
        self.assertEqual(len(done.stderr.splitlines()), 1, done.stderr)
        for word in words:
            self.assertIn(word, done.stderr)


class Figures(PlotTest):
    def test_rev_run_has_all_but_a_specimen(self):
        done = run_plot(plot_runs.write_rev_run(self.folder / "run"))
        self.assert_drawn(done, ["creep", "compression", "grading", "stress_path", "rev", "breakage", "fractures",
                                  "times_to_fracture", "fluctuation"])
        self.assertIn("no figure specimen", done.stderr)

    def test_boundary_value_problem_has_all(self):
        done = run_plot(plot_runs.write_bvp_run(self.folder / "run", SAMPLES), "--output", self.folder / "here")
        self.assert_drawn(done, ["creep", "compression", "grading", "stress_path", "specimen", "rev",
                                 "times_to_fracture"])
        self.assertIn("no figure fluctuation", done.stderr)
        self.assertTrue((self.folder / "here" / "specimen.png").is_file())

    def test_solid_mesh(self):
        run = plot_runs.write_bvp_run(self.folder / "run", SAMPLES, mesh="three")
        self.assert_drawn(run_plot(run, "--figures", "specimen", "--field", "displacement"), ["specimen"])

    def test_comparison(self):
        runs = [plot_runs.write_rev_run(self.folder / name) for name in ("a", "b")]
        done = run_plot("--compare", *runs, "--output", self.folder)
        self.assert_drawn(done, ["compare_creep", "compare_compression"])


class BadInput(PlotTest):
    def edit(self, file, pattern, replacement, count=1):
        text = file.read_text(encoding="utf-8")
        changed = re.sub(pattern, replacement, text, count=count)
        self.assertNotEqual(text, changed)
        file.write_text(changed, encoding="utf-8")

    def test_folders(self):
        self.assert_refused(run_plot(self.folder / "nowhere"), "nowhere", "no such folder")
        self.assert_refused(run_plot(self.folder), str(self.folder), "history.csv")

    def test_history(self):
        run = plot_runs.write_rev_run(self.folder / "run")
        history = run / "history.csv"
        self.edit(history, "void_ratio_with_fines", "something_else")
        self.assert_refused(run_plot(run, "--figures", "compression"), str(history), "void_ratio_with_fines")
        self.edit(history, r"(?m)^([^,]+),2.0,load,", r"\1,two,load,")
        self.assert_refused(run_plot(run, "--figures", "creep"), str(history), "line 27", "column stage", "'two'")
        history.write_text(history.read_text(encoding="utf-8")[:-40], encoding="utf-8")
        self.assert_refused(run_plot(run), str(history), "values for", "columns")

    def test_stage_that_does_not_exist(self):
        run = plot_runs.write_rev_run(self.folder / "run")
        self.assert_refused(run_plot(run, "--figures", "creep", "--creep-stage", 7), "history.csv", "stage 7")

    def test_snapshots(self):
        run = plot_runs.write_rev_run(self.folder / "run")
        file = run / "snapshots" / "final.h5"
        with h5py.File(file, "a") as content:
            del content["/grains/radius"]
        self.assert_refused(run_plot(run), str(file), "/grains/radius")
        file.write_bytes(file.read_bytes()[:3000])
        self.assert_refused(run_plot(run, "--figures", "grading"), str(file), "HDF5")
        file.write_text("not HDF5", encoding="utf-8")
        self.assert_refused(run_plot(run, "--figures", "rev"), str(file), "HDF5")
        with h5py.File(file, "w") as content:
            content.attrs["format"] = "somebody else's"
        self.assert_refused(run_plot(run, "--figures", "rev"), str(file), "format")

    def test_tables(self):
        run = plot_runs.write_rev_run(self.folder / "run")
        self.edit(run / "jumps.csv", "largest_deviation_zz_Pa", "something_else")
        self.assert_refused(run_plot(run, "--figures", "fluctuation"), "jumps.csv", "largest_deviation_zz_Pa")
        self.edit(run / "breakage.csv", "1000000.0,2.0", "late,2.0")
        self.assert_refused(run_plot(run, "--figures", "breakage"), "breakage.csv", "column time_s", "'late'")
        (run / "fractures.csv").unlink()
        self.assert_refused(run_plot(run, "--print-fractures"), str(run), "fractures.csv")
        with h5py.File(run / "snapshots" / "final.h5", "a") as content:
            del content["/grains/crack_velocity"]
        self.assert_refused(run_plot(run, "--print-times"), "final.h5", "/grains/crack_velocity")

    def test_nothing_broke(self):
        run = plot_runs.write_rev_run(self.folder / "run")
        for table in ("jumps.csv", "fractures.csv"):
            header = (run / table).read_text(encoding="utf-8").splitlines()[0]
            (run / table).write_text(header + "\n", encoding="utf-8")
        for figure, table in (("fluctuation", "jumps.csv"), ("fractures", "fractures.csv")):
            self.assert_refused(run_plot(run, "--figures", figure), table)

    def test_fields(self):
        run = plot_runs.write_bvp_run(self.folder / "run", SAMPLES)
        piece = run / "fields" / "two_0003.0.vtu"
        self.assert_refused(run_plot(run, "--figures", "specimen", "--field", "colour"), "colour", "void_ratio")
        self.edit(piece, "AQAAAGAAAABgAAAAMgAAAA==eNoN", "AQAAAGAAAABgAAAAMgAAAA==AAAA")
        self.assert_refused(run_plot(run, "--figures", "specimen"), str(piece), "connectivity")
        piece.write_text(piece.read_text(encoding="utf-8")[:700], encoding="utf-8")
        self.assert_refused(run_plot(run, "--figures", "specimen"), str(piece), "XML")
        piece.unlink()
        self.assert_refused(run_plot(run, "--figures", "specimen"), str(piece), "no such file")

    def test_comminution_limit(self):
        run = plot_runs.write_rev_run(self.folder / "run")
        self.edit(run / "parameters.prm", "Comminution limit", "Something else")
        self.assert_refused(run_plot(run, "--figures", "grading"), "parameters.prm", "comminution limit")
        self.assert_refused(run_plot(run, "--figures", "grading", "--comminution-limit", "0"), "limit", "positive")
        self.assert_drawn(run_plot(run, "--figures", "grading", "--comminution-limit", "1e-4"), ["grading"])

    def test_figure_without_data_that_was_asked_for(self):
        run = plot_runs.write_rev_run(self.folder / "run")
        self.assert_refused(run_plot(run, "--figures", "specimen"), "specimen", "fields/*.pvtu")


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0]])

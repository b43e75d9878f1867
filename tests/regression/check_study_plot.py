"""Law: of curves y = k y0 the median over runs is that of k, times y0, and so are quartiles and ends, as far as all reach."""

import argparse
import csv
import subprocess
import sys
import tempfile
import types
import unittest
from pathlib import Path

import numpy as np

sys.dont_write_bytecode = True
ARGUMENTS = argparse.ArgumentParser()
ARGUMENTS.add_argument("--source", type=Path, default=Path(__file__).resolve().parents[2])
ARGUMENTS.add_argument("--build", type=Path)
SOURCE = ARGUMENTS.parse_known_args()[0].source
sys.path[:0] = [str(SOURCE / "apps"), str(SOURCE / "tests" / "support")]

import plot_runs  # noqa: E402
from plotting import study_bands  # noqa: E402

SLOPES = {"15e6": (0.001, 0.002, 0.004), "21.7e6": (0.003, 0.005, 0.009)}
CREEP = types.SimpleNamespace(x="time_s", y="strain_zz", stage=2, change=True)


def write_study(folder):
    """A study of two values and three seeds, and a run that failed."""
    rows = [["run", "stress", "seed", "status", "message"]]
    for stress, slopes in SLOPES.items():
        for seed, slope in enumerate(slopes, start=1):
            plot_runs.write_rev_run(folder / "runs" / f"{stress}-{seed}", slope=slope)
            rows.append([f"{stress}-{seed}", stress, str(seed), "finished", ""])
    rows.append(["15e6-4", "15e6", "4", "failed", "no equilibrium"])
    with open(folder / "table.csv", "w", newline="", encoding="utf-8") as file:
        csv.writer(file).writerows(rows)
    return folder


class StudyPlot(unittest.TestCase):
    def setUp(self):
        self.folder = write_study(Path(self.enterContext(tempfile.TemporaryDirectory())))

    def run_plot(self, *arguments):
        return subprocess.run(["/usr/bin/python3", str(SOURCE / "apps" / "slowsand-plot"), *map(str, arguments)],
                              capture_output=True, text=True)

    def test_bands_are_those_of_the_slopes(self):
        sets = study_bands.read_sets(self.folder)
        self.assertEqual({title: len(runs) for title, runs in sets.items()},
                         {"stress = 1.5e+07": 3, "stress = 2.17e+07": 3})  # the failed run is not among them
        for slopes, runs in zip(SLOPES.values(), sets.values()):
            x, values = study_bands.sample_together([study_bands.make_curve(run, CREEP) for run in runs], True)
            self.assertAlmostEqual(x[-1] / 1e6, 1., delta=1e-9)
            at_end = study_bands.compute_bands(values)[:, -1]
            per_slope = np.log10(1e6) + 2  # plot_runs.make_history
            expected = per_slope * np.percentile(slopes, (0, 25, 50, 75, 100))
            np.testing.assert_allclose(at_end, expected, rtol=1e-9)

    def test_curves_end_where_the_shortest_does(self):
        history = self.folder / "runs" / "15e6-2" / "history.csv"
        lines = history.read_text(encoding="utf-8").splitlines()
        history.write_text("\n".join(lines[:-20]) + "\n", encoding="utf-8")  # a decade has twenty rows
        runs = study_bands.read_sets(self.folder)["stress = 1.5e+07"]
        x, values = study_bands.sample_together([study_bands.make_curve(run, CREEP) for run in runs], True)
        self.assertAlmostEqual(x[-1] / 1e5, 1., delta=1e-9)
        self.assertTrue(np.isfinite(values).all())

    def test_against_a_column_that_wavers(self):
        waver = study_bands.Curve(np.array([0., 1., 0.5, 2., 3.]), np.array([0., 10., 99., 20., 30.]))
        falling = study_bands.Curve(np.array([4., 1., 2., 0.5]), np.array([40., 10., 99., 5.]))
        x, values = study_bands.sample_together([waver, falling], False)
        self.assertEqual((x[0], x[-1]), (0.5, 3.))
        np.testing.assert_allclose(values, [10. * x] * 2, rtol=1e-14)

    def test_figures(self):
        for arguments, name in ((("--stage", 2, "--change"), "study_strain_zz_against_time_s"),
                                (("--y", "stress_zz_Pa", "--x", "strain_zz"), "study_stress_zz_Pa_against_strain_zz")):
            done = self.run_plot("--study", self.folder, *arguments)
            self.assertEqual(done.returncode, 0, done.stderr)
            path = Path(done.stdout.strip())
            self.assertEqual((path.parent, path.stem), (self.folder / "figures", name))
            self.assertEqual(path.read_bytes()[:8], b"\x89PNG\r\n\x1a\n")

    def test_bad_input(self):
        for arguments, words in ((("--y", "colour"), ["history.csv", "column colour"]),
                                 (("--stage", 7), ["history.csv", "no stage 7"]),
                                 (("--y", "kind"), ["history.csv", "column kind", "text"])):
            self.assert_refused(words, "--study", self.folder, *arguments)
        self.assert_refused(["table.csv"], "--study", self.folder / "runs")
        table = self.folder / "table.csv"
        table.write_text(table.read_text().replace("finished", "failed"))
        self.assert_refused(["table.csv", "no run has finished"], "--study", self.folder)
        table.write_text(table.read_text().replace("status", "colour"))
        self.assert_refused(["table.csv", "column status"], "--study", self.folder)

    def assert_refused(self, words, *arguments):
        done = self.run_plot(*arguments)
        self.assertEqual(done.returncode, 2, done.stdout + done.stderr)
        self.assertEqual(len(done.stderr.splitlines()), 1, done.stderr)
        for word in words:
            self.assertIn(word, done.stderr)


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0]])

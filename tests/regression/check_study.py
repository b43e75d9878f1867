"""Law: a study's table holds what its runs left; killed and resumed it has the same histories; a failed run is a row."""

import csv
import json
import os
import signal
import statistics
import subprocess
import sys
import time
from pathlib import Path

import numpy as np

sys.dont_write_bytecode = True
sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))

from study_cases import PATIENCE, STRESS, StudyTest, run_tests  # noqa: E402


def read_rows(path):
    with open(path, newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def read_histories(folder):
    return {path.parent.name: path.read_bytes() for path in folder.glob("runs/*/history.csv")}


class Tables(StudyTest):
    def test_shipped_study_has_the_values_of_its_histories(self):
        study = self.source / "apps" / "cases" / "study_creep_scatter.json"
        done = self.run_study(study, "--output", self.output)
        self.assertIn("6 of 6 runs finished", done.stderr)
        rows = read_rows(self.output / "table.csv")
        self.assertEqual([(row["stress"], row["seed"]) for row in rows],
                         [(stress, seed) for stress in ("15000000", "21700000") for seed in ("1", "2", "3")])
        self.assertEqual({row["status"] for row in rows}, {"finished"})
        self.assertEqual(len({row["void_ratio"] for row in rows}), 6)
        for row in rows:
            self.check_row(row)
        self.check_summary(rows)

    def check_row(self, row):
        """Each result once more, by other means."""
        folder = self.output / "runs" / row["run"]
        self.assertIn(f"set Seed             = {row['seed']}".replace(" ", ""),
                      (folder / "parameters.prm").read_text(encoding="utf-8").replace(" ", ""))
        history = read_rows(folder / "history.csv")
        loading = [line for line in history if line["stage"] == "1"]
        start = loading[-1]
        creep = [(float(line["time_s"]) - float(start["time_s"]), float(line["strain_zz"]) - float(start["strain_zz"]))
                 for line in [start] + [line for line in history if line["stage"] == "2"]]
        self.assertEqual(float(row["void_ratio"]), float(loading[-1]["void_ratio"]))
        self.assertAlmostEqual(float(loading[-1]["stress_zz_Pa"]) / float(row["stress"]), 1., delta=2e-3)  # the servo's
        for time_s in ("100", "10000", "1e+06"):
            expected = [strain for moment, strain in creep if moment <= float(time_s) * (1 + 1e-9)][-1]
            self.assertAlmostEqual(float(row[f"creep_strain_at_{time_s}_s"]), expected, delta=1e-11)  # ten digits
        fitted = np.array([point for point in creep if 100. <= point[0] <= 1e6])
        self.assertAlmostEqual(float(row["slope_per_decade"]), np.polyfit(np.log10(fitted[:, 0]), fitted[:, 1], 1)[0],
                               delta=1e-10)  # ten digits
        summary = json.loads((folder / "summary.json").read_text(encoding="utf-8"))
        self.assertEqual(int(row["broken_delayed"]), summary["broken_delayed"])
        self.assertAlmostEqual(float(row["friction"]), summary["figures"]["packing friction [-]"], delta=1e-10)

    def check_summary(self, rows):
        for line in read_rows(self.output / "summary.csv"):
            values = [float(row["void_ratio"]) for row in rows if row["stress"] == line["stress"]]
            low, _, high = statistics.quantiles(values, n=4, method="inclusive")
            expected = {"median": statistics.median(values), "mean": statistics.mean(values),
                        "deviation": statistics.stdev(values), "quartile_low": low, "quartile_high": high,
                        "least": min(values), "largest": max(values), "runs": 3}
            for name, value in expected.items():
                self.assertAlmostEqual(float(line[f"void_ratio_{name}"]) / value, 1., delta=1e-9)  # ten digits
            self.assertEqual((line["seeds"], line["finished"]), ("3", "3"))

    def test_zip_takes_values_side_by_side(self):
        grains = {"name": "Packing/Grains", "values": [60, 70], "label": "n"}
        study = self.write_study(parameters=[STRESS, grains], combine="zip", settings={"Stage 2/Duration": 10}, seeds=[1])
        self.run_study(study, "--output", self.output, "--quiet")
        rows = read_rows(self.output / "table.csv")
        self.assertEqual([row["run"] for row in rows], ["stress_5000000-n_60-seed_1", "stress_10000000-n_70-seed_1"])
        for row in rows:
            history = read_rows(self.output / "runs" / row["run"] / "history.csv")
            self.assertEqual((history[0]["grains"], history[-1]["time_s"]), (row["n"], "10"))
        listed = self.run_study(self.write_study(parameters=[STRESS, grains]), "--check").stdout.split()
        self.assertEqual(len(listed), 8)  # the grid: 2 x 2 values, 2 seeds


class Interruption(StudyTest):
    def start(self, *arguments):
        """A study of which at least one run has ended and one is under way."""
        process = subprocess.Popen(self.make_command(*arguments, "--processes", 1), stderr=subprocess.PIPE, text=True)
        self.addCleanup(process.stderr.close)
        limit = time.monotonic() + PATIENCE
        while process.poll() is None and time.monotonic() < limit and not self.is_half_way():
            time.sleep(0.005)
        self.assertIsNone(process.poll(), "the study was over before it could be stopped")
        return process

    def is_half_way(self):
        """Some outcome is there, and another run has written a checkpoint under creep."""
        ended = {path.parent for path in self.output.glob("runs/*/outcome.json")}
        return ended and any(path.read_bytes().count(b"\n") > 15 for path in self.output.glob("runs/*/history.csv")
                             if path.parent not in ended and (path.parent / "checkpoint.h5").exists())

    def assert_nothing_runs(self):
        """No process has the study's folder on its command line."""
        limit, wanted = time.monotonic() + 5., str(self.output).encode()
        while any(wanted in command for command in list_commands()):
            self.assertLess(time.monotonic(), limit, "a run has outlived its study")
            time.sleep(0.01)
        cut_off = [path for path in self.output.glob("runs/*") if not (path / "outcome.json").exists()]
        self.assertEqual(len(cut_off), 1)
        self.assertFalse((cut_off[0] / "summary.json").exists(), "a run went on to its end without its study")

    def test_killed_and_resumed_has_the_same_histories(self):
        study = self.write_study(seeds={"first": 1, "count": 3})
        whole = self.folder / "whole"
        self.run_study(study, "--output", whole)
        process = self.start(study, "--output", self.output)
        os.kill(process.pid, signal.SIGKILL)
        process.wait()
        self.assert_nothing_runs()
        ended = {path: path.stat().st_mtime_ns for path in self.output.glob("runs/*/outcome.json")}
        self.assertTrue(0 < len(ended) < 3)
        self.run_study("--resume", self.output, study)
        self.assertEqual(ended, {path: path.stat().st_mtime_ns for path in ended})  # those were not run again
        self.assertEqual(read_histories(self.output), read_histories(whole))
        rows, expected = read_rows(self.output / "table.csv"), read_rows(whole / "table.csv")
        self.assertEqual(sorted(row["resumed"] for row in rows), ["0", "0", "1"])
        for row, other in zip(rows, expected):
            self.assertEqual([row[name] for name in ("run", "status", "void_ratio", "cycles")],
                             [other[name] for name in ("run", "status", "void_ratio", "cycles")])

    def test_interrupted_it_ends_its_runs_and_writes_its_table(self):
        study = self.write_study(seeds={"first": 1, "count": 3})
        for number in (signal.SIGTERM, signal.SIGINT):
            with self.subTest(signal=number.name):
                self.output = self.folder / number.name
                process = self.start(study, "--output", self.output)
                process.send_signal(number)
                self.assertEqual(process.wait(PATIENCE), 1)
                self.assertIn("--resume", process.stderr.read())
                self.assert_nothing_runs()
                states = [row["status"] for row in read_rows(self.output / "table.csv")]
                self.assertEqual(sorted(set(states)), ["finished", "not run"])


class Failures(StudyTest):
    CAP = {"name": "Equilibrium/Cycle cap", "values": [10, 200000]}  # no REV comes to rest in ten cycles

    def test_failed_runs_are_rows_and_the_others_go_on(self):
        study = self.write_study(parameters=[self.CAP], settings={"Stage 2/Duration": 10})
        done = self.run_study(study, "--output", self.output, "--quiet", status=1)
        self.assertIn("2 of 4 runs without results (2 failed)", done.stderr)
        rows = read_rows(self.output / "table.csv")
        self.assertEqual([(row["cycle_cap"], row["status"], row["exit_status"]) for row in rows],
                         [("10", "failed", "1")] * 2 + [("200000", "finished", "0")] * 2)
        self.assertIn("no equilibrium", rows[0]["message"])
        self.assertEqual([bool(row["void_ratio"]) for row in rows], [False, False, True, True])
        summary = read_rows(self.output / "summary.csv")
        self.assertEqual([(row["finished"], row["void_ratio_median"] == "nan") for row in summary],
                         [("0", True), ("2", False)])
        times = self.get_times()
        self.run_study("--resume", self.output, "--quiet", status=1)
        self.assertEqual(self.get_times(), times)  # nothing was run again
        self.run_study("--resume", self.output, "--quiet", "--retry-failed", status=1)
        changed = [name for name, value in self.get_times().items() if value != times[name]]
        self.assertEqual(sorted(changed), ["cycle_cap_10-seed_1", "cycle_cap_10-seed_2"])

    def get_times(self):
        return {path.parent.name: path.stat().st_mtime_ns for path in self.output.glob("runs/*/outcome.json")}

    def test_timeout_and_a_column_that_is_not_there(self):
        study = self.write_study(seeds=[1], timeout_s=0.05)
        self.run_study(study, "--output", self.output, "--quiet", status=1)
        row, = read_rows(self.output / "table.csv")
        self.assertEqual((row["status"], row["message"]), ("timed out", "not finished within 0.05 s"))
        study = self.write_study(seeds=[1], results=[{"column": "colour"}])  # results and time may change
        self.run_study(study, "--resume", self.output, "--quiet", "--retry-failed", status=1)
        row, = read_rows(self.output / "table.csv")
        self.assertEqual(row["status"], "no results")
        self.assertIn("column colour is missing", row["message"])
        self.run_study(self.write_study(seeds=[1]), "--resume", self.output, "--quiet")
        row, = read_rows(self.output / "table.csv")
        self.assertEqual(row["status"], "finished")


def list_commands():
    commands = []
    for path in Path("/proc").glob("[0-9]*/cmdline"):
        try:
            commands.append(path.read_bytes())
        except OSError:
            pass
    return commands


if __name__ == "__main__":
    run_tests(__doc__)

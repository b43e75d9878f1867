"""Law: one command makes every experiment of the time-to-fracture paper in its small size, with a row for each statement,
a figure for each experiment, and closed-form statements met; verdicts follow their bounds; bad input is refused."""

import csv
import math
import re
import subprocess
import sys
from pathlib import Path

sys.dont_write_bytecode = True
sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))

from study_cases import PATIENCE, StudyTest, run_tests  # noqa: E402

FIGURES = ("fig1", "fig2", "fig3", "fig5", "fig6", "fig7", "fig8", "triaxial", "fig9", "fig10", "fig11", "walls",
           "compression", "waiting", "sensitivity")
CLOSED_FORMS = ("siblings", "slope", "v0", "first_jump")
COLUMNS = ["figure", "statement", "paper", "ours", "scatter", "agrees"]


def read_rows(path):
    with open(path, newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


class Paper(StudyTest):
    def run_paper(self, *arguments, status=0):
        done = subprocess.run(["bash", str(self.source / "apps/cases/paper/run.sh"), *map(str, arguments)],
                              capture_output=True, text=True, timeout=2 * PATIENCE)
        self.assertEqual(done.returncode, status, done.stdout + done.stderr)
        return done

    def test_small_set_is_whole(self):
        statements = read_rows(self.source / "apps/cases/paper/statements.csv")
        document = self.folder / "paper.md"
        options = ("--programs", self.build, "--runs", self.folder / "runs")
        self.run_paper("small", *options, "--document", document)
        output = self.folder / "paper" / "small"
        self.check_rows(statements, read_rows(output / "results.csv"))
        for figure in FIGURES:
            picture = (output / "figures" / f"{figure}.png").read_bytes()
            self.assertTrue(picture.startswith(b"\x89PNG") and picture.rstrip().endswith(b"IEND\xaeB`\x82"), figure)
        self.check_page(statements, document.read_text(encoding="utf-8"))
        self.check_one_again(options, output)

    def check_rows(self, statements, rows):
        self.assertEqual(list(rows[0]), COLUMNS)
        for statement in statements:
            text = statement["statement"] + (f" [{statement['unit']}]" if statement["unit"] != "-" else "")
            found = [row for row in rows if row["figure"] == statement["figure"] and row["statement"] == text]
            self.assertEqual(len(found), 1, text)
            self.assertEqual(found[0]["paper"], statement["paper"])
            self.assertTrue(math.isfinite(float(found[0]["ours"])), text)
            if statement["key"] in CLOSED_FORMS:
                self.assertEqual(found[0]["agrees"], "yes", text)
            elif statement["full_only"] == "yes" or not statement["low"]:
                self.assertEqual(found[0]["agrees"], "-", text)
            else:  # to four digits, as printed
                ours, slack = float(found[0]["ours"]), 1e-3 * abs(float(found[0]["ours"]))
                if float(statement["low"]) + slack <= ours <= float(statement["high"]) - slack:
                    self.assertEqual(found[0]["agrees"], "yes", text)
                if not float(statement["low"]) - slack <= ours <= float(statement["high"]) + slack:
                    self.assertEqual(found[0]["agrees"], "no", text)
        slope = [row for row in rows if row["statement"].startswith("slope of log crack velocity")][0]
        self.assertEqual(slope["ours"], "60")

    def check_page(self, statements, page):
        for statement in statements:
            self.assertIn(statement["statement"], page)
        for link in re.findall(r"!\[[^]]*\]\(([^)]+)\)", page):
            self.assertTrue((self.folder / link).is_file(), link)

    def check_one_again(self, options, output):
        """Runs are found again: nothing is started, the numbers are the same."""
        again = self.folder / "again"
        done = self.run_paper("small", "fig3", *options, "--output", again)
        self.assertNotIn("paper: ", done.stderr)
        rows = read_rows(again / "results.csv")
        self.assertEqual(rows, [row for row in read_rows(output / "results.csv") if row["figure"] == "fig3"])

    def test_any_parameter_can_be_set(self):
        """Another exponent of Charles' law is the slope of Fig. 3, which disagrees with the paper's 60; a setting that is
        none, and a parameter that there is not, are said."""
        options = ("--programs", self.build, "--seeds", 1, "--output", self.folder / "out")
        self.run_paper("small", "fig3", *options, "--set", "Crack growth/Exponent=40")
        slope = [row for row in read_rows(self.folder / "out" / "rows.csv") if row["statement"].startswith("slope of log")][0]
        self.assertEqual((slope["ours"], slope["agrees"]), ("40", "no"))
        self.assertIn("Crack growth/Exponent=40", slope["made with"])
        self.assertIn("SECTION/NAME=VALUE", self.run_paper("small", "fig3", *options, "--set", "Exponent", status=2).stderr)
        done = self.run_paper("small", "fig3", *options, "--set", "Crack growth/Exponnent=40", status=1)
        self.assertIn("unknown parameter", done.stderr)

    def test_run_that_fails_is_said(self):
        program = self.folder / "slowsand-rev"
        program.write_text("#!/bin/bash\necho 'disk is full' >&2\nexit 1\n", encoding="utf-8")
        program.chmod(0o755)
        done = self.run_paper("small", "fig7", "fig2", "--programs", self.folder, "--output", self.folder / "out", status=1)
        self.assertIn("exit status 1: disk is full", done.stderr)
        rows = read_rows(self.folder / "out" / "results.csv")
        self.assertEqual({row["agrees"] for row in rows}, {"no result"})
        self.assertEqual({row["figure"] for row in rows}, {"fig2", "fig7"})

    def test_bad_input(self):
        done = self.run_paper("small", "fig4", "--programs", self.build, status=2)
        self.assertIn("no experiment 'fig4'", done.stderr)
        done = self.run_paper("small", "--programs", self.folder, "--output", self.folder / "out", status=2)
        self.assertIn("has not been built", done.stderr)

    def test_verdicts_follow_their_bounds(self):
        sys.path.insert(0, str(self.source / "apps"))
        from paper.statements import Results, read_statements
        for values, is_full, expected in (([22., 23.], True, "yes"), ([10., 12.], True, "no"), ([], True, "no result"),
                                          ([math.nan], True, "no")):
            results = Results(read_statements(self.source / "apps/cases/paper/statements.csv"), is_full)
            results.add("q_max", values)
            self.assertEqual(results.judge(results.rows["q_max"]), expected)
        results = Results(results.statements, False)
        results.add("grains", [200.])
        self.assertEqual(results.judge(results.rows["grains"]), "-")

    def test_yield_is_where_two_lines_cross(self):
        """Of a curve of two straight lines in log stress: their corner, to rounding."""
        sys.path.insert(0, str(self.source / "apps"))
        import numpy as np
        from paper.compression import find_yield
        stress = np.logspace(5, 8, 301)
        x = np.log10(stress)
        strain = 0.01 * x + 0.1 * np.maximum(x - 7.2, 0.)
        self.assertAlmostEqual(np.log10(find_yield((stress, strain))), 7.2, places=9)

    def test_waiting_is_worth_a_stress(self):
        """A material that obeys time-stress equivalence has C_alpha/C_c = 1/(n (1 - 1/b)) exactly; what comes back on
        unloading does not count."""
        sys.path.insert(0, str(self.source / "apps"))
        import numpy as np
        from paper import waiting
        tops = np.array([21.7, 27., 32., 38., 47., 60., 80., 104.]) * 1e6
        columns = {"stage": [2], "stress_zz_Pa": [tops[0]], "strain_zz": [0.]}
        for k, top in enumerate(tops[1:]):
            left = 0.2 * np.log10(top / tops[0])
            for stage, stress, strain in ((3 + 2 * k, top, left + 0.01), (4 + 2 * k, tops[0], left)):
                for name, value in zip(columns, (stage, stress, strain)):
                    columns[name].append(value)

        class Run:
            def get_column(self, name):
                return np.array(columns[name])
        curve = waiting.read_irrecoverable(Run())
        for n in waiting.EXPONENTS:
            low, high = waiting.raise_stress(waiting.WINDOW, n)
            left = np.diff(waiting.compute_irrecoverable(curve, [low, high]))[0]
            self.assertAlmostEqual(left / np.log10(high / low), 0.2, places=9)
            self.assertAlmostEqual(left / 4. / 0.2, 1. / (n * (1. - 1. / 1.83472)), places=9)  # four decades
            self.assertAlmostEqual(waiting.compute_index(curve, (low, high)), 0.2, places=9)

    def test_grains_broken_by_waiting_and_by_the_stress_it_is_worth(self):
        """By hand: three before; 10 within 1e6 s of 12; 1 at each 1 MPa from 21.7 to 104 MPa, unloadings not counted."""
        sys.path.insert(0, str(self.source / "apps"))
        import numpy as np
        from paper import waiting

        class Run:
            def __init__(self, **columns):
                self.columns = columns

            def get_column(self, name):
                return np.array(self.columns[name])
        crept = Run(stage=[2, 3, 3, 3], time_s=[0., 1e2, 1e6, 1e7], broken_instant=[3, 3, 4, 4], broken_delayed=[0, 5, 9, 11])
        stress = np.array([10e6, 21.7e6, 61.7e6, 21.7e6, 104e6])
        compressed = Run(stage=[2, 2, 3, 4, 5], stress_zz_Pa=stress, broken_instant=[1, 3, 43, 43, 85.3], broken_delayed=[0] * 5)
        for n in waiting.EXPONENTS:
            waited, worth = waiting.count_broken(crept, compressed, n)
            self.assertEqual(waited, 10)
            self.assertAlmostEqual(worth, (waiting.raise_stress(1e6, n) - 21.7e6) / 1e6, places=6)

    def test_void_ratio_inside_a_box(self):
        """One grain in the middle of a box of which a margin is left out: closed form, to the grid's 120 points an edge; a
        grain within the margin does not count."""
        sys.path.insert(0, str(self.source / "apps"))
        import numpy as np
        from paper.walls import compute_void_ratio_inside
        from plotting.snapshot import Snapshot
        box = Snapshot(Path(), 0., np.diag([1.4, 1.4, 1.6]), np.array([[0.7, 0.7, 0.8], [0.1, 0.1, 0.1]]),
                       np.array([0.4, 0.09]), np.zeros(2))
        solid = 4. / 3. * math.pi * 0.4**3
        self.assertAlmostEqual(compute_void_ratio_inside(box, 0.2) / ((1. * 1. * 1.2 - solid) / solid), 1., delta=2e-3)

    def make_creep(self, logs, strains, summary):
        """A run folder that says a creep stage of its own: strain [-] at times of these logarithms [s]."""
        run = self.folder / "made"
        run.mkdir(exist_ok=True)
        lines = ["time_s,stage,kind,strain_zz,stress_zz_Pa,broken_instant,broken_delayed", "0,3,load,0.02,3e7,0,0"]
        lines += [f"{10.**x!r},4,dynamic,{0.02 + e!r},3e7,0,{k + 1}" for k, (x, e) in enumerate(zip(logs, strains))]
        (run / "history.csv").write_text("\n".join(lines) + "\n", encoding="utf-8")
        (run / "parameters.prm").write_text("subsection Stage 4\n  set Kind = creep\nend\n", encoding="utf-8")
        from plotting.run_folder import RunFolder
        made = RunFolder(run)
        made.summary = summary
        return made

    def test_rupture_is_the_earlier_of_strain_and_event(self):
        """Of 1 % a decade from 1 s: 3.5 % are exceeded at 1e4 s, the first row beyond; an earlier event of the run's own
        wins."""
        sys.path.insert(0, str(self.source / "apps"))
        from paper.triaxial import find_rupture
        logs = list(range(7))
        for summary, expected in (({}, 1e4), ({"rupture_time_s": 1e6}, 1e4), ({"rupture_time_s": 1e2}, 1e2)):
            self.assertAlmostEqual(find_rupture(self.make_creep(logs, [0.01 * x for x in logs], summary), 0.035) / expected,
                                   1., places=9)
        self.assertEqual(find_rupture(self.make_creep(logs, [0.01 * x for x in logs], {}), 0.07), math.inf)

    def test_steepest_creep_of_a_bent_line(self):
        """1 % a decade to 1e4 s, then 5 %: the steepest half decade has 5 %, five times the mean before; a straight line
        has its own slope, and once it. Rows are finer than the grid: to a row's share of half a decade, 2 %."""
        sys.path.insert(0, str(self.source / "apps"))
        from paper.triaxial import find_steepest
        logs = [k / 100 for k in range(601)]
        bent = [1e-9 + 0.01 * x + 0.04 * max(0., x - 4.) for x in logs]
        slope, ratio = find_steepest(self.make_creep(logs, bent, {}))
        self.assertAlmostEqual(slope / 0.05, 1., delta=0.02)
        self.assertAlmostEqual(ratio / 5., 1., delta=0.02)
        slope, ratio = find_steepest(self.make_creep(logs, [1e-9 + 0.01 * x for x in logs], {}))
        self.assertAlmostEqual(slope / 0.01, 1., delta=0.02)
        self.assertTrue(math.isnan(ratio) or abs(ratio - 1.) < 0.04)

    def test_drawn_grading_is_the_programs(self):
        sys.path.insert(0, str(self.source / "apps"))
        from paper.packing import GRADING
        text = (self.source / "dem/grading.cc").read_text(encoding="utf-8")
        body = text[text.index("Grading make_ne34_grading()"):]
        points = re.findall(r"\{([\d.]+)e-3, ([\d.]+)\}", body[:body.index("};")])
        self.assertEqual([(float(d), 100 * float(p)) for d, p in points], [tuple(point) for point in GRADING])


if __name__ == "__main__":
    run_tests(__doc__)

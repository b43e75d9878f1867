"""Law: numbers of slowsand-plot equal known answers (slopes, grading with fines, invariants, mesh, spheres)."""

import argparse
import csv
import io
import math
import shutil
import subprocess
import sys
import tempfile
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
from plotting import (curves, fluctuation, fracture_times, grading, rev_picture, run_folder, shaft, snapshot,  # noqa: E402
                      specimen, stress_path, vtu)

SAMPLES = SOURCE / "tests" / "regression" / "deal_ii_fields"


def print_slopes(*arguments):
    """Rows of the CSV that slowsand-plot prints."""
    command = ["/usr/bin/python3", str(SOURCE / "apps" / "slowsand-plot"), "--print-slopes", *map(str, arguments)]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    return list(csv.DictReader(io.StringIO(done.stdout)))


class Slopes(unittest.TestCase):
    """Law: strain = a + s log10(t) with t from the start of creep has the slope s in every decade."""

    def setUp(self):
        self.folder = Path(self.enterContext(tempfile.TemporaryDirectory()))

    def test_slope_of_a_line_is_found_in_each_decade(self):
        rows = print_slopes(plot_runs.write_rev_run(self.folder / "run"), "--decades", 2, 6)
        self.assertEqual([row["from_s"] for row in rows], ["100", "1000", "10000", "100000", "100"])
        for row in rows:  # history.csv carries 17 digits, the printout 8: 1e-7 of the slope is rounding
            self.assertAlmostEqual(float(row["slope_per_decade"]) / plot_runs.SLOPE, 1., delta=1e-7)
            self.assertEqual(row["rows"], "81" if row is rows[-1] else "21")  # 20 rows a decade, both ends in

    def test_mean_over_gauss_points_and_longest_stage_without_parameters(self):
        run = plot_runs.write_bvp_run(self.folder / "run", SAMPLES)
        (run / "parameters.prm").unlink()
        self.assertAlmostEqual(float(print_slopes(run)[-1]["slope_per_decade"]) / plot_runs.SLOPE, 1., delta=1e-7)

    def test_interval_is_that_of_student(self):
        row = print_slopes(plot_runs.write_rev_run(self.folder / "run", scatter=2e-4))[-1]
        columns = plot_runs.make_history(scatter=2e-4)
        time, strain = columns["time"] - plot_runs.CREEP_START, columns["axial"]
        chosen = (columns["stage"] == 2) & (time > 99.) & (time < 1.01e6)
        fit, covariance = np.polyfit(np.log10(time[chosen]), strain[chosen], 1, cov=True)  # an independent fit
        half = 1.99045 * math.sqrt(covariance[0, 0])  # t of 79 degrees, two-sided 95 %, from tables
        self.assertAlmostEqual(float(row["slope_per_decade"]), fit[0], delta=1e-9)
        self.assertAlmostEqual(float(row["interval_high"]) - fit[0], half, delta=1e-4 * half)  # digits of the table
        self.assertTrue(float(row["interval_low"]) < plot_runs.SLOPE < float(row["interval_high"]))

    def test_quantiles_of_student(self):
        for degrees, value in ((1, 12.7062), (2, 4.30265), (10, 2.22814), (120, 1.97993)):  # tables, six digits
            self.assertAlmostEqual(curves.compute_t_quantile(degrees) / value, 1., delta=1e-4)

    def test_too_few_rows_give_no_slope(self):
        row = print_slopes(plot_runs.write_rev_run(self.folder / "run"), "--decades", 7, 8)[0]
        self.assertEqual((row["rows"], row["slope_per_decade"]), ("0", "nan"))


class Grading(unittest.TestCase):
    """Law: siblings keep 0.523861 of their parent's volume, the rest are fines, log-uniform in [d_c/10, d_c]."""

    def test_one_broken_grain(self):
        folder = Path(self.enterContext(tempfile.TemporaryDirectory()))
        files = [plot_runs.write_snapshot(folder / "b_final.h5", 0., broken=(0,)),
                 plot_runs.write_snapshot(folder / "a_initial.h5", 0., broken=())]
        first, last = snapshot.find_first_and_last(files)[""]
        self.assertEqual((first.path.name, last.path.name), ("a_initial.h5", "b_final.h5"))
        parent = 4. / 3. * math.pi * 0.135e-3**3
        lost = first.compute_solid_volume() - last.compute_solid_volume()
        self.assertAlmostEqual(lost / parent, 1. - 0.523861, delta=1e-6)  # the constant has six digits
        limit, total = 1e-5, first.compute_solid_volume()
        at = np.array([0.9e-6, 1e-5 / math.sqrt(10.), 1e-5, 1e-3])  # below, middle, top of the fines, above all grains
        passing = grading.compute_passing(grading.gather_grains([last]), lost, limit, at)
        np.testing.assert_allclose(passing, [0., lost / total / 2, lost / total, 1.], rtol=1e-12, atol=1e-15)

    def test_without_fines_the_share_is_that_of_the_grains(self):
        diameters, volumes = np.array([3., 1., 2.]), np.array([5., 1., 2.])
        passing = grading.compute_passing((diameters, volumes), 0., 0., np.array([0.5, 1., 2.5, 3.]))
        np.testing.assert_allclose(passing, [0., 1 / 8, 3 / 8, 1.], rtol=1e-15)


class Measures(unittest.TestCase):
    """Law: tables and figures of breakage measures equal what the run is known to hold."""

    def setUp(self):
        self.run = run_folder.RunFolder(plot_runs.write_rev_run(
            Path(self.enterContext(tempfile.TemporaryDirectory())) / "run"))

    def print_table(self, option):
        command = ["/usr/bin/python3", str(SOURCE / "apps" / "slowsand-plot"), option, str(self.run.path)]
        done = subprocess.run(command, capture_output=True, text=True, check=True)
        return list(csv.DictReader(io.StringIO(done.stdout)))

    def test_fluctuation_is_that_of_what_broke_under_control(self):
        found = fluctuation.read_fluctuation(self.run)
        broken, rise, drop = np.array(plot_runs.DISTURBANCES).T
        np.testing.assert_array_equal(found.broken, broken)
        np.testing.assert_array_equal(found.rise, rise)
        np.testing.assert_array_equal(found.drop, -drop)
        np.testing.assert_allclose(found.mean, [0.4e6, 0.06e6, 0.02e6], rtol=1e-15)

    def test_times_to_fracture_are_sorted(self):
        # Every crack has 0.9 R to go at one velocity: the smallest radius first, ties by number, siblings never.
        rows = [row for row in self.print_table("--print-times") if row["snapshot"] == "final"]
        self.assertEqual(len(rows), 216 - 7)
        times = [float(row["time_to_fracture_s"]) for row in rows]
        self.assertEqual(times, sorted(times))
        self.assertAlmostEqual(times[0] / (0.9 * 0.1e-3 / plot_runs.CRACK_VELOCITY), 1., delta=1e-9)  # ten digits
        self.assertAlmostEqual(times[-1] / (0.9 * 0.135e-3 / plot_runs.CRACK_VELOCITY), 1., delta=1e-9)
        self.assertEqual([int(row["rank"]) for row in rows], list(range(1, len(rows) + 1)))
        first = [int(row["grain"]) for row in rows if row["time_to_fracture_s"] == rows[0]["time_to_fracture_s"]]
        self.assertEqual(first, sorted(first))

    def test_a_crack_that_is_through_takes_no_time(self):
        cracks = snapshot.Cracks(*(np.array(values) for values in (
            [4, 3, 2], [1., 1., 1.], [1.5, 0.5, 0.], [0.1, 0.1, 0.])))
        grains, times = fracture_times.sort_times(cracks)
        np.testing.assert_array_equal(grains, [4, 3])
        np.testing.assert_allclose(times, [0., 5.], rtol=1e-15)

    def test_fractures_are_counted_by_cause_generation_and_size(self):
        rows = self.print_table("--print-fractures")
        total = {(cause, generation): sum(int(row["broken"]) for row in rows if (row["cause"], row["generation"])
                                          == (cause, generation))
                 for cause in ("delayed", "instant") for generation in ("0", "1")}
        self.assertEqual(total, {("delayed", "0"): 2, ("instant", "0"): 1, ("delayed", "1"): 0, ("instant", "1"): 1})
        largest = [row for row in rows if float(row["to_diameter_m"]) > 0.2699e-3]
        self.assertEqual({(row["cause"], row["broken"]) for row in largest}, {("delayed", "1"), ("instant", "1")})
        packing = [row for row in rows if row["cause"] == "delayed" and row["generation"] == "0"]
        self.assertEqual(sum(int(row["grains_of_the_packing"]) for row in packing), 216)
        self.assertEqual([row["grains_of_the_packing"] for row in rows if row["generation"] == "1"], ["nan"])


class Shaft(unittest.TestCase):
    """Law: the mean over the shaft of a stress that is linear in depth is that at the middle of its points."""

    def test_mean_of_the_points_nearest_to_the_wall(self):
        folder = Path(self.enterContext(tempfile.TemporaryDirectory()))
        depths = (4., 0.5, 1.5)  # in no order, unevenly
        with open(folder / "shaft.csv", "w", encoding="utf-8") as file:
            file.write("age_s,stage,step,point,depth_m,distance_m,radial_stress_Pa\n")
            for step, age in enumerate((0., 1e4)):
                for i, depth in enumerate(depths):
                    file.write(f"{age},1,{step},{2 * i},{depth},0.01,{(step + 1) * 1e5 * depth}\n")
                    file.write(f"{age},1,{step},{2 * i + 1},{depth},0.04,7e9\n")  # further off: left out
        ages, _, means = shaft.compute_means(run_folder.Table(folder / "shaft.csv"), "radial_stress_Pa")
        np.testing.assert_array_equal(ages, [0., 1e4])
        np.testing.assert_allclose(means, [2.25e5, 4.5e5], rtol=1e-14)


class StressPath(unittest.TestCase):
    """Law: p = tr/3 and q = |axial - radial| in axisymmetric compression; neither changes under a rotation."""

    def test_invariants(self):
        p, q = stress_path.compute_invariants(np.array([[9., 9., 21.7, 0., 0., 0.], [0., 0., 0., 2., 0., 0.]]))
        np.testing.assert_allclose(p, [39.7 / 3, 0.], rtol=1e-15, atol=1e-15)
        np.testing.assert_allclose(q, [12.7, math.sqrt(3.) * 2.], rtol=1e-14)
        turn = np.linalg.qr(np.random.default_rng(1).standard_normal((3, 3)))[0]
        s = turn @ np.diag([9., 9., 21.7]) @ turn.T
        turned = np.array([[s[0, 0], s[1, 1], s[2, 2], s[0, 1], s[1, 2], s[0, 2]]])
        np.testing.assert_allclose(np.ravel(stress_path.compute_invariants(turned)), [39.7 / 3, 12.7], rtol=1e-13)


class Mesh(unittest.TestCase):
    """Law: what deal.II wrote is what is read: box, cells, field values, time; a box shows its surface alone."""

    def test_plane_mesh(self):
        grid = vtu.read_pvtu(SAMPLES / "two_0003.pvtu")
        self.assertEqual((grid.cells.shape, grid.is_solid), ((6, 4), False))
        np.testing.assert_allclose(grid.points.max(axis=0), [0.01, 0.02, 0.], rtol=1e-6)  # written as 32-bit numbers
        corners = grid.points[grid.cells]
        area = 0.5 * np.cross(corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1])[:, 2]
        np.testing.assert_allclose(area, 2e-4 / 6, rtol=1e-5)  # positive: corners go round, as the drawing needs
        np.testing.assert_allclose(np.unique(grid.fields["void_ratio"]), 0.6 + 0.01 * np.arange(6), rtol=1e-6)

    def test_pieces_of_several_processes_make_one_mesh(self):
        folder = Path(self.enterContext(tempfile.TemporaryDirectory()))
        for name in ("a.vtu", "b.vtu"):
            shutil.copy(SAMPLES / "two_0003.0.vtu", folder / name)
        pieces = "".join(f'<Piece Source="{name}"/>' for name in ("a.vtu", "b.vtu"))
        (folder / "all.pvtu").write_text(f"<VTKFile><PUnstructuredGrid>{pieces}</PUnstructuredGrid></VTKFile>",
                                         encoding="utf-8")
        grid, one = vtu.read_pvtu(folder / "all.pvtu"), vtu.read_last_fields(SAMPLES)  # three.pvd is the first by name
        self.assertEqual((len(grid.cells), grid.cells.max()), (12, len(grid.points) - 1))
        np.testing.assert_array_equal(grid.points[grid.cells[6:]], grid.points[grid.cells[:6]])
        self.assertEqual(one.time, 1.5)  # as the .pvd says

    def test_solid_mesh(self):
        grid = vtu.read_pvtu(SAMPLES / "three_0003.pvtu")
        faces = specimen.find_surface(grid)
        self.assertEqual(len(faces), 2 * (2 * 2 + 2 * 3 + 2 * 3))
        corners = grid.points[faces]
        areas = np.linalg.norm(np.cross(corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1]), axis=1) / 2
        self.assertAlmostEqual(areas.sum() / (2 * (1 * 2 + 2 * 3 + 1 * 3) * 1e-4), 1., delta=1e-5)
        np.testing.assert_allclose(grid.fields["displacement"], 1e-4, rtol=1e-6)


class Spheres(unittest.TestCase):
    """Law: a sphere covers the disc of its radius, and the nearer of two spheres hides the other."""

    def test_disc_and_order(self):
        view = rev_picture.make_view(0., 0.)  # the eye on the positive x axis: y to the right, z up
        np.testing.assert_allclose(view, [[0., 1., 0.], [0., 0., 1.], [1., 0., 0.]], atol=1e-15)
        pair = snapshot.Snapshot(None, 0., np.eye(3), np.array([[2., 0., 0.], [0., 0., 0.]]), np.array([0.5, 1.]),
                                 np.array([1, 0]))
        picture = rev_picture.render(pair, view, (-1., 1., -1., 1.))
        covered = picture[..., 3].mean()
        self.assertAlmostEqual(covered, math.pi / 4, delta=2. / rev_picture.PIXELS)  # a pixel along the rim
        centre, rim = picture[450, 450, :3], picture[450, 850, :3]
        self.assertGreater(centre[0], 3. * centre[2])  # the small one in front, in the siblings' colour
        self.assertLess(rim[0], 2. * rim[2])


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0]])

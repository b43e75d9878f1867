"""Law: bad input gets one message that says what is wrong where, exit status 2, and nothing is overwritten; a full disk
gets path and cause, exit status 1, and the last checkpoint stays valid."""

import argparse
import pathlib
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import unittest

SKIPPED = 77  # CTest's SKIP_RETURN_CODE

CASE = """set Seed = 1
set Number of stages = 2
subsection Packing
  set Grains = 60
  set Friction = 0.1
end
subsection Stage 1
  set Kind = oedometric
  set Stress = 1e6
  set Increments = 4
end
subsection Stage 2
  set Kind = creep
  set Duration = 100
end
"""


# One element of a creeping fluid-like solid: all that a boundary-value run writes, in a second.
BVP_CASE = """set Material = viscoelastic
subsection Mesh
  set Kind = cylinder
end
subsection Boundary conditions
  set Number of conditions = 3
  subsection Condition 1
    set Boundary = bottom
  end
  subsection Condition 2
    set Boundary = outer
    set Component = r
  end
  subsection Condition 3
    set Boundary = top
    set Kind = pressure
  end
end
subsection Loading
  set Number of stages = 2
  subsection Stage 1
    set Increments = 3
    set Targets = top pressure: 1e6
  end
  subsection Stage 2
    set Kind = creep
    set Duration = 100
  end
end
"""


class BadInput(unittest.TestCase):
    build = pathlib.Path()

    def setUp(self):
        self.folder = pathlib.Path(tempfile.mkdtemp())
        self.addCleanup(shutil.rmtree, self.folder)
        self.case = self.folder / "case.prm"
        self.case.write_text(CASE)

    def run_program(self, *arguments, program="slowsand-rev", **options):
        return subprocess.run([self.build / program, *map(str, arguments), "--quiet"], capture_output=True, text=True,
                              timeout=120, cwd=self.folder, **options)

    def expect_refusal(self, result, *words):
        self.assertEqual(result.returncode, 2, result.stderr)
        # Where /sys is not mounted (a bare chroot), Open MPI's hwloc speaks first; the rest is ours and is one line.
        lines = [line for line in result.stderr.strip().splitlines() if not line.startswith("[hwloc/")]
        self.assertEqual(len(lines), 1, result.stderr)
        for word in words:
            self.assertIn(word, result.stderr)

    def line_of(self, text):
        return next(n for n, line in enumerate(self.case.read_text().splitlines(), 1) if text in line)

    def change_case(self, old, new):
        self.case.write_text(self.case.read_text().replace(old, new))

    def finish_run(self, program="slowsand-rev"):
        run = self.folder / program
        if program == "slowsand-bvp":
            self.case.write_text(BVP_CASE)
        result = self.run_program(self.case, "--output", run, program=program)
        self.assertEqual(result.returncode, 0, result.stderr)
        return run

    def read_all(self, folder):
        return {path: path.read_bytes() if path.is_file() else "a folder" for path in sorted(folder.rglob("*"))}

    # Parameters: file, line, name, value, allowed range.

    def test_misspelt_parameter(self):
        self.change_case("set Friction", "set Frictoin")
        self.expect_refusal(self.run_program(self.case), "case.prm", f"line {self.line_of('Frictoin')}", "Frictoin")

    def test_misspelt_section(self):
        self.change_case("subsection Packing", "subsection Pakcing")
        self.expect_refusal(self.run_program(self.case), "case.prm", "Pakcing")

    def test_value_out_of_range(self):
        self.change_case("set Grains = 60", "set Grains = -3")
        self.expect_refusal(self.run_program(self.case), "case.prm", f"line {self.line_of('-3')}", "Grains", "-3", ">= 10")

    def test_number_of_stages_out_of_range(self):
        self.change_case("Number of stages = 2", "Number of stages = 0")
        self.expect_refusal(self.run_program(self.case), "case.prm", f"line {self.line_of('= 0')}", "Number of stages", ">= 1")

    def test_value_that_is_no_number(self):
        self.change_case("set Stress = 1e6", "set Stress = much")
        self.expect_refusal(self.run_program(self.case), f"line {self.line_of('much')}", "Stress", "much")

    def test_override_out_of_range(self):
        self.expect_refusal(self.run_program(self.case, "--set", "Grains/Poisson ratio=0.7"), "--set", "Poisson ratio", "0.7", "0.5")

    def test_missing_case(self):
        self.expect_refusal(self.run_program("nowhere.prm"), "nowhere.prm")

    def test_stages_that_contradict_themselves(self):
        self.change_case("set Duration = 100", "set Duration = 0")
        self.expect_refusal(self.run_program(self.case, "--check"), "case.prm", f"line {self.line_of('Duration')}",
                            "Stage 2/Duration", "'0'", "above 0 s")

    def test_stage_with_two_targets(self):
        self.change_case("set Stress = 1e6", "set Stress = 1e6\n  set Axial strain = 0.1")
        self.expect_refusal(self.run_program(self.case, "--check"), f"line {self.line_of('Axial strain')}",
                            "Stage 1/Axial strain", "'0.1'", "Stress is given already")

    def test_share_of_a_strength_that_nobody_knows(self):
        self.change_case("set Kind = creep\n  set Duration = 100", "set Kind = triaxial\n  set Share of q_max = 0.9")
        self.expect_refusal(self.run_program(self.case, "--check"), f"line {self.line_of('Share')}",
                            "Stage 2/Share of q_max", "'0.9'", "searches for it")

    def test_load_without_a_target(self):
        self.change_case("  set Stress = 1e6\n", "")
        self.expect_refusal(self.run_program(self.case, "--check"), f"line {self.line_of('oedometric')}",
                            "Stage 1/Kind", "one of: Stress, Axial strain")

    def test_strength_search_without_a_drop(self):
        self.change_case("set Duration = 100", "set Drop below q_max = 1")
        self.expect_refusal(self.run_program(self.case), f"line {self.line_of('Drop')}", "'1'", "> 0 and < 1")

    def test_shear_between_walls(self):
        self.change_case("set Kind = oedometric\n  set Stress = 1e6",
                         "set Kind = strain path\n  set Strain = 0, 0, 0.01, 0.02, 0, 0")
        self.assertEqual(self.run_program(self.case, "--check").returncode, 0)
        self.expect_refusal(self.run_program(self.case, "--check", "--set", "Boundary/Kind=walls"),
                            f"line {self.line_of('Strain')}", "Stage 1/Strain", "walls cannot shear")

    def test_boundary_that_is_neither(self):
        self.expect_refusal(self.run_program(self.case, "--check", "--set", "Boundary/Kind=membrane"), "Boundary/Kind",
                            "membrane", "periodic | walls")

    def test_single_precision_where_it_does_not_reach(self):
        single = "Motion/Precision=single"
        self.expect_refusal(self.run_program(self.case, "--check", "--set", single, "--set", "Equilibrium/Unbalanced ratio=1e-9"),
                            "Unbalanced ratio", ">= 1e-06", "single")
        self.expect_refusal(self.run_program(self.case, "--check", "--set", single, "--set", "Boundary/Kind=walls"), "walls", "single")

    def test_profile_that_is_no_function(self):
        self.case.write_text(BVP_CASE)
        for number, profile, reason in ((1, "(z + 5) / height", "is no function of x, y and z"), (3, "z", "is for a displacement")):
            name = f"Boundary conditions/Condition {number}/Profile"
            self.expect_refusal(self.run_program(self.case, "--check", "--set", f"{name}={profile}", program="slowsand-bvp"), name,
                                profile, reason)

    def test_boundary_value_problem_with_unknown_parameter(self):
        self.expect_refusal(self.run_program(self.case, "--check", program="slowsand-bvp"), "case.prm")

    def test_lazy_answers_and_step_control_where_they_do_not_reach(self):
        case = self.folder / "lazy.prm"
        case.write_text(BVP_CASE.replace("set Material = viscoelastic", "set Material = rev"))
        check = (case, "--check", "--set")
        self.expect_refusal(self.run_program(*check, "REVs/Lazy tolerance=0.2", program="slowsand-bvp"), "Lazy tolerance", "0.2")
        self.expect_refusal(self.run_program(*check, "REVs/Lazy tolerance=1e-3", "--set", "Motion/Masses are true=true",
                                             program="slowsand-bvp"), "Lazy tolerance", "Masses are true")
        control = (*check, "Stepping/Control/Is active=true", "--set")
        self.expect_refusal(self.run_program(*control, "REVs/Ageing=events", program="slowsand-bvp"), "Control/Is active", "schedule")
        self.expect_refusal(self.run_program(*control, "REVs/Ageing=schedule", "--set", "Stepping/Control/Smallest share=1e-3",
                                             program="slowsand-bvp"), "Smallest share")

    # Packing files: file and line.

    def expect_packing_refused(self, text, *words):
        packing = self.folder / "packing.txt"
        packing.write_text(text)
        self.expect_refusal(self.run_program(self.case, "--set", f"Packing/File={packing}", "--output", self.folder / "run"),
                            "packing.txt", *words)
        self.assertFalse((self.folder / "run").exists())

    def test_packing_with_overlapping_grains(self):
        self.expect_packing_refused("# cell 1e-3 1e-3 1e-3\n2e-4 5e-4 5e-4 1e-4\n3e-4 5e-4 5e-4 1e-4\n", ":3", "overlap")

    def test_packing_with_a_radius_of_zero(self):
        self.expect_packing_refused("# cell 1e-3 1e-3 1e-3\n2e-4 5e-4 5e-4 0\n", ":2", "radius")

    def test_packing_beyond_a_wall(self):
        self.change_case("subsection Packing", "subsection Boundary\n  set Kind = walls\nend\nsubsection Packing")
        self.expect_packing_refused("# cell 1e-3 1e-3 1e-3\n2e-4 5e-4 4e-5 1e-4\n", ":2", "wall -5")

    def test_packing_without_a_cell(self):
        self.expect_packing_refused("2e-4 5e-4 5e-4 1e-4\n", ":1", "cell")

    # Run folders.

    def test_folder_that_holds_a_run(self):
        run = self.finish_run()
        before = self.read_all(run)
        self.expect_refusal(self.run_program(self.case, "--output", run), str(run), "--resume", "--overwrite")
        self.assertEqual(before, self.read_all(run))

    def test_nothing_to_resume(self):
        self.expect_refusal(self.run_program("--resume", self.folder / "nowhere"), "nowhere")

    def test_run_of_another_boundary(self):
        run = self.finish_run()
        before = self.read_all(run)
        self.expect_refusal(self.run_program("--resume", run, "--set", "Boundary/Kind=walls"), "checkpoint.h5",
                            "Boundary/Kind")
        self.assertEqual(before, self.read_all(run))

    def break_file(self, name, change):
        for program, changed in (("slowsand-rev", "Laboratory/Checkpoint interval=7"),
                                 ("slowsand-bvp", "Output/Checkpoint interval=7")):
            run = self.finish_run(program)
            for path in (run / name, run / name.replace(".", "_previous.")):  # else the older checkpoint helps
                if path.is_file():
                    path.write_bytes(change(path.read_bytes()))
            before = self.read_all(run)
            self.expect_refusal(self.run_program("--resume", run, "--set", changed, program=program), name)
            after = self.read_all(run)
            self.assertEqual([path for path in sorted({*before, *after}) if before.get(path) != after.get(path)], [])

    def break_checkpoint(self, change):
        self.break_file("checkpoint.h5", change)

    def test_history_of_other_columns(self):
        self.break_file("history.csv", lambda data: b"time_s,colour\n" + data)

    def test_truncated_checkpoint(self):
        self.break_checkpoint(lambda data: data[: len(data) // 2])

    def test_checkpoint_of_another_format(self):
        self.break_checkpoint(lambda data: b"not HDF5 at all" * 100)

    def test_checkpoint_of_another_program(self):
        import h5py

        run = self.finish_run()
        (run / "checkpoint.h5").unlink()
        with h5py.File(run / "checkpoint.h5", "w") as file:
            file["temperature"] = [1.0, 2.0]
        self.expect_refusal(self.run_program("--resume", run), "checkpoint.h5", "format")

    def test_replay_of_a_foreign_file(self):
        result = subprocess.run([self.build / "slowsand-replay", self.case], capture_output=True, text=True, timeout=60)
        self.expect_refusal(result, "case.prm")

    # A disk that fills up.

    def test_full_disk_keeps_the_checkpoint_alone(self):
        run = self.finish_run()
        checkpoint = run / "checkpoint.h5"
        before = checkpoint.read_bytes()
        limit = len(before) // 2  # the system refuses any larger file, as a full disk does

        def fill_disk():
            signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
            resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit))

        result = self.run_program("--resume", run, preexec_fn=fill_disk)
        self.assertEqual(result.returncode, 1, result.stderr)
        self.assertIn("checkpoint.h5", result.stderr)
        self.assertIn("arge", result.stderr)  # "File too large": the cause as the system names it
        self.assertEqual(checkpoint.read_bytes(), before)
        self.assertEqual([path.name for path in run.glob("checkpoint.h5*")], ["checkpoint.h5"])
        self.assertEqual(self.run_program("--resume", run).returncode, 0)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--source", required=True)
    parser.add_argument("--build", required=True)
    arguments, rest = parser.parse_known_args()
    BadInput.build = pathlib.Path(arguments.build).resolve()
    if not (BadInput.build / "slowsand-rev").exists():
        print("skipped: slowsand-rev has not been built")
        sys.exit(SKIPPED)
    unittest.main(argv=[sys.argv[0], *rest])


if __name__ == "__main__":
    main()

"""Law: a bad study gets one line that names file, line, key, value and what is allowed, exit status 2, before anything is
run or written."""

import contextlib
import io
import json
import runpy
import sys
import unittest.mock
from pathlib import Path

sys.dont_write_bytecode = True
sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))

from study_cases import STRESS, STUDY, StudyTest, run_tests  # noqa: E402

CREEP = {"column": "strain_zz", "stage": 2}

# name -> (changes of the study, words of the message)
KEYS = {
    "unknown key": ({"seedz": 1}, ["seedz", "did you mean 'seeds'", "allowed: case"]),
    "no such case": ({"case": "nowhere.prm"}, ["case", "nowhere.prm", "no such file"]),
    "case that is no name": ({"case": 3}, ["case", "3"]),
    "foreign program": ({"program": "rm"}, ["program", '"rm"', "slowsand-rev, slowsand-bvp"]),
    "settings in a list": ({"settings": [1]}, ["settings", "[1]", "object"]),
    "setting that is a list": ({"settings": {"Packing/Grains": [60]}}, ["settings.Packing/Grains", "[60]"]),
    "setting with an equals sign": ({"settings": {"Packing/Grains=60": 1}}, ["Packing/Grains=60", "Section/Name"]),
    "seed among the settings": ({"settings": {"Seed": 1}}, ["settings.Seed", "seeds"]),
    "combine": ({"combine": "product"}, ["combine", '"product"', "grid, zip"]),
    "no seeds": ({"seeds": []}, ["seeds", "[]", "at least one"]),
    "negative seed": ({"seeds": [1, -1]}, ["seeds[1]", "-1", "0 to 2147483647"]),
    "seed that is true": ({"seeds": [True]}, ["seeds[0]", "true", "integer"]),
    "seed twice": ({"seeds": [4, 4]}, ["seeds[1]", "4", "twice"]),
    "count of seeds": ({"seeds": {"first": 1, "count": 0}}, ["seeds.count", "0", "1 to 100000"]),
    "count without first": ({"seeds": {"count": 3}}, ["seeds", "'first' is missing"]),
    "seeds beyond the largest": ({"seeds": {"first": 2**31 - 2, "count": 3}}, ["seeds.first", "2147483645"]),
    "timeout": ({"timeout_s": 0}, ["timeout_s", "0", "> 0"]),
}
PARAMETERS = {
    "one that is no object": ({"parameters": ["Seed"]}, ["parameters[0]", '"Seed"', "object"]),
    "no list": ({"parameters": {}}, ["parameters", "list"]),
    "without values": ({"parameters": [{"name": "Packing/Grains"}]}, ["parameters[0]", "'values' is missing"]),
    "no values": ({"parameters": [{"name": "Packing/Grains", "values": []}]}, ["parameters[0].values", "at least one"]),
    "value that is null": ({"parameters": [{"name": "Packing/Grains", "values": [60, None]}]},
                           ["parameters[0].values[1]", "null", "neither a number"]),
    "value twice": ({"parameters": [{"name": "Packing/Grains", "values": [60, 60.0, 60]}]},
                    ["parameters[0].values[1]", "60", "twice"]),
    "misspelt key": ({"parameters": [{"nmae": "Packing/Grains", "values": [60]}]},
                     ["parameters[0].nmae", "did you mean 'name'"]),
    "zip of two lengths": ({"parameters": [STRESS, {"name": "Packing/Grains", "values": [60]}], "combine": "zip"},
                           ["parameters[1].values", "1 values", "has 2", "zip"]),
    "parameter twice": ({"parameters": [STRESS, STRESS]}, ["parameters[1].name", "Stage 1/Stress", "parameters[0]"]),
    "among the settings too": ({"parameters": [STRESS], "settings": {"Stage 1/Stress": 1e6}},
                               ["parameters[0].name", "Stage 1/Stress", "settings"]),
    "two of one label": ({"parameters": [STRESS, {"name": "Stage 2/Stress", "values": [1]}]},
                         ["parameters[1]", "'stress'", "label"]),
    "label with a comma": ({"parameters": [{**STRESS, "label": "a,b"}]}, ["parameters[0].label", "a,b"]),
    "label of the table": ({"parameters": [{**STRESS, "label": "seed"}]}, ["parameters[0]", "'seed'", "label"]),
    "folders of one name": ({"parameters": [{"name": "Stage 1/Name", "values": ["a b", "a_b"]}]}, ["name_a_b-seed_1"]),
    "unknown to the program": ({"parameters": [{"name": "Packing/Grians", "values": [60]}]},
                               ["parameters[0].name", "Packing/Grians", "did you mean 'Packing/Grains'"]),
    "out of the program's range": ({"parameters": [{"name": "Packing/Grains", "values": [60, 3]}]},
                                   ["parameters[0].values[1]", "Packing/Grains", "'3'", ">= 10"]),
    "setting unknown to the program": ({"settings": {"Packing/Grians": 60}}, ["settings.Packing/Grians", "Packing/Grains"]),
}
RESULTS = {
    "none": ({"results": []}, ["results", "at least one"]),
    "unknown key": ({"results": [{"colunm": "strain_zz"}]}, ["results[0].colunm", "did you mean 'column'"]),
    "neither summary nor column": ({"results": [{"name": "x"}]}, ["results[0]", "either"]),
    "column that is a number": ({"results": [{"column": 3}]}, ["results[0].column", "3"]),
    "take": ({"results": [{"column": "strain_zz", "take": "median"}]}, ["results[0].take", '"median"', "last, first"]),
    "stage": ({"results": [{"column": "strain_zz", "stage": 0}]}, ["results[0].stage", "0", ">= 1"]),
    "change without stage": ({"results": [{"column": "strain_zz", "change": True}]}, ["results[0].change", "stage"]),
    "at without times": ({"results": [{**CREEP, "take": "at"}]}, ["results[0]", "times_s"]),
    "times without at": ({"results": [{**CREEP, "times_s": [1]}]}, ["results[0].times_s", "last"]),
    "slope backwards": ({"results": [{**CREEP, "take": "slope", "times_s": [10, 1]}]}, ["results[0].times_s", "[10, 1]"]),
    "file elsewhere": ({"results": [{"column": "x", "file": "../x.csv"}]}, ["results[0].file", "../x.csv"]),
    "summary with a stage": ({"results": [{"summary": "cycles", "stage": 1}]}, ["results[0].stage", "unknown key"]),
    "column twice": ({"results": [{"column": "void_ratio"}, {"column": "void_ratio"}]},
                     ["results[1]", "'void_ratio'", "results[0]"]),
}


class BadStudy(StudyTest):
    def expect_refusal(self, words, *arguments):
        done = self.run_study(*arguments, status=2)
        self.assertEqual(len(done.stderr.splitlines()), 1, done.stderr)
        for word in words:
            self.assertIn(word, done.stderr)

    def call_study(self, *arguments):
        """(exit status, standard error) of the program inside this process: sixty times its start-up would take long."""
        spoken = io.StringIO()
        with unittest.mock.patch.object(sys, "argv", self.make_command(*arguments)[1:]):
            with contextlib.redirect_stderr(spoken):
                return runpy.run_path(sys.argv[0])["main"](), spoken.getvalue()

    def check_table(self, table):
        for name, (changes, words) in table.items():
            with self.subTest(name):
                study = self.write_study(**changes)
                status, message = self.call_study(study, "--output", self.output)
                self.assertEqual((status, len(message.splitlines())), (2, 1), message)
                for word in [str(study), *words]:
                    self.assertIn(word, message)
                self.assertRegex(message, r"study\.json, line \d+" if "folders" not in name else "study.json")
                self.assertFalse(self.output.exists())

    def test_keys(self):
        self.check_table(KEYS)

    def test_parameters(self):
        self.check_table(PARAMETERS)

    def test_results(self):
        self.check_table(RESULTS)

    def test_line_is_that_of_the_value(self):
        study = self.write_study(parameters=[{"name": "Packing/Grains", "values": [60, 70, -5]}])
        line = next(n for n, text in enumerate(study.read_text().splitlines(), 1) if "-5" in text)
        self.expect_refusal([f"line {line}, parameters[0].values[2]", "-5"], study)

    def test_text_that_is_not_json(self):
        study = self.write_study()
        sound = study.read_text()
        for text, words in ((sound.replace('"results"', "results"), ["line 7", "not valid JSON"]),
                            (sound[:40], ["not valid JSON"]), ("", ["not valid JSON"]),
                            ("[1]", ["line 1", "[1]", "object"]), ("[" * 100000, ["study.json"]),
                            (sound.replace("1,", "NaN,", 1), ["NaN", "line"]),
                            (sound.replace('"seeds"', '"seeds": [3],\n\n"seeds"'), ["line 5", "seeds", "twice"])):
            with self.subTest(text[:60]):
                study.write_text(text)
                self.expect_refusal(words, study)
        study.write_bytes(b'{"case": "\xff"}')
        self.expect_refusal(["UTF-8"], study)
        self.expect_refusal(["nowhere.json", "cannot be read"], self.folder / "nowhere.json")

    def test_case_that_the_program_refuses(self):
        case = self.folder / "small.prm"
        case.write_text(case.read_text().replace("set Friction", "set Frictoin"))
        self.expect_refusal(["small.prm", "line 4", "Frictoin"], self.write_study(), "--output", self.output)
        self.assertFalse(self.output.exists())

    def test_folders(self):
        study = self.write_study(settings={"Stage 2/Duration": 10}, seeds=[1])
        self.output.mkdir()
        (self.output / "somebody's").write_text("work")
        self.expect_refusal([str(self.output), "exists already"], study, "--output", self.output)
        self.assertEqual([path.name for path in self.output.iterdir()], ["somebody's"])
        self.expect_refusal(["study.json"], "--resume", self.output)
        self.expect_refusal(["nowhere"], "--resume", self.folder / "nowhere")
        self.expect_refusal(["has not been built"], study, "--programs", self.folder)

    def test_resumed_with_another_study(self):
        study = self.write_study(seeds=[1], settings={"Stage 2/Duration": 10})
        self.run_study(study, "--output", self.output, "--quiet")
        before = {path: path.read_bytes() for path in self.output.rglob("*") if path.is_file()}
        for changes, key in (({"seeds": [2]}, "seeds"), ({"settings": {"Stage 2/Duration": 20}}, "settings")):
            other = self.write_study(**{**json.loads(study.read_text()), **changes})
            self.expect_refusal([str(other), "line", key, "differs"], other, "--resume", self.output)
            study = self.write_study(seeds=[1], settings={"Stage 2/Duration": 10})
        case = self.folder / "small.prm"
        case.write_text(case.read_text() + "# another\n")
        self.expect_refusal(["small.prm", "differs"], study, "--resume", self.output)
        self.assertEqual(before, {path: path.read_bytes() for path in self.output.rglob("*") if path.is_file()})
        outcome = next(self.output.glob("runs/*/outcome.json"))
        outcome.write_text("{}")
        self.expect_refusal(["outcome.json"], "--resume", self.output)


if __name__ == "__main__":
    run_tests(__doc__)

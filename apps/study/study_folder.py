"""The folder of a study: study.json and case.prm as used, runs/NAME, table.csv, summary.csv.

A run's folder holds, beside what its program writes, run.log (its standard error) and, once its process has ended,
outcome.json: that file is what says that a run need not be run again.
"""

import fcntl
import json
import os
import shutil
from dataclasses import asdict, dataclass
from pathlib import Path

from plotting.errors import BadInput

from .study_file import compare_studies, read_study

FINISHED, FAILED, TIMED_OUT = "finished", "failed", "timed out"


@dataclass
class Outcome:
    """How a run's process ended."""

    status: str
    exit_status: int  # of the process; minus the number of the signal that ended it
    seconds: float  # of its last process
    resumed: bool  # its last process went on from a checkpoint
    message: str  # last line of its standard error; empty if it finished


class StudyFolder:
    """One study's folder, held by one process at a time."""

    def __init__(self, path):
        self.path, self._lock = Path(path), None

    def check_unused(self):
        """Raises BadInput if there is something already."""
        if self.path.exists() and (not self.path.is_dir() or any(self.path.iterdir())):
            raise BadInput(f"{self.path}: exists already; give another --output, or --resume {self.path} to go on with "
                           "the study that it holds")

    def create(self, study):
        """Makes the folder with copies of study and case; the study's runs are made with that copy."""
        self.check_unused()
        (self.path / "runs").mkdir(parents=True, exist_ok=True)
        self._hold()
        case = self.path / ("case" + study.case.suffix)
        shutil.copyfile(study.case, case)
        study.case = case
        write_text_file(self.path / "study.json", study.text.text)

    def reopen(self, study_path):
        """The study that the folder holds; with @p study_path that one, which must have the same runs."""
        if not (self.path / "study.json").is_file():
            raise BadInput(f"{self.path}: holds no study.json to go on with")
        cases = sorted(self.path.glob("case.*"))
        if not cases:
            raise BadInput(f"{self.path}: holds no case file (case.prm or case.json)")
        self._hold()
        study = read_study(self.path / "study.json", cases[0])
        if study_path is not None:
            given = read_study(study_path)
            compare_studies(given, study)
            given.case = study.case
            write_text_file(self.path / "study.json", given.text.text)
            study = given
        return study

    def get_run_folder(self, name):
        return self.path / "runs" / name

    def read_outcome(self, name):
        """Outcome of a run, None if it has not ended."""
        file = self.get_run_folder(name) / "outcome.json"
        if not file.is_file():
            return None
        try:
            return Outcome(**json.loads(file.read_text(encoding="utf-8")))
        except (ValueError, TypeError):
            raise BadInput(f"{file}: is not an outcome of a run; remove it to have that run made again") from None

    def write_outcome(self, name, outcome):
        write_text_file(self.get_run_folder(name) / "outcome.json", json.dumps(asdict(outcome), indent=2) + "\n")

    def _hold(self):
        """Two processes must not start the same runs. The lock ends with the process, however that ends."""
        self._lock = open(self.path / "lock", "w", encoding="utf-8")
        try:
            fcntl.flock(self._lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            raise BadInput(f"{self.path}: another slowsand-study is at work there") from None


def write_text_file(path, text):
    """Whole or not at all: under another name, then renamed."""
    temporary = path.with_name(path.name + ".tmp")
    try:
        with open(temporary, "w", encoding="utf-8") as file:
            file.write(text)
            file.flush()
            os.fsync(file.fileno())
        os.replace(temporary, path)
    except OSError:
        temporary.unlink(missing_ok=True)
        raise

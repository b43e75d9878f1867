"""What the program itself has to say against a study, asked before anything runs."""

import os
import re
import subprocess
from concurrent.futures import ThreadPoolExecutor

from plotting.errors import BadInput

from .run_plan import list_sets, make_settings
from .run_queue import ENVIRONMENT

LONGEST_CHECK = 120  # [s]


def check_case(study, program, n_processes):
    """Asks PROGRAM --check with each set of values and the first seed. Raises BadInput with the first refusal, of the
    case itself in the program's words, of a value at its place in the study file."""
    _reject_if_refused(study, None, _ask(program, study.case, study.settings.items()))
    sets = list_sets(study)
    settings = [make_settings(study, values, study.seeds[0]) for values in sets]
    with ThreadPoolExecutor(n_processes) as pool:  # threads that wait for processes
        for values, refusal in zip(sets, pool.map(lambda one: _ask(program, study.case, one), settings)):
            _reject_if_refused(study, values, refusal)


def describe_program(program):
    """Its line of --version."""
    try:
        done = subprocess.run([str(program), "--version"], capture_output=True, text=True, timeout=LONGEST_CHECK,
                              env=dict(os.environ, **ENVIRONMENT))
        return done.stdout.strip()
    except OSError:
        return f"{program}: has not been built"


def _ask(program, case, settings):
    """The program's refusal without its name; empty if it accepts."""
    command = [str(program), "--check", str(case)]
    command += [part for path, value in settings for part in ("--set", f"{path}={value}")]
    done = subprocess.run(command, stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=LONGEST_CHECK,
                          env=dict(os.environ, **ENVIRONMENT))
    if done.returncode == 0:
        return ""
    lines = done.stderr.strip().splitlines() or [f"exit status {done.returncode} without a message"]
    return re.sub(rf"^{re.escape(program.name)}: ", "", lines[-1])


def _reject_if_refused(study, values, refusal):
    if not refusal:
        return
    by_study = re.match(r"--set: ((?:unknown )?parameter '([^']+)'.*)", refusal)
    if by_study:
        message, path = by_study.groups()
        if path in study.settings:
            study.text.reject(f"settings.{path}", message)
        for i, parameter in enumerate(study.parameters):
            if parameter.path == path:
                is_unknown = message.startswith("unknown") or values is None
                study.text.reject(f"{parameter.place}.name" if is_unknown else
                                  f"{parameter.place}.values[{parameter.values.index(values[i])}]", message)
    which = "" if not values else " with " + ", ".join(
        f"{parameter.path} = {value}" for parameter, value in zip(study.parameters, values))
    raise BadInput(f"{study.text.path}: {study.program} --check refuses the case{which}: {refusal}")

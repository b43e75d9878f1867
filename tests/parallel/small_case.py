"""A boundary-value problem small enough to run several times: one element, four Gauss points of seventy grains."""

import os
import subprocess
from pathlib import Path

CASE = """set Seed = 3
subsection Problem
  set Initial stress = 1e6, 1e6, 1e6, 0, 0, 0
end
subsection Mesh
  set Kind = cylinder
  set Outer radius = 0.035
  set Height = 0.02
end
subsection Boundary conditions
  set Number of conditions = 4
  subsection Condition 1
    set Boundary = bottom
    set Component = z
  end
  subsection Condition 2
    set Boundary = axis
    set Component = r
  end
  subsection Condition 3
    set Boundary = outer
    set Component = r
  end
  subsection Condition 4
    set Boundary = top
    set Kind = pressure
    set Value = 1e6
  end
end
subsection Loading
  set Number of stages = 2
  subsection Stage 1
    set Increments = 6
    set Spacing = geometric
    set Targets = top pressure: 15e6
  end
  subsection Stage 2
    set Kind = creep
    set Duration = 1e6
    set Outputs per decade = 2
  end
end
subsection REVs
  set Packings = 0
end
subsection Packing
  set Grains = 70
  set Friction = 0.1
  set Void ratio tolerance = 1
  set Pressure = 1e6
end
subsection Output
  set Checkpoint interval = 4
end
"""

# Options: REVs stay where they were dealt to; or, since these are cheap, move without a limit and are balanced in each step.
STAY = ("--set", "REVs/Move between ranks=false")
MOVE = ("--set", "REVs/Smallest cost to move=0", "--set", "REVs/Balance tolerance=0")


def write_case(folder):
    path = Path(folder) / "small.prm"
    path.write_text(CASE, encoding="utf-8")
    return path


def make_command(build, n_ranks, *arguments):
    launcher = ["mpirun", "-np", str(n_ranks)] if n_ranks > 1 else []
    return launcher + [str(Path(build) / "slowsand-bvp"), "--quiet", *map(str, arguments)]


def make_environment():
    return dict(os.environ, OMPI_ALLOW_RUN_AS_ROOT="1", OMPI_ALLOW_RUN_AS_ROOT_CONFIRM="1",
                OMPI_MCA_rmaps_base_oversubscribe="1", OMPI_MCA_hwloc_base_binding_policy="none",
                OPENBLAS_NUM_THREADS="1", DEAL_II_NUM_THREADS="1",
                OMPI_MCA_mpi_yield_when_idle="1")  # more ranks than cores: whoever waits must make room


def run(build, n_ranks, *arguments):
    done = subprocess.run(make_command(build, n_ranks, *arguments), env=make_environment(), capture_output=True,
                          text=True, timeout=300, check=False)
    if done.returncode != 0:
        raise AssertionError(f"{' '.join(done.args)}: exit status {done.returncode}\n{done.stderr}")

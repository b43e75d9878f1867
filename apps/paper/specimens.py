"""The specimens that several experiments begin with, and what is read out of their runs."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from plotting.curves import sample_steps
from plotting.fracture_times import sort_times
from plotting.run_folder import select_creep
from plotting.snapshot import read_cracks

OEDOMETER, STRENGTH, TRIAXIAL = "rev_oedometer_creep.prm", "rev_strength.prm", "rev_triaxial_creep.prm"
FULL_BATCH = 30  # N_max of the paper


@dataclass
class Laboratory:
    """What an experiment needs: how to run, with which seeds, where results and figures go."""

    chains: object  # Chains
    results: object  # Results
    seeds: list
    figures: Path
    is_full: bool
    batches: tuple  # grains broken at once, of Fig. 8
    usual_batch: int  # N_max


def pack(chains, seed):
    """At 100 kPa isotropic."""
    return chains.run("packing", OEDOMETER, 1, seed)


def compress(chains, seed):
    """Isotropic to 10 MPa."""
    return chains.run("isotropic", STRENGTH, 2, seed, base=pack(chains, seed))


def load(chains, seed):
    """In the oedometer to 21.7 MPa."""
    return chains.run("oedometer", OEDOMETER, 2, seed, base=pack(chains, seed))


def creep(chains, seed):
    """In the oedometer at 21.7 MPa."""
    return chains.run("oedometer_creep", OEDOMETER, 3, seed, base=load(chains, seed))


def find_snapshot(run, stage):
    """Path of the REV at a stage's end; stage 0: the packing."""
    return run.path / "snapshots" / (f"stage_{stage}.h5" if stage else "initial.h5")


def sample_creep(run, times):
    """Axial creep strain [-] at times [s] since the creep stage began; nan behind the run's end."""
    curve = select_creep(run)
    return sample_steps(curve.time, curve.strain, times)


def fit_line(times, strains):
    """(slope per decade of time, share of the variance that the line explains); nan if the strain does not vary."""
    known = np.isfinite(strains)
    x, y = np.log10(np.asarray(times)[known]), np.asarray(strains)[known]
    if len(x) < 3 or np.ptp(y) == 0.:
        return np.nan, np.nan
    slope, level = np.polyfit(x, y, 1)
    return slope, 1. - np.sum((y - level - slope * x)**2) / np.sum((y - y.mean())**2)


@dataclass
class Disturbances:
    """Of the dynamic computations of one creep stage that breaking grains began, axial stress, an entry each."""

    time: np.ndarray  # [s], end of the jump before
    broken: np.ndarray  # at once [-]
    is_delayed: np.ndarray  # broken by cracks; else by overload within the avalanche that followed
    rise: np.ndarray  # [Pa], not negative
    drop: np.ndarray  # [Pa], not negative
    strain: np.ndarray  # axial, that the computation brought [-]

    @property
    def mean(self):
        """The paper's measure [Pa]: mean of the sizes of the largest rise and the largest drop."""
        return 0.5 * (self.rise + self.drop)


def read_disturbances(run, stage):
    """Those before a rupture's own batch."""
    table = run.read_table("jumps.csv")
    end = table.get_column("time_s") + table.get_column("length_s")
    broken = table.get_column("broken")
    chosen = (table.get_column("stage") == stage) & (broken > 0)
    rupture = run.summary.get("rupture_time_s")
    if rupture is not None:
        chosen &= end < rupture * (1 - 1e-9)  # histories carry ten digits
    is_delayed = np.array([cause == "delayed" for cause in table.get_column("cause")], dtype=bool)
    return Disturbances(end[chosen], broken[chosen], is_delayed[chosen],
                        table.get_column("largest_deviation_zz_Pa")[chosen],
                        -table.get_column("smallest_deviation_zz_Pa")[chosen],
                        table.get_column("strain_change_zz")[chosen])


def run_batch(chains, seed, batch, settings=None):
    """One jump from the oedometer at 21.7 MPa, after which so many grains break at once, and what follows it."""
    loaded = load(chains, seed)
    duration = sort_times(read_cracks(find_snapshot(loaded, 2)))[1][batch - 1] * (1 + 1e-9)  # the last grain included
    own = {"Fracture/Batch limit": batch, "Stage 3/Duration": repr(float(duration)),
           "Stage 3/First output": repr(float(duration)), **(settings or {})}
    name = f"batch_{batch}" + "".join(f"-{key.rsplit('/', 1)[-1].lower().replace(' ', '_')}_{value}"
                                      for key, value in (settings or {}).items())
    return chains.run(name, OEDOMETER, 3, seed, own, loaded)

"""Beyond the paper: what its open choices do to the slope of oedometer creep, and what the size of the REV does."""

from dataclasses import dataclass

import numpy as np

from plotting import style

from .oedometer import compute_slope
from .specimens import creep, pack
from .walls import choose_box

REFERENCE = "as shipped"
SIZES = {"small": (100, 200, 400), "full": (500, 1000, 2000, 4000, 11497)}  # grains
OWN_SIZE = {"small": 200, "full": 11497}  # of all other experiments
USUAL_SIZE = {"small": 200, "full": 2000}  # of the table of choices: their scatter is known well enough from seeds


@dataclass
class Choice:
    """One choice made otherwise."""

    key: str  # of its statement, the slope over that of the reference
    name: str
    settings: dict  # Section/Name -> value
    has_own_packing: bool = False  # else it is the reference's


CHOICES = (
    Choice("d0_1", "reference diameter d0 = 1 mm", {"Strength/Reference diameter": 1e-3}),
    Choice("d0_4", "reference diameter d0 = 4 mm", {"Strength/Reference diameter": 4e-3}),
    Choice("per_grain", "roughness S_q of each grain", {"Grains/Roughness rule": "per grain"}, True),
    Choice("rotation", "rotation of grains free", {"Grains/Rotation is free": "true"}, True),
    Choice("truncation_1", "strength truncated at X = 1.5", {"Strength/Truncation": 1.5}),
    Choice("truncation_2", "strength truncated at X = 2", {"Strength/Truncation": 2.}),
    Choice("half_batch", "N_max halved", {"Fracture/Batch limit": 0, "Fracture/Batch share": 0.0013}),
    Choice("large_batch", "N_max four times as large", {"Fracture/Batch limit": 0, "Fracture/Batch share": 0.0104}))


def measure_slopes(laboratory, settings, packed_with=None):
    """(creep strain per decade from 1e2 to 1e6 s [%], one a seed; runs; faults)

    @param packed_with  settings of the runs whose packings are taken: the search for their friction is saved
    """
    chains = laboratory.chains.vary(settings)

    def run_one(seed):
        if packed_with is None:
            return creep(chains, seed)
        packed = pack(laboratory.chains.vary(packed_with), seed)
        run = creep(chains.vary({"Packing/Friction": repr(packed.summary["figures"]["packing friction [-]"])}), seed)
        if run.get_column("void_ratio")[0] == packed.get_column("void_ratio")[0]:
            return run
        return creep(chains, seed)  # the friction was found at another set of first positions

    runs, faults = chains.run_seeds(run_one, laboratory.seeds)
    return [100 * compute_slope(run) for run in runs], runs, faults


def draw_choices(laboratory):
    """The table of choices and that of sizes."""
    size = "full" if laboratory.is_full else "small"
    own = OWN_SIZE[size]
    by_size = {n: measure_slopes(laboratory, settle(n, own)) for n in SIZES[size]}
    reference = by_size[USUAL_SIZE[size]]
    found = {f"{REFERENCE}, {USUAL_SIZE[size]} grains": reference}
    mean = np.mean(reference[0]) if reference[0] else np.nan
    for choice in (*CHOICES, Choice("walls", "six rigid walls", choose_box(laboratory.is_full), True)):
        usual = settle(USUAL_SIZE[size], own)
        slopes, runs, faults = measure_slopes(laboratory, {**usual, **choice.settings},
                                              None if choice.has_own_packing else usual)
        found[choice.name] = slopes, runs, faults
        laboratory.results.add(choice.key, [slope / mean for slope in slopes] if np.isfinite(mean) else [], faults)
    for name, (slopes, runs, _) in found.items():
        laboratory.results.add_note("sensitivity", f"{name}: creep strain per decade from 1e2 to 1e6 s", "% per decade", slopes)
        laboratory.results.add_note("sensitivity", f"{name}: void ratio at 100 kPa", "-",
                                    [run.get_column("void_ratio")[0] for run in runs])
    _tell_sizes(laboratory, by_size)
    style.save(_draw_bars(found, by_size), laboratory.figures, "sensitivity")


def settle(n_grains, own):
    """Settings of a REV of that size: N_max by its share, as shipped; none for the size that all experiments have."""
    return {} if n_grains == own else {"Packing/Grains": n_grains, "Fracture/Batch limit": 0}


def _tell_sizes(laboratory, by_size):
    for n, (slopes, _, faults) in by_size.items():
        laboratory.results.add_note("sensitivity", f"REV of {n} grains: creep strain per decade from 1e2 to 1e6 s",
                                    "% per decade", slopes, faults)
    least, most = min(by_size), max(by_size)
    faults = by_size[least][2] + by_size[most][2]
    few, many = by_size[least][0], by_size[most][0]
    is_known = len(few) > 1 and len(many) > 1
    laboratory.results.add("size_scatter", [np.std(few, ddof=1) / np.std(many, ddof=1)] if is_known else [], faults)
    laboratory.results.add("size_mean", [np.mean(few) / np.mean(many)] if few and many else [], faults)


def _draw_bars(found, by_size):
    figure, (upper, lower) = style.new_figure(4.6, 2, height_ratios=(len(found), len(by_size)))
    for axes, rows in ((upper, {name: entry[0] for name, entry in found.items()}),
                       (lower, {f"{n} grains": entry[0] for n, entry in by_size.items()})):
        for k, slopes in enumerate(rows.values()):
            axes.plot(slopes, np.full(len(slopes), k), "o", color=style.BLUE, markerfacecolor="none", markeredgewidth=0.6)
            if slopes:
                axes.plot(np.mean(slopes), k, "|", color="black", markersize=10)
        axes.set_yticks(range(len(rows)), rows, fontsize=6)
        axes.invert_yaxis()
        axes.set_xlim(left=0)
    lower.set_xlabel("creep strain per decade [%]\nfrom 1e2 to 1e6 s (circles:\nseeds, bars: their mean)")
    return figure

"""The oedometer of one element against servo-controlled REVs of the same packing.

The element's four Gauss points share one packing and differ in their strengths, which go by the point's number. Each
point's REV is also taken through the test alone, axial stress held by a servo. What is compared is the mean over the
four of each kind, weighted by the radius of the point, as the element weights them.
"""

import numpy as np

from creep_curves import make_times, sample
from plotting import style

POINT = "One element against its REVs alone"
BVP_CASE, REV_CASE = "apps/cases/bvp_oedometer_one_element.prm", "apps/cases/rev_oedometer_creep.prm"
GRAINS, INCREMENTS = 220, 25  # of both
GAUSS = 0.5 / np.sqrt(3.)
WEIGHTS = np.array([0.5 - GAUSS, 0.5 + GAUSS, 0.5 - GAUSS, 0.5 + GAUSS]) / 2.  # points 0, 2 inside, 1, 3 outside
TIMES = make_times(1, 6, 1)


def study(runs, results, options):
    times = make_times(0, 6, 50)
    pairs, elements, alone = [], [], []
    for seed in options.seeds:
        settings = {"Seed": seed, "Packing/Grains": GRAINS, **options.small}
        element = runs.run(f"element_{seed}", "slowsand-bvp", BVP_CASE, {**settings, "REVs/Packings": 1})
        revs = [runs.run(f"element_{seed}_rev_{number}", "slowsand-rev", REV_CASE,
                         {**settings, "REV number": number, "Stage 1/Increments": INCREMENTS,
                          "Stage 2/Points per decade": 2}) for number in range(len(WEIGHTS))]
        pairs.append((element, revs))
        elements.append(sample_element(element, times))
        alone.append(WEIGHTS @ [sample(rev, times) for rev in revs])
    _add_rows(pairs, results)
    style.save(_draw(times, 100 * np.array(elements), 100 * np.array(alone)), options.figures, "one_element")


def sample_element(run, times):
    """Axial creep strain [-] of the element: mean over its points, weighted by their radius."""
    strains = [run.get_column(f"{probe}_strain_zz") for probe in run.get_probes()]
    return sample(run, times, WEIGHTS @ strains)


def _add_rows(pairs, results):
    elements = np.array([sample_element(element, TIMES) for element, _ in pairs])
    singles = np.array([[sample(rev, TIMES) for rev in revs] for _, revs in pairs])
    means = np.tensordot(singles, WEIGHTS, axes=(1, 0))
    command = f"{pairs[0][0].command}; {pairs[0][1][0].command}; and so on"
    for k, time in enumerate(TIMES):
        name, difference = f"1e{np.log10(time):.0f} s", elements[:, k] - means[:, k]
        deviation = means[:, k].std(ddof=1)
        results.add(POINT, f"creep strain of the element at {name}, mean", 100 * elements[:, k].mean(), "%", command)
        results.add(POINT, f"the same of the REVs alone at {name}", 100 * means[:, k].mean(), "%", command)
        results.add(POINT, f"standard deviation over packings at {name} of a REV alone, the first of each",
                    100 * singles[:, 0, k].std(ddof=1), "%", command)
        results.add_below(POINT, f"mean difference at {name}, against the standard deviation over packings of the "
                          "means of four", 100 * abs(difference.mean()), "%", command, 100 * deviation)


def _draw(times, elements, alone):
    figure, axes = style.new_figure(2.6)
    for values, colour, label in ((alone, style.BLUE, "REVs alone, stress by servo"),
                                  (elements, style.VERMILION, "one element")):
        axes.semilogx(times, values.T, color=colour, linewidth=0.4, alpha=0.6)
        axes.semilogx(times, values.mean(axis=0), color=colour, linewidth=1.8, label=f"{label}, mean of packings")
    axes.fill_between(times, alone.mean(axis=0) - alone.std(axis=0, ddof=1), alone.mean(axis=0) + alone.std(
        axis=0, ddof=1), color=style.BLUE, alpha=0.12, linewidth=0)
    axes.set_xlabel("time since the start of creep [s]")
    axes.set_ylabel("axial creep strain [%]\n(compression positive)")
    axes.set_ylim(bottom=0)
    axes.legend(loc="upper left")
    return figure

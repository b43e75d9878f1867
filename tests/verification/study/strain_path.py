"""One element driven by its top against its REV on the same strain path, fracture off.

The element's REV is first consolidated to a stress by a servo, the REV alone comes to rest at held strain. So that both
begin alike, the stress that the REV alone has then is the element's initial stress, and the servo of both is put to
sleep: it has nothing to do on a strain path. A stage of one increment each drives both through the same strains.

The two compute the same stretch with other roundings. A REV answers both with the same bits (docs/theory.md, section 8);
what that is worth is shown by the REV's difference from itself when its strains change beyond that rounding.
"""

import numpy as np

from plotting import style

POINT = "Strain-driven element against its REV"
BVP_CASE, REV_CASE = "apps/cases/bvp_oedometer_one_element.prm", "apps/cases/rev_oedometer_creep.prm"
INCREMENTS, HEIGHT = 10, 0.02  # of the path; of the mesh [m]
STRAIN = 0.04  # axial, logarithmic, compression-positive [-]
REST = {"Fracture/Grains break": "false", "Equilibrium/Unbalanced ratio": 1e-9, "Equilibrium/Stress tolerance": 1,
        "Equilibrium/Servo gain": 1e-300, "Packing/Grains": 220, "Seed": 1}
LIMIT = 1e-6
BEYOND_ROUNDING = 1e-8  # relative change of strain
COMMAND = "bash docs/verification/run.sh --only strain_path"  # the commands themselves would fill a page


def study(runs, results, options):
    settings = {**REST, **options.small}
    element, rev = run_pair(runs, settings, STRAIN)
    found = [element.get_tensor("stress", probe) for probe in element.get_probes()]
    results.add_below(POINT, f"largest difference of stress over its norm to a strain of {STRAIN}",
                      max(compare(stress, rev) for stress in found), "-", COMMAND, LIMIT)
    other = run_rev(runs, "rev_beyond_rounding", settings, STRAIN * (1 + BEYOND_ROUNDING))
    results.add(POINT, f"the REV alone from itself, strains changed by {BEYOND_ROUNDING:g} of themselves",
                compare(other.get_tensor("stress"), rev), "-", COMMAND)
    results.add(POINT, f"axial stress at a strain of {STRAIN}", rev[-1, 2] / 1e6, "MPa", COMMAND)
    style.save(_draw(make_strains(STRAIN), rev, found[0]), options.figures, "strain_path")


def compare(found, expected):
    """Largest difference over the norm of the stress, the common start apart."""
    norm = np.linalg.norm(expected[1:], axis=1)
    return float(np.max(np.linalg.norm(found[1:] - expected[1:], axis=1) / norm))


def make_strains(last):
    return [last * k / INCREMENTS for k in range(INCREMENTS + 1)]


def run_rev(runs, name, settings, last):
    return runs.run(f"path_{name}", "slowsand-rev", REV_CASE, {**settings, **make_rev_stages(make_strains(last))})


def run_pair(runs, settings, last):
    """The element's run and the stresses [Pa] of the REV alone, one row an increment from the common start on."""
    expected = run_rev(runs, "rev", settings, last).get_tensor("stress")
    initial = ", ".join(f"{value:.10g}" for value in expected[0])
    element = runs.run("path_element", "slowsand-bvp", BVP_CASE, {
        **settings, "REVs/Packings": 1, "Problem/Initial stress": initial, **make_bvp_stages(make_strains(last)[1:])})
    return element, expected


def make_rev_stages(strains):
    settings = {"Number of stages": len(strains)}
    for k, strain in enumerate(strains, start=1):
        settings |= {f"Stage {k}/Kind": "strain path", f"Stage {k}/Strain": f"0, 0, {strain:.17g}, 0, 0, 0",
                     f"Stage {k}/Stress": 0, f"Stage {k}/Increments": 1, f"Stage {k}/Duration": 0}
    return settings


def make_bvp_stages(strains):
    """The top is displaced instead of pressed."""
    settings = {"Boundary conditions/Condition 4/Kind": "displacement", "Boundary conditions/Condition 4/Component": "z",
                "Boundary conditions/Condition 4/Value": 0, "Loading/Number of stages": len(strains)}
    for k, strain in enumerate(strains, start=1):
        stage = f"Loading/Stage {k}/"
        settings |= {stage + "Kind": "load", stage + "Increments": 1, stage + "Spacing": "linear", stage + "Duration": 0,
                     stage + "Targets": f"top displacement z: {HEIGHT * np.expm1(-strain):.17g}"}
    return settings


def _draw(strains, expected, found):
    figure, axes = style.new_figure(2.4)
    for column, name, colour in ((2, "axial", style.BLUE), (0, "lateral", style.VERMILION)):
        axes.plot(100 * np.array(strains), expected[:, column] / 1e6, color=colour, label=f"{name}, REV alone")
        axes.plot(100 * np.array(strains), found[:, column] / 1e6, "o", color=colour, markerfacecolor="none",
                  markersize=5, label=f"{name}, a point of the element")
    axes.set_xlabel("axial strain [%] (compression positive)")
    axes.set_ylabel("stress [MPa] (compression positive)")
    axes.legend(loc="upper left")
    return figure

"""Fig. 3: crack velocities of all grains. Fig. 5: sorted times to fracture of a real state."""

import numpy as np

from plotting import style
from plotting.fracture_times import LATEST, sort_times
from plotting.snapshot import read_cracks, read_stresses

from .specimens import compress, find_snapshot, load, run_batch

SLOWEST = 1e-300  # [m/s]; below it doubles lose digits
REFERENCE, EXPONENT, TOUGHNESS = 0.1, 60., 1.1  # v0 [m/s], n, K_c of quartz [MPa m^0.5] (Table 1, section 3)


def draw_velocities(laboratory):
    """Fig. 3: K-v at 10 MPa isotropic."""
    runs, faults = laboratory.chains.run_seeds(lambda seed: compress(laboratory.chains, seed), laboratory.seeds)
    clouds = [_read_cloud(run) for run in runs]
    fits = [np.polyfit(*cloud, 1) for cloud in clouds]
    results = laboratory.results
    results.add("slope", [fit[0] for fit in fits], faults)
    results.add("v0", [10**fit[1] for fit in fits], faults)
    results.add("velocity_span", [np.ptp(cloud[1]) for cloud in clouds], faults)
    if clouds:
        style.save(_draw_cloud(*clouds[0]), laboratory.figures, "fig3")


def _read_cloud(run):
    """log10 of normalised stress [-] and of crack velocity [m/s], of every grain whose crack grows."""
    file = find_snapshot(run, 2)
    strength, stress = read_stresses(file)
    velocity = read_cracks(file).velocity
    chosen = velocity > SLOWEST
    return np.log10(stress[chosen] / strength[chosen]), np.log10(velocity[chosen])


def _draw_cloud(stress, velocity):
    figure, axes = style.new_figure(2.6)
    axes.plot(stress, velocity, ".", color=style.BLUE, markersize=2, label="grains at 10 MPa isotropic")
    ends = np.array([stress.min(), 0.])
    axes.plot(ends, np.log10(REFERENCE) + EXPONENT * ends, color="black", linewidth=0.6,
              label=f"Charles' law, n = {EXPONENT:g}")
    axes.set_xlabel(r"log$_{10}$ of contact stress over strength, $\sigma/\sigma_{lim}$ = K/K$_c$ [-]" + "\n"
                    rf"(quartz: K$_c$ = {TOUGHNESS} MPa m$^{{0.5}}$)")
    axes.set_ylabel(r"log$_{10}$ of crack velocity [m/s]")
    axes.legend(loc="upper left")
    return figure


def draw_times(laboratory):
    """Fig. 5: after loading in the oedometer, the jump that follows beside it."""
    chains, batch = laboratory.chains, laboratory.usual_batch

    def run_one(seed):
        return load(chains, seed), run_batch(chains, seed, batch)

    pairs, faults = chains.run_seeds(run_one, laboratory.seeds)
    differences, lasts, drawn = [], [], []
    for loaded, jumped in pairs:
        times = sort_times(read_cracks(find_snapshot(loaded, 2)))[1]
        table = jumped.read_table("jumps.csv")
        first = table.get_column("cause").index("delayed")
        rank = int(table.get_column("broken")[first])
        length = table.get_column("time_s")[first] + table.get_column("length_s")[first]  # loading takes no time
        differences.append(length / times[rank - 1] - 1.)
        lasts.append(times[batch - 1])
        drawn.append((times, length, rank))
    laboratory.results.add("first_jump", differences, faults)
    laboratory.results.add("next_times", lasts, faults)
    if drawn:
        style.save(_draw_times(*drawn[0]), laboratory.figures, "fig5")


def _draw_times(times, length, rank):
    shown = times[(times > 0) & (times < LATEST)]
    figure, axes = style.new_figure(2.6)
    axes.loglog(shown, np.arange(1, len(shown) + 1), drawstyle="steps-post", color=style.BLUE,
                label="sorted times, oedometer at 21.7 MPa")
    axes.plot(length, rank, "o", color=style.VERMILION, label=f"first jump, {rank} broken")
    axes.set_xlabel("time to fracture [s]")
    axes.set_ylabel("grains that break until then [-]")
    axes.legend(loc="lower right")
    return figure

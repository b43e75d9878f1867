"""One look for all figures: one journal column wide, colours that survive colour blindness (Okabe and Ito)."""

from pathlib import Path

import matplotlib

matplotlib.use("Agg")  # no screen is needed or looked for
import matplotlib.pyplot as plt

COLUMN_WIDTH = 3.54  # [inch], 90 mm
BLUE, VERMILION, ORANGE, GREEN, PURPLE, GREY = "#0072B2", "#D55E00", "#E69F00", "#009E73", "#CC79A7", "#7F7F7F"
CYCLE = [BLUE, VERMILION, GREEN, PURPLE, ORANGE, "#56B4E9", "#000000"]

plt.rcParams.update({
    "font.size": 8, "axes.labelsize": 8, "legend.fontsize": 7, "xtick.labelsize": 7, "ytick.labelsize": 7,
    "axes.spines.top": False, "axes.spines.right": False, "axes.linewidth": 0.6, "lines.linewidth": 1.2,
    "lines.markersize": 3, "xtick.direction": "out", "ytick.direction": "out", "legend.frameon": False,
    "axes.prop_cycle": matplotlib.cycler(color=CYCLE), "savefig.dpi": 300,
    "savefig.bbox": "tight", "savefig.pad_inches": 0.02, "mathtext.default": "regular",
})


def new_figure(height, rows=1, columns=1, **options):
    """A figure one column wide and `height` inches high."""
    return plt.subplots(rows, columns, figsize=(COLUMN_WIDTH, height), layout="constrained", **options)


def save(figure, folder, name):
    """Writes folder/name.png and returns its path."""
    path = Path(folder) / f"{name}.png"
    path.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(path)
    plt.close(figure)
    return path

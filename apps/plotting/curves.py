"""Numbers out of curves of one run: a value at a time, the slope per decade of time."""

import math

import numpy as np

ROUNDING = 1e-9  # relative, of times that a history writes with ten digits


def sample_steps(time, values, times):
    """Values at given times [s]: those of the last row by then, since creep moves in steps from equilibrium to
    equilibrium. NaN before the first row and after the last.

    @pre time does not fall
    """
    times = np.asarray(times, dtype=float)
    last = np.searchsorted(time, times * (1 + ROUNDING), side="right") - 1
    sampled = np.asarray(values, dtype=float)[np.maximum(last, 0)]
    return np.where((last < 0) | (times > time[-1] * (1 + ROUNDING)), np.nan, sampled)


def fit_slope(time, strain, from_decade, to_decade):
    """(rows, slope, half width): least squares of strain over log10(time [s]) for 10^from <= time <= 10^to.

    Slope [-] per decade; half width of its 95 % interval (Student's t) about the straight line. It tells how well a
    line describes this one run, not how far another packing would lie from it. NaN with fewer than three rows.
    """
    chosen = (time >= 10.**from_decade * (1 - 1e-12)) & (time <= 10.**to_decade * (1 + 1e-12))  # ends, to rounding
    x, y = np.log10(time[chosen]), strain[chosen]
    n = len(x)
    if n < 3 or np.ptp(x) == 0.:
        return n, math.nan, math.nan
    spread = np.sum((x - x.mean())**2)
    slope = np.sum((x - x.mean()) * y) / spread
    residual = y - y.mean() - slope * (x - x.mean())
    error = math.sqrt(np.sum(residual**2) / (n - 2) / spread)
    return n, slope, compute_t_quantile(n - 2) * error


def compute_t_quantile(degrees, confidence=0.95):
    """Two-sided quantile of Student's t. With t = sqrt(n) tan(a) its density is cos(a)^(n-1), which is integrated."""
    angle = np.linspace(0., math.pi / 2, 200001)[:-1]
    density = np.cos(angle)**(degrees - 1)
    share = np.concatenate(([0.], np.cumsum((density[1:] + density[:-1]) / 2)))
    return math.sqrt(degrees) * math.tan(np.interp(confidence, share / share[-1], angle))

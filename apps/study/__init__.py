"""Studies: one case at several parameter values and seeds, run side by side, one table out."""

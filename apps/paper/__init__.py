"""The experiments of the time-to-fracture paper, one module for each specimen."""

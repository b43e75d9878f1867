"""Figures from Slowsand's run folders. Each module owns one figure or one file format."""

"""Draws the output directory of a run; see scripts/plot --help."""

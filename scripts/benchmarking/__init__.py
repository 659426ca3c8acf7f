"""Measures the program: see scripts/benchmark --help."""

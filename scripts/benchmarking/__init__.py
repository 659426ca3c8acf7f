# SPDX-License-Identifier: LGPL-2.1-or-later
"""Measures the program: see scripts/benchmark --help."""

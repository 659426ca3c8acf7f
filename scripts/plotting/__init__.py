# SPDX-License-Identifier: LGPL-2.1-or-later
"""Draws the output directory of a run; see scripts/plot --help."""

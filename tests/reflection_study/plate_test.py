#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""In a plate that the program runs as much returns as in the chain.

usage: plate_test.py STRIP_OPERATORS TOMBOLO
"""

import math
import tempfile
import unittest

import numpy
from cases import into_particles, results_of, read_programs
from tombolo import Scene

WAVELENGTH, LENGTH, GAP, END_TIME = 12, 48, 12, 92
AMPLITUDE = 1e-8


def transform_in_plate(smoothing, time_step, frequency):
    """Of the axial velocity at x = -9, in the middle of a plate through which the program sends a
    Hann burst from the left; the edges of the plate are so far away that nothing arrives from them.
    Of elements alone without a smoothing."""
    phase = f"(x+{GAP + LENGTH})/{LENGTH}"
    carrier = f"cos({2 * math.pi / WAVELENGTH!r}*x)"
    burst = f"{AMPLITUDE}*(0.5-0.5*cos(2*pi*{phase}))*{carrier}"
    particles = {"Formulation": "momentum consistent particle", "momentum consistent particle": {
        "Shape functions": "moving least squares", "Smoothing": smoothing}}
    elements = {"Formulation": "fully integrated hexahedron"}
    n_steps = math.ceil(END_TIME / time_step)
    with tempfile.TemporaryDirectory() as directory:
        run = Scene({
            "Dimension": 2, "End time": n_steps * time_step,
            "Output directory": directory + "/plate", "Parts": "a, b", "Materials": "m",
            "Initial conditions": "burst",
            "Mesh": {"Type": "box", "box": {
                "Lower corner": "-96, 0", "Upper corner": "44, 160", "Cells": "140, 160"}},
            "Part: a": {"Cells": "x < 0", "Material": "m", **elements},
            "Part: b": {"Cells": "otherwise", "Material": "m",
                        **(particles if smoothing else elements)},
            "Material: m": {"Model": "elastic", "elastic": {
                "Density": 1, "Young's modulus": 1, "Poisson's ratio": 0}},
            "Initial condition: burst": {
                "Velocity": f"if({phase} > 0 && {phase} < 1, {burst}, 0); 0"},
            "Time step": {"Fixed": time_step},
            "Output": {"Write solution": False, "Number": 1,
                       "probes": {"Locations": "station: -9, 80"}},
        }).run()
        probes = run.probes
        time, velocity = probes["time"], probes["station velocity x"]
    # What rings at other frequencies is faded out.
    taper = 0.5 - 0.5 * numpy.cos(math.pi * numpy.clip((END_TIME - time) / 18, 0, 1))
    return (taper * velocity * numpy.exp(1j * frequency * time)).sum() * time_step / AMPLITUDE


class Plate(unittest.TestCase):
    def test_returns_what_the_chain_returns(self):
        for smoothing in ("paper", "affine"):
            with self.subTest(smoothing=smoothing):
                reduced, = results_of(into_particles(smoothing, wavelength=WAVELENGTH))
                there, without = (
                    transform_in_plate(name, reduced.time_step, reduced.frequency)
                    for name in (smoothing, ""))
                self.assertGreater(abs(without), 5)
                self.assertGreater(reduced.reflection, 0.004)
                in_plate = abs(there - without) / abs(without)
                self.assertLess(abs(in_plate / reduced.reflection - 1), 0.01)


if __name__ == "__main__":
    read_programs()
    unittest.main()

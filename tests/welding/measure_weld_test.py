#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""scripts/measure_weld and scripts/measure_flat_shoulder on tables made here, whose torque, temperatures
and heat are known."""

import json
import math
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "python"))

from script_testing import DirectoryTest, run_module, write_table  # noqa: E402
from welding import flat_shoulder, measure  # noqa: E402

TOOL = (9e-3, 3e-3, 4e-3, 10)
PLUNGE, END = 0.05, 0.6


def write_run(directory, n_rows=60):
    """Torque of 100 N m in the plunge and of 150 after it; the contact at 200 °C and then at 425, where
    the metal has 150 MPa. Nothing touches at the first row."""
    headings = (["time [s]", "step"] + [f"tool mean force {axis} [N]" for axis in "xyz"]
                + ["tool mean torque z [N m]", "tool nodes [1]", "tool contact mean temperature [°C]",
                   "tool contact largest temperature [°C]", "tool tool temperature [°C]",
                   "tool area in contact [m^2]"])
    rows = []
    for k in range(n_rows + 1):
        t = END * k / n_rows
        hot = t > PLUNGE * (1 + 1e-9)
        rows.append([t, k, 10.0, -20.0, -3000.0, -150.0 if hot else -100.0, 5 if k else 0,
                     (425.0 if hot else 200.0) if k else 0.0, 500.0 + k, 20.0 + k, 1e-4])
    write_table(directory / "contact.csv", headings, rows)
    write_table(directory / "statistics.csv",
                ["time [s]", "largest nodal temperature [°C]", "energy error", "broken bonds [1]"],
                [[0.0, 20.0, "", 0], [PLUNGE, 700.0, -0.002, 3], [END, 1000.0, 0.001, 8]])
    tabular = {"Temperatures": "20, 350, 500", "Flow stresses": "300e6, 310e6; 200e6; 100e6"}
    (directory / "parameters.json").write_text(
        json.dumps({"Material: aluminium": {"j2 plasticity": {"tabular": tabular}}}), "utf-8")


class MeasureWeld(DirectoryTest):
    def setUp(self):
        super().setUp()
        write_run(self.directory)

    def test_the_torque_of_a_tool_that_sticks(self):
        self.assertAlmostEqual(measure.torque_over_shear(*TOOL), 2.01226e-6, delta=1e-11)
        # A flat disc.
        self.assertAlmostEqual(measure.torque_over_shear(7.62e-3, 0, 0, 0), 9.2667e-7, delta=1e-11)
        self.assertAlmostEqual(measure.surface_area(7.62e-3, 0, 0, 0), 1.82415e-4, delta=1e-9)
        self.assertAlmostEqual(measure.surface_area(*TOOL), 3.33357e-4, delta=1e-9)

    def test_torque_forces_and_temperatures(self):
        weld = measure.Weld(self.directory, "tool", "aluminium", TOOL)
        result = measure.measure(weld, None, PLUNGE)
        self.assertAlmostEqual(result["torque, end of the plunge"], 100.0, places=9)
        self.assertAlmostEqual(result["torque, traverse"], 150.0, places=9)
        sticking = 150e6 / math.sqrt(3) * measure.torque_over_shear(*TOOL)
        self.assertAlmostEqual(result["torque of Schmidt and Hattel, traverse"], sticking, places=9)
        self.assertAlmostEqual(result["torque over that, traverse"], 150.0 / sticking, places=12)
        self.assertAlmostEqual(result["area in contact over that of the tool, traverse"], 1 / 3.33357, places=5)
        self.assertAlmostEqual(result["force z on the tool, traverse"], 3000.0, places=9)
        self.assertAlmostEqual(result["mean temperature of the contact, traverse"], 425.0, places=9)
        self.assertEqual(result["largest temperature, end of the plunge"], 700.0)
        self.assertEqual(result["largest temperature, end"], 1000.0)
        self.assertEqual(result["largest energy error"], 0.002)
        self.assertEqual(result["broken bonds"], 8)

    def test_a_window_may_begin_between_two_rows(self):
        weld = measure.Weld(self.directory, "tool", "aluminium", TOOL)
        self.assertAlmostEqual(weld.mean(weld.torque(), 0.045, 0.055), 125.0, places=9)

    def test_a_run_that_ended_in_the_plunge(self):
        weld = measure.Weld(self.directory, "tool", "aluminium", TOOL)
        result = measure.measure(weld, (0.1, 2.0), PLUNGE)
        self.assertIn("torque, end of the plunge", result)
        self.assertNotIn("torque, traverse", result)

    def test_means_of_intervals_leave_out_what_is_no_number(self):
        times, values = measure.binned([0.0, 1.0, 2.0, 3.0], [math.nan, 4.0, 6.0, 8.0], 2.0)
        self.assertEqual(values, [4.0, 7.0])
        self.assertEqual(times, [0.5, 2.5])

    def test_picture_and_numbers(self):
        picture = self.directory / "weld.png"
        finished = run_module("welding", self.directory, "--picture", picture, "--window", "0.2,0.5")
        self.assertEqual(finished.returncode, 0, finished.stderr)
        self.assertIn("torque over that, traverse", finished.stdout)
        self.assertGreater(picture.stat().st_size, 10000)

    def test_what_cannot_be_measured_is_said_in_a_sentence(self):
        for arguments, message in ((("nowhere",), "there is no"),
                                   ((self.directory, "--contact", "pin"), 'no column "pin'),
                                   ((self.directory, "--material", "steel"), "no table of flow stresses")):
            finished = run_module("welding", *arguments)
            self.assertEqual(finished.returncode, 1, arguments)
            self.assertIn(message, finished.stderr)
            self.assertNotIn("Traceback", finished.stderr)


def write_flat_shoulder(directory):
    """500 W of friction and 2 W of plastic work from 1 s on, and a temperature that rises by 100 degrees a second."""
    times = [0.25 * k for k in range(41)]
    write_table(directory / "contact.csv", ["time [s]", "shoulder friction heat [J]"],
                [[t, 500.0 * max(0.0, t - 1.0)] for t in times])
    write_table(directory / "statistics.csv",
                ["time [s]", "largest nodal temperature [°C]", "plastic heat [J]", "enthalpy [J]"],
                [[t, 25.0 + 100.0 * t, 2.0 * max(0.0, t - 1.0), 400.0 * t] for t in times])


class MeasureFlatShoulder(DirectoryTest):
    def setUp(self):
        super().setUp()
        write_flat_shoulder(self.directory)

    def test_rates_and_temperatures_until_the_end_of_the_run(self):
        rows = flat_shoulder.curves(self.directory)
        self.assertEqual([row[0] for row in rows], [2.11, 3.10, 4.16, 5.11, 6.50, 8.09])
        for time, temperature, _, friction, _, plastic, _ in rows:
            # Nothing after the start of the motion counts for its last row before.
            self.assertAlmostEqual(temperature, 25.0 + 100.0 * (time if time != 6.5 else 6.375), places=9)
            self.assertAlmostEqual(friction, 500.0, places=9)
            self.assertAlmostEqual(plastic, 2.0, places=9)
        self.assertEqual(flat_shoulder.enthalpies(self.directory), [(6.5, 2600.0, 3395)])

    def test_between_nodes_the_profile_is_linear(self):
        sides = {1: ([0.0, 32e-3], [1000.0, 200.0]), -1: ([0.0, 32e-3], [800.0, 0.0])}
        for distance, right, _, left, _ in flat_shoulder.profile(sides):
            self.assertAlmostEqual(right, 1000.0 - 25.0 * distance, places=9)
            self.assertAlmostEqual(left, 800.0 - 25.0 * distance, places=9)

    def test_numbers_and_a_picture_of_a_run_that_ends_early(self):
        picture = self.directory / "flat.png"
        finished = run_module("welding.flat_shoulder", self.directory, "--picture", picture)
        self.assertEqual(finished.returncode, 0, finished.stderr)
        self.assertIn(" 500 ( 739  -32.3 %)", finished.stdout)
        self.assertGreater(picture.stat().st_size, 10000)


if __name__ == "__main__":
    unittest.main()

#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""scripts/measure_cut on tables made here, whose forces and temperatures are known."""

import json
import math
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "python"))

from script_testing import DirectoryTest, run_module, write_table  # noqa: E402
from cutting import measure, titanium  # noqa: E402

TRAVEL, TIME = 2e-3, 1e-4


def write_run(directory, force, feed, n_rows=50, with_heat=True):
    """A run whose cutting and feed forces at the time t are those of the functions, to the order of
    a trapezoid; without touching in the first tenth."""
    directory.mkdir()
    headings = ["time [s]", "step", "tool impulse x [N s]", "tool impulse y [N s]",
                "tool position x [m]", "tool position y [m]", "tool nodes"]
    if with_heat:
        headings += ["tool contact mean temperature [K]", "tool contact largest temperature [K]"]
    rows, impulse = [], [0.0, 0.0]
    step = TIME / n_rows
    for k in range(n_rows + 1):
        t = k * step
        if k > 0:
            middle = t - 0.5 * step
            impulse = [impulse[0] + step * force(middle), impulse[1] - step * feed(middle)]
        touches = 10 * k >= n_rows
        row = [t, k, *impulse, TRAVEL * t / TIME, 0.0, 5 if touches else 0]
        if with_heat:
            row += [300.0 + 1e6 * t, 320.0 + 1e6 * t] if touches else [0.0, 0.0]
        rows.append(row)
    write_table(directory / "contact.csv", headings, rows)
    write_table(directory / "statistics.csv",
                ["time [s]", "energy error", "heat balance error", "particles that fly off [1]"],
                [[0.0, "", 0.0, 0.0], [0.5 * TIME, -0.004, 1e-14, 3.0], [TIME, 0.002, -2e-14, 1.0]])
    (directory / "summary.json").write_text(json.dumps({"steps": 7, "wall_seconds": 1.5}), "utf-8")


class Titanium(DirectoryTest):
    """scripts/cut_titanium on tables of other tests."""

    def table(self, speed, thickness):
        path = self.directory / "tests.csv"
        write_table(path, ["speed [m/min]", "thickness [um]", "friction"], [[speed, thickness, 0.5]])
        return titanium.read_tests(path)

    def test_speeds_and_thicknesses_are_any_positive_numbers(self):
        for speed, thickness, name in ((30, 60, "30-60"), (22.5, 60, "22.5-60"), ("3e1", "0.5", "30-0.5")):
            (condition, row), = self.table(speed, thickness).items()
            self.assertEqual(titanium.name_of(condition), name)
            _, entries = titanium.settings(condition, 20.0, row["friction"])
            self.assertAlmostEqual(float(entries["Contact: tool/Cutting speed"]), float(speed) / 60.0)

    def test_what_is_no_positive_number_is_refused_with_its_column(self):
        for speed in (0, -30, "nan", "inf", "fast", ""):
            with self.assertRaisesRegex(measure.CutError, "speed"):
                self.table(speed, 60)

    def test_runs_that_have_not_come_to_their_end_are_made_again(self):
        self.assertFalse(titanium.has_finished(self.directory))
        for ended in ("interrupted", "failed", "finished"):
            (self.directory / "summary.json").write_text(json.dumps({"ended": ended}), "utf-8")
            self.assertEqual(titanium.has_finished(self.directory), ended == "finished")


class MeasureCut(DirectoryTest):
    def test_forces_over_the_window_and_the_travel(self):
        write_run(self.directory / "run", lambda t: 600.0 * t / TIME, lambda t: 60.0)
        result = measure.measure(self.directory / "run", window=(0.4, 1.0), width=2.0)
        self.assertAlmostEqual(result["cutting force over the travel"], 150.0, places=9)
        self.assertAlmostEqual(result["cutting force"], 210.0, places=9)
        self.assertAlmostEqual(result["feed force"], 30.0, places=9)
        self.assertAlmostEqual(result["feed force over the travel"], 30.0, places=9)
        self.assertAlmostEqual(result["travel"], TRAVEL, places=15)
        self.assertEqual(result["seconds"], 1.5)

    def test_a_window_may_begin_between_two_rows(self):
        write_run(self.directory / "run", lambda t: 500.0, lambda t: 0.0, n_rows=7)
        result = measure.measure(self.directory / "run", window=(0.33, 0.77))
        self.assertAlmostEqual(result["cutting force"], 500.0, places=9)

    def test_temperatures_are_those_while_something_touches(self):
        write_run(self.directory / "run", lambda t: 1.0, lambda t: 0.0)
        result = measure.measure(self.directory / "run")
        # Linear from 0.1 to 1, and in the window from 0.4 to 1, of the time.
        self.assertAlmostEqual(result["mean temperature of the contact over the travel"],
                               300.0 + 0.55 * 100.0, places=9)
        self.assertAlmostEqual(result["largest temperature of the contact"], 320.0 + 0.7 * 100.0,
                               places=9)

    def test_errors_are_the_largest_of_either_sign(self):
        write_run(self.directory / "run", lambda t: 1.0, lambda t: 0.0)
        result = measure.measure(self.directory / "run")
        self.assertEqual(result["largest energy error"], 0.004)
        self.assertEqual(result["largest heat balance error"], 2e-14)
        self.assertEqual(result["particles that fly off"], 3.0)

    def test_the_ratio_of_two_runs(self):
        write_run(self.directory / "hot", lambda t: 600.0, lambda t: 55.0)
        write_run(self.directory / "cold", lambda t: 800.0, lambda t: 60.0, with_heat=False)
        finished = run_module("cutting", self.directory / "hot", "--without-heat", self.directory / "cold", "--json",
                       self.directory / "out.json")
        self.assertEqual(finished.returncode, 0, finished.stderr)
        self.assertIn("cutting force over the travel, with heat over without", finished.stdout)
        result = json.loads((self.directory / "out.json").read_text("utf-8"))
        self.assertAlmostEqual(result["cutting force, with heat over without"], 0.75, places=9)

    def test_speed_of_the_chip(self):
        rake = math.radians(10.0)
        along = (-math.sin(rake), math.cos(rake))
        speed = 3.0
        points = [(0.0, 0.2), (0.0, 0.5), (0.0, 0.9), (0.0, 0.7)]
        velocities = [(9.0, 9.0), (speed * along[0], speed * along[1]),
                      ((speed + 1.0) * along[0], (speed + 1.0) * along[1]), (5.0, 5.0)]
        pressed = [(1.0, 0.0), (1.0, 0.0), (1.0, 0.0), (0.0, 0.0)]
        self.assertAlmostEqual(
            measure.chip_speed(points, velocities, pressed, (0.0, 0.0), 1.0, rake), speed + 0.5,
            places=12)
        self.assertIsNone(
            measure.chip_speed(points[:1], velocities[:1], pressed[:1], (0.0, 0.0), 1.0, rake))

    def test_what_cannot_be_measured_is_said_in_a_sentence(self):
        write_run(self.directory / "run", lambda t: 1.0, lambda t: 0.0)
        finished = run_module("cutting", self.directory / "nowhere")
        self.assertEqual(finished.returncode, 1)
        self.assertIn("error: there is no", finished.stderr)
        finished = run_module("cutting", self.directory / "run", "--contact", "drill")
        self.assertEqual(finished.returncode, 1)
        self.assertIn("has no column \"drill impulse x\"", finished.stderr)
        for option, value in (("--window", "1,0.4"), ("--window", "a"), ("--width", "0")):
            finished = run_module("cutting", self.directory / "run", option, value)
            self.assertEqual(finished.returncode, 2, (option, value))
            self.assertIn("allowed", finished.stderr)
        (self.directory / "run" / "contact.csv").write_text("time [s]\n0\nx\n", "utf-8")
        finished = run_module("cutting", self.directory / "run")
        self.assertEqual(finished.returncode, 1)
        self.assertIn("is damaged", finished.stderr)
        self.assertNotIn("Traceback", finished.stderr)


if __name__ == "__main__":
    unittest.main()

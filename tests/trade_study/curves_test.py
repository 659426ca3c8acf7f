#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Distances of curves of runs from measured ones."""

import math
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "python"))

from script_testing import DirectoryTest  # noqa: E402
from studying.curves import Distance  # noqa: E402
from studying.quantities import NoValue  # noqa: E402

MEASURED = "depth [mm],force [kN]\n0,0\n1,2\n3,6\n4,8"
TEXT = "distance of press.csv/pull force from ../test.csv/force"


class Curves(DirectoryTest):
    def setUp(self):
        super().setUp()
        self.measured = self.directory / "test.csv"
        self.directory /= "studies"
        self.directory.mkdir()
        self.measured.write_text(MEASURED, "utf-8")

    def distance(self, table, text=TEXT):
        (self.directory / "press.csv").write_text(table, "utf-8")
        return Distance(text, self.directory).value(self.directory)

    def message(self, table, text=TEXT):
        with self.assertRaises(NoValue) as caught:
            self.distance(table, text)
        return str(caught.exception)

    def refusal(self, measured, text=TEXT):
        self.measured.write_text(measured, "utf-8")
        with self.assertRaises(ValueError) as caught:
            Distance(text, self.directory)
        return str(caught.exception)

    def test_a_curve_has_no_distance_from_itself_on_any_rows(self):
        self.assertAlmostEqual(self.distance("depth [mm],pull force [kN]\n0,0\n0.3,0.6\n2.9,5.8\n4,8\n"), 0)

    def test_a_shifted_curve_has_its_shift_over_the_range(self):
        self.assertAlmostEqual(self.distance("depth,pull force\n-1,-1\n5,11\n"), 1 / 8)

    def test_a_difference_that_grows_linearly_is_integrated_exactly(self):
        # x³/3 over 4, of the range 8.
        self.assertAlmostEqual(self.distance("depth,pull force\n0,0\n4,12\n"), math.sqrt(4**3 / 3 / 4) / 8)

    def test_rows_count_by_what_they_span(self):
        # A step up at 2: whatever the rows, half of the curve is wrong by 4.
        few = self.distance("depth,pull force\n0,0\n2,4\n2.000001,8\n4,12\n")
        many = self.distance("depth,pull force\n0,0\n0.1,0.2\n0.2,0.4\n0.3,0.6\n2,4\n2.000001,8\n4,12\n")
        self.assertAlmostEqual(few, math.sqrt(16 / 2) / 8, 5)
        self.assertAlmostEqual(few, many)

    def test_only_what_both_have_is_compared(self):
        self.assertAlmostEqual(self.distance("depth,pull force\n3,7\n4,9\n9,99\n"), 1 / 8)

    def test_rows_without_a_number_and_a_row_that_is_cut_are_left_out(self):
        self.assertAlmostEqual(self.distance("depth,other,pull force\n0,1,nan\n0,1,1\n2,,\n4,1,9\n4.5,1,9"), 1 / 8)

    def test_what_a_run_may_lack(self):
        for table, words in (
                ("depth,pull force\n5,0\n6,0\n", 'the curves do not overlap: "depth" is from 5 to 6 in press.csv, '
                                                 'and "depth" is from 0 to 4 in test.csv'),
                ("depth,pull farce\n0,0\n1,0\n", 'has no column "pull force". Did you mean "pull farce"?'),
                ("depth,pull force\n0,0\n2,1\n2,3\n", "does not rise: 2 follows 2"),
                ("depth,pull force\n0,0\n", "no two rows with numbers"),
                ("depth [m],pull force\n0,0\n1,1\n", '"depth" is in m in press.csv, and "depth" in mm in test.csv'),
                ("depth,pull force [N]\n0,0\n1,1\n", '"pull force" is in N in press.csv, and "force" in kN')):
            with self.subTest(words=words):
                self.assertIn(words, self.message(table))
        self.assertIn("there is no ", self.message("", TEXT.replace("press", "pressed")))

    def test_what_is_no_measured_curve(self):
        for measured, words in (("depth,farce\n0,0\n1,1\n", 'has no column "force". Did you mean "farce"?'),
                                ("depth,force\n1,0\n0,1\n", 'the first column "depth" of'),
                                ("depth,force\n0,0\n1,a\n", "the file is damaged"),
                                ("depth,force\n0,1\n1,1\n", "has one value only")):
            with self.subTest(words=words):
                self.assertIn(words, self.refusal(measured))
        self.assertIn("does not name two curves", self.refusal(MEASURED, "distance of press.csv/pull force"))
        self.assertIn("there is no ", self.refusal(MEASURED, TEXT.replace("test", "tests")))

    def test_another_measured_curve_is_another_quantity(self):
        before = Distance(TEXT, self.directory).key
        self.measured.write_text(MEASURED.replace("8", "9"), "utf-8")
        self.assertNotEqual(Distance(TEXT, self.directory).key, before)


if __name__ == "__main__":
    unittest.main()

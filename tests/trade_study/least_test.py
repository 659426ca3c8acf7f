#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Searches for the least error on a mock program; SciPy must be there.

usage: least_test.py
"""

import csv
import json
import tempfile
import unittest

from check import Checker


class Least(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        holder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(holder.cleanup)
        cls.checker = Checker(f"{holder.name}/runs")
        cls.made = cls.search()

    @classmethod
    def search(cls, *settings, output="least"):
        """Exit code, text, calls, and the rows of members.csv by behaviour."""
        sets = [word for setting in settings for word in ("--set", setting)]
        code, text, calls = cls.checker.run("least.prm", output, *sets)
        return code, text, calls, {row["behaviour"]: row for row in cls.checker.runs(output)}

    def search_good(self, *settings):
        """The row of the run that always ends, and the calls."""
        _, _, calls, rows = self.search("Factor: behaviour/Values = good", *settings, output="good")
        return rows["good"], calls

    def file(self, name):
        return self.checker.directory / "least" / name

    def test_the_least_error_of_one_entry(self):
        code, text, calls, rows = self.made
        self.assertEqual(code, 0, text)
        good, bounded, refused = (rows[name] for name in ("good", "bounded", "refuses"))
        self.assertAlmostEqual(float(good["x"]), 1, delta=0.012)
        self.assertLess(float(good["misfit"]), 0.012 / 17.2)
        self.assertAlmostEqual(float(good["summary.json/results/list/0/length"]), 16.2 + 1 / float(good["x"]))
        # 8, -2 / x and 1 / x of the run with the least error, not of the last one.
        self.assertAlmostEqual(float(good["mean of statistics.csv/error, relative"]), (8 - 1 / float(good["x"])) / 3)
        self.assertEqual(float(good["wall time [s]"]), float(good["x"]))
        self.assertLessEqual(int(good["runs"]), 16)
        self.assertIn(f"at x = {float(good['x']):.4g}, {good['runs']} runs", good["message"])
        # Beyond 0.7 its runs stop.
        self.assertTrue(0.67 < float(bounded["x"]) <= 0.7, bounded)
        self.assertEqual((refused["state"], refused["x"]), ("refused", ""))
        self.assertIn("fails at all values tried: file.prm:3", refused["message"])
        self.assertEqual(len(calls), sum(int(row["runs"]) for row in rows.values()))

    def test_the_run_with_the_least_error_stays_and_all_trials_are_listed(self):
        rows = self.made[-1]
        summary = json.loads(self.file("members/behaviour=good/summary.json").read_text("utf-8"))
        self.assertAlmostEqual(summary["wall_seconds"], float(rows["good"]["x"]))
        with open(self.file("members/behaviour=bounded.trials.csv"), newline="", encoding="utf-8") as file:
            trials = list(csv.DictReader(file))
        self.assertEqual(len(trials), int(rows["bounded"]["runs"]))
        self.assertEqual(len({trial["Model/x"] for trial in trials}), len(trials))
        for trial in trials:
            self.assertEqual(trial["misfit"] == "", float(trial["Model/x"]) > 0.7)
            self.assertEqual("x is too large" in trial["message"], float(trial["Model/x"]) > 0.7)
        self.assertEqual(min(float(trial["misfit"] or "inf") for trial in trials), float(rows["bounded"]["misfit"]))
        self.assertFalse([path for path in self.file("members").iterdir() if path.name.endswith(".least")])

    def test_what_was_found_is_told(self):
        self.assertRegex(self.made[1], r"behaviour good → bounded: error [^,]+, time ÷ 1.\d+, x ÷ 1.\d+\.")
        self.assertIn("| behaviour | misfit | wall time [s] | front | x | mean of", self.file("report.md").read_text("utf-8"))
        found = json.loads(self.file("study.json").read_text("utf-8"))["members"][0]["found"]
        self.assertAlmostEqual(found["x"], 1, delta=0.012)

    def test_a_search_that_was_made_is_not_made_again(self):
        _, _, calls, rows = self.search()
        self.assertEqual(calls, [])
        self.assertEqual(rows, self.made[-1])

    def test_several_entries_at_once(self):
        good, _ = self.search_good(
            "Search/Entry = Model/x & Model/error", "Search/From = 1 & -3", "Search/To = 4 & 5",
            "Error/Quantities of interest = summary.json/results/list/0/length | summary.json/wall_seconds",
            "Error/References = 17.2, 2", "Error/Combination = root mean square")
        self.assertAlmostEqual(float(good["x"]), 2, delta=0.1)
        self.assertAlmostEqual(float(good["error"]), 2, delta=0.5)

    def test_an_end_and_a_search_that_is_cut_are_told(self):
        good, _ = self.search_good("Search/To = 0.5")
        self.assertIn("; x is at an end of what was tried", good["message"])
        good, calls = self.search_good("Search/Largest number of runs = 4")
        self.assertIn("; not yet within the tolerance", good["message"])
        self.assertEqual(len(calls), 4)

    def test_bounds_and_multiples_of_a_value(self):
        good, _ = self.search_good("Search/Relative to = summary.json/limit", "Search/To = 2.6",
                                   "Search/Quantities of interest = summary.json/wall_seconds", "Search/At most = 0.8")
        # The limit is 0.5 and x at most 0.8.
        self.assertTrue(1.55 < float(good["x"]) <= 1.6, good)


if __name__ == "__main__":
    unittest.main()

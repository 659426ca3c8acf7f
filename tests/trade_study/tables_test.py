#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""scripts/study --table and scripts/measure_run on files of a few rows."""

import json
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "python"))

from script_testing import PROJECT, DirectoryTest, run  # noqa: E402

MEMBERS = """member,model,size,state,error of it,time [s],on the front,summary.json/steps,a.json/x/largest speed,message
a,bar,2,measured,0.012345,123.4,1,1234567,-11.0,
b,bar,1,measured,4.5678e-7,1.5,0,8,2,
c,rod,1,stopped,,,0,,,it said so
"""


class Tables(DirectoryTest):
    def setUp(self):
        super().setUp()
        (self.directory / "members.csv").write_text(MEMBERS, "utf-8")

    def table(self, *options):
        return run(PROJECT / "scripts/study", "--table", self.directory, *options)

    def test_a_column_for_each_choice_of_a_factor(self):
        result = self.table("--rows", "size", "--columns", "model", "--values", "error | cost")
        self.assertEqual(result.stdout.splitlines(), [
            "| size | bar | rod |", "|---|---|---|", "| 2 | 0.0123, 123 | – |", "| 1 | 4.57e-7, 1.50 | stopped |"])

    def test_a_column_for_each_value_of_some_runs(self):
        result = self.table("--where", "model = bar", "--rows", "size", "--values", "steps|largest speed", "--digits", "2")
        self.assertEqual(result.stdout.splitlines(), [
            "| size | steps | largest speed |", "|---|---|---|", "| 2 | 1234567 | -11 |", "| 1 | 8 | 2 |"])

    def test_what_cannot_be_shown(self):
        for options, words in ((("--columns", "size", "--values", "speed"), 'no column "speed"'),
                               (("--rows", "size", "--columns", "size"), "differ in model"),
                               (("--where", "model = beam"), "no run is left"),
                               (("--where", "bar"), "no column")):
            with self.subTest(options=options):
                if words.startswith("differ"):
                    (self.directory / "members.csv").write_text(MEMBERS.replace("rod", "car"), "utf-8")
                result = self.table(*options)
                self.assertEqual(result.returncode, 1)
                self.assertIn(words, result.stderr)


class MeasuredRuns(DirectoryTest):
    def make_run(self, directory, seconds, statics=None):
        directory.mkdir(exist_ok=True)
        summary = {"steps": 3, "step_processor_seconds": seconds}
        (directory / "summary.json").write_text(json.dumps({**summary, **({"statics": statics} if statics else {})}))
        (directory / "statistics.csv").write_text(
            "time [s],external work [J],remap loss [J],energy error,largest speed [m/s]\n0,0,0,0,nan\n1,4,0.5,1e-3,7\n")

    def measured(self):
        result = run(PROJECT / "scripts/measure_run", self.directory)
        self.assertEqual(result.returncode, 0, result.stderr)
        return json.loads((self.directory / "measured.json").read_text("utf-8"))

    def test_energies_over_the_work(self):
        self.make_run(self.directory, 2)
        measured = self.measured()
        self.assertEqual(measured["run"]["over the work"], {"external work": 1, "remap loss": 0.125})
        self.assertEqual(measured["run"]["last"]["largest speed"], 7)
        self.assertEqual(measured["all"]["step_processor_seconds"], 2)

    def test_sums_over_stages(self):
        self.make_run(self.directory / "bend", 2, {"force_evaluations": 10})
        self.make_run(self.directory / "release", 3, {"force_evaluations": 5})
        measured = self.measured()
        self.assertEqual(sorted(measured), ["all", "bend", "release"])
        self.assertEqual(measured["all"]["step_processor_seconds"], 5)
        self.assertEqual(measured["all"]["force_evaluations"], 15)

    def test_a_run_without_an_end_is_refused(self):
        result = run(PROJECT / "scripts/measure_run", self.directory)
        self.assertEqual(result.returncode, 1)
        self.assertIn("cannot be measured", result.stderr)


if __name__ == "__main__":
    unittest.main()

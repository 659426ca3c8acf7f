#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""What scripts/benchmark reads of the logs of other packages, which errors it counts, and what it refuses."""

import contextlib
import io
import json
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "python"))

from script_testing import PROJECT, SCRIPTS, DirectoryTest, run  # noqa: E402

from benchmarking import peers, solutions  # noqa: E402
from benchmarking.runs import BenchmarkError  # noqa: E402

LAMMPS = """Peridynamic bonds:
  total # of bonds = 3057972
  bonds/atom = 101.973
       10 2.0660704e+21   0.80692624            0    1283.8851    116.88807    7.3216141 \n\
Loop time of 0.940702 on 1 procs for 10 steps with 29988 atoms
"""
CALCULIX = """ The numbers below are estimated upper bounds

   nodes:        29988
   elements:        25688

 Job finished
"""
RESULTS = """    1PSTEP                         1          15           1          \n\
  100CL  101 7.50000E-01         756                     1    1           1
    1PSTEP                         2          29           1          \n\
  100CL  102 1.500000000         756                     1    2           1
"""


class Peers(unittest.TestCase):
    def test_logs_are_read(self):
        self.assertEqual(peers.read_lammps(LAMMPS), peers.Finished(29988, 10, 101.973))
        self.assertEqual(peers.read_calculix(CALCULIX, RESULTS), peers.Finished(29988, 29))

    def test_a_run_without_its_end_is_refused_with_what_it_said(self):
        with self.assertRaisesRegex(BenchmarkError, "ERROR: Lost atoms"):
            peers.read_lammps(LAMMPS.split("Loop")[0] + "ERROR: Lost atoms")
        for log, results in ((CALCULIX.replace("Job finished", "*ERROR in nonlingeo"), RESULTS), (CALCULIX, "")):
            with self.assertRaisesRegex(BenchmarkError, "CalculiX has not come to its end"):
                peers.read_calculix(log, results)

    def test_a_package_that_is_missing_is_said_and_left_out(self):
        printed = io.StringIO()
        with contextlib.redirect_stdout(printed):
            cases = peers.choose_cases(lambda command: command == "lmp")
        self.assertEqual({case.package for case in cases}, {"LAMMPS", peers.TOMBOLO})
        self.assertRegex(printed.getvalue(), "^CalculiX is not installed .*setup --peers.*apt-get install calculix-ccx")
        self.assertEqual(printed.getvalue().count("\n"), 1)

    def test_without_any_nothing_is_measured(self):
        done = run(sys.executable, "-B", "-m", "benchmarking", PROJECT, "--peers", "--program", "/none", PYTHONPATH=SCRIPTS,
                   PATH="/none")
        self.assertEqual((done.returncode, done.stdout), (1, ""))
        self.assertRegex(done.stderr, "neither LAMMPS nor CalculiX is installed .*apt-get install lammps calculix-ccx")

    def test_the_mesh_of_a_rod(self):
        mesh = {name: lines.splitlines() for name, lines in peers.mesh_of([2, 2, 2]).items()}
        self.assertEqual([len(mesh[name]) for name in ("nodes", "cells", "velocities")], [27, 8, 81])
        self.assertEqual(mesh["nodes"][4], "5, 5, 5, 0")
        self.assertEqual(mesh["cells"][0], "1, 1, 2, 5, 4, 10, 11, 14, 13")
        self.assertEqual(mesh["cells"][-1], "8, 14, 15, 18, 17, 23, 24, 27, 26")
        self.assertEqual(mesh["velocities"][14], "5, 3, -0")
        deck = (PROJECT / peers.FOLDER / "rod.inp").read_text("utf-8")
        filled = deck.format(**peers.mesh_of([2, 2, 2]), element="C3D8", step=1, end=2, n_steps=2)
        self.assertIn("*ELEMENT, TYPE=C3D8, ELSET=ROD\n1, 1, 2, 5", filled)


class Solutions(DirectoryTest):
    def problem(self, **changes):
        entries = {"title": "bar", "reference": {"length": 2, "width": 1}, "settings": [], "levels": [0.1, 0.05],
                   "sizes": {"4": ["Cells = 4"], "8": ["Cells = 8"]},
                   "models": [{"name": "elements", "file": "bar.prm", "sizes": ["4", "8"], "two_ranks": "8"},
                              {"name": "particles", "file": "bar.prm", "sizes": ["4"]}]}
        for folder in ("benchmarks", "parameter_files"):
            (self.directory / folder).mkdir(exist_ok=True)
        (self.directory / "parameter_files/bar.prm").touch()
        pattern = changes.pop("pattern", None)
        (self.directory / solutions.SETTINGS).write_text(json.dumps({**entries, **changes}), "utf-8")
        return solutions.Problem(self.directory, pattern)

    def test_the_shipped_models_are_there(self):
        self.assertGreater(len(solutions.Problem(PROJECT).models), 4)

    def test_runs_of_a_round(self):
        for ranks, runs in ((1, ["elements 4 1", "elements 8 1", "particles 4 1"]),
                            (2, ["elements 4 1", "elements 8 1", "elements 8 2", "particles 4 1"])):
            self.assertEqual([f"{model.name} {size} {n}" for model, size, n in self.problem().runs(ranks)], runs)
        self.assertEqual([model.name for model in self.problem(pattern="^part").models], ["particles"])

    def test_the_error_is_the_root_of_the_mean_square(self):
        self.assertAlmostEqual(self.problem().error({"length": 2.06, "width": 0.96, "height": 7}), 0.035355339)
        with self.assertRaisesRegex(BenchmarkError, "no result width"):
            self.problem().error({"length": 2})

    def test_what_is_not_there_is_named(self):
        missing = [{"name": "elements", "file": "rod.prm", "sizes": ["4"]}]
        unknown = [{"name": "elements", "file": "bar.prm", "sizes": ["6"]}]
        for changes, words in (({"models": missing}, "names rod.prm"), ({"models": unknown}, "no size 6"),
                               ({"pattern": "shell"}, 'no model .*"shell".*elements, particles')):
            with self.assertRaisesRegex(BenchmarkError, words):
                self.problem(**changes)

    def test_the_front_and_the_time_to_an_error(self):
        rows = [{"model": model, "seconds": seconds, "error": error, "ranks": ranks}
                for model, seconds, error, ranks in (("a", 4, 0.02, 1), ("a", 1, 0.2, 1), ("b", 2, 0.3, 1), ("b", 3, 0.04, 1),
                                                     ("a", 0.5, 0.2, 2))]
        solutions.mark_front(rows, 0.05)
        self.assertEqual([row["on_front"] for row in rows], [False, True, False, True, False])
        self.assertEqual(solutions.seconds_to(rows, 0.1), {"a": 4, "b": 3})
        self.assertEqual(solutions.seconds_to(rows, 0.03), {"a": 4, "b": None})


if __name__ == "__main__":
    unittest.main()

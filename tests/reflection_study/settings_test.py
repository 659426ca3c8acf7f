#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""What is wrong with the file of a reflection study is refused with its entry and what is allowed.

usage: settings_test.py STRIP_OPERATORS TOMBOLO
"""

import os
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

from cases import read_programs
from reflection.settings import ReflectionSettings
from tombolo.parameter_file import InputError, ParameterFile

SCRIPTS = Path(__file__).resolve().parents[2] / "scripts"


class Settings(unittest.TestCase):
    def setUp(self):
        holder = tempfile.TemporaryDirectory()
        self.addCleanup(holder.cleanup)
        self.path = Path(holder.name) / "study.prm"

    def read(self, group):
        self.path.write_text("set Groups = one\nsubsection Group: one\n" + group + "end\n", "utf-8")
        return ReflectionSettings(ParameterFile(self.path))

    def study(self, group, *options):
        self.read(group)
        return subprocess.run(
            [sys.executable, "-B", "-m", "reflection", self.path, *options], text=True,
            stdout=subprocess.PIPE, stderr=subprocess.PIPE, check=False, cwd=self.path.parent,
            env={**os.environ, "PYTHONPATH": str(SCRIPTS)})

    def test_the_cases_are_the_product_of_the_lists(self):
        study = self.read("set Pairs = FE-FE, FE-particles\nset Spacing ratios = 1/3, 2\n"
                          "set Waves = P, S\nset Angles = 0, 30, 60\n")
        self.assertEqual(study.n_cases(), 24)
        self.assertEqual([(row.case.right, row.ratio, row.case.wave, row.degrees)
                          for row in study.groups[0].rows[::7]],
                         [("FE", "1/3", "P", 0), ("FE", "2", "P", 30),
                          ("particles", "1/3", "P", 60), ("particles", "2", "S", 0)])

    def test_what_is_wrong_is_refused_with_its_entry_and_what_is_allowed(self):
        for group, *parts in (
                ("set Pairs = FE-FE\nset Wavelength = 10\n", "study.prm:4",
                 'Did you mean "Group: one/Wavelengths"'),
                ("set Waves = P\n", "Pairs"),
                ("set Pairs = FE-PE\n", "study.prm:3", "FE-particles", 'Did you mean "FE-FE"'),
                ("set Pairs = FE-FE\nset Waves = P, Q\n", "study.prm:4",
                 "allowed is a list of P, S"),
                ("set Pairs = FE-FE\nset Wavelengths =\n", "study.prm:4", "the list is empty"),
                ("set Pairs = FE-FE\nset Cycles = 2\n", "study.prm:4",
                 "allowed is a number from 8 to 100"),
                ("set Pairs = FE-FE\nset Wavelengths = 10, 2\n", "study.prm:4", "2 is outside",
                 "4 to 1000"),
                ("set Pairs = FE-FE\nset Angles = 90\n", "study.prm:4", "0 to 80"),
                ("set Pairs = FE-FE\nset Spacing ratios = 1/x\n", "study.prm:4",
                 '"x" is not a number'),
                ("set Pairs = FE-FE\nset Spacing ratios = 1/0\n", "study.prm:4", "1/10 to 10"),
                ("set Pairs = FE-FE\nset Reference = 1, 2\n", "2 values for the 1 cases"),
                ("set Pairs = FE-FE\nset Filter powers = 1.5\n", "whole number")):
            with self.subTest(group=group), self.assertRaises(InputError) as caught:
                self.read(group)
            for part in parts:
                self.assertIn(part, str(caught.exception))

    def test_what_the_program_does_not_know_is_refused_for_the_case(self):
        for lists, options, *parts in (
                ("set Smoothings = affine, afine\n", (), "Smoothing", '"afine"',
                 'did you mean "affine"'),
                ("set Elements = hexahedron, hexaedron\n", ("--validate",), "Formulation",
                 '"hexaedron"', 'Did you mean "hexahedron"')):
            result = self.study("set Pairs = FE-particles\n" + lists, *options)
            self.assertEqual(result.returncode, 1, result.stderr)
            for part in ('Error: ', 'section "Group: one": case 2 of the group cannot be computed',
                         *parts):
                self.assertIn(part, result.stderr)
            self.assertEqual(list(self.path.parent.rglob("reflection.csv")), [])

    def test_a_directory_that_cannot_be_made_is_refused(self):
        result = self.study("set Pairs = FE-FE\n", "--set", "Output directory = study.prm/below")
        self.assertEqual(result.returncode, 1, result.stderr)
        self.assertIn('entry "Output directory" = "study.prm/below": nothing can be', result.stderr)

    def test_the_entries_are_printed_as_a_file_that_can_be_read(self):
        result = self.study("set Pairs = FE-FE\n", "--print-parameters", "--set",
                            "Group: one/Waves = S")
        self.assertIn("set Waves = S", result.stdout)
        self.path.write_text(result.stdout, "utf-8")
        self.assertEqual(ReflectionSettings(ParameterFile(self.path)).n_cases(), 1)


if __name__ == "__main__":
    read_programs()
    unittest.main()

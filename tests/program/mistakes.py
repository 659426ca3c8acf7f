#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""All mistakes of an input at once, what --validate finds in a mesh, listings of entries, entries that are reset.

    mistakes.py PROGRAM MPIEXEC SOURCE_DIRECTORY
"""

import json
import os
import re
import shutil
import sys
import unittest

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import command_line
import run_cases

# The lines of twenty_mistakes.prm and the message for each.
TWENTY = (
    (4, '"End time" = "-1": allowed is a number larger than zero.'),
    (7, 'the name "steel" stands twice.'),
    (11, 'found "Largest energy error   = 0.1". Did you mean "set Largest energy error   = 0.1"?'),
    (14, '"Mesh/Type" = "bx": allowed is one of "box"'),
    (17, 'unknown entry "Mesh/box/Cell". Did you mean "Cells"?'),
    (22, '"Part: left/Cells" = "x <"'),
    (24, '"Part: left/Material" = "stel": there is no material of this name. Did you mean "steel"?'),
    (32, 'Dilation" = "wide": allowed is a number.'),
    (33, 'Dilation" is set twice, here and at case.prm:32.'),
    (34, 'Smoothing" = "afine"'),
    (40, 'the entry "Density" is missing.'),
    (40, 'the entry "Poisson\'s ratio" is missing.'),
    (46, '"Material: copper/Model" = "elastik": allowed is one of "chaboche", "elastic"'),
    (52, '"Condition: pulse/Function" = "0.1*sin(pi*t)"'),
    (56, 'unknown entry "Condition: wall/Wher". Did you mean "Where"?'),
    (61, '"Initial condition: start/Velocity" = "1; 2; 3"'),
    (65, 'unknown entry "Contact: floor/Stifness". Did you mean "Stiffness"?'),
    (67, 'the entry "Normal" is missing.'),
    (72, 'unknown section "Outputt". Did you mean "Output"?'),
    (77, '"Checkpoint/Keep" = "0": allowed is a whole number from 1'),
)

SQUARES = """# vtk DataFile Version 3.0
strip
ASCII
DATASET UNSTRUCTURED_GRID
POINTS 6 double
0 0 0  1 0 0  2 0 0  0 1 0  1 1 0  2 1 0
CELLS 2 10
4 0 1 4 3
4 1 2 5 4
CELL_TYPES 2
9
9
"""


class Mistakes(command_line.Case):
    def mistakes_in(self, *options, ranks=1):
        """The numbered messages of a run that is refused."""
        printed = self.run_program(*options, exits=1, ranks=ranks)
        self.assertEqual(len(re.findall(r"\bError: ", printed)), 1, printed)
        found = re.findall(r"^ ?(\d+)\. (.*)$", printed, re.M)
        self.assertEqual([int(number) for number, _ in found], list(range(1, len(found) + 1)), printed)
        return [message for _, message in found], printed

    def write_twenty(self, *changes):
        self.write("case.prm", run_cases.changed_file(os.path.join(run_cases.HERE, "twenty_mistakes.prm"), changes))

    def test_twenty_mistakes_are_told_at_once_in_the_order_of_the_file(self):
        self.write_twenty()
        for options, ranks in ((("--validate",), 1), ((), 1), (("--dry-run",), 2)):
            messages, printed = self.mistakes_in(*options, "case.prm", ranks=ranks)
            self.assertEqual(len(messages), len(TWENTY), printed)
            for message, (line, piece) in zip(messages, TWENTY):
                self.assertTrue(message.startswith("case.prm:%d: " % line), message)
                self.assertIn(piece, message)
            self.assertIn("20 mistakes were found:", printed)
        self.assertEqual(sorted(os.listdir(self.directory)), ["case.prm", "rod.prm"])

    def test_no_more_than_twenty_are_printed_and_the_others_counted(self):
        self.write_twenty(("  set Keep = 0\n", "  set Keep = 0\n  set Kept = 1\n  set Wall = 2\n"))
        messages, printed = self.mistakes_in("--validate", "case.prm", "--set", "Mesh/Typ = box")
        self.assertEqual(len(messages), 20)
        self.assertIn("23 mistakes were found, of which these are the first 20:", printed)
        self.assertNotIn("Mesh/Typ =", printed)  # comes after the files

    def test_what_follows_from_a_mistake_is_not_told(self):
        for change, piece in (
                (["set Density         = 100", "set Densty          = 100"], "Densty"),
                (["set Density         = 100", "Density             = 100"], "a line begins with"),
                (["set Density         = 100", "set Density           100"], '"set" without "="'),
                (["Parts            = left, right", "Parts            = left, rigth"], "Part: right"),
                (["set Parts            = left, right\n", ""], "Part: left"),
                (["set Conditions       = pulse", "set Conditions       = pulse\nset Processe = foo\n"
                  "subsection Process: foo\nend"], '"Processe"'),
                (["set Materials        = steel", "set Materials        = steel, steel"], "stands twice"),
                (["set Dimension        = 2", "set Dimension        = 4"], "from 2 to 3"),
                (["  set Type = box", "  set Typ = box"], '"Mesh/Typ"'),
                (["set Where    = x < 1e-9", "set Wher     = x < 1e-9"], "Wher")):
            self.write_rod("case.prm", "output", change)
            printed = self.run_program("--validate", "case.prm", exits=1)
            self.assertIn(piece, printed)
            self.assertNotIn("mistakes were found", printed)

    def test_entries_without_effect_are_told_beside_other_mistakes(self):
        self.write_rod("case.prm", "output",
                       ["    set Density         = 100\n", ""],
                       ["  set Formulation = hexahedron\n",
                        "  set Formulation = hexahedron\n  subsection lagrange hexahedron\n    set Degree = 2\n  end\n"])
        messages, printed = self.mistakes_in("--validate", "case.prm")
        self.assertEqual(len(messages), 2, printed)
        self.assertIn('"Part: left/lagrange hexahedron/Degree" = "2" has no effect here', messages[0])
        self.assertIn('"Density" is missing', messages[1])

    def test_overrides_are_told_beside_the_file(self):
        self.write_rod("case.prm", "output", ["set Density         = 100", "set Density         = heavy"])
        messages, printed = self.mistakes_in("--validate", "case.prm", "--set", "Mesh/Typ = box", "--set", "nothing",
                                             "--set", "Time step/Maximum = -1")
        self.assertEqual(len(messages), 4, printed)
        self.assertTrue(messages[0].startswith("case.prm:37: "), printed)
        for piece in ('--set "nothing": "=" is missing.', '--set "Mesh/Typ = box": unknown entry',
                      '--set "Time step/Maximum = -1": allowed is a number of at least 0.'):
            self.assertEqual(sum(message.startswith(piece) for message in messages), 1, piece)


class Meshes(command_line.Case):
    """--validate reads the mesh."""

    FILE = ["  set Type = box\n  subsection box\n    set Upper corner = 2, 0.4\n    set Cells        = 10, 2\n  end",
            "  set Type = file\n  subsection file\n    set File = strip.vtk\n  end"]

    def write_mesh(self, text):
        self.write("strip.vtk", text)

    def test_a_mesh_file_is_read(self):
        self.write_rod("case.prm", "output", self.FILE)
        self.write_mesh(SQUARES)
        self.assertIn("nothing wrong was found", self.run_program("--validate", "case.prm", ranks=2))
        self.write_mesh(SQUARES.replace("4 1 2 5 4", "4 1 2 5 9"))
        self.assertIn("strip.vtk", self.run_program("--validate", "case.prm", exits=1))
        os.remove(self.path("strip.vtk"))
        self.assertIn("strip.vtk", self.run_program("--validate", "case.prm", exits=1))
        self.assertEqual(sorted(os.listdir(self.directory)), ["case.prm", "rod.prm"])

    def test_names_of_boundaries_and_groups_are_checked(self):
        self.write_rod("case.prm", "output", ["  set Where    = x < 1e-9", "  set Boundary = x mim"],
                       ["  set Cells       = x < 1", "  set Cells       = group copper"])
        printed = self.run_program("--validate", "case.prm", exits=1, ranks=2)
        self.assertIn("2 mistakes were found:", printed)
        self.assertIn('case.prm:19: entry "Part: left/Cells" = "group copper": The mesh has no groups', printed)
        self.assertIn('case.prm:44: entry "Condition: pulse/Boundary" = "x mim": The mesh has no boundary', printed)
        self.assertIn('Did you mean "x min"?', printed)

    def test_cells_without_a_part_are_found(self):
        self.write_rod("case.prm", "output", ["  set Cells       = otherwise", "  set Cells       = x > 1.5"])
        self.assertIn("is in no part", self.run_program("--validate", "case.prm", exits=1))


class Listings(command_line.Case):
    def test_all_entries_are_printed_without_a_file(self):
        printed = self.run_program("--print-parameters")
        for entry in ("# set Young's modulus", "# set Dilation", "subsection Contact: NAME", "subsection drill",
                      "# set Safety factor", "# set End time"):
            self.assertIn(entry, printed)
        values = json.loads(self.run_program("--print-parameters=json", ranks=2))
        self.assertEqual(values["Time step"]["Safety factor"], 0.85)
        self.assertIn("Upper corner", values["Mesh"]["box"])
        page = self.run_program("--print-parameters=markdown", "--set", "Dimension = 2")
        self.assertIn("| `End time` | mandatory |", page)

    def test_a_section_is_printed_alone(self):
        printed = self.run_program("--print-parameters=prm:Time step")
        self.assertTrue(printed.startswith("subsection Time step\n"), printed)
        self.assertTrue(printed.endswith("\nend\n"), printed)
        self.assertIn("  # set Safety factor", printed)
        self.assertNotIn("End time", printed)
        part_text = self.run_program("--print-parameters=json:Part: right/momentum consistent particle", "rod.prm")
        self.assertEqual(json.loads(part_text), {"Dilation": 1.8, "Smoothing": "affine"})
        self.assertIn("Dilation", self.run_program("--print-parameters=prm:Part/momentum consistent particle"))
        page = self.run_program("--print-parameters=markdown:Checkpoint")
        self.assertIn("| `Keep` | `2` |", page)
        self.assertNotIn("`End time`", page)

    def test_a_printed_section_can_be_read_again(self):
        printed = self.run_program("--print-parameters=prm:Material: steel/elastic", "rod.prm")
        self.write("steel.prm", printed)
        self.write_rod("case.prm", "output",
                       ["subsection Material: steel\n", "include steel.prm\nsubsection Material: steel\n"],
                       ["    set Density         = 100\n    set Young's modulus = 100\n", ""])
        self.assertIn("nothing wrong was found", self.run_program("--validate", "case.prm"))

    def test_unknown_sections_and_formats_are_refused(self):
        for option, piece in (("=prm:Time stepp", 'Did you mean "Time step"?'),
                              ("=prm:Mesh/Type", 'write "set Type = ..."'),
                              ("=xml:Mesh", "has all sections"), ("=Time step", "allowed is prm, json, xml or markdown")):
            printed = self.run_program("--print-parameters" + option, exits=1)
            self.assertIn(piece, printed)
            self.assertEqual(printed.count("Error: "), 1)


class TakenBack(command_line.Case):
    """`--set "Section/Entry ="` is as though the file did not set the entry."""

    def test_a_default_is_back(self):
        dilation = "Part: right/momentum consistent particle/Dilation"
        self.write_rod("case.prm", "output", ["set Dilation  = 1.8", "set Dilation  = 1.3"])
        values = json.loads(self.run_program("--print-parameters=json:Part: right/momentum consistent particle",
                                             "case.prm", "--set", dilation + " ="))
        self.assertNotIn("Dilation", values)
        self.assertIn("nothing wrong was found", self.run_program("--validate", "case.prm", "--set", dilation + " ="))

    def test_a_mandatory_entry_is_missing_then(self):
        printed = self.run_program("--validate", "rod.prm", "--set", "End time =", exits=1)
        self.assertIn('rod.prm: the entry "End time" is missing.', printed)

    def test_a_wrong_value_does_not_matter(self):
        self.write_rod("case.prm", "output", ["set Times = 0.25", "set Times = soon\n  set Interval = 0.1"])
        self.run_program("--validate", "case.prm", exits=1)
        self.assertIn("nothing wrong was found", self.run_program("--validate", "case.prm", "--set", "Output/Times ="))

    def test_a_former_name_is_taken_back_too(self):
        self.write_rod("case.prm", "output", ["subsection Output", "subsection Time step\n  set Look interval = 3\nend\n"
                                              "subsection Output"])
        for name in ("Look interval", "Check interval"):
            values = json.loads(self.run_program("--print-parameters=json:Time step", "case.prm", "--set",
                                                 "Time step/%s =" % name))
            self.assertNotIn("Check interval", values)

    def test_unknown_names_are_refused(self):
        printed = self.run_program("--validate", "rod.prm", "--set", "Mesh/Typ =", exits=1)
        self.assertIn('unknown entry "Mesh/Typ". Did you mean "Type"?', printed)


if __name__ == "__main__":
    command_line.PROGRAM, command_line.MPIEXEC, command_line.SOURCE = sys.argv[1:4]
    loader = unittest.TestLoader()
    chosen = sys.argv[4:] or ["Mistakes", "Meshes", "Listings", "TakenBack"]
    suite = unittest.TestSuite(loader.loadTestsFromTestCase(globals()[name]) for name in chosen)
    result = unittest.TextTestRunner(verbosity=2).run(suite)
    sys.exit(0 if result.wasSuccessful() and result.testsRun > 0 else 1)

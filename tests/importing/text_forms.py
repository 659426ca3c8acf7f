#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Forms of text that programs write, each of the same mesh, and files that files name.

    text_forms.py PROJECT_DIRECTORY
"""

import re

from deck_testing import DeckTest, card, main, part_of, replaced, same_measures, text_of

MARK = "\ufeff"
BAR, CUBES = text_of("bar.k"), text_of("two_cubes.inp")
NODES, ELEMENTS = part_of(BAR, "*NODE\n", "*ELEMENT"), part_of(BAR, "*ELEMENT_SOLID\n", "*SET_NODE")
SET_1 = "*SET_NODE_LIST\n         1\n         1         2         3         4"


def windows(text):
    return text.replace("\n", "\r\n")


def joined_by(text, separator):
    return re.sub(" +", separator, re.sub("\n +", "\n", text))


class TextForms(DeckTest):
    def assert_same(self, text, name, expected):
        self.assertTrue(same_measures(self.mesh(text, name), expected), name)

    def test_marks_line_ends_and_blanks_are_no_difference(self):
        for name, text in (("a.inp", CUBES), ("a.k", BAR)):
            expected = self.mesh(text, name)
            for form in (MARK + text, windows(text), MARK + windows(text), re.sub("\n", "   \n", text)):
                self.assert_same(form, name, expected)

    def test_decks_of_ls_dyna_in_all_forms(self):
        expected = self.mesh(BAR, "a.k")
        first = "       1       1       1       5       6       2       4       8       7       3"
        line = "        4.000000        0.000000        0.000000"
        forms = {
            "elements first": [(NODES + ELEMENTS, ELEMENTS + NODES)],
            "lower case": [("*NODE\n", "*node\n"), ("*ELEMENT_SOLID", "*element_solid"), ("*END", "*end\nx")],
            "remarks": [(first, first + " cell of the bar, upper half")],
            "commas": [(ELEMENTS, joined_by(ELEMENTS, ","))],
            "tabs": [(ELEMENTS, joined_by(ELEMENTS, "\t"))],
            "D": [(line, "    4.000000D+00      0.0000d+00             0.0")],
            "no letter": [(line, "          0.4+01          0.0-01             0.0")],
            "columns of a set": [(SET_1, "*SET_NODE_COLUMN\n         1\n         1       0.5\n         2\n         3\n"
                                  "         4")],
            "a set of sets": [(SET_1, "*SET_NODE_ADD\n         1\n        11         9\n*SET_NODE_ADD\n         9\n"
                               "        12         1\n*SET_NODE_LIST\n        11\n         1         2\n"
                               "*SET_NODE_LIST_GENERATE\n        12\n         3         4")],
            "a parameter": [("        4.000000", "          &right"),
                            ("*NODE\n", "*PARAMETER\n" + card("Rright", 4.0) + "\n*NODE\n")],
        }
        for name, changes in forms.items():
            with self.subTest(name):
                mesh = self.mesh(replaced(BAR, *changes), "a.k")
                self.assert_volume(mesh, "bar", 4)
                for end in ("node set 1", "node set 2"):
                    self.assert_area(mesh, end, 1)
                self.assertEqual(mesh.groups, expected.groups)

    def test_constraints_of_nodes_are_boundaries(self):
        text = re.sub(r"(?m)^( {7}[1-4] .{46}0)$", rf"\1{card(4, 7, width=8)}", BAR)
        mesh = self.mesh(text, "a.k")
        for axis in "xy":
            self.assert_area(mesh, "held along " + axis, 1)
        self.assertNotIn("held along z", mesh.node_sets)
        self.assert_remark(mesh, 'TC of *NODE (first on line 14) holds nodes. They are the boundaries "held along x" '
                           "(4 nodes)")

    def test_names_that_are_not_utf_8_are_latin_1(self):
        mesh = self.mesh(replaced(CUBES, ("NSET=NS1", "NSET=Hülse")).encode("latin-1"), "a.inp")
        self.assertEqual(len(mesh.node_sets["Hülse"]), 3)
        mesh = self.mesh(replaced(BAR, ("*SET_NODE_LIST\n         2", "*SET_NODE_LIST_TITLE\nHülse\n         2")).encode(
            "latin-1"), "a.k")
        self.assertIn("Hülse", mesh.node_sets)
        self.assertIn("UTF-16", self.error(b"\xff\xfe*\0N\0", "a.inp"))

    def test_files_are_read_where_they_are_named(self):
        expected = self.mesh(CUBES, "a.inp")
        second = " 2, 2, 9, 10, 3, 6, 11,\n 12, 7\n"
        nodes = " 1, 0.0, 0.0, 0.0\n 2, 1.0, 0.0, 0.0\n"
        for text, included in (
                (replaced(CUBES, ("ELSET=EB2\n" + second, "ELSET=EB2, INPUT=part.dat\n")), MARK + windows(second)),
                (replaced(CUBES, ("NSET=ALLNODES\n" + nodes, "input = .\\part.dat , NSET=ALLNODES\n")),
                 "** a comment\n" + nodes),
                (replaced(CUBES, (nodes, "*INCLUDE, INPUT=part.dat\n")), nodes),
                ("*INCLUDE, INPUT=part.dat\n", CUBES)):
            self.write("part.dat", included)
            self.assert_same(text, "a.inp", expected)
        self.write("part.dat", "*KEYWORD\n" + ELEMENTS + NODES + "*END\nnot read\n")
        self.assert_same(replaced(BAR, (NODES + ELEMENTS, "*INCLUDE\npart.dat\n")), "a.k", self.mesh(BAR, "b.k"))

    def test_lines_of_included_files_are_named(self):
        text = replaced(CUBES, ("*HEADING\n", "*INCLUDE, INPUT=part.dat\n*HEADING\n"))
        for main_file, included, message in (
                (text, "*NODE\n51, 0, 0, 0\n52, x, 0, 0\n", 'line 3 of "part.dat": "x" stands where'),
                (text, "*NSET, NSET=a\n77\n", 'line 2 of "part.dat": There is no node of number 77'),
                (text, "*INCLUDE, INPUT=part.dat\n", 'line 1 of "part.dat": "part.dat" includes itself'),
                (text, "*NODE\n51, 0, 0, 0\n*ELEMENT, TYPE=C3D8, ELSET=a\n51, 1, 2, 3, 4, 5, 6, 7, 51\n",
                 'line 4 of "part.dat": A cell is'),
                (replaced(text, (" 4, 0.0", " 3, 0.0")), "** nothing\n", "line 10: There are two nodes of number 3")):
            with self.subTest(message):
                self.write("part.dat", included)
                self.assertIn(message, self.error(main_file, "a.inp"))
        self.write("part.dat", "*AMPLITUDE, NAME=a\n0, 0\n")
        said = "\n".join(self.converted(text, "a.inp").report.summary())
        self.assertIn('*AMPLITUDE (1 time, line 1 of "part.dat")', said)

    def test_what_exists_of_a_range_is_taken_and_the_rest_is_counted(self):
        result = self.converted(CUBES + "*NSET, NSET=near, GENERATE\n 1, 8\n"
                                "*NSET, NSET=whole, GENERATE\n 1, 3000000000, 1\n*ELSET, ELSET=both, GENERATE\n 1, 9, 1\n"
                                "*SURFACE, NAME=top, TRIM=YES\n 1, S2\n", "a.inp")
        self.assert_volume(result.mesh, "both", 2)
        self.assert_remark(result.mesh, 'Missing are 2999999988 of 3000000000 nodes of the set "whole" (line')
        self.assert_remark(result.mesh, '6 of 9 elements of the set "both" (line')
        self.assertFalse(any('"near" (line' in remark for remark in result.mesh.remarks))

    def test_what_is_not_read_is_refused_with_its_line(self):
        cases = (
            (("        4.000000", "          &right"), 'there is no parameter "right" of type R, I or C in *PARAMETER'),
            (("       1       1       1       5", "1\t1\t1\t12345678901"), "line 35: The card has tabs"),
            (("*SET_NODE_LIST\n         1\n         1", "*SET_NODE_ADD\n         1\n         5"),
             "line 41: There is no set of nodes of number"),
            (("20        4.0", "20        4.0x"), 'line 33: "4.0x'),
            (("20        4.000000", "20           1e999"), "is not finite"),
            ((ELEMENTS, ELEMENTS.replace("7       3", "7      33", 1)), "line 35: There is no node of number 33"),
        )
        for change, message in cases:
            with self.subTest(message):
                self.assertIn(message, self.error(replaced(BAR, change), "a.k"))


main()

#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Decks in all forms that programs write, and what they say that a parameter file has not.

    dyna_forms.py PROJECT_DIRECTORY PROGRAM
"""

import re

from deck_testing import DeckTest, DeckError, card, main, text_of

BAR = text_of("bar.k")


def part_of(begin, end):
    return BAR[BAR.index(begin):BAR.index(end)]


NODES, ELEMENTS = part_of("*NODE", "*ELEMENT"), part_of("*ELEMENT", "*SET_NODE")
SETS = part_of("*SET_NODE", "*BOUNDARY_SPC")
SUPPORT, DRIVE = part_of("*BOUNDARY_SPC", "*DEFINE"), part_of("*BOUNDARY_PRE", "*END")
MATERIAL = part_of("*MAT_ELASTIC", "*NODE")
SUPPORTED, DRIVEN = SUPPORT.split("\n")[1], DRIVE.split("\n")[1]


def wide(text):
    """The deck with fields of 20 columns."""
    result, widths = [], [10]
    for line in text.split("\n"):
        if line.startswith("*"):
            widths = [8, 16] if line == "*NODE" else [8] if line.startswith("*ELEMENT") else [10]
            if line.startswith("*DEFINE"):
                widths = [10]
        elif line and line[0] == " ":
            fields, begin = [], 0
            while begin < len(line):
                width = widths[min(len(fields), len(widths) - 1)]
                fields.append(line[begin:begin + width].strip())
                begin += width
            if widths == [10] and not line[:10].strip():
                fields = line.split()
            line = card(*fields, width=20)
        result.append(line)
    return "\n".join(result).replace("*KEYWORD", "*KEYWORD LONG=Y")


# Each of these is the same scene.
FORMS = {
    "line ends of Windows": lambda bar: bar.replace("\n", "\r\n"),
    "byte-order mark": lambda bar: "\ufeff" + bar,
    "lower case": lambda bar: bar.lower(),
    "elements before nodes": lambda bar: bar.replace(NODES + ELEMENTS, ELEMENTS + NODES),
    "sets before all": lambda bar: bar.replace(SETS, "").replace("*PART\n", SETS + "*PART\n"),
    "remarks behind the columns": lambda bar: re.sub(r"(?m)^(( +\d+){10})$", r"\1 cell of the bar, upper half", bar),
    "commas": lambda bar: bar.replace(ELEMENTS, re.sub(r"(\d) +", r"\1,", ELEMENTS)),
    "two cards and zeros": lambda bar: bar.replace(ELEMENTS, re.sub(
        r"(?m)^(.{16})(.+)$", rf"\1\n\2{card(0, 0, width=8)}", ELEMENTS).replace("*ELEMENT_SO\nLID", "*ELEMENT_SOLID")),
    "tabs": lambda bar: bar.replace(ELEMENTS, re.sub(r"(\d) +", r"\1\t", re.sub(r"(?m)^ +", "", ELEMENTS))),
    "wide fields": wide,
    "wide fields of a keyword alone": lambda bar: bar.replace(ELEMENTS, "*ELEMENT_SOLID %\n" + "".join(
        card(*line.split()) + "\n" for line in ELEMENTS.split("\n")[1:-1])),
    "blanks about a sign of equality": lambda bar: wide(bar).replace("LONG=Y", "LONG = Y"),
    "exponents without letters": lambda bar: bar.replace("7.85E-09", " 7.85-09").replace("  210000.0", "    2.1+05"),
    "exponents of Fortran": lambda bar: bar.replace("7.85E-09", "7.85D-09").replace(
        "        4.000000", "    4.000000D+00"),
    "numbers and titles of conditions": lambda bar: bar.replace(
        SUPPORT, "*BOUNDARY_SPC_SET_ID\n         7left end\n" + SUPPORTED + "\n").replace(
            DRIVE, "*BOUNDARY_PRESCRIBED_MOTION_SET_ID\n         1\n" + DRIVEN + "\n"),
    "titles of sections and materials": lambda bar: bar.replace("*SECTION_SOLID\n", "*SECTION_SOLID_TITLE\nbricks\n"),
    "two sections": lambda bar: bar.replace("*SECTION_SOLID\n", "*SECTION_SOLID\n" + card(2, 1) + "\n"),
    "what programs write for blanks": lambda bar: bar.replace(
        DRIVEN, card(2, 1, 2, 1, 1.0, 0, "1.0E+28", "0.0")).replace(
            "   1.0E-06\n", card("1.0E-06", 0, 0, 0, "1.0E8\n")),
    "a node set of cards with one node": lambda bar: bar.replace(
        "*SET_NODE_LIST\n         1\n         1         2         3         4",
        "*SET_NODE_COLUMN\n         1\n" + "\n".join(card(n) for n in (1, 2, 3, 4))),
    "parameters": lambda bar: bar.replace("  210000.0", card("&Young")).replace(
        "       1.0\n*END", card("-&speed") + "\n*END").replace(
            "*PART\n", "*PARAMETER\nR  young  210000.0  R  speed      -1.0\n*PART\n"),
    "expressions": lambda bar: bar.replace("  210000.0", card("&young")).replace(
        "       1.0\n*END", card("&speed") + "\n*END").replace(
            "*PART\n", "*PARAMETER\nI  n              3\n*PARAMETER_EXPRESSION\nR gpa     1.0d3 + (\n          0 * &n)\n"
            "R young,  max(70*gpa, 1) * n\nI half    7 / 2\nR speed   -half + sqrt(16.) - (2 * -1) ** 2 + nint(3.5)\n*PART\n"),
    "a comment in Latin-1": lambda bar: bar.replace("*NODE\n", "$ Stäbe\n*NODE\n").encode("latin-1"),
    "blank cards": lambda bar: bar.replace(SUPPORTED, SUPPORTED + "\n\n"),
}

SET_1 = "*SET_NODE_LIST\n         1\n         1         2         3         4\n"
PLASTIC = MATERIAL.replace("ELASTIC", "PIECEWISE_LINEAR_PLASTICITY").rstrip("\n")
CURVE = "*DEFINE_CURVE\n         5\n" + card("1.0E-5", 300, width=20) + "\n" + card(0.1, 400, width=20) + "\n"
VELOCITY = "*INITIAL_VELOCITY\n" + card(0, 1) + "\n" + card(100, 0, 0) + "\n"


def wall(head, tail=0):
    return "*RIGIDWALL_PLANAR_ID\n         3anvil\n" + head + "\n" + card(-0.01, 0, 0, 0.99, 0, 0, tail) + "\n"


# Changes of the deck, the exit code, and what is printed or written ("!": what is not).
CASES = {
    "an end of a drive": ([(DRIVEN, DRIVEN + card(0, "5.0E-7"))], 0, [
        "set End      = 5e-07", "Condition: drive", "all keywords were used"]),
    "a beginning of a drive": ([(DRIVEN, DRIVEN + card(0, 0, "5.0E-7"))], 0, [
        "set Start    = 5e-07", ".csv, t - 5e-07); free; free", "all keywords were used"]),
    "a support from a time to a time": ([("*BOUNDARY_SPC_SET", "*BOUNDARY_SPC_SET_BIRTH_DEATH"), (
        SUPPORTED, SUPPORTED + "\n" + card("2.0E-7", "5.0E-7"))], 0, [
            "set Start    = 2e-07", "set End      = 5e-07", "Condition: support", "all keywords were used"]),
    "a drive along a vector": ([
        (DRIVEN, card(2, 4, *DRIVEN.split()[2:5], 8)),
        ("*END", "*DEFINE_VECTOR\n" + card(8, 1, 0, 0, 4, 0, 4) + "\n*END")], 0, [
            "set Axes     = 0.6, 0, 0.8;",
            "); free; free", "all keywords were used"]),
    "a drive along a vector alone": ([
        (DRIVEN, card(2, -4, *DRIVEN.split()[2:5], 8)),
        ("*END", "*DEFINE_VECTOR\n" + card(8, 1, 0, 0, 4, 0, 4) + "\n*END")], 0, ["set Axes     = 0.6, 0, 0.8;", "); 0; 0"]),
    "a drive along a vector that is not there": ([(DRIVEN, card(2, 4, *DRIVEN.split()[2:5], 8))], 0, [
        "VID = 8 is no *DEFINE_VECTOR of this file", "!Condition: drive"]),
    "an end of a drive after that of the scene": ([(DRIVEN, DRIVEN + card(0, "2.0E-6"))], 0, [
        "Condition: drive", "all keywords were used"]),
    "exceptions of a velocity": ([("*END", VELOCITY + "*END")], 0, [
        "set Velocity = if(abs(x - 0) < 4e-06, 0, 100); 0; 0"]),
    "a velocity of one part": ([("*END", "*INITIAL_VELOCITY_GENERATION\n" + card(1, 2, 0, 5, 0, 0) + "\n\n*END")], 0, [
        "set Part     = bar", "set Velocity = 5; 0; 0"]),
    "a velocity of a set of parts": ([("*END", "*INITIAL_VELOCITY_GENERATION\n" + card(1, 1, 0, 5) + "\n\n*END")], 0, [
        "there is no part set 1, so that this is left out", "!flight"]),
    "a wall for some nodes": ([("*END", wall(card(2)) + "*END")], 0, [
        "set Boundary = node set 2", ": anvil", "Contact: wall 1"]),
    "a wall in a box": ([("*END", wall(card(2, 0, 8)) + "*END")], 0, ["BOXID = 8 is not understood", "!Contact:"]),
    "a wall on which nothing slides": ([("*END", wall("", 1.0) + "*END")], 0, [
        "set Friction = 10", "FRIC = 1: nothing slides"]),
    "a wall whose first card is blank": ([("*END", wall("").replace("_ID\n         3anvil", "") + "*END")], 0, [
        "set Point  = -0.01, 0, 0", "all keywords were used"]),
    "a wall that welds": ([("*END", wall("", 2.0) + "*END")], 0, ["FRIC = 2 is not understood", "!Contact:"]),
    "local axes": ([(SUPPORTED, card(1, 3, 1, 0, 0))], 0, ["CID = 3 is no *DEFINE_COORDINATE_SYSTEM", "!Condition: support"]),
    "local axes of a clamp": ([(SUPPORTED, card(1, 3, 1, 1, 1))], 0, ["set Type     = clamp"]),
    "local axes along the global ones": ([
        (SUPPORTED, card(1, 3, 1, 0, 0)),
        ("*END", "*DEFINE_COORDINATE_SYSTEM\n" + card(3, 0, 0, 0, 0, 2, 0) + "\n" + card(0, 0, 1) + "\n*END")], 0, [
            "set Function = free; 0; free", "all keywords were used"]),
    "oblique local axes": ([
        (SUPPORTED, card(1, 3, 1, 0, 0)),
        ("*END", "*DEFINE_COORDINATE_SYSTEM\n" + card(3, 0, 0, 0, 1, 1, 0) + "\n" + card(-1, 1, 0) + "\n*END")], 0, [
            "set Axes     = 0.7071067812, 0.7071067812, 0; -0.7071067812, 0.7071067812, 0", "set Function = 0; free; free",
            "Condition: support", "all keywords were used"]),
    "supports of nodes beside one of no cell and one in axes that are not there": ([
        (NODES, NODES + card(99, width=8) + card(9, 0, 0, width=16) + "\n"),
        (SUPPORT, "*BOUNDARY_SPC_NODE\n" + "\n".join(card(*row) for row in (
            (99, 0, 1, 1), (17, 3, 1), *((n, 0, 1, 1, 1) for n in (1, 2, 3, 4)))) + "\n")], 0, [
                "set Boundary = node set 1", "Condition: support 1", "!Condition: support 2", "*BOUNDARY_SPC_NODE (2 times",
                "none of its nodes is one of a cell, so that this is left out (line 47)",
                "CID = 3 is no *DEFINE_COORDINATE_SYSTEM or _VECTOR of this file, so that this is left out (line 48)"]),
    "a pressure on faces of the boundary and on one inside": ([
        ("*END", "*LOAD_SEGMENT\n" + card(1, 2, 0, 5, 6, 7, 8) + "\n" + card(1, 2, 0, 17, 18, 19, 20) + "\n*END")], 0, [
            "set Boundary = segments of line 56", "it is no face of the boundary, so that this is left out (line 55)"]),
    "several supports with titles": ([(SUPPORTED, SUPPORTED + "\n         2right, 5\n" + card(2, 0, 0, 1, 0)),
                                      ("*BOUNDARY_SPC_SET\n", "*BOUNDARY_SPC_SET_ID\n         1left\n")], 0, [
                                          "line 47: left", "line 49: right, 5", "free; 0; free"]),
    "rotations": ([(SUPPORTED, card(1, 0, 1, 1, 1, 1, 1, 1))], 0, [
        "nodes of solids do not turn", "set Type     = clamp"]),
    "constraints on nodes": ([
        (NODES.split("\n")[n], NODES.split("\n")[n] + card(7, 0, width=8)) for n in (1, 2, 3, 4)], 0, [
            "set Boundary = held along x", "set Type     = clamp"]),
    "constraints of two directions": ([
        (NODES.split("\n")[n], NODES.split("\n")[n] + card(4 if n < 5 else 3, 0, width=8)) for n in range(1, 9)], 0, [
            "set Boundary = held along x", "set Function = 0; 0; free", "!set Boundary = held along z",
            "set Where    = abs(x - 1) < 4e-06", "set Function = free; free; 0"]),
    "a hardening curve": ([(MATERIAL, PLASTIC + card(1.0) + "\n" + card(0, 0, 5) + "\n" + CURVE)], 0, [
        "set Plastic strains = 0, 1e-05, 0.1, 10\n", "set Flow stresses   = 300, 300, 400, 10300.9901", "begins at the strain 1e-05",
        "SIGY = 1.0 is not used"]),
    "a hardening curve that falls": ([(MATERIAL, PLASTIC + card(1.0) + "\n" + card(0, 0, 5) + "\n" + CURVE.replace("400", "200"))], 0, [
        "set Plastic strains = 0, 1e-05, 0.1\n", "falls at its end: it is constant beyond"]),
    "a hardening curve that is not there": ([(MATERIAL, PLASTIC + "\n" + card(0, 0, 5) + "\n")], 1, [
        "line 11: LCSS = 5 of material 1 is no *DEFINE_CURVE of this file, and there is no SIGY"]),
    "no yield stress": ([(MATERIAL, PLASTIC + "\n")], 1, ["the yield stress (SIGY) of material 1 is 0"]),
    "a set of sets": ([(SET_1, "*SET_NODE_ADD\n         1\n        11        12\n" + SET_1.replace(
        "         1\n         1         2         3         4", "        11\n         1         2") + SET_1.replace(
            "         1\n         1         2         3         4", "        12\n         3         4"))], 0, [
                "set Boundary = node set 1", "all keywords were used"]),
    "a set that the mesh does not have": ([(SET_1, SET_1.replace("LIST", "GENERAL"))], 0, [
        "the node set 1 is a *SET_NODE_GENERAL (line 39), which is not read", "*SET_NODE_GENERAL (1 time, line 39)",
        "!Condition: support", "Condition: drive"]),
    "a part whose number is that of a node": ([
        ("*SECTION", "*PART\nskin\n" + card(5, 9, 1) + "\n*SECTION"),
        ("*SET_NODE_LIST\n         2\n", "*ELEMENT_SHELL\n" + card(1, 5, 17, 18, 19, 20, width=8) +
         "\n*SET_NODE_LIST\n         2\n")], 0, [
             'the part 5 "skin" has no solid elements', "set Parts            = bar\n",
             "*ELEMENT_SHELL (cards: 1): shells are no cells"]),
    "a part without a number": ([("*PART\nbar\n" + card(1, 1, 1), "*PART_INERTIA\nbar\n\n" + card(2, 0.5, 0.5))], 1, [
        'line 8: "" stands where the number of a part should']),
    "no solids": ([("*ELEMENT_SOLID", "*ELEMENT_BEAM")], 1, ["there are no hexahedra (*ELEMENT_SOLID)"]),
    "a name in Latin-1": ([("*SET_NODE_LIST\n         1\n", "*SET_NODE_LIST_TITLE\nHülse, #1\n         1\n")], 0, [
        "set Boundary = Hülse 1\n"]),
    "an unknown parameter": ([("  210000.0", card("&young"))], 1, [
        'line 12: there is no parameter "young" of type R, I or C in *PARAMETER']),
    "an expression that divides by zero": ([("*PART\n", "*PARAMETER_EXPRESSION\nR x       1 / (3 / 4)\n*PART\n")], 1, [
        '*PARAMETER_EXPRESSION: "1 / (3 / 4)" has no finite value.']),
    "an expression of a later parameter": ([("*PART\n", "*PARAMETER_EXPRESSION\nR x       2 * &y\nR y       1\n*PART\n")], 1, [
        'there is no parameter "y" before it']),
    "an expression that is a program": ([("*PART\n", "*PARAMETER_EXPRESSION\nR x       open('x').read()\n*PART\n")], 1, [
        "is no expression of numbers, parameters"]),
    "a number beyond its columns": ([("   1.0E-06\n*PART", "     1.0E-6\n*PART")], 1, [
        'line 5: "1.0E-" stands where a number should. What goes on behind it is beyond']),
    "fields of a used card": ([("*PART\nbar\n" + card(1, 1, 1), "*PART\nbar\n" + card(1, 1, 1, 0, 4)),
                               (MATERIAL, MATERIAL.rstrip("\n") + card(0, 0, 3) + "\n")], 0, [
                                   "line 8: *PART: HGID = 4 is not used.",
                                   "line 12: *MAT_ELASTIC: K = 3 is not used."]),
    "attributes of a set": ([(SET_1, SET_1.replace("  1\n   ", "  1       0.5\n   "))], 0, ["DA1 = 0.5 is not used"]),
    "keywords and their number": ([
        ("*END", "*HOURGLASS\n" + card(1, 4) + "\n*HOURGLASS\n" + card(2, 4) + "\n*END")], 0, [
        "2 keywords were not used", "*HOURGLASS (2 times, first on line 54)", "#   line 56: *HOURGLASS"]),
    "nothing of many cards": ([("*END", "*ELEMENT_MASS\n" + "\n".join(card(n, n, 1.0) for n in range(1, 99)) +
                                "\n*END")], 0, ["*ELEMENT_MASS (1 time", "#     98 cards", "!        77"]),
    "tabs that miss the columns": ([("  7.85E-09  210000.0       0.3", "\t7.85E-09\t210000.0\t0.3")], 1, [
        "line 12: The card has tabs, by which a field does not begin in its columns"]),
    "a curve that is not used": ([("*END", CURVE + "*END")], 0, ["*DEFINE_CURVE 5 is used by nothing"]),
}


class Forms(DeckTest):
    def convert(self, text, name="bar.k"):
        """Exit code, what was printed, and the parameter file."""
        try:
            result = self.converted(text, name)
        except DeckError as error:
            return 1, str(error), ""
        for path, content in result.files().items():
            path.write_text(content, encoding="utf-8")
        return 0, "\n".join(result.report.summary()), result.text()

    @staticmethod
    def scene_of(text):
        """The parameter file without comments."""
        return "\n".join(line for line in text.split("\n") if not line.startswith("#")).strip()

    def test_all_forms_are_one_scene(self):
        _, _, expected = self.convert(BAR)
        for name, form in FORMS.items():
            with self.subTest(name):
                text = form(BAR)
                self.assertNotEqual(text, BAR)
                code, printed, written = self.convert(text)
                self.assertEqual(code, 0, printed)
                self.assertEqual(self.scene_of(written), self.scene_of(expected))
                self.assertIn("all keywords were used", printed)
                said = self.dry_run("bar.prm")
                self.assertIn("mass 3.14e-08, extent [0, 4] x [0, 1] x [0, 1]", said)

    def test_nothing_is_lost_without_a_word(self):
        for name, (changes, expected_code, parts) in CASES.items():
            with self.subTest(name):
                text = BAR
                for old, new in changes:
                    self.assertEqual(text.count(old), 1, old)
                    text = text.replace(old, new)
                code, printed, written = self.convert(text.encode("latin-1"))
                self.assertEqual(code, expected_code, printed)
                for part in parts:
                    if part.startswith("!"):
                        self.assertNotIn(part[1:], self.scene_of(written))
                    else:
                        self.assertIn(part, printed + written)
                # Names of boundaries are those that the reader gives.
                if any("set Boundary" in part for part in parts):
                    self.dry_run("bar.prm")

    def test_files_are_included_relative_to_the_file_that_names_them(self):
        main = BAR.replace(NODES + ELEMENTS, "*INCLUDE\nmesh\\all.k\n")
        self.write("mesh/all.k", "*KEYWORD\n*INCLUDE\nnodes.k\n*END\nnot read\n")
        self.write("mesh/nodes.k", b"\xef\xbb\xbf" + (ELEMENTS + NODES).replace("\n", "\r\n").encode())
        code, printed, _ = self.convert(main)
        self.assertEqual(code, 0, printed)
        code, printed, _ = self.convert(main.replace("*INCLUDE\nmesh\\all.k", "*INCLUDE_PATH_RELATIVE\nmesh\n*INCLUDE\nall.k"))
        self.assertEqual((code, printed), (0, "all keywords were used"))
        self.write("mesh/all.k", "*INCLUDE\nnodes.k\n")
        self.assertIn("extent [0, 4] x [0, 1] x [0, 1]", self.dry_run("bar.prm"))
        for text, message in (("*INCLUDE\nnone.k\n", 'line 2 of "mesh\\all.k": "none.k", relative to the file that names it: There is no such file'),
                              ("*INCLUDE\n../bar.k\n", '"../bar.k" includes itself'),
                              ("*INCLUDE_STAMPED_PART\nnodes.k\n", "*INCLUDE_STAMPED_PART is not allowed"),
                              (ELEMENTS + NODES + MATERIAL.replace("   0.3", "   0.x"), 'line 28 of "mesh\\all.k"')):
            self.write("mesh/all.k", text)
            code, printed, _ = self.convert(main)
            self.assertEqual(code, 1, printed)
            self.assertIn(message, printed)

    def test_the_end_of_a_name_that_utf_16_hides_is_refused(self):
        code, printed, _ = self.convert(BAR.encode("utf-16"))
        self.assertEqual(code, 1)
        self.assertIn("UTF-16", printed)


main()

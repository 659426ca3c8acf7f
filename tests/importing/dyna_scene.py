#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Parameter files that scripts/import makes of LS-DYNA keyword files.

    dyna_scene.py PROJECT_DIRECTORY PROGRAM
"""

import csv
import subprocess

from deck_testing import DECKS, PROGRAM, PROJECT, DeckTest, card, main

DECK = DECKS / "rod.k"


class DynaScene(DeckTest):
    def setUp(self):
        super().setUp()
        self.deck = DECK.read_text(encoding="utf-8")

    def convert(self, *changes, target=()):
        """Writes the deck, changed, and converts it: exit code and what was printed."""
        text = self.deck
        for old, new in changes:
            self.assertEqual(text.count(old), 1, old)
            text = text.replace(old, new)
        self.write("rod.k", text)
        result = subprocess.run([PROJECT / "scripts" / "import", "--program", PROGRAM, "rod.k", *target], cwd=self.directory,
                                capture_output=True, text=True, check=False)
        return result.returncode, result.stdout + result.stderr

    def scene_of(self, *changes):
        code, printed = self.convert(*changes)
        self.assertEqual(code, 0, printed)
        return " ".join((self.directory / "rod.prm").read_text(encoding="utf-8").split())

    def test_the_scene_runs(self):
        scene = self.scene_of()
        for part in ("set Cells = group part 11", "set Formulation = momentum consistent particle",
                     "set Dilation = 1.6", "set Rebuild interval = 30", "set Limit = 0.5", "set Self-contact = true",
                     "set Flow stresses = 300, 400", "set Function = 2*table(rod_curve_6.csv, t); free; free",
                     "set Velocity = 0; 0; -1", "set Normal = 0, 0, 1", "mass: t, length: mm, time: s"):
            self.assertIn(part, scene)
        code, printed = self.run_program("rod.prm")
        self.assertEqual(code, 0, printed)
        with open(self.directory / "output" / "rod" / "conditions.csv", encoding="utf-8") as file:
            last = list(csv.reader(file))[-1]
        self.assertGreater(len(last), 6)

    def test_what_is_not_used_stands_in_comments_with_its_line(self):
        scene = self.scene_of(("*CONTACT_AUTOMATIC_SINGLE_SURFACE", "*CONTACT_DRAWBEAD"))
        self.assertIn("# line 63: *CONTACT_DRAWBEAD: ", scene)
        self.assertIn("# 0.2 0.2", scene)
        self.assertNotIn("Self-contact = true", scene)
        scene = self.scene_of()
        self.assertIn("fragments of rod of particles touch each other by Self-contact", scene)
        self.assertIn("set Self-contact friction = 0.2", scene)

    def test_parts_of_particles_meet_by_self_contact(self):
        corners = [(x, y, z) for z in (0, 1) for x, y in ((3, 0), (4, 0), (4, 1), (3, 1))]
        nodes = "".join(f"{n:8d}" + "".join(f"{float(x):16.1f}" for x in at) + "\n" for n, at in enumerate(corners, 13))
        scene = self.scene_of(
            ("*ELEMENT_SOLID\n", nodes + "*ELEMENT_SOLID\n" + "".join(f"{n:8d}" for n in (3, 33, *range(13, 21))) + "\n"),
            ("*SECTION_SOLID\n", "*PART\nother\n" + card(33, 2, 2) + "\n*SECTION_SOLID\n"))
        self.assertIn("fragments of rod of particles, other touch each other by Self-contact", scene)
        self.assertNotIn("rod of particles set Master parts = other", scene)
        self.assertIn("set Slave parts = rod steel side set Master parts = other", scene)
        self.assertEqual(scene.count("set Self-contact friction = 0.2"), 2)

    def test_johnson_cook_and_plastic_kinematic(self):
        old = self.deck[self.deck.index("*MAT_ELASTIC_TITLE"):self.deck.index("*MAT_PIECEWISE")]
        cook = "\n".join(["*MAT_JOHNSON_COOK", card(1, "8.96e-9", 46000, 124000, 0.34),
                          card(65, 356, 0.37, 0.013, 1.09, 1356, 298, 1), card(383e6), card(0)]) + "\n"
        scene = self.scene_of((old, cook))
        for part in ("set Hardening exponent = 0.37", "set Melting temperature = 1356",
                     "set Reference rate = 1", "set Specific heat capacity = 383000000"):
            self.assertIn(part, scene)
        self.assertIn("pressure is linear elastic", scene)
        self.assertEqual(self.run_program("--dry-run", "rod.prm")[0], 0)
        kinematic = "\n".join(["*MAT_003", card(1, "7.85e-9", 210000, 0.3, 300, 21000, 0),
                               card(40, 5, 0.4)]) + "\n"
        scene = self.scene_of((old, kinematic))
        self.assertIn("set Hardening modulus = 0", scene)
        self.assertIn("set Back stress moduli = 23333.33333", scene)
        self.assertIn("set Erosion strain = 0.4", scene)
        self.assertIn("set Cowper-Symonds rate = 40", scene)
        self.assertEqual(self.run_program("--dry-run", "rod.prm")[0], 0)

    def test_damage_and_equation_of_state(self):
        old = self.deck[self.deck.index("*MAT_ELASTIC_TITLE"):self.deck.index("*MAT_PIECEWISE")]
        cook = "\n".join(["*MAT_JOHNSON_COOK", card(1, "8.96e-9", 46000, 124000, 0.34),
                          card(65, 356, 0.37, 0.013, 1.09, 1356, 298, 1),
                          card("383e6", 0, 0, 0, 0.54, 4.89, 3.03, 0.014), card(1.12),
                          "*EOS_GRUNEISEN", card(5, "3.94e6", 1.489, 0, 0, 2.02, 0.47, 0), card(1)]) + "\n"
        part = card(11, 1, 1)
        self.assertEqual(self.deck.count(part), 1)
        scene = self.scene_of((old, cook), (part, card(11, 1, 1, 5)))
        for line in ("set D1 = 0.54", "set D3 = -3.03", "set D5 = 1.12", "set Erosion damage = 1",
                     "# D3 is above zero", "set Equation of state = mie gruneisen",
                     "set Sound speed = 3940000", "set Gruneisen correction = 0.47",
                     "set Quadratic bulk viscosity = 1.5"):
            self.assertIn(line, scene)
        self.assertNotIn("pressure is linear elastic", scene)
        self.assertNotIn("*EOS_GRUNEISEN\n#     ", scene)
        code, printed = self.run_program("--dry-run", "rod.prm")
        self.assertEqual(code, 0, printed)

    def test_all_files_are_written_or_none(self):
        (self.directory / "rod.msh").mkdir()
        code, printed = self.convert()
        self.assertEqual((code, printed.strip()), (1, "import: rod.msh: Is a directory"))
        self.assertEqual(sorted(path.name for path in self.directory.iterdir()), ["rod.k", "rod.msh"])
        code, printed = self.convert(target=("none/rod.prm",))
        self.assertEqual((code, printed.strip()), (1, "import: none/rod.prm: No such file or directory"))
        code, printed = self.convert(target=("rod.k",))
        self.assertEqual(code, 1, printed)
        self.assertEqual((self.directory / "rod.k").read_text(), self.deck)

    def test_materials_in_several_units_are_refused(self):
        code, printed = self.convert((card(1, "7.85e-9", "210000.0", 0.3), card(1, 7850, "210.0e9", 0.3)))
        self.assertEqual(code, 1)
        for part in ("rod.k: line 32: the density of material 1 is 7850", "material 2 (line 35) is 7.85e-09",
                     "not in the same units", "Allowed is a factor of up to 1000"):
            self.assertIn(part, printed)
        self.assertFalse((self.directory / "rod.prm").exists())

    def test_bad_decks_are_refused_with_their_line(self):
        for change, message in (
                ((card(1, "7.85e-9", "210000.0", 0.3), card(1, "7.85e-9", "x", 0.3)), 'line 34: "x" stands'),
                ((card(1, "7.85e-9", "210000.0", 0.3), card(1, 0, "210000.0", 0.3)), "the density of material 1"),
                ((card(1, 0, 1, 1, 1), card(7, 0, 1, 1, 1)), "there is no node set 7"),
                (("*NODE\n", "*NODES\n"), "There is no section *NODE")):
            code, printed = self.convert(change)
            self.assertEqual(code, 1, printed)
            self.assertIn(message, printed)


main()

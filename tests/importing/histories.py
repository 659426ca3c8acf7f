#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Nodes and elements that decks watch.

    histories.py PROJECT_DIRECTORY PROGRAM
"""

from deck_testing import DeckTest, card, main, replaced, text_of

BAR, PRESS, IMPACT, TIED = (text_of(name) for name in ("bar.k", "press.k", "impact.inp", "tied.inp"))
SOLIDS = "*SET_SOLID_TITLE\nmiddle\n" + card(6) + "\n" + card(2, 3) + "\n"


class DynaHistories(DeckTest):
    def watched(self, cards, *parts, deck=BAR):
        self.check_scene(replaced(deck, ("*END", cards + "*END")), "deck.k", *parts)

    def test_nodes_and_solids(self):
        self.watched(SOLIDS + "*DATABASE_HISTORY_NODE\n" + card(17, 20) + "\n*DATABASE_HISTORY_NODE_SET\n" + card(1, 2) +
                     "\n*DATABASE_HISTORY_SOLID\n" + card(1, 4, 1) + "\n*DATABASE_HISTORY_SOLID_SET\n" + card(6) +
                     "\n*DATABASE_NODOUT\n" + card("1.0E-7") + "\n*DATABASE_ELOUT\n" + card("2.0E-7") + "\n",
                     "set Mesh nodes = 17, 20, 1, 2, 3, 4, 18, 19 set Interval = 1e-07",
                     "set Locations = solid 1: 0.5, 0.5, 0.5; solid 4: 3.5, 0.5, 0.5; solid 2: 1.5, 0.5, 0.5; "
                     "solid 3: 2.5, 0.5, 0.5 set Time between rows = 2e-07", "all keywords were used")
        code, printed = self.run_program("deck.prm")
        self.assertEqual(code, 0, printed)
        rows = self.rows("points.csv")
        self.assertGreater(len(rows["time"]), 5)
        self.assertGreater(rows["solid 4 stress xx"][-1], 100)
        # The drive goes 1 mm in the time of the scene.
        self.assertAlmostEqual(self.rows("probes.csv")["mesh node 17 displacement x"][-1], 1, 9)

    def test_names_of_nodes_and_solids(self):
        self.watched("*DATABASE_HISTORY_NODE_ID\n" + card(17) + "tip, upper\n" + card(18) + "\n"
                     "*DATABASE_HISTORY_SOLID_ID\n" + card(1) + "root: left\n" + card(2) + "root: left\n",
                     "set Mesh nodes = 17, 18", 'the node 17, "tip upper", is "mesh node 17".',
                     "set Locations = root left: 0.5, 0.5, 0.5; root left (2): 1.5, 0.5, 0.5")

    def test_what_has_no_history_is_named(self):
        free = card(90, width=8) + card(0.0, 5.0, 0.0, width=16) + "\n"
        self.watched("*NODE\n" + free + "*DATABASE_HISTORY_NODE\n" + card(90, 17) + "\n", "set Mesh nodes = 17",
                     "line 57: nodes that are no corners of cells have no history here: 90.")
        self.watched("*DATABASE_NODOUT\n" + card("1.0E-7") + "\n", "*DATABASE_NODOUT is used by nothing", "!subsection Output")
        self.watched("*DATABASE_HISTORY_SOLID\n" + card(1, 101) + "\n", "set Locations = solid 1: 0.5, 0.5, 0.5 end",
                     "the element 101 is one of a rigid part: it has no history", deck=PRESS)
        for cards, message in (("*DATABASE_HISTORY_SOLID\n" + card(9), "There is no element of number 9"),
                               ("*DATABASE_HISTORY_SOLID_SET\n" + card(9), "there is no solid set 9"),
                               ("*DATABASE_HISTORY_NODE_SET\n" + card(9), "there is no node set 9"),
                               ("*DATABASE_HISTORY_NODE\n" + card(99), "There is no node of number 99")):
            with self.subTest(message), self.assertRaises(Exception) as context:
                self.converted(replaced(BAR, ("*END", cards + "\n*END")), "deck.k")
            self.assertIn(message, str(context.exception))

    def test_too_many(self):
        text = BAR[:BAR.index("*NODE")] + "*NODE\n"
        n = 60
        for k in range(n + 1):
            for c, (y, z) in enumerate(((0, 0), (1, 0), (1, 1), (0, 1))):
                text += card(4 * k + c + 1, width=8) + card(float(k), float(y), float(z), width=16) + "\n"
        text += "*ELEMENT_SOLID\n"
        for k in range(n):
            text += card(k + 1, 1, *(4 * k + c for c in (1, 5, 6, 2, 4, 8, 7, 3)), width=8) + "\n"
        text += "*SET_SOLID_GENERATE\n" + card(7) + "\n" + card(1, n) + "\n*DATABASE_HISTORY_SOLID_SET\n" + card(7) + "\n*END\n"
        self.check_scene(text, "deck.k", f"there are {n} elements with histories, more than 50, so that this is left out",
                         "!point history")
        some = "*DATABASE_HISTORY_SOLID\n" + "".join(card(k) + "\n" for k in range(1, 51))
        self.check_scene(replaced(text, ("*DATABASE", some + "*DATABASE")), "deck.k", "solid 50: 49.5", "!solid 51",
                         "there are 60 elements with histories")


def history(*requests, options=", TIME INTERVAL=1E-7"):
    return replaced(IMPACT, ("*END STEP", f"*OUTPUT, HISTORY{options}\n" + "".join(requests) + "*END STEP"))


class AbaqusHistories(DeckTest):
    def check(self, text, *parts, runs=False):
        self.check_scene(text, "deck.inp", *parts, runs=runs)

    def test_history_output(self):
        self.check(history("*NODE OUTPUT, NSET=FOOT\n U, RF\n", "*ELEMENT OUTPUT, ELSET=BAR\n S, PEEQ, LE\n"),
                   "set Mesh nodes = 1, 2, 3, 4 set Interval = 1E-7",
                   "set Locations = element 1: 0.5, 0.5, 0.5; element 2: 0.5, 0.5, 1.5 set Time between rows = 1E-7",
                   "*NODE OUTPUT: RF (field 2) is not used", "*ELEMENT OUTPUT: LE (field 3) is not used",
                   "set Number = 20", "*NODE OUTPUT (1 time, line 54)", runs=True)
        rows = self.rows("points.csv")
        self.assertGreater(abs(rows["element 1 stress zz"][-1]), 10)
        self.check(history("*NODE OUTPUT, NSET=FOOT, VARIABLE=PRESELECT\n", options=", FREQUENCY=7"),
                   "set Mesh nodes = 1, 2, 3, 4 set Steps = 7", "!FREQUENCY")
        self.check(history("*ELEMENT OUTPUT, ELSET=BAR\n MISES\n", options=", NUMBER INTERVAL=4"),
                   "set Time between rows = 5e-07")

    def test_prints_of_calculix(self):
        text = replaced(IMPACT, ("*OUTPUT, FIELD, NUMBER INTERVAL=20\n*NODE OUTPUT\n U, V\n", (
            "*NODE PRINT, NSET=FOOT, FREQUENCY=5\n U, RF\n*EL PRINT, ELSET=BAR, TOTALS=YES\n S, E\n")))
        self.check(text, "set Mesh nodes = 1, 2, 3, 4 set Steps = 5",
                   "set Locations = element 1: 0.5, 0.5, 0.5; element 2: 0.5, 0.5, 1.5 end",
                   "*EL PRINT: E (field 2) is not used", "*EL PRINT: TOTALS=YES is not used",
                   "*NODE PRINT: RF (field 2) is not used")

    def test_what_has_no_history_is_named(self):
        for request, reason in (("*NODE OUTPUT\n U\n", "without NSET it is of the whole model"),
                                ("*ELEMENT OUTPUT\n S\n", "without ELSET it is of the whole model"),
                                ("*NODE OUTPUT, NSET=FOOT\n RF\n", "none of its variables is in a history here"),
                                ("*ELEMENT OUTPUT, ELSET=BAR, POSITION=NODES\n S\n", "POSITION=NODES is not understood")):
            self.check(history(request, options=", FREQUENCY=7"), reason + ", so that this is left out",
                       "*OUTPUT: FREQUENCY=7 is not used", "!Mesh nodes", "!Locations")

    def test_steps_go_on_with_the_histories_of_those_before(self):
        text = replaced(TIED, ("*END STEP", "*OUTPUT, HISTORY\n*NODE OUTPUT, NSET=B2.HEAD\n U3, NT\n"
                               "*ELEMENT OUTPUT, ELSET=B2.ALL\n S33\n*END STEP"))
        # The instances have nodes and elements of the same numbers.
        probes = ("subsection Output subsection probes set Mesh nodes = 13, 14, 15, 16 end subsection point history "
                  "set Locations = element B2.1: 0.5, 0.5, 1.5 end end")
        scene, said = self.scene(text, "deck.inp")
        self.assertEqual(scene.count(probes), 2, scene)
        self.assertIn('5 is "mesh node 13", 6 is "mesh node 14"', said)
        self.assertEqual(self.run_program("--validate", "deck.prm")[0], 0)
        scene, _ = self.scene(replaced(text, (
            "*DSLOAD", "*OUTPUT, HISTORY, FREQUENCY=3\n*NODE OUTPUT, NSET=B1.HEAD\n U\n*DSLOAD")), "deck.inp")
        self.assertEqual(scene.count(probes), 1, scene)
        self.assertIn("set Mesh nodes = 5, 6, 7, 8 set Steps = 3", scene)


main()

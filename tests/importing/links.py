#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Springs and dashpots of decks.

    links.py PROJECT_DIRECTORY PROGRAM
"""

from deck_testing import DeckTest, card, main, replaced, text_of

BAR, MOUNTED, IMPACT, CYCLIC = (text_of(name) for name in ("bar.k", "mounted.k", "impact.inp", "cyclic.inp"))
SUPPORTS = BAR[BAR.index("*BOUNDARY_SPC"):BAR.index("*DEFINE_CURVE")]
FIXED = "*BOUNDARY_SPC_NODE\n" + card(90, 0, 1, 1, 1) + "\n"


def node(number, *place):
    return f"{number:8d}" + "".join(f"{x:16.6f}" for x in place) + "\n"


def dyna(elements, nodes=node(90, 6, 0, 0), section=card(3), spring=card(7, 100.0), further=FIXED):
    """The bar, held at its left end, with discrete elements of the parts 5 (spring) and 6 (damper)."""
    parts = ("*PART\nspring\n" + card(5, 3, 7) + "\ndamper\n" + card(6, 3, 8) + "\n*SECTION_DISCRETE\n" + section + "\n" +
             "*MAT_SPRING_ELASTIC\n" + spring + "\n*MAT_DAMPER_VISCOUS\n" + card(8, "1.0E-4") + "\n")
    return replaced(BAR, ("*PART\n", parts + "*PART\n"), ("*ELEMENT_SOLID\n", nodes + "*ELEMENT_SOLID\n"),
                    (SUPPORTS, "*BOUNDARY_SPC_SET\n" + card(1, 0, 1, 1, 1) + "\n" + further + "*ELEMENT_DISCRETE\n" + elements),
                    (BAR[BAR.index("*BOUNDARY_PRESCRIBED"):], "*END\n"))


def element(number, part, first, second, vid=0, *further):
    return card(number, part, first, second, vid, width=8) + "".join(
        f"{x:>{width}}" for x, width in zip(further, (16, 8, 16))) + "\n"


class DynaLinks(DeckTest):
    def check(self, text, *parts):
        self.check_scene(text, "deck.k", *parts)

    def test_a_spring_to_a_place_and_a_damper_between_nodes(self):
        self.check(dyna(element(1, 5, 17, 90, 0, 2.0) + element(2, 6, 90, 20) + element(3, 5, 1, 18, 0, 0, 0, 0.5),
                        further=FIXED + "*DATABASE_DEFORC\n" + card("1.0E-7") + "\n"),
                   "set Processes = spring 1, damper 2, spring 3", "all keywords were used",
                   "subsection Process: spring 1 set Type = link subsection link set Point = 4, 0, 0 set End = 6; 0; 0 "
                   "set Stiffness = 200 end",
                   "subsection Process: damper 2 set Type = link subsection link set Point = 4, 0, 1 set End = 6; 0; 0 "
                   "set Damping = 0.0001 end",
                   "set Point = 0, 0, 0 set Other point = 4, 1, 0 set Stiffness = 100 set Length = 3.623105626",
                   "set Further outputs = link history", "subsection link history set Time between rows = 1e-07",
                   "!has no cells", "!no solid elements")

    def test_an_end_that_moves(self):
        curve, motion = "*DEFINE_CURVE\n" + card(9) + "\n" + card(0, 0, width=20) + "\n" + card("1.0E-6", 1, width=20) + "\n", \
            "*BOUNDARY_PRESCRIBED_MOTION_NODE\n"
        # Nodes are held by TC as well.
        nodes = node(90, 6, 0, 0)[:-1] + f"{4:8d}\n" + node(91, 6, 1, 0)[:-1] + f"{7:8d}\n"
        text = dyna(element(1, 5, 17, 90) + element(2, 5, 18, 91), nodes, further=(
            "*BOUNDARY_SPC_NODE\n" + card(90, 0, 0, 0, 1) + "\n" + curve + motion + card(90, 1, 2, 9, 0.5) + "\n"))
        self.check(text, "set End = 6 + (0.5*table(deck_curve_9.csv, t)); 0; 0", "set End = 6; 1; 0", "!Boundary = held",
                   "all keywords were used")
        code, printed = self.run_program("deck.prm")
        self.assertEqual(code, 0, printed)
        rows = self.rows("links.csv")
        length, force = rows["spring 1 length"][-1], rows["spring 1 force x"][-1]
        self.assertGreater(length, 2.4)
        self.assertAlmostEqual(force, 100 * (length - 2), 3)
        moving = replaced(text, (motion + card(90, 1, 2), motion + card(90, 1, 0)))
        self.check(moving, "set End = 6 + (0.5*table(deck_curve_9_integrated.csv, t)); 0; 0")

    def test_a_block_on_springs(self):
        self.check(MOUNTED, "all keywords were used", 'the node 7, "upper corner", is "mesh node 7"', "set Model = chaboche",
                   "set Where = abs(y - 0) < 4e-06 && abs(z - 0) < 4e-06 set Type = displacement set Function = free; 0; 0",
                   "set Function = if(t < 1.5e-05, if(t < 5e-06, 0, 100*table(deck_curve_9.csv, t - 5e-06)), 0)",
                   "!has no cells: it is left out", '!"held along x" (2 nodes)')
        code, printed = self.run_program("deck.prm")
        self.assertEqual(code, 0, printed)
        # The spring 202 is drawn by 0.1 at the start; the edge turns by 0.01.
        rows = self.rows("links.csv")
        self.assertAlmostEqual(rows["spring 202 force z"][0], -100, 6)
        self.assertAlmostEqual(rows["spring 201 length"][-1], 2 - 0.01 * 0.5, 4)
        self.assertGreater(len(rows["time"]), 9)
        self.assertGreater(len(self.rows("points.csv")["time"]), 18)

    def test_what_is_no_link_is_named(self):
        to_end = element(1, 5, 17, 90)
        for text, reason in (
                (dyna(to_end, further=""), "*ELEMENT_DISCRETE 1: its node 90 is in no cell, and is not held"),
                (dyna(to_end, further=FIXED.replace(card(1, 1, 1), card(1, 1, 0))),
                 "its node 90 is in no cell, and is not held"),
                (dyna(element(1, 5, 17, 90, 3)), "VID = 3 is not understood"),
                (dyna(element(1, 5, 17, 0)), "N2 = 0, a spring to the ground, has no direction here"),
                (dyna(element(1, 4, 17, 90)), "there is no *PART 4"),
                (dyna(to_end, section=card(3, 1)), "DRO = 1 of *SECTION_DISCRETE 3 is not understood"),
                (dyna(to_end, section=card(3) + "\n" + card(0, 2.0)), "TDL = 2.0 of *SECTION_DISCRETE 3 is not understood"),
                (dyna(to_end, spring=card(9, 1)), "its material 7 is not there"),
                (dyna(to_end, spring=card(7, 0)), "its stiffness and its damping are not larger than zero"),
                (dyna(to_end, node(90, 4, 0, 0)), "its ends are at one place, so that it has no direction"),
                (dyna(element(1, 5, 17, 90, 0, 0, 0, 3.0)), "its length without force is not larger than zero")):
            with self.subTest(reason):
                scene, said = self.scene(text)
                self.assertIn(reason, said)
                self.assertIn("so that this is left out", said)
                self.assertNotIn("Process", scene)
        self.check(dyna(to_end, spring=card(7, 100.0) + "\n*MAT_SPRING_ELASTIC\n" + card(9, 1.0)), "is used by nothing",
                   "set Processes = spring 1")


SPRINGS = ("*NODE\n 90, 0., 0., 4.\n 91, 1., 0., 4.\n*ELEMENT, TYPE=SPRINGA, ELSET=S\n 11, 9, 90\n"
           "*ELEMENT, TYPE=SPRING2, ELSET=S2\n 12, 10, 91\n*ELEMENT, TYPE=DASHPOTA, ELSET=D\n 13, 5, 11\n"
           "*SPRING, ELSET=S\n\n 100.\n*SPRING, ELSET=S2\n 3, 3\n 50.\n*DASHPOT, ELSET=D\n\n 1E-4\n*NSET, NSET=ENDS\n 90, 91\n")


def abaqus(springs=SPRINGS, held=" ENDS, PINNED\n", step=""):
    return replaced(IMPACT, ("*NSET, NSET=FOOT\n", springs + "*NSET, NSET=FOOT\n"), (" FOOT, 3, 3\n", " FOOT, 3, 3\n" + held),
                    ("*NODE OUTPUT\n U, V\n*END STEP", step + "*END STEP"))


class AbaqusLinks(DeckTest):
    def check(self, text, *parts):
        self.check_scene(text, "deck.inp", *parts)

    def test_springs_and_a_dashpot(self):
        self.check(abaqus(step="*OUTPUT, HISTORY, TIME INTERVAL=1E-7\n*ELEMENT OUTPUT, ELSET=S\n S11\n"),
                   "set Processes = spring 11, spring 12, damper 13", "all keywords were used",
                   "set Point = 0, 0, 2 set End = 0; 0; 4 set Stiffness = 100 end",
                   "set Point = 1, 0, 2 set End = 1; 0; 4 set Stiffness = 50 end",
                   "set Point = 0, 0, 1 set Other point = 1, 1, 2 set Damping = 0.0001 end",
                   "elements SPRING2 keep their direction", "subsection link history set Time between rows = 1E-7",
                   "set Further outputs = link history")
        code, printed = self.run_program("deck.prm")
        self.assertEqual(code, 0, printed)
        rows = self.rows("links.csv")
        self.assertAlmostEqual(rows["spring 12 force z"][-1], 50 * (rows["spring 12 length"][-1] - 2), 2)

    def test_an_end_that_moves_in_steps(self):
        text = replaced(abaqus(), (" FOOT, 3, 3\n", " FOOT, 1, 3\n"))
        text = text[:text.index("*STEP")].replace("*PLASTIC, HARDENING=JOHNSON COOK\n 90., 292., 0.31, 1.09, 1356., 298.\n"
                                                  "*RATE DEPENDENT, TYPE=JOHNSON COOK\n 0.025, 1.0\n", "")
        for name, value in (("pull", 0.5), ("release", 0.25)):
            text += f"*STEP, NAME={name}\n*STATIC\n 0.5, 1.\n*BOUNDARY\n 90, 3, 3, {value}\n*END STEP\n"
        self.check(text, "set End = 0; 0; 4 + (0.5*t) set Stiffness = 100 set Length = 2",
                   "subsection Process: spring 11 subsection link set End = 0; 0; 4 + (0.5 + -0.25*t) end end",
                   "!subsection Process: spring 12 subsection link set End",
                   "set Initial conditions = flight 1 subsection Statics")
        code, printed = self.run_program("deck.prm")
        self.assertEqual(code, 0, printed)
        let_go = replaced(text, ("*BOUNDARY\n 90, 3, 3, 0.25\n", "*BOUNDARY, OP=NEW\n FOOT, 1, 3\n 91, PINNED\n"))
        scene, said = self.scene(let_go, "deck.inp")
        self.assertIn('TYPE=SPRINGA, 11: in the step "release" its node 90 is in no cell, and is not held', said)
        self.assertIn("set Processes = spring 12, damper 13 ", scene)
        self.assertNotIn("spring 11", scene.replace("SPRINGA, 11", ""))
        for name, pull in (("pull", 0.5), ("release", 0.25)):
            rows = self.rows("links.csv", f"deck/{name}")
            self.assertAlmostEqual(rows["spring 11 force z"][-1], 100 * pull, delta=2)

    def test_a_machine_with_a_soft_head(self):
        self.check(CYCLIC, "all keywords were used", "set Processes = spring 1, spring 2, spring 3, spring 4, damper 5",
                   "set Back stress moduli = 40000, 2000")
        code, printed = self.run_program("deck.prm")
        self.assertEqual(code, 0, printed)
        for name, sign in (("Pull", 1), ("Push", -1)):
            rows, points = (self.rows(table, f"deck/{name}") for table in ("links.csv", "points.csv"))
            pull = sum(rows[f"spring {k} force z"][-1] for k in range(1, 5))
            # A section of 1: the force is the stress, of which a point beside the foot has somewhat less.
            self.assertAlmostEqual(pull, points["element 2 stress zz"][-1], delta=30)
            self.assertGreater(sign * pull, 300)
            self.assertGreater(sign * points["element 1 back stress 1 zz"][-1], 50)
            self.assertEqual(len(rows["time"]), 11)

    def test_nodes_of_instances(self):
        text = replaced(text_of("tied.inp"), ("*TIE, NAME=T\n B2.LOWER, B1.UPPER\n", (
            "*ELEMENT, TYPE=SPRINGA, ELSET=SPRINGS\n 1, B1.1, B2.5\n*SPRING, ELSET=SPRINGS\n\n 100.\n")))
        self.check(text, "set Processes = spring 1", "set Point = 0, 0, 0 set Other point = 0, 0, 2 set Stiffness = 100")
        self.assertIn("at the node 5 lies another one, and nodes are found by their places here",
                      self.scene(replaced(text, ("B1.1, B2.5", "B1.5, B2.7")), "deck.inp")[1])

    def test_what_is_no_link_is_named(self):
        for changes, reason in (
                (("*SPRING, ELSET=S\n", "*SPRING, ELSET=S, NONLINEAR\n"),
                 "NONLINEAR is not understood, so that this is left out"),
                (("\n 100.\n", "\n 100., , 20.\n 90., , 100.\n"), "it has 2 lines of constants, and one is understood"),
                ((" 3, 3\n", " 1, 1\n"), "TYPE=SPRING2, 12: its degrees of freedom are not those along the line"),
                (("*SPRING, ELSET=S2\n 3, 3\n 50.\n", ""), "TYPE=SPRING2, 12: no *SPRING or *DASHPOT names it"),
                (("\n 100.\n", "\n 100., 7.\n"), "*SPRING: 7. (field 2) is not used")):
            with self.subTest(reason):
                self.assertIn(reason, self.scene(abaqus(replaced(SPRINGS, changes)), "deck.inp")[1])
        self.assertIn("is a number and two nodes", self.error(abaqus(replaced(
            SPRINGS, (" 11, 9, 90\n", " 11, 9, 90, 1\n"))), "deck.inp"))
        self.assertIn("its node 90 is in no cell, and is not held", self.scene(abaqus(held=""), "deck.inp")[1])
        grounded = "*ELEMENT, TYPE=SPRING1, ELSET=G\n 20, 9\n*SPRING, ELSET=G\n 3\n 100.\n"
        said = self.scene(abaqus(SPRINGS + grounded), "deck.inp")[1]
        self.assertIn("*SPRING: it is of no elements SPRINGA or SPRING2, so that this is left out", said)
        self.assertIn("*ELEMENT, TYPE=SPRING1 is left out", said)
        mesh = self.converted(abaqus(), "deck.inp", is_mesh_alone=True)
        self.assertIn("*ELEMENT, TYPE=SPRINGA is left out", "\n".join(mesh.report.summary()))


main()

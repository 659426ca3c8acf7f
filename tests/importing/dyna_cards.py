#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""What becomes of cards of LS-DYNA: rigid parts, contacts between bodies, loads, materials, outputs.

    dyna_cards.py PROJECT_DIRECTORY PROGRAM
"""

from deck_testing import DeckError, DeckTest, card, main, part_of, replaced, text_of

PRESS, BAR = text_of("press.k"), text_of("bar.k")
ELASTIC = BAR[BAR.index("*MAT_ELASTIC"):BAR.index("*NODE")]
END = "*END"


class DynaCards(DeckTest):
    def check(self, text, *parts, **options):
        self.check_scene(text, "deck.k", *parts, **options)

    def test_a_rigid_punch_presses_a_blank(self):
        self.check(PRESS, "set Formulation = rigid", "set Displacement = 0; 0; -1*table(deck_curve_6_integrated.csv, t)",
                   "set Slave parts = blank set Master parts = punch set Friction = 0.1",
                   "set Boundary = node set 3 set Type = displacement set Function = free; free; 0",
                   "set Where = abs(x - 0) < 2e-06 && abs(z - 0) < 2e-06 set Type = clamp",
                   "set Boundary = segment set 4 set Type = pressure set Function = 0.001*table(deck_curve_6.csv, t)",
                   "set Function = 0; 0; -1*table(deck_curve_6.csv, t)", "set Safety factor = 0.6",
                   "set Quadratic bulk viscosity = 1.2", "set Interval = 1e-06", "set Statistics interval = 1e-07",
                   "set Further outputs = part history", "set Mesh nodes = 1, 2",
                   "LCSS = 8 is a table over strain rates: they are plastic ones", "set Strain rates = 0.001, 100",
                   "set Plastic strains = 0, 0.5, 10 set", "set Flow stresses = 200, 300, 2200; 250, 350, 2250",
                   "SOFT = 2 is not used", "VDC = 20 is not used", "*HOURGLASS (1 time")
        self.check(replaced(PRESS, (card(0, 0, 8), card(0, 0, 8, 0, 1))), "!they are plastic ones", "!VP", "set Strain rates = 0.001, 100")
        self.dry_run("deck.prm")
        rows = (self.directory / "deck_curve_6_integrated.csv").read_text().split("\n")
        self.assertIn("1e-05, 0.05", rows[-2])

    def test_a_table_that_names_its_curves(self):
        old = "*DEFINE_TABLE\n         8\n               0.001\n                 100\n"
        new = "*DEFINE_TABLE_2D\n" + card(8) + "\n" + card(4.6, 81, width=20) + "\n" + card(-6.9077553, 82, width=20) + "\n"
        log = ("PLASTICITY\n", "PLASTICITY_LOG_INTERPOLATION\n")
        self.check(replaced(PRESS, (old, new), log), "set Strain rates = 0.000999999979, 99.48431564", "set Flow stresses = 250, 350, 2250; 200, 300, 2200",
                   "stresses are linear in the rate, not in its logarithm")
        with self.assertRaisesRegex(DeckError, "8 names the curve 83, which is not there"):
            self.converted(replaced(PRESS, (old, replaced(new, ("82", "83")))), "deck.k")

    def test_what_a_rigid_material_leaves_free(self):
        for card_2, parts in ((card(0), ("set Displacement = free; free; free", "set Rotation = free")),
                              (card(1, 6, 4), ("set Displacement = 0; free; 0", "set Axis = 0, 0, 1",
                                               "set Rotation = about the axis"))):
            text = replaced(PRESS, (card(1, 4, 7) + "\n", card_2 + "\n"), (
                PRESS[PRESS.index("*BOUNDARY_PRESCRIBED_MOTION_RIGID"):PRESS.index("*CONTACT")],
                "*DEFINE_CURVE\n" + card(6) + "\n" + card(0, 0, width=20) + "\n" + card(1, 1, width=20) + "\n"))
            self.check(text, *parts)

    def test_contacts(self):
        contact = PRESS[PRESS.index("*CONTACT"):PRESS.index("*LOAD_SEG")]

        def of(keyword, sides, second="", third=""):
            return replaced(PRESS, (contact, f"*CONTACT_{keyword}\n{sides}\n{second}\n{third}\n"))
        self.check(of("TIED_SURFACE_TO_SURFACE", card(4, 2, 0, 3)),
                   "set Slave boundary = segment set 4 set Master parts = punch set Type = tied")
        self.check(of("AUTOMATIC_SINGLE_SURFACE", card(5, 0, 2), card(0.2)),
                   "set Slave parts = blank set Master parts = punch set Friction = 0.2",
                   "folds of blank that meet themselves are not seen")
        self.check(of("AUTOMATIC_GENERAL", card(0, 0, 5)), "set Slave parts = blank set Master parts = punch")
        self.check(of("ERODING_NODES_TO_SURFACE", card(3, 2, 4, 3)), "set Slave boundary = node set 3")
        self.check(of("FORMING_ONE_WAY_SURFACE_TO_SURFACE", card(2, 1, 3, 3)), "set Slave parts = blank")
        self.check(of("TIED_SURFACE_TO_SURFACE_CONSTRAINED_OFFSET", card(1, 2, 3, 3)), "set Type = tied",
                   "nodes are tied where they are nearer than 10 %")
        ranks = card(0, 200) + "\n&" + card(1, 2) + "\n"
        self.check(of("AUTOMATIC_SURFACE_TO_SURFACE_MPP", ranks + card(1, 2, 3, 3), card(0.3)), "set Slave parts = blank",
                   "set Friction = 0.3", "the card of MPP \"0       200\" is not used", "the card of MPP \"&")
        self.check(of("TIED_SURFACE_TO_SURFACE_ID_OFFSET_MPP", card(5) + "joint, outer\n" + ranks + card(1, 2, 3, 3)),
                   ": joint, outer", "set Slave parts = blank", "set Type = tied")
        self.check(of("SURFACE_TO_SURFACE_THERMAL", card(1, 2, 3, 3), "", "\n" + card(0, 0, 40)), "H0 = 40 is not used",
                   "set Slave parts = blank")
        self.check(of("SURFACE_TO_SURFACE_INTERFERENCE", card(1, 2, 3, 3), "", "\n" + card(5)),
                   "LCID1 = 5 is not understood, so that this is left out", "!Body contact: joint")
        for keyword, sides, reason in (
                ("AUTOMATIC_SURFACE_TO_SURFACE", card(1, 2, 3, 3, 7), "SBOXID = 7 is not understood"),
                ("TIEBREAK_SURFACE_TO_SURFACE", card(1, 2, 3, 3), "a layer of particles that shares its nodes with both"),
                ("AUTOMATIC_SURFACE_TO_SURFACE_TIEBREAK", card(1, 2, 3, 3), "a layer of particles that shares its nodes"),
                ("TIED_SURFACE_TO_SURFACE_FAILURE", card(1, 2, 3, 3), "a layer of particles that shares its nodes"),
                ("SURFACE_TO_SURFACE_TIED_WELD", card(1, 2, 3, 3), "with a `Bonding temperature`"),
                ("AUTOMATIC_SURFACE_TO_SURFACE", card(1, 9, 3, 3), "none of its parts has solid elements"),
                ("AUTOMATIC_SURFACE_TO_SURFACE", card(1, 9, 3, 2), "there is no part set 9"),
                ("AUTOMATIC_SINGLE_SURFACE", card(1, 0, 3), "there are no two bodies")):
            with self.subTest(reason):
                self.check(of(keyword, sides), reason + ", so that this is left out" if "not" in reason else reason,
                           "!Body contact: joint")
        self.check(of("SURFACE_TO_SURFACE", card(1, 2, 3, 3), card(2, 7)), "FS = 2 names a table of friction", "!set Friction = 2")
        self.check(of("AUTOMATIC_SURFACE_TO_SURFACE", card(1, 2, 3, 3), card(0, 0, 0, 0, 0, 0, 0, "1.0E-6")),
                   "DT = 1.0E-6 is not understood, so that this is left out")

    def test_loads_at_nodes_and_on_segments(self):
        curve = "*DEFINE_CURVE\n" + card(7) + "\n" + card(0, 0, width=20) + "\n" + card(1, 1, width=20) + "\n"
        load = "*LOAD_NODE_SET\n" + card(2, 1, 7, 10.0) + "\n"
        self.check(replaced(BAR, (END, curve + load + END)), "set Type = traction set Area = initial",
                   "set Function = 40*table(deck_curve_7.csv, t); 0; 0", "the force at each of 4 nodes is a traction")
        def of(*nodes):
            return replaced(BAR, (END, f"{curve}*LOAD_NODE_POINT\n" + "".join(card(n, 1, 7, f) + "\n" for n, f in nodes) + END))
        self.check(of((17, 10), (18, 10), (19, 10), (20, 10)), "set Boundary = node set 2 set Type = traction set Area = initial",
                   "set Function = 40*table(deck_curve_7.csv, t); 0; 0", "the force at each of 4 nodes is a traction")
        self.check(of((17, 10), (18, 10)), 'the nodes of "17", "18" make no face of the boundary', "!set Type = traction")
        self.check(of((17, 10), (18, 10), (19, 20), (20, 20)), 'on "17", "18", "19", "20" turn the body', "!set Type = traction")
        for late, pressure in (("4.0E-7", "if(t < 4e-07, 0, 2*table(deck_curve_7.csv, t - 4e-07))"),
                               ("0", "2*table(deck_curve_7.csv, t)")):
            for death, whole in (("8.0E-7", f"if(t < 8e-07, {pressure}, 0)"), ("2.0E-6", pressure)):
                scene, said = self.scene(replaced(BAR, (END, curve + "*SET_SEGMENT\n" + card(3) + "\n" + card(
                    17, 18, 19, 20) + "\n*LOAD_SEGMENT_SET\n" + card(3, 7, 2.0, late, death) + "\n" + END)))
                self.assertIn(f"set Type = pressure set Function = {whole} end", scene)
                self.assertIn("all keywords were used", said)
        segments = "*LOAD_SEGMENT\n" + card(7, 2.0, 0, 17, 18, 19, 20) + "\n"
        self.check(replaced(BAR, (END, curve + segments + END)), "set Boundary = segments of line",
                   "set Function = 2*table(deck_curve_7.csv, t)")
        falling = replaced(curve, (card(1, 1, width=20), card(-1, 1, width=20)))
        self.assertIn("falls from 0 to -1 in time", self.refusal(replaced(BAR, (END, falling + load + END))))

    def refusal(self, text):
        try:
            self.converted(text, "deck.k").files()
        except Exception as error:  # its sentence
            return str(error)
        return ""

    def test_velocities_at_the_start(self):
        spin = "*INITIAL_VELOCITY_GENERATION\n" + card(1, 2, 3.0, 5) + "\n" + card(0, 1, 0, 0, 0, 2) + "\n"
        self.check(replaced(BAR, (END, spin + END)), "set Spin = 0, 0, 3", "set Centre of spin = 0, 1, 0",
                   "set Part = bar", "set Velocity = 5; 0; 0")
        some = "*INITIAL_VELOCITY\n" + card(2) + "\n" + card(7) + "\n"
        self.check(replaced(BAR, (END, some + END)), "set Where = abs(x - 4) < 4e-06", "set Velocity = 7; 0; 0")

    def test_moving_walls_and_spheres(self):
        head = card(-0.01, 0, 0, 0.99, 0, 0)
        self.check(replaced(BAR, (END, f"*RIGIDWALL_PLANAR_MOVING\n{card(0)}\n{head}\n{card(2.0, 3.0)}\n" + END)),
                   "set Mass = 2", "set Initial velocity = 3, 0, 0", "set Directions = 1, 0, 0")
        self.check(replaced(BAR, (END, f"*RIGIDWALL_GEOMETRIC_SPHERE\n{card(0)}\n{card(-2, 0, 0, 1, 0, 0)}\n{card(1.5)}\n" +
                                  END)), "set Surface = sphere", "set Radius = 1.5", "set Origin = -2, 0, 0")

    def test_a_material_over_the_temperature(self):
        def curve(number, *points):
            return f"*DEFINE_CURVE\n{card(number)}\n" + "".join(card(*point, width=20) + "\n" for point in points)
        material = ("*MAT_ELASTIC_VISCOPLASTIC_THERMAL\n" + card(1, "7.85E-9", 210000, 0.3, 300, "1.2E-5", 21) + "\n" +
                    card(0) + "\n" + card(40, 5, 22, 0, 23) + "\n" + card(0, 0, 20.0) + "\n" +
                    curve(21, (0, 300), (0.1, 400)) + curve(22, (20, 210000), (520, 180000)) +
                    curve(23, (20, 300), (520, 100)))
        self.check(replaced(BAR, (ELASTIC, material)), "set Young's modulus = 210000", "set Temperatures = 20, 520",
                   "set Flow stresses = 300, 400, 10300; 100, 200, 10100", "the thermal expansion is left out",
                   "set Cowper-Symonds rate = 40 set Cowper-Symonds exponent = 5", "set Initial temperature = 20")
        heat = ("*MAT_THERMAL_ISOTROPIC\n" + card(9) + "\n" + card("4.5E8", 50) + "\n*INITIAL_TEMPERATURE_SET\n" +
                card(0, 20.0) + "\n")
        text = replaced(BAR, (ELASTIC, material + heat), ("*PART\nbar\n" + card(1, 1, 1), "*PART\nbar\n" + card(
            1, 1, 1, 0, 0, 0, 0, 9)))
        self.check(text, "set Young's modulus = 20: 210000, 520: 180000", "set Specific heat capacity = 450000000",
                   "set Conductivity = 50", "set Thermal expansion = 1.2e-05", "set Temperature = 20")

        material = "*MAT_ELASTIC_PLASTIC_THERMAL\n" + "\n".join(card(*row) for row in (
            (1, "7.85E-9"), (20, 520), (210000, 180000), (0.3, 0.35), ("1.2E-5", "1.4E-5"), (300, 100), (2000, 1000))) + "\n"
        text = replaced(BAR, (ELASTIC, material + heat), ("*PART\nbar\n" + card(1, 1, 1), "*PART\nbar\n" + card(
            1, 1, 1, 0, 0, 0, 0, 9)))
        self.check(text, "set Young's modulus = 20: 210000, 520: 180000", "set Poisson's ratio = 20: 0.3, 520: 0.35",
                   "set Thermal expansion = 20: 1.2e-05, 520: 1.4e-05", "set Temperatures = 20, 520",
                   "set Plastic strains = 0, 10 ", "set Flow stresses = 300, 20492.30769; 100, 10155.86592")
        self.check(replaced(BAR, (ELASTIC, replaced(material, (card(300, 100), card(0)), (card(2000, 1000), card(0))))),
                   "set Model = elastic", "set Young's modulus = 210000", "!Flow stress")

    def test_heat_of_a_density_of_its_own(self):
        for density, capacity in (("0", 450000000), ("7.85E-9", 450000000), ("15.7E-9", 900000000)):
            thermal = "*MAT_THERMAL_ISOTROPIC\n" + card(9, density) + "\n" + card("4.5E8", 50) + "\n"
            self.check(replaced(BAR, (ELASTIC, ELASTIC + thermal), (card(1, 1, 1), card(1, 1, 1, 0, 0, 0, 0, 9))),
                       f"set Specific heat capacity = {capacity} ", "!TRO")

    def test_the_law_of_johnson_and_cook_without_temperatures(self):
        material = "*MAT_SIMPLIFIED_JOHNSON_COOK\n" + card(1, "8.96E-9", 124000, 0.34) + "\n" + card(
            90, 292, 0.31, 0.025, 0.8, 400, "1.0E28") + "\n"
        self.check(replaced(BAR, (ELASTIC, material)), "set Flow stress = johnson cook", "set Hardening coefficient = 292",
                   "set Rate coefficient = 0.025", "set Reference rate = 1 ", "set Erosion strain = 0.8",
                   "SIGMAX = 400 is not used", "!SIGSAT", "!Specific heat", runs=True)

    def test_a_material_that_is_not_read(self):
        scene, said = self.scene(replaced(BAR, ("*MAT_ELASTIC", "*MAT_NULL")), "deck.k")
        self.assertIn("the material 1 of part 1 is *MAT_NULL (line 11), which is not read: write its section", scene + said)

    def test_nodes_turn_about_an_axis(self):
        curve = "*DEFINE_CURVE\n" + card(7) + "\n" + card(0, 0, width=20) + "\n" + card(1, 2, width=20) + "\n"

        def of(dof, kind, *further, keyword="SET", axis=card(0.5, 0.25)):
            return replaced(BAR, (END, curve + f"*BOUNDARY_PRESCRIBED_MOTION_{keyword}\n" +
                                  card(2, dof, kind, 7, 0.5, *further) + "\n" + (axis + "\n" if axis else "") + card(1, 1, 2, 7) + "\n" + END))
        self.check(of(9, 2), "set Function = free; 0; 0", "set Axis = 1, 0, 0", "set Angle = 0.5*table(deck_curve_7.csv, t)",
                   "set Centre = 0, 0.5, 0.25", "set Function = 1*table(deck_curve_7.csv, t); free; free")
        self.check(of(9, 2, 0, "5.0E-7"), "set End = 5e-07", "set Angle = 0.5*table(deck_curve_7.csv, t)")
        self.check(of(10, 2), "set Function = 0; free; 0", "set Axis = 0, 1, 0", "set Centre = 0.25, 0, 0.5")
        self.check(of(11, 0), "set Angle = 0.5*table(deck_curve_7_integrated.csv, t)", "set Centre = 0.5, 0.25, 0")
        late = (0, "9.0E-7", "5.0E-7")
        self.check(of(9, 2, *late), "set Start = 5e-07 set End = 9e-07", "set Angle = 0.5*table(deck_curve_7.csv, t - 5e-07)")
        self.check(of(9, 0, *late), "set Angle = 0.5*table(deck_curve_7_integrated.csv, t - 5e-07)")
        for changes, reason in (((-9, 2), "DOF = -9 is not understood"), ((9, 1), "VAD = 1 is not understood")):
            self.left_out(of(*changes), reason)
        self.left_out(of(9, 2, axis=card(0.5, 0.25, 1)), "LRB = 1 is not understood")
        self.left_out(of(5, 2, axis=""), "DOF = 5 is a rotation of nodes, and nodes of solids do not turn")

    def left_out(self, text, reason):
        """The motion about an axis is left out, and the one behind it is read."""
        scene, said = self.scene(text)
        self.assertIn(reason, said)
        self.assertNotIn("set Angle", scene)
        self.assertIn("set Function = 1*table(deck_curve_7.csv, t); free; free", scene)

    def test_a_bar_that_is_turned_a_quarter(self):
        text = replaced(BAR, (BAR[BAR.index("*SET_NODE_LIST"):BAR.index("*DEFINE_CURVE")],
                              "*SET_NODE_GENERAL\n" + card(1) + "\n" + card("ALL") + "\n*DATABASE_HISTORY_NODE\n" + card(20) +
                              "\n*DATABASE_HISTORY_SOLID\n" + card(4) + "\n"),
                        (card(2, 1, 2, 1, 1.0), card(1, 11, 2, 1, 1.570796) + "\n" + card(1, 0.5)))
        self.check(text, "set Centre = 1, 0.5, 0")
        code, printed = self.run_program("deck.prm")
        self.assertEqual(code, 0, printed)
        # The node 20 lies at 4, 0, 1.
        place = [values[-1] for name, values in self.rows("probes.csv").items() if name.startswith("mesh node 20 position")]
        for value, wanted in zip(place, (1.5, 3.5, 1)):
            self.assertAlmostEqual(value, wanted, 4)

    def test_statics_damping_and_mass_scaling(self):
        self.check(replaced(BAR, (END, "*CONTROL_IMPLICIT_GENERAL\n" + card(1, "1.0E-7") + "\n" + END)),
                   "set Time integration = quasi-static", "set Largest step = 1e-07")
        self.check(replaced(BAR, (END, "*DAMPING_GLOBAL\n" + card(0, 1000) + "\n*CONTROL_TIMESTEP\n" +
                                  card(0, 0.8, 0, 0, "-1.0E-7") + "\n" + END)),
                   "set Rate = 1000", "set Target time step = 8e-08", "set Safety factor = 0.8")

    def test_numbers_of_two_things_are_refused(self):
        for keyword, cards in (("PART", "twin\n" + card(1, 1, 1)), ("SECTION_SOLID", card(1, 1)),
                               ("MAT_ELASTIC", card(1, "7.85E-9", 1000.0)), ("SET_NODE_LIST", card(1) + "\n" + card(17)),
                               ("DEFINE_CURVE", card(1) + "\n" + card(0, 1, width=20) + "\n" + card(1, 1, width=20))):
            with self.subTest(keyword), self.assertRaisesRegex(DeckError, "two .* of number 1|has the number 1 of another"):
                self.converted(replaced(BAR, (END, f"*{keyword}\n{cards}\n{END}")), "deck.k")

    def test_fields_that_have_no_counterpart_are_said(self):
        for cards, *parts in (
                ("*CONTROL_TIMESTEP\n" + card(0, 1.2, 0, 0, "1.0E-7"), "TSSFAC = 1.2 is not used", "DT2MS = 1.0E-7 is not used",
                 "!set Target", "!set Safety"),
                ("*CONTROL_IMPLICIT_GENERAL\n" + card(2), "IMFLAG = 2 is not used", "!quasi-static"),
                ("*CONTROL_IMPLICIT_GENERAL\n" + card(1) + "\n*CONTROL_IMPLICIT_DYNAMICS\n" + card(1),
                 "steps of motion (*CONTROL_IMPLICIT_DYNAMICS) are explicit here", "!quasi-static"),
                ("*DEFINE_CURVE\n" + card(7) + "\n" + card(0, 0, width=20) + "\n" + card("1.0E-7", 1, width=20) +
                 "\n*LOAD_BODY_Z\n" + card(7), "the curve 7 ends at the time 1e-07, and the run at 1e-06")):
            with self.subTest(parts[0]):
                self.check(replaced(BAR, (END, cards + "\n" + END)), *parts)
        self.check(replaced(BAR, (card(1, 2), card(1, 11))), "ELFORM = 11 is no hexahedron of one or of eight points")

    def test_velocities_of_single_nodes_count(self):
        text = replaced(BAR, (END, "*INITIAL_VELOCITY_NODE\n" + card(1, 7.0) + "\n*INITIAL_VELOCITY\n" + card(0) + "\n" +
                              card(3.0) + "\n" + END))
        self.check(text, "set Initial conditions = flight 1, flight 2", "flight 1 set Velocity = 3; 0; 0",
                   "set Velocity = 7; 0; 0")

    def test_an_axis_of_two_nodes_is_left_out(self):
        self.check(replaced(BAR, (END, "*INITIAL_VELOCITY_GENERATION\n" + card(1, 2, 10.0) + "\n" + card(0, 0, 0, -999, 1, 2) + "\n" + END)),
                   "NX = -999, by which nodes give the axis, is not understood", "!set Spin")

    def test_the_plane(self):
        points = ((0, 0), (1, 0), (2, 0), (0, 1), (1, 1), (2, 1))
        nodes = "*NODE\n" + "".join(card(k, width=8) + card(x, y, width=16) + "\n" for k, (x, y) in enumerate(points, 1))
        shells = "*ELEMENT_SHELL\n" + card(1, 1, 1, 2, 5, 4, width=8) + "\n" + card(2, 1, 2, 3, 6, 5, width=8) + "\n"
        text = BAR[:BAR.index("*SECTION")] + "*SECTION_SHELL\n" + card(1, 13) + "\n" + ELASTIC + nodes + shells + (
            part_of(BAR, "*DEFINE_CURVE", "*BOUNDARY_PRES"))
        for cards, *parts in (
                ("*INITIAL_VELOCITY_GENERATION\n" + card(1, 2, 10.0, 1, 2) + "\n" + card(3, 4, 0, 0, 0, -2), "set Velocity = 1; 2",
                 "set Spin = -10 set Centre of spin = 3, 4"),
                ("*INITIAL_VELOCITY_GENERATION\n" + card(1, 2, 10.0) + "\n" + card(0, 0, 0, 1), "in two dimensions nodes turn about z"),
                ("*INITIAL_VELOCITY\n" + card(0) + "\n" + card(1, 0, 3), "VZ = 3 is not understood", "!set Velocity"),
                ("*RIGIDWALL_PLANAR\n" + card(0) + "\n" + card(0, 0, -1, 0, 0, 0), "its normal has no length in the plane"),
                ("*BOUNDARY_PRESCRIBED_MOTION_NODE\n" + card(3, 3, 0, 1), "in two dimensions there is nothing along z"),
                ("*BOUNDARY_SPC_NODE\n" + card(3, 0, 0, 0, 1), "!set Type = displacement")):
            with self.subTest(parts[0]):
                self.check(text + cards + "\n", *parts, dimension=2)
        rigid = replaced(text, ("*MAT_ELASTIC", "*MAT_RIGID"), (card(0.3), card(0.3) + "\n" + card(1, 3, 4)))
        for dof, *parts in ((7, "set Displacement = free; free", "set Angle = 1*table(deck_curve_1.csv, t)", "!set Axis"),
                            (3, "DOF = 3 is none of two dimensions (1, 2 and 7 are)", "set Rotation = free")):
            self.check(rigid + "*BOUNDARY_PRESCRIBED_MOTION_RIGID\n" + card(1, dof, 2, 1) + "\n", *parts, dimension=2)
        self.check(replaced(text, (card(1, 13), card(1, 12))), "ELFORM = 12 is plane stress", dimension=2)
        with self.assertRaisesRegex(DeckError, "ELFORM = 15 is axisymmetric"):
            self.check(replaced(text, (card(1, 13), card(1, 15))), dimension=2)

    def test_body_loads_of_a_set_of_parts(self):
        loads = "*LOAD_BODY_X\n" + card(6, 2.0) + "\n*LOAD_BODY_PARTS\n" + card(3) + "\n*SET_PART_LIST\n" + card(3) + "\n"
        # The punch has nodes where the blank has some.
        self.check(replaced(PRESS, (END, loads + card(1) + "\n" + END)), "the parts of *LOAD_BODY_PARTS are neither all nor those "
                   "of a box, so that this is left out", "!set Function = -2*table")
        text = replaced(BAR, ("*SECTION", "*PART\nend\n" + card(2, 1, 1) + "\n*SECTION"), ("       4       1", "       4       2"))
        self.check(replaced(text, (END, loads.replace(card(6, 2.0), card(1, 2.0)) + card(2) + "\n" + END)),
                   "set Type = gravity set Where = x > 2.999996 && x < 4.000004 set Function = -2*table(deck_curve_1.csv, t); 0; 0")
        self.check(replaced(PRESS, (END, loads + card(1, 2) + "\n" + END)), "set Type = gravity set Function = -2*table")

    def test_parts_of_one_material_with_other_heat(self):
        heat = "".join("*MAT_THERMAL_ISOTROPIC\n" + card(k) + "\n" + card("4.5E8", 10 * k) + "\n" for k in (8, 9))
        parts = "".join(f"*PART\n{name}\n" + card(k, 1, 1, 0, 0, 0, 0, thermal) + "\n"
                        for k, name, thermal in ((1, "bar", 8), (2, "end", 9), (3, "tip", 9)))
        elements = [line for line in BAR.split("\n") if line.startswith(("       3       1", "       4       1"))]
        self.check(replaced(BAR, (BAR[BAR.index("*PART"):BAR.index("*SECTION")], heat + parts), *(
            (line, line[:15] + str(k) + line[16:]) for k, line in enumerate(elements, 2))),
            "set Materials = material 1, material 1 (2)", "set Conductivity = 80", "set Conductivity = 90",
            "subsection Part: tip set Cells = group part 3 set Formulation = fully integrated hexahedron set Material = material 1 (2)")

    def test_tables_of_temperature(self):
        curves = "".join(f"*DEFINE_CURVE\n{card(k)}\n{card(0, s, width=20)}\n{card(0.1, s + 50, width=20)}\n"
                         for k, s in ((51, 300), (52, 100)))
        material = ("*MAT_106\n" + card(1, "7.85E-9", 210000, 0.3, 300, 0, 50) + "\n" + card(0) + "\n" +
                    card(0, 0, 0, 0, 0, 0, 0, -60) + "\n" + card(0, 0, 20.0) + "\n*DEFINE_TABLE\n" + card(50) + "\n" +
                    card(20.0, width=20) + "\n" + card(520.0, width=20) + "\n" + curves + "*DEFINE_CURVE\n" + card(60) + "\n" +
                    card(20, "1E-5", width=20) + "\n" + card(1020, "2E-5", width=20) + "\n*MAT_THERMAL_ISOTROPIC\n" + card(9) +
                    "\n" + card("4.5E8", 50) + "\n")
        text = replaced(BAR, (ELASTIC, material), (card(1, 1, 1), card(1, 1, 1, 0, 0, 0, 0, 9)))
        # The expansion from 20 to 1020 is 0.02: the mean of its increments.
        self.check(text, "set Temperatures = 20, 520 set Flow stresses = 300, 350, 5300; 100, 150, 5100", "!Strain rates",
                   "set Thermal expansion = 19.999: 1e-05, 20.001: 1e-05, 1019.999: 3e-05, 1020.001: 2e-05")
        with self.assertRaisesRegex(DeckError, "LCALPH of material 1: 61 is no"):
            self.converted(text.replace("-60", "-61"), "deck.k")

    def test_johnson_cook_without_temperatures(self):
        material = ("*MAT_JOHNSON_COOK\n" + card(1, "7.85E-9", 80000, 210000, 0.3) + "\n" + card(90, 292, 0.31) + "\n" + card(0) +
                    "\n" + card(0) + "\n")
        self.check(replaced(BAR, (ELASTIC, material)), "TM is not above TR: there is no thermal softening",
                   "set Melting temperature = 2e+09", "set Reference rate = 1", "CP = 0: plastic work does not heat", "!Taylor-Quinney")

    def test_a_pressure_pulls_where_segments_go_round_the_other_way(self):
        def of(*segments):
            return replaced(BAR, (END, "*SET_SEGMENT\n" + card(3) + "\n" + "".join(card(*one) + "\n" for one in segments) +
                                  "*LOAD_SEGMENT_SET\n" + card(3, 1, 2.0) + "\n" + END))
        end, foot, inward = (17, 18, 19, 20), (1, 4, 3, 2), (20, 19, 18, 17)
        self.check(of(end, foot), "set Function = 2*table", "!pulls")
        self.check(of(inward), "set Function = -2*table", "the segments go round as seen from inside: a pressure on them pulls")
        self.check(of(inward, foot), "its segments go round both ways", "!set Type = pressure")

    def test_places_and_units_in_files_that_are_moved(self):
        wall = "*RIGIDWALL_PLANAR\n" + card(0) + "\n" + card(-1, 0, 0, 0, 0, 0) + "\n"
        move = "*DEFINE_TRANSFORMATION\n" + card(1) + "\n" + card("TRANSL", 1.0) + "\n"
        body = BAR[BAR.index("*NODE"):BAR.index("*DEFINE_CURVE")]

        def of(further, scale, number):
            self.write("body.k", body + further)
            cards = "\n".join(("body.k", card(0), card(0), card(1, 1, scale), card(number)))
            return replaced(BAR, (body, move + "*INCLUDE_TRANSFORM\n" + cards + "\n"))
        self.check(of("", 1, 1), "set Boundary = node set 1")
        for further, scale, number in ((wall, 1, 1), ("*LOAD_BODY_X\n" + card(1, 2.0) + "\n", 0.001, 0)):
            with self.assertRaisesRegex(DeckError, r'of "body.k": \*.* is in a file of \*INCLUDE_TRANSFORM'):
                self.converted(of(further, scale, number), "deck.k")

    def test_moduli_and_sets_that_are_wrong(self):
        with self.assertRaisesRegex(DeckError, "ETAN of material 1 is 210000. Allowed is a tangent modulus below E = 210000"):
            self.converted(replaced(BAR, ("*MAT_ELASTIC", "*MAT_003"), (card(0.3), card(0.3, 300, 210000.0))), "deck.k")
        with self.assertRaisesRegex(DeckError, "has pairs of a first and a last number"):
            self.converted(replaced(BAR, ("*SET_NODE_LIST\n", "*SET_NODE_LIST_GENERATE\n"), (card(1, 2, 3, 4), card(1, 2, 3))), "deck.k")
        with self.assertRaisesRegex(DeckError, 'There are two parameters "e", 1.0 and 2.0'):
            self.converted(replaced(BAR, ("*PART\n", "*PARAMETER\nR  e       1.0\nR  e       2.0\n*PART\n")), "deck.k")
        with self.assertRaisesRegex(DeckError, "has 9 numbers. Allowed are eight on a card"):
            self.converted(replaced(BAR, (card(1, 2, 3, 4), "1,2,3,4,5,6,7,8,9")), "deck.k")


main()

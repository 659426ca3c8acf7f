#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Parameter files of files of Abaqus: materials, sections, conditions, contacts, steps, and what is said of the rest.

    abaqus_scene.py PROJECT_DIRECTORY PROGRAM
"""

from deck_testing import DeckError, DeckTest, main, replaced, text_of

IMPACT, TIED = text_of("impact.inp"), text_of("tied.inp")


class AbaqusScene(DeckTest):
    def check(self, text, *parts, runs=False):
        self.check_scene(text, "deck.inp", *parts, runs=runs)

    def refused(self, text, message):
        with self.assertRaises(DeckError) as context:
            self.converted(text, "deck.inp").files()
        self.assertIn(message, str(context.exception))

    def test_an_explicit_step_of_johnson_cook(self):
        self.check(IMPACT, "set Formulation = hexahedron", "set Time integration = explicit", "set End time = 2e-06",
                   "set Yield stress = 90", "set Rate coefficient = 0.025", "set Taylor-Quinney coefficient = 0.9",
                   "set Specific heat capacity = 383000000", "set Initial temperature = 298",
                   "set Boundary = FOOT set Type = displacement set Function = free; free; 0", "set Function = 0; free; free",
                   "set Function = 10*table(deck_amplitude_RAMP.csv, t)", "set Velocity = 0; 0; -190000",
                   "set Number = 20", "# set Unit labels = mass: t, length: mm, time: s", "*NODE OUTPUT (1 time, line 54)",
                   "Degrees of freedom 4 to 6 are not used", runs=True)

    def test_stages_with_heat_and_a_tie(self):
        self.check(TIED, "set Stages = Heat, Press", "set Time integration = quasi-static", "set Largest step = 0.1",
                   "set Time integration = backward Euler", "set Function = 20 + 80*t", "set Function = 100",
                   "set Function = free; free; -0.01*t", "set Function = 5*t", "set Type = tied",
                   "set Young's modulus = 0: 210000, 500: 180000", "set Temperatures = 0, 500",
                   "set Flow stresses = 300, 400, 400; 200, 225, 250", "set Conductivity = 50",
                   "set Conditions = support 1, drive 3, temperature 4, load 5", "no heat goes from one side",
                   "*CONTROLS (1 time")
        self.check(TIED + "*STEP, NAME=Fly\n*DYNAMIC, EXPLICIT\n , 1E-7\n*BOUNDARY, OP=NEW\n*DSLOAD, OP=NEW\n*END STEP\n",
                   "set Time integration = explicit set Conditions = end")

    def test_loads_contact_and_a_rigid_body(self):
        text = replaced(
            TIED, ("C3D8T", "C3D8R"), ("*TIE, NAME=T\n B2.LOWER, B1.UPPER\n", "*NODE\n 1, 0.5, 0.5, 2.\n"
                                       "*RIGID BODY, REF NODE=1, ELSET=B2.ALL\n*SURFACE INTERACTION, NAME=I\n*FRICTION\n 0.3,\n"
                                       "*CONTACT PAIR, INTERACTION=I, TYPE=SURFACE TO SURFACE\n B1.UPPER, B2.LOWER\n"),
            ("*SOLID SECTION, ELSET=ALL, MATERIAL=STEEL\n*END PART\n", "*END PART\n"),
            ("*END ASSEMBLY\n", "*SOLID SECTION, ELSET=B1.ALL, MATERIAL=STEEL\n*SOLID SECTION, ELSET=B2.ALL, MATERIAL=STEEL\n"
             "*END ASSEMBLY\n"))
        text = text[:text.index("*STEP")] + (
            "*AMPLITUDE, NAME=A, DEFINITION=SMOOTH STEP\n 0., 0., 1E-5, 1.\n*STEP\n*DYNAMIC, EXPLICIT\n , 1E-5\n"
            "*FIXED MASS SCALING, FACTOR=4.\n*BULK VISCOSITY\n 0.05, 1.1\n"
            "*BOUNDARY, AMPLITUDE=A\n 1, 3, 3, -0.01\n*BOUNDARY\n 1, 1, 2\n 1, 4, 6\n"
            "*CLOAD\n B1.HEAD, 1, 2.\n*DLOAD\n , GRAV, 9810., 0., 0., -1.\n B1.ALL, P3, 4.\n"
            "*DSLOAD\n B1.UPPER, TRVEC, 3., 0., 2., 0.\n*END STEP\n")
        self.check(text, "set Formulation = rigid", "set Origin = 0.5, 0.5, 2",
                   "set Displacement = 0; 0; -0.01*table(deck_amplitude_A.csv, t)", "!set Rotation",
                   "set Slave boundary = B1.UPPER set Master boundary = B2.LOWER set Friction = 0.3",
                   "set Type = traction set Area = initial set Function = 8; 0; 0", "a traction over their faces, whose area is 1",
                   "set Type = gravity", "set Function = 0; 0; (9810)*-1", "set Type = pressure",
                   "set Function = 0; (3)*1; 0", "set Mass factor = 4", "set Linear bulk viscosity = 0.05")

    def test_general_contact_and_heat_alone(self):
        text = replaced(TIED, ("*TIE, NAME=T\n B2.LOWER, B1.UPPER\n", ""),
                        ("*SOLID SECTION, ELSET=ALL, MATERIAL=STEEL\n*END PART\n", "*END PART\n"),
                        ("*END ASSEMBLY\n", "*SOLID SECTION, ELSET=B1.ALL, MATERIAL=STEEL\n"
                         "*SOLID SECTION, ELSET=B2.ALL, MATERIAL=STEEL\n*END ASSEMBLY\n"
                         "*SURFACE INTERACTION, NAME=I\n*FRICTION\n 0.2,\n*CONTACT\n*CONTACT INCLUSIONS, ALL EXTERIOR\n"
                         "*CONTACT PROPERTY ASSIGNMENT\n , , I\n"))
        self.check(text, "set Slave parts = B1.ALL set Master parts = B2.ALL set Friction = 0.2", "!set Stiffness")
        text = text[:text.index("*STEP")] + ("*STEP\n*DYNAMIC TEMPERATURE-DISPLACEMENT, EXPLICIT\n , 1E-5\n"
                                             "*SFILM\n B2.UPPER, F, 20., 5.\n*DSFLUX\n B2.UPPER, S, 7.\n*END STEP\n")
        self.check(text, "set Type = convection", "set Ambient temperature = 20", "set Film coefficient = 5",
                   "set Type = heat flux", "!backward Euler")
        behaviour = "*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE={}\n"
        self.check(text.replace("*CONTACT\n", behaviour.format("HARD") + "*CONTACT\n"), "!*SURFACE BEHAVIOR",
                   "set Friction = 0.2 set Stiffness = 10")
        self.check(text.replace("*CONTACT\n", behaviour.format("LINEAR") + " 1E7,\n*CONTACT\n"), "*SURFACE BEHAVIOR",
                   "!set Stiffness")

    def test_axes_of_nodes(self):
        def of(transform):
            return replaced(IMPACT, ("*SURFACE, NAME=TOP\n", transform + "*SURFACE, NAME=TOP\n"))
        self.check(of("*TRANSFORM, NSET=FOOT\n 1., 0., 1., 0., 1., 0.\n"), "!*TRANSFORM",
                   "set Boundary = FOOT set Type = displacement set Axes = 1, 0, 1; 0, 1, 0 set Function = free; free; 0")
        self.check(of("*TRANSFORM, NSET=FOOT, TYPE=C\n 3., 0., 0., 3., 0., 2.\n"), "!*TRANSFORM",
                   "set Type = displacement set Axes = cylindrical set Axis = 0, 0, 2 set Centre = 3, 0, 0 set Function = free; free; 0")
        self.check(of("*TRANSFORM, NSET=FOOT, TYPE=S\n 3., 0., 0., 3., 0., 2.\n"), "TYPE=S is not understood (R and C are)",
                   "!set Axes")
        self.check(of("*TRANSFORM, NSET=FOOT\n 1., 0., 1., 2., 0., 2.\n"), "its two points span no plane with the origin")

    def test_single_nodes_that_are_held_alike_are_one_condition(self):
        text = replaced(IMPACT, (" FOOT, 3, 3\n", " 1, 3, 3\n 2, 3, 3\n 3, 3, 3\n 5, 1, 1\n 4, 3, 3\n"))
        self.check(text, "set Boundary = FOOT set Type = displacement set Function = free; free; 0",
                   "set Where = abs(x - 0) < 2e-06 && abs(y - 0) < 2e-06 && abs(z - 1) < 2e-06 set Type = displacement",
                   "set Conditions = support 1, support 2, support 3, load 4")

    def test_forces_at_single_nodes_are_a_traction_together(self):
        def loaded(*rows):
            return IMPACT[:IMPACT.index("*DSLOAD")] + "*CLOAD\n" + "".join(f" {row}\n" for row in rows) + "*END STEP\n"

        self.check(loaded("9, 3, 0.5", "10, 3, 0.5", "11, 3, 1.", "12, 3, 1.", "FOOT, 1, 2."),
                   "set Function = 8; 0; 0", "!set Function = 0; 0; 3", "the forces on \"9\", \"10\", \"11\", \"12\" turn the body")
        self.check(loaded("9, 3, 0.5", "10, 3, 0.5", "11, 3, 0.5", "12, 3, 0.5"), "set Function = 0; 0; 2",
                   "the force at each of 4 nodes is a traction over their faces, whose area is 1", runs=True)
        self.check(loaded("9, 3, 1.", "10, 3, 1."), 'the nodes of "9", "10" make no face of the boundary')
        self.check(loaded("9, 3, 1.", "10, 3, 1.", "11, 3, 1.", "12, 3, 1.", "5, 3, 1."), "is on no face of the boundary that")

    def test_steady_heat_needs_no_capacity(self):
        text = IMPACT[:IMPACT.index("*MATERIAL")] + (
            "*MATERIAL, NAME=COPPER\n*CONDUCTIVITY\n 50.,\n*STEP\n*HEAT TRANSFER, STEADY STATE\n 1., 1.\n*BOUNDARY\n FOOT, 11, 11, 0.\n"
            "*FILM\n 2, F2, -12., 10.\n*NODE PRINT, NSET=ALL\n NT\n*END STEP\n")
        self.check(text, "set Model = heat conductor", "set Specific heat capacity = 0.00125", "set Conductivity = 50",
                   "Steps of heat are steady", "The densities do not tell the units", runs=True)
        # Two lengths of 1 with the conductivity 50, and the film of 10.
        self.assertAlmostEqual(self.rows("probes.csv")["mesh node 12 temperature"][-1], -12 * 0.4 / 1.4, 9)

    def test_johnson_cook_without_temperatures_does_not_soften(self):
        self.check(replaced(IMPACT, (" 90., 292., 0.31, 1.09, 1356., 298.", " 90., 292., 0.31, 0.77")),
                   "set Thermal exponent = 1", "set Melting temperature = 2e+09", "without a melting temperature", runs=True)

    def test_cells_of_second_order_are_elements_of_degree_2(self):
        corners = [(x, y, z) for z in (0, 2) for x, y in ((0, 0), (2, 0), (2, 2), (0, 2))]
        edges = [(1, 0, 0), (2, 1, 0), (1, 2, 0), (0, 1, 0), (1, 0, 2), (2, 1, 2), (1, 2, 2), (0, 1, 2), (0, 0, 1), (2, 0, 1),
                 (2, 2, 1), (0, 2, 1)]
        text = "*NODE\n" + "".join(f" {k}, {x}, {y}, {z}\n" for k, (x, y, z) in enumerate(corners + edges, 1)) + (
            "*ELEMENT, TYPE=C3D20R, ELSET=ALL\n 1, " + ",".join(map(str, range(1, 16))) + ",\n 16,17,18,19,20\n"
            "*MATERIAL, NAME=M\n*ELASTIC\n 100., 0.3\n*SOLID SECTION, ELSET=ALL, MATERIAL=M\n"
            "*NSET, NSET=FOOT\n 1,2,3,4\n*BOUNDARY\n FOOT, 1, 3\n*STEP\n*STATIC\n*CLOAD\n")
        # The forces of an even traction of 1 on such a face.
        rows = "".join(f" {node}, 3, {-1 / 3:.9g}\n" for node in range(5, 9)) + "".join(
            f" {node}, 3, {4 / 3:.9g}\n" for node in range(13, 17))
        self.check(text + rows + "*END STEP\n", "set Formulation = lagrange hexahedron", "set Degree = 2",
                   "set Function = 0; 0; 0.999999997*t", "elements of degree 2 here", runs=True)
        # An edge with its middle.
        self.check(text.replace("FOOT, 1, 3", "FOOT, 1, 2\n 1, 3, 3\n 2, 3, 3\n 9, 3, 3") + rows + "*END STEP\n",
                   "set Where = abs(y - 0) < 2e-06 && abs(z - 0) < 2e-06 set Type = displacement set Function = free; free; 0")
        self.check(text.replace("*STEP\n", "*SURFACE INTERACTION, NAME=I\n*CONTACT\n*CONTACT INCLUSIONS, ALL EXTERIOR\n"
                                "*CONTACT PROPERTY ASSIGNMENT\n , , I\n*STEP\n") + rows + "*END STEP\n",
                   "set Formulation = hexahedron", "set Refine where = abs(x) >= 0 set Refinement levels = 1",
                   "Each cell of second order is 8 elements of degree 1 here, since *CONTACT needs these", runs=True)

    def test_forces_in_the_plane_are_of_the_thickness(self):
        self.check("*NODE\n 1, 0., 0.\n 2, 2., 0.\n 3, 2., 1.\n 4, 0., 1.\n*ELEMENT, TYPE=CPE4, ELSET=ALL\n 1, 1,2,3,4\n"
                   "*MATERIAL, NAME=M\n*ELASTIC\n 100., 0.3\n*SOLID SECTION, ELSET=ALL, MATERIAL=M\n 0.5\n"
                   "*BOUNDARY\n 1, 1, 2\n 4, 1\n*STEP\n*STATIC\n*CLOAD\n 2, 1, 3.\n 3, 1, 3.\n*END STEP\n",
                   "set Function = 12*t; 0", runs=True)

    def test_initial_conditions_are_those_of_the_first_stage(self):
        step = IMPACT[IMPACT.index("*STEP"):].rstrip("\n").replace("*STEP", "*STEP, NAME=Fly")
        text = IMPACT + step + "\n"
        self.check(text, "subsection Stage: step 1", "load 3 set Initial conditions = flight 1 ", "subsection Stage: Fly")
        self.assertEqual(self.scene(text, "deck.inp")[0].count("set Initial conditions"), 1)

    def test_nothing_is_lost_without_a_word(self):
        self.check(replaced(IMPACT, ("*ELASTIC\n 124000., 0.34", "*ELASTIC, MODULI=LONG TERM\n 124000., 0.34, 0., 7."),
                            ("*OUTPUT, FIELD", "*DLOAD\n BAR, BZ, 3.\n*OUTPUT, FIELD")),
                   "line 29: *ELASTIC: MODULI=LONG TERM is not used", "line 30: *ELASTIC: 7. (field 4) is not used",
                   "BZ is not understood (P1 to P6 and GRAV are), so that this is left out", "set Function = 10*table")
        self.check(replaced(IMPACT, ("*STEP\n*DYN", "*STEP, NAME=Modes\n*FREQUENCY\n 5\n*END STEP\n*STEP\n*DYN")),
                   '*STEP "Modes" has no procedure that is possible here')

    def test_bad_decks_are_refused_with_their_line(self):
        for change, message in (
                (("ELSET=BAR, MATERIAL=COPPER", "ELSET=BAR, MATERIAL=IRON"), 'line 25: There is no *MATERIAL "IRON"'),
                (("*DENSITY\n 8.96E-9\n", ""), 'line 26: the material "COPPER" has no *DENSITY'),
                (("124000.", "-1."), "line 29: the Young's modulus"),
                ((" FOOT, 3, 3", " FEET, 3, 3"), 'There is no set of nodes "FEET"'),
                ((" FOOT, 3, 3", " FOOT, 3, 1"), "line 46: the last degree of freedom is 1, and the first one is 3"),
                ((" TOP, P, 10.", " TIP, P, 10."), 'There is no *SURFACE "TIP"'),
                ((" 0., 0., 1E-6, 1.", " 0., 0., 0., 1."), 'the times of the amplitude "RAMP" must increase'),
                (("AMPLITUDE=RAMP", "AMPLITUDE=RUMP"), 'There is no *AMPLITUDE "RUMP"'),
                (("*SOLID SECTION, ELSET=BAR, MATERIAL=COPPER\n", ""), "there is no *SOLID SECTION with cells")):
            with self.subTest(message):
                self.refused(replaced(IMPACT, change), message)


main()

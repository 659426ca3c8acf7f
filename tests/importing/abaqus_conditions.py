#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""What files of Abaqus prescribe at the start and over time, and laws of materials over the strain rate.

    abaqus_conditions.py PROJECT_DIRECTORY PROGRAM
"""

from deck_testing import DeckError, DeckTest, main, replaced, text_of

IMPACT, TIED = text_of("impact.inp"), text_of("tied.inp")
START = IMPACT[IMPACT.index("*INITIAL CONDITIONS, TYPE=VELOCITY"):IMPACT.index("*BOUNDARY")]
HEAT = TIED[TIED.index("*INITIAL CONDITIONS"):TIED.index("*BOUNDARY")]
STEP = IMPACT[IMPACT.index("*STEP"):]
COOK = IMPACT[IMPACT.index("*PLASTIC"):IMPACT.index("*SPECIFIC")]
PAIR = ("*SURFACE INTERACTION, NAME=I\n*FRICTION\n 0.2,\n*CONTACT\n*CONTACT INCLUSIONS, ALL EXTERIOR\n"
        "*CONTACT PROPERTY ASSIGNMENT\n , , I\n")


class AbaqusConditions(DeckTest):
    def check(self, text, *parts, runs=False):
        self.check_scene(text, "deck.inp", *parts, runs=runs)

    def test_each_component_is_that_of_its_last_line(self):
        start = "*INITIAL CONDITIONS, TYPE=VELOCITY\n FOOT, 1, 5.\n ALL, 3, -9.\n*INITIAL CONDITIONS, TYPE=VELOCITY\n ALL, 2, 2.\n"
        text = replaced(IMPACT, (START, start), (STEP, "*STEP\n*DYNAMIC, EXPLICIT\n , 1E-9\n*END STEP\n"),
                        ("*BOUNDARY\n FOOT, 3, 3\n XS, XSYMM\n", ""))
        self.check(text, "set Velocity = 0; 2; -9", "set Where = abs(z - 0) < 2e-06 set Velocity = 5; 2; -9", runs=True)
        rows = self.rows("statistics.csv")
        for axis, momentum in (("x", 0.5 * 5), ("y", 2 * 2), ("z", 2 * -9)):
            self.assertAlmostEqual(rows[f"momentum {axis}"][0] / 8.96e-9, momentum, 9)

    def test_nodes_at_one_place_are_told_apart_by_their_parts(self):
        text = replaced(TIED, (HEAT, "*INITIAL CONDITIONS, TYPE=VELOCITY\n B1.5, 1, 3.\n B2.1, 3, 7.\n"))
        self.check(text, "set Part = B1.ALL set Where = abs(x - 0) < 2e-06 && abs(y - 0) < 2e-06 && abs(z - 1) < 2e-06 set Velocity = 3; 0; 0",
                   "set Part = B2.ALL set Where =")
        self.check(replaced(TIED, (" B1.FOOT, ENCASTRE\n", " B1.5, 1, 3\n")),
                   "make no face of the boundary, and others lie where they do, so that this is left out", "!support")

    def test_temperatures_are_those_of_most_nodes(self):
        self.check(replaced(TIED, (HEAT, "*INITIAL CONDITIONS, TYPE=TEMPERATURE\n B1.FOOT, 500.\n")), "set Initial temperature = 0",
                   "set Where = abs(z - 0) < 2e-06 set Temperature = 500", "set Function = 100*t")
        self.check(replaced(IMPACT, (" ALL, 298.\n", " ALL, 298.\n FOOT, 400.\n")), "set Initial temperature = 298",
                   "no step has heat, and the temperature of all nodes is that of most, 298", "!set Temperature =")

    def test_amplitudes_go_on_in_further_steps(self):
        steps = ("*STEP, NAME={}\n*DYNAMIC, EXPLICIT\n , 1E-6\n{}*END STEP\n")
        first = "*DSLOAD, AMPLITUDE=RAMP\n TOP, P, 10.\n"
        for time, parts in (("", ("set Function = 5",)), (", TIME=TOTAL TIME", ("set Function = 10*table(deck_amplitude_RAMP_B.csv, t)",))):
            text = replaced(IMPACT, (STEP, steps.format("A", first) + steps.format("B", "")),
                            ("*AMPLITUDE, NAME=RAMP\n 0., 0., 1E-6, 1.", f"*AMPLITUDE, NAME=RAMP{time}\n 0., 0., 2E-6, 1."))
            self.check(text, "set Function = 10*table(deck_amplitude_RAMP.csv, t)", *parts)
        self.assertIn("-1e-06, 0\n1e-06, 1\n", (self.directory / "deck_amplitude_RAMP_B.csv").read_text())
        self.check(replaced(text, ("NAME=B", "NAME=A")), "set Stages = A, A (2)")

    def test_amplitudes_that_are_not_understood(self):
        for option, rows in (("DEFINITION=PERIODIC", " 1, 3., 0., 0.\n 0., 1."), ("VALUE=ABSOLUTE", " 0., 0., 1E-6, 1.")):
            with self.subTest(option):
                self.check(replaced(IMPACT, ("RAMP\n 0., 0., 1E-6, 1.", f"RAMP, {option}\n{rows}"), ("TOP, P, 10.", "TOP, P, 11.")),
                           f'the amplitude "RAMP" has {option}', "!set Type = pressure")

    def test_a_line_that_is_not_understood_leaves_the_others(self):
        text = replaced(IMPACT, ("*OUTPUT, FIELD", "*DLOAD\n BAR, CENTRIF, 1., 0., 0., 0., 0., 0., 1.\n BAR, P1, 5.\n*OUTPUT, FIELD"))
        self.check(text, "CENTRIF is not understood (P1 to P6 and GRAV are), so that this is left out (line 54)", "set Function = 5 ")
        self.check(replaced(text, ("CENTRIF, 1., 0., 0., 0., 0., 0., 1.", "GRAV, 9810., 0., -1., -1.")),
                   "the direction of GRAV is no unit vector", "set Function = 0; (9810)*-0.7071067812; (9810)*-0.7071067812")
        self.check(replaced(text, ("CENTRIF, 1., 0., 0., 0., 0., 0., 1.", "GRAV, 9810.")), "GRAV has no direction, so that this is left out")

    def test_loads_of_one_step_act_together(self):
        step = "*STEP, NAME={}\n*DYNAMIC, EXPLICIT\n , 1E-6\n{}*END STEP\n"
        loads = "*DLOAD\n BAR, GRAV, 3., 1., 0., 0.\n BAR, GRAV, 4., 0., 1., 0.\n*DSLOAD\n TOP, P, 5.\n*DSLOAD\n TOP, P, 5.\n"
        bare = (START, ""), ("*BOUNDARY\n FOOT, 3, 3\n XS, XSYMM\n", "")
        self.check(replaced(IMPACT, (STEP, step.format("A", loads)), *bare), "set Conditions = gravity 1, gravity 2, load 3, load 4",
                   runs=True)
        x, y, z = (self.rows("statistics.csv")[f"momentum {axis}"][-1] for axis in "xyz")
        self.assertAlmostEqual(y / x, 4 / 3, 6)
        self.assertAlmostEqual(z / x * 2 * 8.96e-9, -10 / 3, 3)
        self.check(replaced(IMPACT, (STEP, step.format("A", loads) + step.format("B", "*DLOAD\n BAR, GRAV, 7., 1., 0., 0.\n")), *bare),
                   "set Conditions = gravity 1, gravity 2, load 3, load 4", "set Conditions = load 3, load 4, gravity 5",
                   "set Function = (7)*1; 0; 0")

    def test_what_ends_in_a_step_begins_anew(self):
        def step(name, text):
            return f"*STEP, NAME={name}, NLGEOM\n*STATIC\n 1., 1.\n{text}*END STEP\n"
        text = replaced(IMPACT, (STEP, step("A", "*DSLOAD\n TOP, P, 10.\n*BOUNDARY\n 9, 3, 3, -0.01\n") + step(
            "B", "*DSLOAD, OP=NEW\n*BOUNDARY, OP=NEW\n FOOT, 3, 3\n 9, 3, 3, -0.03\n") + step("C", "*DSLOAD\n TOP, P, 20.\n")))
        self.check(text, "set Function = 10*t", "set Function = 20*t", "set Function = free; free; -0.01 + -0.02*t", "!10 + 10*t")

    def test_a_rigid_body_through_steps(self):
        text = replaced(
            TIED, (HEAT, "*AMPLITUDE, NAME=A\n 0., 0., 1E-6, 1.\n*AMPLITUDE, NAME=B\n 0., 1., 1E-6, 2.\n"), ("C3D8T", "C3D8R"),
            ("*TIE, NAME=T\n B2.LOWER, B1.UPPER\n", "*NODE\n 1, 0.5, 0.5, 2.\n*RIGID BODY, REF NODE=1, ELSET=B2.ALL\n"))

        def steps(*texts):
            return text[:text.index("*STEP")] + "".join(f"*STEP, NAME={name}\n*DYNAMIC, EXPLICIT\n , 1E-6\n{one}*END STEP\n"
                                                        for name, one in zip("KLMN", texts))
        held, drive = "*BOUNDARY\n 1, 1, 2\n 1, 4, 6\n", "*BOUNDARY, AMPLITUDE={}\n 1, 3, 3, 0.01\n"
        self.check(steps(held + drive.format("A"), "", drive.format("B"), "*BOUNDARY, OP=NEW\n B1.FOOT, 1, 3\n"),
                   "set Displacement = 0; 0; 0.01*table(deck_amplitude_A.csv, t)", "set Displacement = 0; 0; 0 ",
                   "set Displacement = 0; 0; 0.01*table(deck_amplitude_B.csv, t) + -0.01", "set Displacement = free; free; free", runs=True)
        # At rest in the second step, and in free flight in the last one.
        for name, begin, end in (("K", 0, 0.01), ("L", 0.01, 0.01), ("M", 0.01, 0.02), ("N", 0.02, 0.03)):
            position = self.rows(f"{name}/rigid_bodies.csv")["B2.ALL position z"]
            self.assertAlmostEqual(position[0] - 2, begin, 9)
            self.assertAlmostEqual(position[-1] - 2, end, 9)
        self.check(steps(held + "*CLOAD, AMPLITUDE=A\n 1, 3, 5.\n", "", "*CLOAD, OP=NEW\n"),
                   "set Force = 0; 0; 5*table(deck_amplitude_A.csv, t)", "set Force = 0; 0; 5 ")
        self.assertNotIn("Force", self.scene(steps(held, held), "deck.inp")[0])
        self.assertEqual(self.scene(steps(held + "*CLOAD\n 1, 3, 5.\n", "*CLOAD, OP=NEW\n"), "deck.inp")[0].count("set Force"), 1)

    def test_a_reference_node_is_one_node(self):
        with self.assertRaisesRegex(DeckError, 'REF NODE="NONE" of \\*RIGID BODY has 0 nodes. Allowed is one.'):
            self.converted(replaced(IMPACT, ("*STEP", "*NSET, NSET=NONE\n*RIGID BODY, REF NODE=NONE, ELSET=BAR\n*STEP")), "deck.inp")

    def test_a_rigid_body_of_the_plane(self):
        text = ("*NODE\n 1, 0., 0.\n 2, 1., 0.\n 3, 1., 1.\n 4, 0., 1.\n 9, 0.5, 0.\n*ELEMENT, TYPE=CPE4R, ELSET=B\n 1, 1,2,3,4\n"
                "*MATERIAL, NAME=M\n*DENSITY\n 1E-9,\n*ELASTIC\n 100., 0.3\n*SOLID SECTION, ELSET=B, MATERIAL=M\n"
                "*RIGID BODY, REF NODE=9, ELSET=B\n*STEP\n*DYNAMIC, EXPLICIT\n , 1E-3\n*BOUNDARY, TYPE=VELOCITY\n 9, 1, 1, 5.\n{}*END STEP\n")
        self.check(text.format(""), "set Displacement = 5*t; free", "set Rotation = free", "!set Axis")
        self.check(text.format(" 9, 6, 6, 2.\n"), "set Angle = 2*t", "!set Rotation")

    def test_options_that_give_numbers_another_meaning(self):
        for change, reason, lost in (
                (("*BOUNDARY\n FOOT", "*BOUNDARY, SUBMODEL, STEP=1\n FOOT"), "SUBMODEL is not understood", "!set Conditions = support"),
                (("*DSLOAD, AMP", "*DSLOAD, TIME DELAY=1E-7, AMP"), "TIME DELAY is not understood", "!set Type = pressure"),
                (("*BOUNDARY\n FOOT", "*INITIAL CONDITIONS, TYPE=STRESS, GEOSTATIC\n BAR, -5., 0., -8., 2., 0.5\n*BOUNDARY\n FOOT"),
                 "GEOSTATIC is not understood", "!set Stress")):
            with self.subTest(reason):
                self.check(replaced(IMPACT, change), reason + ", so that this is left out", lost)

    def test_a_rigid_body_with_a_velocity_over_time(self):
        text = replaced(
            TIED, (HEAT, "*AMPLITUDE, NAME=A\n 0., 0., 1E-6, 1.\n"), ("C3D8T", "C3D8R"),
            ("*TIE, NAME=T\n B2.LOWER, B1.UPPER\n", "*NODE\n 1, 0.5, 0.5, 2.\n*RIGID BODY, REF NODE=1, ELSET=B2.ALL\n"))
        text = text[:text.index("*STEP")] + ("*STEP\n*DYNAMIC, EXPLICIT\n , 2E-6\n*BOUNDARY, TYPE=VELOCITY, AMPLITUDE=A\n 1, 3, 3, 100.\n"
                                             "*BOUNDARY\n 1, 1, 2\n 1, 4, 6\n*END STEP\n")
        self.check(text, "set Displacement = 0; 0; 100*table(deck_amplitude_A_integrated.csv, t)", runs=True)
        position = self.rows("rigid_bodies.csv")["B2.ALL position z"]
        self.assertAlmostEqual((position[-1] - position[0]) / 1.5e-4, 1, 6)

    def test_contacts_that_are_not_understood(self):
        surface = ("*SURFACE INTERACTION, NAME=I\n*FRICTION, ROUGH\n*SURFACE, NAME=W, TYPE=CYLINDER\n 0., 0., 0., 1., 0., 0.\n"
                   "*SURFACE, NAME=V, COMBINE=UNION\n TOP, TOP\n")
        for pair, *parts in (("TOP,", "a surface does not meet itself here", "!set Slave"),
                             ("TOP, W", 'the *SURFACE "W" (line 50) is of TYPE=CYLINDER, which is not read', "!set Slave"),
                             ("TOP, V", 'the *SURFACE "V" (line 52) is of COMBINE=UNION, which is not read', "!set Slave"),
                             ("TOP, TOP", "set Friction = 10"), ("TOP, TOP, TIED", "set Type = tied", "!set Friction")):
            pair, tied, _ = pair.partition(", TIED")
            text = replaced(IMPACT, ("*STEP", surface + f"*CONTACT PAIR, INTERACTION=I{tied and ', TIED'}\n {pair}\n*STEP"))
            scene, said = self.scene(text, "deck.inp")
            for part in parts:
                (self.assertNotIn if part[0] == "!" else self.assertIn)(part.lstrip("!"), scene + said)
        text = replaced(TIED, ("*TIE, NAME=T\n B2.LOWER, B1.UPPER\n", PAIR.replace(", , I", ", , I\n B2.LOWER, B1.UPPER, J") +
                               "*SURFACE INTERACTION, NAME=J\n*FRICTION\n 0.7,\n"))
        self.check(text, "set Friction = 0.2", "B2.LOWER (field 1) is not used", "!set Friction = 0.7")

    def test_mass_scaling_of_some_elements_is_left_out(self):
        def scaled(elements):
            return replaced(IMPACT, ("*OUTPUT, FIELD", "*FIXED MASS SCALING, ELSET=SOME, DT=1E-8, TYPE=BELOW MIN\n*OUTPUT, FIELD"),
                            ("*NSET, NSET=FOOT", f"*ELSET, ELSET=SOME\n {elements}\n*NSET, NSET=FOOT"))
        self.check(scaled("1"), "*FIXED MASS SCALING (1 time, line 55)", "!set Target time step")
        self.check(scaled("1, 2"), "set Target time step = 1E-8", "!*FIXED MASS SCALING")

    def test_flow_stresses_over_the_strain_rate(self):
        curve = "*PLASTIC{}\n {}., 0.\n {}., 0.1\n"
        self.check(replaced(IMPACT, (COOK, curve.format("", 200, 300) + curve.format(", RATE=100.", 250, 360))),
                   "set Strain rates = 0, 100 set Flow stresses = 200, 300; 250, 360")
        self.check(replaced(IMPACT, (COOK, curve.format("", 200, 300) + "*RATE DEPENDENT, TYPE=POWER LAW\n 40., 5.\n")),
                   "set Flow stresses = 200, 300 set Cowper-Symonds rate = 40 set Cowper-Symonds exponent = 5")

    def test_an_expansion_since_a_temperature(self):
        """α(T) (T - 20) grows from 0 to 1000 by 2e-5 980 + 1e-5 20, as the mean of its increments."""
        self.check(replaced(TIED, ("*EXPANSION\n 1.2E-5\n", "*EXPANSION, ZERO=20.\n 1E-5, 0.\n 2E-5, 1000.\n")),
                   "set Thermal expansion = -0.001: 1e-05, 0.001: 9.8e-06, 999.999: 2.98e-05, 1000.001: 2e-05")
        with self.assertRaisesRegex(DeckError, "the temperatures of an expansion must increase"):
            self.converted(replaced(TIED, ("*EXPANSION\n 1.2E-5\n", "*EXPANSION\n 1E-5, 5.\n 2E-5, 5.\n")), "deck.inp")

    def test_names_of_two_things_are_refused(self):
        for text, message in (("*MATERIAL, NAME=Copper\n*DENSITY\n 1E-9\n", r"two of \*MATERIAL called"),
                              ("*AMPLITUDE, NAME=Ramp\n 0., 0., 1., 1.\n", r"two of \*AMPLITUDE called")):
            with self.subTest(message), self.assertRaisesRegex(DeckError, message):
                self.converted(replaced(IMPACT, ("*STEP", text + "*STEP")), "deck.inp")

    def test_loads_of_a_step_begin_as_its_procedure_says(self):
        plain = TIED.replace(", AMPLITUDE=RAMP", "")
        self.check(plain, "set Function = 100 ", "set Function = free; free; -0.01 ", "set Function = 5 ")
        self.check(plain.replace("-DISPLACEMENT\n", "-DISPLACEMENT, STEADY STATE\n"), "set Function = 20 + 80*t",
                   "set Function = free; free; -0.01*t", "set Function = 5*t", "Steps of heat are steady",
                   "set Density = 7.85e-09", "set Specific heat capacity = 159000 ")
        for procedure, function in (("*STATIC\n 1., 1.\n", "10*t"), ("*VISCO\n 1., 1.\n", "10 "), ("*DYNAMIC\n 1., 1.\n", "10 ")):
            with self.subTest(procedure):
                self.check(replaced(IMPACT, (STEP, f"*STEP, NLGEOM\n{procedure}*DSLOAD\n TOP, P, 10.\n*END STEP\n")),
                           f"set Type = pressure set Function = {function}")

    def test_steps_of_heat_alone_have_no_mechanics(self):
        step = ("*STEP\n*HEAT TRANSFER\n 0.1, 1.\n*BOUNDARY\n FOOT, 11, 11, 300.\n*DSLOAD\n TOP, P, 10.\n*EL PRINT, ELSET=BAR\n S\n"
                "*END STEP\n")
        text = replaced(IMPACT, (STEP, step), ("*SPECIFIC HEAT", "*CONDUCTIVITY\n 300.,\n*SPECIFIC HEAT"))
        self.check(text, "set Model = heat conductor", "set Function = 300", "!set Function = 0", "!quasi-static",
                   "*BOUNDARY: all steps are *HEAT TRANSFER, and displacements are not used",
                   "*DSLOAD: all steps are *HEAT TRANSFER, so that this is left out",
                   "*INITIAL CONDITIONS: all steps are *HEAT TRANSFER, so that this is left out",
                   "*EL PRINT: all steps are *HEAT TRANSFER, so that this is left out",
                   "what the material has for mechanics is not used", runs=True)
        self.check(replaced(text, (" FOOT, 3, 3\n", " FOOT, 3, 999999999999\n")), "the degree of freedom 7 is not understood")
        self.check(TIED.replace("*COUPLED TEMPERATURE-DISPLACEMENT", "*HEAT TRANSFER"), "!Body contact: joint",
                   "*TIE: all steps are *HEAT TRANSFER, and bodies do not touch without mechanics here, so that this is left out")
        self.check(replaced(TIED, ("*COUPLED TEMPERATURE-DISPLACEMENT", "*HEAT TRANSFER, STEADY STATE")),
                   "set Stages = Heat, Press", "set End time = 1 set Time integration = quasi-static set Conditions = support 1, temp",
                   "other steps have mechanics, and here the body expands at rest", "STEADY STATE is not used")

    def test_stresses_of_integration_points(self):
        """In rows of CalculiX the second field is the number of a point."""
        def scene(stress):
            rows = "".join(f" {e}, {p}, {stress(e, p)}, 0., -8., 2., 0.5, 3.\n" for e in (1, 2) for p in (1, 3))
            text = replaced(IMPACT, (START, "*INITIAL CONDITIONS, TYPE=STRESS\n" + rows + "*INITIAL CONDITIONS, TYPE=TEMPERATURE\n ALL, 298.\n"))
            self.check(text, "set Stress = ", runs=True)
            return self.scene(text, "deck.inp")
        text, said = scene(lambda e, p: 7)
        self.assertIn("stress 1 set Stress = 7; 0; -8; 3; 0.5; 2", text)
        self.assertNotIn("mean stress", said)
        text, said = scene(lambda e, p: 10 * e + p)
        self.assertIn("set Where = z > -2e-06 && z < 1.000002 set Stress = 12; 0; -8; 3; 0.5; 2", text)
        self.assertIn("set Where = z > 0.999998 && z < 2.000002 set Stress = 22; 0; -8; 3; 0.5; 2", text)
        self.assertIn("an element has the mean stress of its points. (2 times)", said)


main()

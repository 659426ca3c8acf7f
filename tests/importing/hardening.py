#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Kinematic hardening of decks.

    hardening.py PROJECT_DIRECTORY PROGRAM
"""

from deck_testing import DeckTest, card, main, part_of, replaced, text_of

BAR, IMPACT, TIED = text_of("bar.k"), text_of("impact.inp"), text_of("tied.inp")
ELASTIC = BAR[BAR.index("*MAT_ELASTIC"):BAR.index("*NODE")]
PLASTIC = TIED[TIED.index("*PLASTIC"):TIED.index("*EXPANSION")]
COOK = IMPACT[IMPACT.index("*PLASTIC"):IMPACT.index("*SPECIFIC")]


class DynaHardening(DeckTest):
    def check(self, material, *parts):
        self.check_scene(replaced(BAR, (ELASTIC, material)), "deck.k", *parts)

    @staticmethod
    def kinematic(beta, tangent=21000):
        return "*MAT_PLASTIC_KINEMATIC\n" + card(1, "7.85E-9", 210000, 0.3, 300, tangent, beta) + "\n"

    def test_shares_of_kinematic_and_isotropic_hardening(self):
        # E ETAN/(E - ETAN) = 70000/3.
        self.check(self.kinematic(0), "set Model = chaboche", "set Yield stress = 300 set Hardening modulus = 0",
                   "set Back stress moduli = 23333.33333", "all keywords were used")
        self.check(self.kinematic(""), "set Model = chaboche", "set Back stress moduli = 23333.33333")
        self.check(self.kinematic(0.25), "set Model = chaboche", "set Hardening modulus = 5833.333333",
                   "set Back stress moduli = 17500 ")
        self.check(self.kinematic(1), "set Model = j2 plasticity", "set Hardening modulus = 23333.33333", "!Back stress")
        self.check(self.kinematic(0, 0), "set Model = j2 plasticity", "set Hardening modulus = 0", "!Back stress")

    def test_a_pull_along_the_tangent(self):
        """A bar that is pulled and pushed slowly: E and ETAN, and yield after twice the yield stress."""
        deck = replaced(BAR, (ELASTIC, self.kinematic(0)),
                        ("*CONTROL_TERMINATION\n   1.0E-06\n", "*CONTROL_TERMINATION\n" + card(2) +
                         "\n*CONTROL_IMPLICIT_GENERAL\n" + card(1, 0.1) + "\n*DATABASE_HISTORY_SOLID\n" + card(2) + "\n"),
                        (part_of(BAR, "*DEFINE_CURVE", "*BOUNDARY_PRESCRIBED"), "*DEFINE_CURVE\n" + card(1) + "\n" + "".join(
                            card(time, way, width=20) + "\n" for time, way in ((0, 0), (1, 0.04), (2, 0)))),
                        (card(1, 0, 1, 1, 1, 0, 0, 0), card(1, 0, 1) + "\n*BOUNDARY_SPC_NODE\n" + card(1, 0, 0, 1, 1) + "\n" +
                         card(2, 0, 0, 0, 1)))
        self.check_scene(deck, "deck.k", "set Model = chaboche", "set Time integration = quasi-static")
        code, printed = self.run_program("deck.prm")
        self.assertEqual(code, 0, printed)
        rows = self.rows("points.csv")
        peak, end = max(rows["solid 2 stress xx"]), rows["solid 2 stress xx"][-1]
        # Strain of 0.01: 300 + ETAN (0.01 - 300/E); back by 600/E elastically, then along ETAN.
        self.assertAlmostEqual(peak, 300 + 21000 * (0.01 - 300 / 210000), delta=5)
        self.assertAlmostEqual(end, peak - 600 - 21000 * (0.01 - 600 / 210000), delta=10)


class AbaqusHardening(DeckTest):
    def check(self, plastic, *parts, text=TIED, old=PLASTIC):
        self.check_scene(replaced(text, (old, plastic)), "deck.inp", *parts)

    def test_linear_hardening(self):
        self.check("*PLASTIC, HARDENING=KINEMATIC\n 300., 0.\n 400., 0.1\n", "set Model = chaboche",
                   "set Back stress moduli = 1000 set Recovery rates = 0", "set Yield stress = 300", "!hardening is isotropic")
        self.check("*PLASTIC, HARDENING=KINEMATIC\n 300., 0.\n", "set Model = j2 plasticity", "!hardening is isotropic")
        self.check("*PLASTIC, HARDENING=KINEMATIC\n 300., 0.\n 400., 0.1\n 450., 0.3\n", "set Model = j2 plasticity",
                   "HARDENING=KINEMATIC with more than two points of a temperature: hardening is isotropic here")

    def test_over_the_temperature(self):
        self.check("*PLASTIC, HARDENING=KINEMATIC\n 300., 0., 20.\n 400., 0.1, 20.\n 200., 0., 520.\n 250., 0.1, 520.\n",
                   "set Back stress moduli = 1000", "set Temperatures = 20, 520", "set Flow stresses = 300, 300; 200, 200",
                   "The moduli and rates of the back stress are those of the temperature 20")
        self.check("*PLASTIC, HARDENING=KINEMATIC\n 300., 0., 198.\n 400., 0.1, 198.\n 200., 0., 398.\n 250., 0.1, 398.\n",
                   "set Back stress moduli = 750", "set Yield stress = 250", "!set Temperatures",
                   "The constants of the hardening are those of the temperature 298",
                   "Plastic work does not heat: ADIABATIC is for isotropic hardening alone", text=IMPACT, old=COOK)

    def test_parameters_of_back_stresses(self):
        head = "*PLASTIC, HARDENING=COMBINED, DATA TYPE=PARAMETERS, NUMBER BACKSTRESSES="
        self.check(head + "2\n 200., 20000., 200., 1000., 0.\n", "set Back stress moduli = 20000, 1000",
                   "set Recovery rates = 200, 0", "set Yield stress = 200", "!is not used")
        # The words as Abaqus/CAE writes them.
        self.check("*Plastic, hardening=COMBINED, datatype=PARAMETERS, number backstresses=1\n 200., 20000., 200.\n"
                   "*Cyclic Hardening, parameters\n 200., 50., 10.\n",
                   "set Back stress moduli = 20000 set Recovery rates = 200",
                   "set Plastic strains = 0, 0.01, 0.02,", "set Flow stresses = 200, 204.7581291,")
        self.check(head + "4\n 200., 1., 1., 2., 2., 3., 3., 4.\n 4., 20.\n 100., 3., 3., 2., 2., 3., 3., 4.\n 4., 520.\n"
                   "*CYCLIC HARDENING\n 200., 0.\n 250., 0.5\n", "set Back stress moduli = 1, 2, 3, 4",
                   "set Recovery rates = 1, 2, 3, 4", "set Plastic strains = 0, 0.5", "set Flow stresses = 200, 250")
        for data in ("", ", DATA TYPE=STABILIZED"):
            self.check(f"*PLASTIC, HARDENING=COMBINED{data}\n 200., 0.\n 300., 0.1\n*CYCLIC HARDENING\n 200., 0.\n 250., 0.5\n",
                       "set Model = j2 plasticity", "hardening is isotropic here", "*CYCLIC HARDENING (1 time, line")

    def test_damage_goes_with_isotropic_hardening(self):
        self.check("*PLASTIC, HARDENING=KINEMATIC\n 300., 0.\n 400., 0.1\n*DAMAGE INITIATION, CRITERION=JOHNSON COOK\n"
                   " 0.5, 4.9, -3., 0.014, 1.12, 1356., 298., 1.\n", "*DAMAGE INITIATION goes with isotropic hardening alone",
                   "set Model = j2 plasticity", "set Flow stresses = 300, 301, 302, 305, 310, 320, 350, 400, 500, 800, 1300",
                   text=IMPACT, old=COOK)

    def test_what_is_wrong_is_refused(self):
        for plastic, message in (
                ("*PLASTIC, HARDENING=KINEMATIC\n 300., 0.\n 200., 0.1\n",
                 "kinematic hardening needs stresses that do not fall"),
                ("*PLASTIC, HARDENING=COMBINED, DATA TYPE=PARAMETERS, NUMBER BACKSTRESSES=4\n 1., 1.\n",
                 "has a yield stress, and"),
                ("*PLASTIC, HARDENING=COMBINED, DATA TYPE=PARAMETERS\n 0., 1., 1.\n", "the yield stress is larger than zero")):
            with self.subTest(message), self.assertRaises(Exception) as context:
                self.converted(replaced(TIED, (PLASTIC, plastic)), "deck.inp")
            self.assertIn(message, str(context.exception))


main()

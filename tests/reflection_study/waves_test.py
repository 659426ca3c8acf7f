#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""What returns from an interface agrees with closed forms and keeps energy; the operators are
adjoint in the masses.

usage: waves_test.py STRIP_OPERATORS TOMBOLO
"""

import math
import unittest
from dataclasses import replace
from itertools import product

import numpy
from cases import (ReflectionCase, into_particles, operators_of, out_of_particles, results_of,
                   read_programs)
from reflection.waves import LatticeWaves

DISCRETIZATIONS = (("paper", "paper"), ("fe matched", "paper"), ("affine", "paper"),
                   ("none", "paper"), ("fe matched", "trace"), ("affine", "trace"))
FILTER = {"filter_power": 4, "filter_strength": 0.5}


class Reflection(unittest.TestCase):
    def near(self, value, expected, tolerance):
        self.assertLess(abs(value - expected), tolerance, f"{value} is not {expected}")

    def test_of_elements_of_unequal_size_is_within_two_percent_of_the_exact_value(self):
        elements = "fully integrated hexahedron", "hexahedron", "lagrange hexahedron"
        cases = [ReflectionCase(element=element, spacing_ratio=ratio, poissons_ratio=0.3, wave=wave,
                                wavelength=wavelength)
                 for element, ratio, wave, wavelength in product(
                     elements, (2, 3, 1 / 2, 1 / 3), "PS", (10, 20))]
        for case, result in zip(cases, results_of(*cases)):
            with self.subTest(case=case):
                self.assertGreater(result.exact, 1e-3)
                self.near(result.reflection / result.exact, 1, 0.02)
                self.near(result.unsmoothed, result.reflection, 0.02 * result.reflection)

    def test_is_the_same_from_both_sides_at_one_frequency(self):
        # sin(k h/2)/h is the same.
        from_fine = 2 * math.pi / (6 * math.asin(math.sin(math.pi / 10) / 3))
        coarse, fine = results_of(ReflectionCase(spacing_ratio=1 / 3, wavelength=10),
                                  ReflectionCase(spacing_ratio=3, wavelength=from_fine))
        self.near(coarse.frequency, fine.frequency, 1e-6)
        self.near(coarse.reflection, fine.reflection, 1e-3 * coarse.reflection)

    def test_is_zero_without_an_interface(self):
        elements = ReflectionCase(wavelength=10, poissons_ratio=0.3, angle=math.pi / 6)
        particles = out_of_particles("affine", right="particles", is_one_part=True,
                                     angle=math.pi / 4, **FILTER)
        for result in results_of(elements, particles):
            self.assertLess(result.unsmoothed, 1e-10)

    def test_and_transmission_share_the_energy_of_the_incident_wave(self):
        case = into_particles("paper", poissons_ratio=0.3, wavelength=16, angle=math.pi / 6)
        for result in results_of(case, replace(case, wave="S")):
            self.assertGreater(result.total, 0.005)
            self.near(result.total**2 + result.transmitted_energy, 1, 1e-4)
            self.assertLess(result.fit_error, 1e-3)

    def test_from_particles_is_mostly_of_short_waves_that_the_filter_removes(self):
        without_filter, filtered = results_of(out_of_particles("affine"),
                                              out_of_particles("affine", **FILTER))
        self.assertGreater(without_filter.unsmoothed, 5 * without_filter.reflection)
        self.assertGreater(without_filter.unsmoothed, 0.01)
        self.assertLess(filtered.unsmoothed, 0.002)

    def test_of_cell_averages_is_a_tenth_of_a_percent(self):
        averages, paper = results_of(into_particles("affine", shape_functions="cell averages"),
                                     into_particles("paper"))
        print("reflected:", averages.reflection, "and", paper.reflection)
        self.assertLess(averages.reflection, 0.0012)
        self.assertLess(averages.reflection, 0.1 * paper.reflection)

    def test_of_a_wave_that_the_lattice_does_not_carry_is_not_a_number(self):
        # At the largest frequency of the paper's particles energy stands still.
        result, = results_of(out_of_particles("paper", wavelength=4.2))
        self.assertTrue(math.isnan(result.reflection))


class ReducedOperators(unittest.TestCase):
    def test_are_adjoint_in_the_masses(self):
        columns = numpy.arange(-30, 31)
        cases = [into_particles(*names, poissons_ratio=0.3, spacing_ratio=0.5)
                 for names in DISCRETIZATIONS]
        for case, operators in zip(cases, operators_of(cases)):
            strip, reduced = operators.strip, operators.reduce(0.7)
            alike = numpy.clip(columns, -strip.n_probed, strip.n_probed)
            masses = operators.masses[alike + strip.n_columns]
            mass, nodal_mass = numpy.repeat(masses[:, 0], 2)[:, None], masses[:, 1:].reshape(-1, 1)

            def difference(a, mass_of_a, b, mass_of_b):
                a, b = (operator.matrix(-30, 30).toarray() for operator in (a, b))
                return abs(mass_of_a * a - (mass_of_b * b).conj().T).max()

            with self.subTest(case=case):
                for a, mass_of_a, b, mass_of_b, tolerance in (
                        (reduced.update, mass, reduced.update, mass, 1e-12),
                        (reduced.short_wave_part, mass, reduced.short_wave_part, mass, 1e-13),
                        (reduced.smoothing, nodal_mass, reduced.interpolation, mass, 1e-13),
                        (reduced.stiffness, nodal_mass, reduced.stiffness, nodal_mass, 1e-12)):
                    self.assertLess(difference(a, mass_of_a, b, mass_of_b), tolerance)
                self.assertGreater(reduced.update.largest_entry(), 0.1)

    def test_leave_translations_alone(self):
        cases = [into_particles(*names) for names in DISCRETIZATIONS]
        translations, inside = numpy.tile(numpy.eye(2), (81, 1)), slice(2 * 20, -2 * 20)
        for case, operators in zip(cases, operators_of(cases)):
            reduced = operators.reduce(0)
            with self.subTest(case=case):
                for operator, factor in ((reduced.smoothing, 1), (reduced.update, 0),
                                         (reduced.short_wave_part, 0)):
                    error = operator.matrix(-40, 40) @ translations - factor * translations
                    self.assertLess(abs(error[inside]).max(), 1e-12)

    def test_of_a_strip_too_small_for_them_are_refused(self):
        operators, = operators_of([into_particles("affine")])
        strip = operators.strip
        responses = numpy.zeros(
            (2 * strip.n_probed + 1, 2, 2 * strip.n_columns + 1, strip.n_rows + 1, 2))
        first = strip.n_columns - strip.n_probed
        responses[0, 0, first, strip.middle] = 1
        operators.near(responses)
        responses[0, 0, first + strip.reach + 1] = 1e-9
        with self.assertRaisesRegex(Exception, "reaches farther than its strip"):
            operators.near(responses)
        operators.stiffness[0] *= 1 + 1e-9
        with self.assertRaisesRegex(Exception, "outer columns of the strip"):
            operators.check_far_columns(operators.stiffness)


class Waves(unittest.TestCase):
    def test_have_the_dispersion_of_the_lattice(self):
        operators, = operators_of([into_particles("paper")])
        reduced = operators.reduce(0)
        element_waves, particle_waves = (LatticeWaves(reduced.update, side, 1, 0, 0.1)
                                         for side in (-1, 1))
        phi = abs(reduced.smoothing.homogeneous(1).symbol(math.pi)[0, 0] - 1) / 4
        for k in (0.2, 0.5, 1):
            symbol = 1 - 2 * phi * (1 - math.cos(k))
            for waves, expected in ((element_waves, 2 * math.sin(k / 2)),
                                    (particle_waves, symbol * math.sin(k))):
                found = math.sqrt(waves.mode(k, "P").eigenvalue)
                self.assertAlmostEqual(found, expected, delta=1e-12)
        # Under central differences the group velocity is cos(k/2)/cos(ωΔt/2).
        mode = element_waves.mode(1, "P")
        expected = math.cos(0.5) / math.cos(0.05 * mode.frequency)
        self.assertAlmostEqual(mode.group_velocity, expected, delta=1e-8)
        # Every frequency has a physical and a short wave of P and of S type among particles.
        self.assertEqual(len(particle_waves.by_side(0.3)[1]), 4)
        self.assertEqual(len(element_waves.by_side(0.3)[1]), 2)


if __name__ == "__main__":
    read_programs()
    unittest.main()

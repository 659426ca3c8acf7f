#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""What holds, drives and loads a cantilever, and what passes through it: conditions.csv, sections.csv, parts.csv.

    conditions.py PROGRAM MPIEXEC motion|rest|tables|sections|ranks
"""

import csv
import math
import re
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "loaded"))
import loaded

PROGRAM, MPIEXEC, SUBJECT = sys.argv[1:4]
SCENE = Path(__file__).with_name("cantilever.prm").read_text("utf-8")
# Its end is driven instead of its weight.
DRIVEN = SCENE.replace("= wall, weight", "= wall, drive").replace("""subsection Condition: weight
  set Type     = gravity
  set Function = 0; -1e-3; 0
""", """subsection Condition: drive
  set Type     = velocity
  set Where    = x > 2 - 1e-9
  set Function = 0.01; free; free
""")
MASS, WEIGHT = 0.5, 0.5e-3
SMOOTHINGS = ("paper", "affine", "fe matched")


def elements_alone():
    return ["Part: tip/Formulation = fully integrated hexahedron"]


def graded_elements():
    """Elements of two sizes within the root and at the interface."""
    return [*elements_alone(), "Mesh/Refine where = x > 1 || y > 0.25"]


def particles_alone(smoothing):
    return ["Part: root/Formulation = momentum consistent particle",
            f"Part: root/momentum consistent particle/Smoothing = {smoothing}", *coupled(smoothing)]


# The lattice filter needs it.
PARTICLE_DILATATION = "Part: tip/momentum consistent particle/Dilatation = of particles"


def coupled(smoothing):
    return [f"Part: tip/momentum consistent particle/Smoothing = {smoothing}", PARTICLE_DILATATION]


def lattice_filter(power):
    return ["Plugin libraries = liblattice_filter.so", f"Lattice filter/Power = {power}"]


def cut(name, x=1., direction=1):
    """A section of the cantilever at x; its side is where the direction points to."""
    return [f"Section: {name}/Point = {x}, 0.25, 0.25", f"Section: {name}/Normal = {direction}, 0, 0"]


class Table:
    """Columns by their names without units."""

    def __init__(self, path):
        with open(path, newline="", encoding="utf-8") as file:
            rows = list(csv.reader(file))
        self.names = [re.sub(r" \[.*\]$", "", name) for name in rows[0]]
        self.columns = {name: [float(row[i]) if row[i] else math.nan for row in rows[1:]]
                        for i, name in enumerate(self.names)}

    def __getitem__(self, name):
        return self.columns[name]

    def vector(self, name, row):
        return [self[f"{name} {axis}"][row] for axis in "xyz"]


class Case(unittest.TestCase):
    def setUp(self):
        self.temporary = tempfile.TemporaryDirectory()
        self.addCleanup(self.temporary.cleanup)
        self.directory = Path(self.temporary.name)

    def run_scene(self, *settings, text=SCENE, ranks=1, name="output", options=()):
        output = self.directory / name
        scene = self.directory / "scene.prm"
        scene.write_text(text.replace("@OUTPUT@", str(output)), "utf-8")
        command = [MPIEXEC, "-n", str(ranks)] if ranks > 1 else []
        command += [*loaded.start_of(PROGRAM), str(scene), *options]
        command += [word for entry in settings for word in ("--set", entry)]
        return output, subprocess.run(command, env=loaded.environment(ranks), capture_output=True, text=True,
                                      check=False)

    def finish(self, *settings, **options):
        output, finished = self.run_scene(*settings, **options)
        self.assertEqual(finished.returncode, 0, finished.stdout + finished.stderr)
        return output

    def refusal(self, *settings, **options):
        _, finished = self.run_scene(*settings, **options)
        self.assertNotEqual(finished.returncode, 0)
        return finished.stderr

    def assert_near(self, one, other, tolerance, what=""):
        for a, b in zip(one, other):
            self.assertLess(abs(a - b), tolerance, f"{what}: {one} and {other}")


class Motion(Case):
    """Impulses, works, rows."""

    def check_impulses(self, settings, ranks=1):
        output = self.finish("Output/Statistics interval = 0.1", *settings, ranks=ranks)
        conditions, statistics = Table(output / "conditions.csv"), Table(output / "statistics.csv")
        scale = WEIGHT * 2
        row_of_step = {step: row for row, step in enumerate(conditions["step"])}
        self.assertGreaterEqual(len(statistics["step"]), 21)
        for row, step in enumerate(statistics["step"]):
            own = row_of_step[step]
            given = [a + b for a, b in zip(conditions.vector("wall impulse", own),
                                           conditions.vector("weight impulse", own))]
            self.assert_near(given, statistics.vector("momentum", row), 1e-12 * scale, settings)
        # The load has no other.
        self.assertAlmostEqual(conditions["weight impulse y"][-1] / (-WEIGHT * 2), 1, delta=0.05)
        return conditions

    def test_impulses_of_support_and_load_are_the_momentum_of_elements(self):
        self.check_impulses(elements_alone())

    def test_impulses_of_support_and_load_are_the_momentum_of_particles(self):
        for smoothing in SMOOTHINGS:
            self.check_impulses(particles_alone(smoothing))

    def test_impulses_of_support_and_load_are_the_momentum_of_a_coupled_body(self):
        for smoothing in SMOOTHINGS:
            self.check_impulses(coupled(smoothing))
        self.check_impulses([*coupled("paper"), *lattice_filter(4)])

    def test_weight_is_the_mass_times_gravity_and_acts_in_the_middle(self):
        conditions = self.check_impulses(elements_alone())
        self.assertAlmostEqual(conditions["weight mean force y"][-1] / -WEIGHT, 1, places=10)
        self.assertAlmostEqual(conditions["weight mean moment z"][-1] / -WEIGHT, 1, places=4)
        self.assertAlmostEqual(conditions["weight mean moment x"][-1] / (0.25 * WEIGHT), 1, places=4)

    def test_moments_are_about_the_given_point(self):
        output = self.finish(*elements_alone(), "Output/condition history/Moments about = 1, 0.25, 0.25")
        conditions = Table(output / "conditions.csv")
        for axis in "xyz":
            self.assertLess(abs(conditions[f"weight mean moment {axis}"][-1]), 1e-4 * WEIGHT)

    def test_work_and_displacement_of_a_drive(self):
        for settings in (elements_alone(), particles_alone("paper"), particles_alone("affine"),
                         [*coupled("paper"), *lattice_filter(4)]):
            output = self.finish(*settings, text=DRIVEN)
            conditions, statistics = Table(output / "conditions.csv"), Table(output / "statistics.csv")
            self.assertAlmostEqual(conditions["drive mean displacement x"][-1], 0.02)
            self.assert_near(conditions.vector("wall mean displacement", -1), [0, 0, 0], 1e-15)
            self.assertGreater(conditions["drive work"][-1], 0)
            works = conditions["drive work"][-1] + conditions["wall work"][-1]
            self.assertAlmostEqual(works / statistics["external work"][-1], 1, places=10)
            self.assertGreater(conditions["drive mean force x"][-1], 0)
            self.assertLess(conditions["wall mean force x"][-1], 0)

    def test_probes_of_a_boundary_move_as_it_is_driven(self):
        names = []
        for ranks in (1, 2):
            output = self.finish("Output/probes/Boundary = x max", "Output/probes/Where = y > 1e-9",
                                 "Output/probes/Columns = * displacement x, * position *", *elements_alone(),
                                 text=DRIVEN, ranks=ranks)
            probes = Table(output / "probes.csv")
            names.append(probes.names)
            moved = [probes[name][-1] for name in probes.names if name.endswith("displacement x")]
            self.assertGreater(len(moved), 3)
            self.assert_near(moved, [0.02] * len(moved), 1e-12)
            self.assertGreater(min(probes[name][0] for name in probes.names if name.endswith("position y")), 1e-9)
        self.assertEqual(*names)
        self.assertIn("The mesh has no boundary \"tip\"",
                      self.refusal("Output/probes/Boundary = tip"))

    def test_a_scene_without_conditions_of_mechanics_has_no_table_of_them(self):
        text = SCENE.replace("= wall, weight", "=")
        text = re.sub(r"subsection Condition: .*?\nend\n", "", text, flags=re.S)
        text = re.sub(r"  subsection condition history.*?  end\n", "", text, flags=re.S)
        output = self.finish(text=text)
        self.assertFalse((output / "conditions.csv").exists())

    def test_energies_of_the_parts_add_up(self):
        for settings, ranks in (((), 1), (graded_elements(), 1), (graded_elements(), 3)):
            output = self.finish("Output/Further outputs = part history",
                                 "Output/part history/Steps between rows = 1", *settings, ranks=ranks)
            parts, statistics = Table(output / "parts.csv"), Table(output / "statistics.csv")
            self.assertAlmostEqual(parts["root mass"][-1] + parts["tip mass"][-1], MASS)
            elastic = parts["root elastic energy"][-1] + parts["tip elastic energy"][-1]
            self.assertAlmostEqual(elastic / statistics["elastic energy"][-1], 1, places=12)
            momentum = parts["root momentum y"][-1] + parts["tip momentum y"][-1]
            self.assertAlmostEqual(momentum / statistics["momentum y"][-1], 1, places=10)
            kinetic = parts["root kinetic energy"][-1] + parts["tip kinetic energy"][-1]
            self.assertAlmostEqual(kinetic / statistics["kinetic energy"][-1], 1, delta=0.05)

    def test_rows_of_the_statistics_come_in_their_own_interval(self):
        output = self.finish("Output/Statistics interval = 0.25", "Output/Number = 2",
                             "Output/Write solution = true")
        times = Table(output / "statistics.csv")["time"]
        self.assertEqual(len(times), 9)
        for i, time in enumerate(times):
            self.assertGreaterEqual(time, 0.25 * i - 1e-6)
            self.assertLess(time, 0.25 * i + 0.1)
        self.assertEqual((output / "solution.pvd").read_text("utf-8").count("cells_"), 3)
        self.assertIn("at most 1000000 are allowed", self.refusal("Output/Statistics interval = 1e-9"))

    def test_what_switches_itself_is_refused_among_further_outputs(self):
        message = self.refusal("Output/Further outputs = condition history")
        self.assertIn("conditions of mechanics", message)
        message = self.refusal("Output/condition history/Moments about = 1, 2")
        self.assertIn("Moments about", message)


class Rest(Case):
    """Damping, and what is left when nothing moves any more."""

    def check_rest(self, settings, ranks=1, energy=1e-18, force=1e-10, moment=1e-10):
        # The first bending mode of the beam has ω ≈ 1.015 h/L² √(E/ρ) ≈ 1.3.
        output = self.finish("Damping/Rate = 2.5", "End time = 40", *settings, ranks=ranks)
        conditions, statistics = Table(output / "conditions.csv"), Table(output / "statistics.csv")
        self.assertLess(statistics["kinetic energy"][-1], energy * statistics["elastic energy"][-1])
        for what, tolerance in (("mean force", force), ("mean moment", moment)):
            support = conditions.vector(f"wall {what}", -1)
            load = conditions.vector(f"weight {what}", -1)
            self.assert_near(support, [-component for component in load], tolerance * WEIGHT, f"{settings} {what}")
        self.assertLess(abs(statistics["energy error"][-1]), 1e-3)
        return output

    def test_a_cantilever_at_rest_has_the_force_and_moment_of_its_load_at_the_support(self):
        self.check_rest(elements_alone())
        self.check_rest(["Part: tip/Formulation = hexahedron", "Part: root/Formulation = hexahedron"])

    def test_a_coupled_cantilever_at_rest_has_the_force_and_moment_of_its_load_at_the_support(self):
        # The shortest waves of particles are not damped, since damping acts on smoothed velocities:
        # the lattice filter removes them.
        for smoothing, ranks in (("affine", 1), ("paper", 2), ("fe matched", 1)):
            self.check_rest([*coupled(smoothing), *lattice_filter(1)], ranks=ranks)

    def test_damping_slows_a_free_body_down_as_an_exponential_and_takes_its_energy(self):
        text = SCENE.replace("= wall, weight", "=\nset Initial conditions = flight")
        text = re.sub(r"subsection Condition: .*?\nend\n", "", text, flags=re.S)
        text = re.sub(r"  subsection condition history.*?  end\n", "", text, flags=re.S)
        text += "\nsubsection Initial condition: flight\n  set Velocity = 0.3; 0; 0.4\nend\n"
        for settings in (elements_alone(), coupled("paper"), coupled("affine")):
            output = self.finish(*settings, "Damping/Rate = if(t < 1, 0.5, 0)", "Time step/Maximum = 0.002",
                                 text=text)
            statistics = Table(output / "statistics.csv")
            start = 0.5 * MASS * 0.25
            self.assertAlmostEqual(statistics["momentum x"][-1] / (MASS * 0.3), math.exp(-0.5), places=3)
            self.assertAlmostEqual(statistics["mass damping"][-1] / (start * (1 - math.exp(-1))), 1, delta=2e-3)
            self.assertLess(abs(statistics["energy error"][-1]), 1e-12)
            self.assertLess(statistics["momentum drift"][-1], 1e-12)

    def test_without_a_rate_there_is_no_damping(self):
        output = self.finish("End time = 0.2")
        self.assertNotIn("mass damping", Table(output / "statistics.csv").names)

    def test_rates_that_are_none_are_refused(self):
        self.assertIn("at least 0", self.refusal("Damping/Rate = -1"))
        self.assertIn("a function of t alone", self.refusal("Damping/Rate = x"))
        self.assertIn("Damping", self.refusal("Damping/Ratio = 1"))


class Sections(Case):
    """Forces through cuts and interfaces, works of single loads."""

    # A force at the tip instead of the weight.
    PUSHED = SCENE.replace("= wall, weight", "= wall, push").replace("""subsection Condition: weight
  set Type     = gravity
  set Function = 0; -1e-3; 0
""", """subsection Condition: push
  set Type     = traction
  set Where    = x > 2 - 1e-9
  set Function = 1e-3; -2e-3; 5e-4
""")
    SECTIONS = ["Sections = middle, joint", *cut("middle"), "Section: joint/Between parts = root, tip",
                "Section: joint/Point = 1, 0.25, 0.25", "Output/section history/Steps between rows = 1"]

    def tables(self, *settings, **options):
        output = self.finish(*settings, **options)
        return Table(output / "sections.csv"), Table(output / "conditions.csv"), Table(output / "statistics.csv")

    def test_at_rest_a_section_has_the_force_and_moment_of_the_load(self):
        for settings, ranks in ((elements_alone(), 1), (graded_elements(), 2), (coupled("affine"), 1),
                                (coupled("paper"), 2)):
            sections, conditions, statistics = self.tables(
                "Damping/Rate = 2.5", "End time = 40", *lattice_filter(1), *settings, *self.SECTIONS,
                "Output/condition history/Moments about = 1, 0.25, 0.25", text=self.PUSHED, ranks=ranks)
            self.assertLess(statistics["kinetic energy"][-1], 1e-18 * statistics["elastic energy"][-1])
            load = max(map(abs, conditions.vector("push mean force", -1)))
            for name in ("middle", "joint"):
                for what in ("mean force", "mean moment"):
                    passed = sections.vector(f"{name} {what}", -1)
                    given = conditions.vector(f"push {what}", -1)
                    self.assert_near(passed, [-component for component in given], 1e-10 * load,
                                     f"{settings} {name} {what}")

    def test_in_static_steps_a_section_has_the_force_and_moment_of_the_load(self):
        """Also of particles with all their defaults, whose surface damping has nothing to do there."""
        for settings, ranks in ((elements_alone(), 1), (particles_alone("affine"), 2), (coupled("affine"), 1)):
            sections, conditions, statistics = self.tables(
                "Time integration = quasi-static", "Statics/Largest step = 0.5", *settings, *self.SECTIONS,
                "Output/condition history/Moments about = 1, 0.25, 0.25", text=self.PUSHED, ranks=ranks)
            load = 1e-3 * 0.25
            self.assertAlmostEqual(conditions["push mean force x"][-1] / load, 1, delta=0.01)
            self.assertLess(max(statistics["energy error"]), 1e-6)
            for name in ("middle", "joint"):
                for what in ("mean force", "mean moment"):
                    for row in range(1, len(sections["step"])):
                        passed = sections.vector(f"{name} {what}", row)
                        given = conditions.vector(f"push {what}", row)
                        self.assert_near(passed, [-component for component in given], 1e-7 * load,
                                         f"{settings} {name} {what}")
            self.assert_near(sections.vector("middle impulse", -1),
                             [-value for value in conditions.vector("push impulse", -1)], 1e-7 * load)

    def test_in_static_steps_tables_have_a_last_row(self):
        output = self.finish("Time integration = quasi-static", "Statics/Largest step = 0.5", *elements_alone(),
                             *self.SECTIONS[:-1], "Output/condition history/Steps between rows = 10",
                             "Output/Further outputs = part history", text=self.PUSHED)
        for name in ("conditions.csv", "sections.csv", "parts.csv"):
            self.assertEqual(Table(output / name)["time"], [0., 2.], name)

    def test_in_motion_impulses_of_section_and_load_are_the_momentum_beyond_the_section(self):
        # All but the nodes of the wall, which do not move.
        settings = ["Sections = root", *cut("root", 0.1), "Output/section history/Steps between rows = 1",
                    "Output/Statistics interval = 0.1", "Damping/Rate = 0"]
        # Particles without smoothing, too: with it, some momentum passes across.
        undamped = "Surface damping/Coefficient = 0"
        for part_settings, ranks in ((elements_alone(), 1), (elements_alone(), 2), (elements_alone(), 3),
                                     ([*particles_alone("none"), undamped], 1), ([*coupled("none"), undamped], 2)):
            sections, conditions, statistics = self.tables(*part_settings, *settings, text=self.PUSHED, ranks=ranks)
            row_of_step = {step: row for row, step in enumerate(conditions["step"])}
            scale = max(map(abs, statistics["momentum y"]))
            self.assertGreater(scale, 1e-5)
            for row, step in enumerate(statistics["step"]):
                own = row_of_step[step]
                given = [a + b for a, b in zip(sections.vector("root impulse", own),
                                               conditions.vector("push impulse", own))]
                self.assert_near(given, statistics.vector("momentum", row), 1e-12 * scale, f"{part_settings} {ranks}")

    def test_in_motion_the_cut_along_an_interface_has_its_force(self):
        for settings, ranks in ((elements_alone(), 3), (graded_elements(), 3), (particles_alone("affine"), 1),
                                (coupled("paper"), 2),
                                (coupled("affine"), 1), ([*coupled("paper"), "Coupling/Bridge = trace"], 2)):
            sections, _, _ = self.tables(*settings, *self.SECTIONS, text=self.PUSHED, ranks=ranks)
            scale = max(map(abs, sections["middle mean force y"]))
            self.assertGreater(scale, 1e-5)
            for axis in "xyz":
                self.assert_near(sections[f"middle mean force {axis}"], sections[f"joint mean force {axis}"],
                                 1e-11 * scale, f"{settings} {axis}")

    def test_both_sides_of_a_cut_feel_the_opposite(self):
        settings = ["Sections = tip, root", *cut("tip", 1.1), *cut("root", 1.1, -1)]
        for smoothing in SMOOTHINGS:
            sections, _, _ = self.tables(*particles_alone(smoothing), *settings, text=self.PUSHED)
            scale = max(map(abs, sections["tip mean force y"]))
            self.assertGreater(scale, 1e-5)
            for axis in "xyz":
                for one, other in zip(sections[f"tip mean force {axis}"], sections[f"root mean force {axis}"]):
                    self.assertLess(abs(one + other), 1e-11 * scale)

    def test_half_of_a_symmetric_body_passes_half_of_the_force(self):
        text = self.PUSHED.replace("1e-3; -2e-3; 5e-4", "1e-3; -2e-3; 0")
        half = text.replace("2, 0.5, 0.5", "2, 0.5, 0.25").replace("8, 2, 2", "8, 2, 1").replace(
            "= wall, push", "= wall, push, middle plane")
        half += "\nsubsection Condition: middle plane\n  set Type = symmetry\n  set Where = z > 0.25 - 1e-9\nend\n"
        for settings in (elements_alone(), particles_alone("paper"), coupled("affine")):
            whole_conditions, _, _ = self.tables(*settings, *self.SECTIONS, "Time step/Maximum = 0.005", text=text)
            half_conditions, _, _ = self.tables(*settings, *self.SECTIONS, "Time step/Maximum = 0.005", text=half)
            for name in ("middle", "joint"):
                for axis in "xy":
                    whole, part = (table[f"{name} mean force {axis}"][-1] for table in (whole_conditions, half_conditions))
                    self.assertAlmostEqual(2 * part / whole, 1, places=8, msg=f"{settings} {name} {axis}")
                self.assertLess(abs(whole_conditions[f"{name} mean force z"][-1]), 1e-15)

    def test_where_cuts_one_of_several_members(self):
        output, finished = self.run_scene(*elements_alone(), "Sections = lower", *cut("lower"),
                                          "Section: lower/Where = y < 0.1", text=self.PUSHED)
        self.assertEqual(finished.returncode, 0, finished.stderr)
        self.assertIn("in 8 cells away from the plane too", " ".join((finished.stdout + finished.stderr).split()))
        self.assertIn("lower mean force x", Table(output / "sections.csv").names)
        # A body cut free at the wall by a predicate alone: what the wall's layer of cells passes on.
        free, _, _ = self.tables(*elements_alone(), "Sections = free, plane", "Section: free/Where = x > 0.1",
                                 "Section: free/Point = 0.1, 0.25, 0.25", *cut("plane", 0.1), text=self.PUSHED)
        for what in ("mean force x", "mean force y", "mean moment z"):
            self.assertEqual(free[f"free {what}"], free[f"plane {what}"])

    def test_a_section_in_two_dimensions_has_force_and_moment_in_the_plane(self):
        text = (self.PUSHED.replace("Dimension        = 3", "Dimension = 2").replace("2, 0.5, 0.5", "2, 0.5")
                .replace("8, 2, 2", "8, 2").replace("1e-3; -2e-3; 5e-4", "1e-3; -2e-3"))
        sections, _, _ = self.tables("Sections = middle", "Section: middle/Point = 1, 0.25",
                                     "Section: middle/Normal = 1, 0", text=text)
        self.assertEqual([name for name in sections.names if "middle" in name],
                         ["middle mean force x", "middle mean force y", "middle mean moment z", "middle impulse x",
                          "middle impulse y"])

    def test_sections_that_are_none_are_refused(self):
        for settings, words in (
                ((), ("needs `Normal`",)),
                (("Section: a/Normal = 1, 0, 0",), ("Normal", "needs `Point`")),
                (cut("a", 3), ("cuts no cell", "no node")),
                (cut("a", -1), ("cuts no cell", "whole bodies")),
                (("Section: a/Where = x > 5",), ("Where", "cuts no cell")),
                (("Section: a/Normal = 0, 0, 0", "Section: a/Point = 1, 0, 0"), ("Normal", "length above zero")),
                (("Section: a/Between parts = root, tap",), ('no part "tap"', 'did you mean "tip"')),
                (("Section: a/Between parts = root",), ("names of two parts",)),
                (("Section: a/Between parts = root, tip", "Section: a/Where = x > 1"), ("no predicate",))):
            message = " ".join(self.refusal("Sections = a", *settings).split())
            for word in words:
                self.assertIn(word, message)
            self.assertFalse((self.directory / "output" / "sections.csv").exists())
        self.assertIn("Sections", self.refusal("Output/Further outputs = section history"))

    def test_works_of_single_loads_are_the_external_work(self):
        text = self.PUSHED.replace("= wall, push", "= wall, push, weight")
        text += "\nsubsection Condition: weight\n  set Type = gravity\n  set Function = 0; -1e-3*t; 0\nend\n"
        for settings, ranks in ((elements_alone(), 2), (particles_alone("paper"), 1), (coupled("affine"), 2),
                                (particles_alone("affine"), 1), (coupled("fe matched"), 1)):
            output = self.finish(*settings, text=text, ranks=ranks)
            conditions, statistics = Table(output / "conditions.csv"), Table(output / "statistics.csv")
            works = [conditions[f"{name} work"][-1] for name in ("wall", "push", "weight")]
            self.assertAlmostEqual(sum(works) / statistics["external work"][-1], 1, places=10, msg=settings)
            self.assertGreater(works[1], works[2])
            self.assertGreater(works[2], 0)
            output = self.finish(*settings, text=self.PUSHED, ranks=ranks)
            alone, statistics = Table(output / "conditions.csv"), Table(output / "statistics.csv")
            total = alone["push work"][-1] + alone["wall work"][-1]
            self.assertAlmostEqual(total / statistics["external work"][-1], 1, places=10, msg=settings)


class Tables(Case):
    """Pressure, gravity and functions from files."""

    PRESSED = SCENE.replace("= wall, weight", "= push\nset Initial conditions = spin")
    PRESSED = re.sub(r"subsection Condition: wall.*?\nend\n", "", PRESSED, flags=re.S)
    PRESSED = re.sub(r"subsection Condition: weight.*?\nend\n", """subsection Condition: push
  set Type     = pressure
  set Where    = x > 2 - 1e-9
  set Function = 1e-3
end
subsection Initial condition: spin
  set Velocity = -(y - 0.25); x - 1; 0
end
""", PRESSED, flags=re.S)

    def test_a_pressure_follows_the_face_it_acts_on(self):
        for settings in (elements_alone(), coupled("affine")):
            output = self.finish(*settings, "End time = 1.5", text=self.PRESSED)
            conditions, statistics = Table(output / "conditions.csv"), Table(output / "statistics.csv")
            for row, time in enumerate(conditions["time"]):
                if row == 0:
                    continue
                force = conditions.vector("push mean force", row)
                size = math.hypot(force[0], force[1])
                self.assertAlmostEqual(size / (1e-3 * 0.25), 1, delta=0.1)
                # It turns with the body, by an angle of about t.
                angle = math.atan2(-force[1], -force[0])
                self.assertAlmostEqual(angle, time, delta=0.15)
                self.assertLess(abs(force[2]), 1e-6)
            self.assertLess(abs(statistics["energy error"][-1]), 1e-3)

    def test_a_pressure_all_around_a_body_has_no_resultant(self):
        # Loads on particles act at Φ x, which is near x.
        for settings, ranks, moment in ((elements_alone(), 1, 1e-14), (coupled("affine"), 1, 1e-7),
                                        (coupled("paper"), 2, 1e-7)):
            output = self.finish(*settings, "Condition: push/Where = x > -1", "End time = 1.5", text=self.PRESSED,
                                 ranks=ranks)
            conditions = Table(output / "conditions.csv")
            for axis in "xyz":
                self.assertLess(max(map(abs, conditions[f"push mean force {axis}"])), 1e-14)
                self.assertLess(max(map(abs, conditions[f"push mean moment {axis}"])), moment)
            self.assertLess(Table(output / "statistics.csv")["momentum drift"][-1], 1e-12)

    def test_a_pressure_pushes_against_the_outward_normal(self):
        output = self.finish(*elements_alone(), "Initial condition: spin/Velocity = 0; 0; 0", "End time = 0.1",
                             text=self.PRESSED)
        self.assertAlmostEqual(Table(output / "conditions.csv")["push mean force x"][-1], -1e-3 * 0.25, places=7)

    def test_a_pressure_in_two_dimensions_follows_its_face(self):
        text = (self.PRESSED.replace("Dimension        = 3", "Dimension = 2").replace("2, 0.5, 0.5", "2, 0.5")
                .replace("8, 2, 2", "8, 2").replace("x - 1; 0", "x - 1"))
        output = self.finish("Condition: push/Where = x > -1", "End time = 1", text=text)
        conditions = Table(output / "conditions.csv")
        for axis in "xy":
            self.assertLess(max(map(abs, conditions[f"push mean force {axis}"])), 1e-14)
        output = self.finish(*elements_alone(), "Initial condition: spin/Velocity = 0; 0", "End time = 0.1", text=text)
        self.assertAlmostEqual(Table(output / "conditions.csv")["push mean force x"][-1], -1e-3 * 0.5, places=7)

    def test_a_function_can_be_a_table_of_a_file(self):
        (self.directory / "load.csv").write_text("time, factor\n# a comment\n0, 0\n0.5, 2\n1.5, 1\n", "utf-8")
        table_output = self.finish("Condition: weight/Function = 0; -1e-3*table(load.csv, t); 0", name="table")
        formula_output = self.finish("Condition: weight/Function = 0; "
                                     "-1e-3*if(t < 0.5, 4*t, if(t < 1.5, 2.5 - t, 1)); 0", name="formula")
        one, other = Table(table_output / "conditions.csv"), Table(formula_output / "conditions.csv")
        for name in one.names:
            scale = max(map(abs, other[name])) + 1e-12
            self.assert_near(one[name], other[name], 1e-9 * scale, name)

    def test_tables_that_are_none_are_refused_with_their_line(self):
        table = self.directory / "load.csv"
        function = "Condition: weight/Function = 0; table(load.csv, t); 0"
        for text, words in (("0, 0\n1, 1\n1, 2\n", ("load.csv", "line 3", "must rise")),
                            ("0, 0\n1,\n2, 2\n", ("line 2", "the value is missing")),
                            ("0, 0\n1, one\n", ("line 2", '"one" is not a finite number')),
                            ("0, 0, 0\n1, 1, 1\n", ("line 1", "two numbers")),
                            ("0, 0\n", ("two points",)), ("", ("empty",))):
            table.write_text(text, "utf-8")
            for ranks in (1, 2):
                message = self.refusal(function, ranks=ranks)
                for word in words:
                    self.assertIn(word, message)
        table.unlink()
        self.assertIn("There is no such file", self.refusal(function))
        self.assertIn("table(FILE, ARGUMENT)", self.refusal("Condition: weight/Function = 0; table(t); 0"))

    def test_gravity_and_pressure_refuse_what_they_do_not_have(self):
        self.assertIn("acts on the volume", self.refusal("Condition: weight/Boundary = x max"))
        self.assertIn("3 components", self.refusal("Condition: weight/Function = -9.81"))
        self.assertIn("one expression is needed", self.refusal("Condition: push/Function = 1; 2; 3", text=self.PRESSED))


class Ranks(Case):
    """The same on several ranks, and when resumed."""

    SETTINGS = ("Output/Further outputs = part history", "Output/Statistics interval = 0.3",
                *lattice_filter(4), "Damping/Rate = if(t < 0.7, 0.3, 0)",
                "End time = 1", *Sections.SECTIONS, "Conditions = wall, weight, push")
    TABLES = ("conditions.csv", "sections.csv", "parts.csv", "statistics.csv")
    SCENE = SCENE + """
subsection Condition: push
  set Type     = traction
  set Where    = x > 2 - 1e-9
  set Function = 0; 0; 1e-4*sin(5*t)
end
"""

    def test_tables_are_the_same_on_several_ranks(self):
        first = self.finish(*self.SETTINGS, *coupled("paper"), name="one", text=self.SCENE)
        for ranks in (2, 3):
            other = self.finish(*self.SETTINGS, *coupled("paper"), ranks=ranks, name=f"on {ranks}", text=self.SCENE)
            for name in self.TABLES:
                a, b = Table(first / name), Table(other / name)
                self.assertEqual(a.names, b.names)
                for column in a.names:
                    if "drift" in column or "error" in column:
                        continue
                    scale = max(map(abs, a[column])) + 1e-9
                    self.assert_near(a[column], b[column], 1e-7 * scale, f"{name} {column}")

    def test_a_resumed_run_has_the_same_tables_bit_by_bit(self):
        for ranks, further in ((1, coupled("paper")), (2, coupled("affine")), (1, particles_alone("paper"))):
            settings = (*self.SETTINGS, *further, "Checkpoint/Step interval = 13", "Checkpoint/Keep = 1000")
            whole = self.finish(*settings, ranks=ranks, name=f"whole {ranks}", text=self.SCENE)
            checkpoints = sorted((whole / "checkpoint").glob("*.h5"))
            before = {name: (whole / name).read_bytes() for name in self.TABLES}
            for checkpoint in checkpoints[1:-1:2]:
                self.finish(*settings, ranks=ranks, name=f"whole {ranks}", text=self.SCENE,
                            options=(f"--resume={checkpoint}",))
                for name in self.TABLES:
                    self.assertEqual((whole / name).read_bytes(), before[name], f"{checkpoint} {name}")


if __name__ == "__main__":
    del sys.argv[1:]
    names = {"motion": Motion, "rest": Rest, "tables": Tables, "sections": Sections, "ranks": Ranks}
    suite = unittest.defaultTestLoader.loadTestsFromTestCase(names[SUBJECT])
    sys.exit(not unittest.TextTestRunner().run(suite).wasSuccessful())

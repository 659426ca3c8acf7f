#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""What the program prints before and after a run: warnings, advice, where the results are, and whose results it replaces.

    advice.py PROGRAM MPIEXEC SOURCE_DIRECTORY
"""

import itertools
import json
import os
import re
import shutil
import sys
import unittest

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import command_line
import run_cases

PARTICLES = "Part: block/momentum consistent particle/"


def subdivided_tetrahedra(n):
    """A VTK file of a unit cube of n^3 cubes, each of six tetrahedra, each of four hexahedra."""
    numbers, cells = {}, []

    def number(*corners):
        point = tuple(sum(corner[d] for corner in corners) / len(corners) / n for d in range(3))
        return numbers.setdefault(tuple(round(x, 9) for x in point), len(numbers))

    for cube in itertools.product(range(n), repeat=3):
        for axes in itertools.permutations(range(3)):
            tetrahedron = [cube]
            for axis in axes:
                tetrahedron.append(tuple(x + (d == axis) for d, x in enumerate(tetrahedron[-1])))
            is_even = axes in ((0, 1, 2), (1, 2, 0), (2, 0, 1))
            for k in range(4):
                a, b, c = [other for other in range(4) if other != k]
                if is_even == (k % 2 == 1):
                    b, c = c, b
                v, a, b, c = (tetrahedron[i] for i in (k, a, b, c))
                cells.append([number(v), number(v, a), number(v, a, b), number(v, b), number(v, c), number(v, a, c),
                              number(v, a, b, c), number(v, b, c)])
    text = "# vtk DataFile Version 3.0\nblock\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS %d double\n" % len(numbers)
    text += "".join("%r %r %r\n" % point for point in numbers)
    text += "CELLS %d %d\n" % (len(cells), 9 * len(cells))
    text += "".join("8 " + " ".join(map(str, cell)) + "\n" for cell in cells)
    return text + "CELL_TYPES %d\n" % len(cells) + "12\n" * len(cells)


BLOCK = """set Title            = Block
set Parts            = block
set Materials        = soft
set Conditions       = pull
set End time         = 10
set Output directory = output
subsection Mesh
  set Type = file
  subsection file
    set File = block.vtk
  end
end
subsection Part: block
  set Cells       = all
  set Formulation = momentum consistent particle
  set Material    = soft
end
subsection Material: soft
  set Model = elastic
  subsection elastic
    set Density         = 1
    set Young's modulus = 1
    set Poisson's ratio = 0.3
  end
end
subsection Condition: pull
  set Where    = x < 1e-9
  set Type     = traction
  set Function = 1e-3*t; 0; 0
end
"""


class PatchTest(command_line.Case):
    def defect(self, *settings, ranks=1):
        self.write("block.vtk", subdivided_tetrahedra(2))
        self.write("block.prm", BLOCK)
        options = [part for setting in settings for part in ("--set", setting)]
        printed = self.run_program("--dry-run", "block.prm", *options, ranks=ranks)
        return float(re.search(r", patch-test defect ([^ ,\n]+)", printed).group(1)), printed

    def test_the_defect_is_printed_and_the_entry_that_cures_it_advised(self):
        least_squares, printed = self.defect(PARTICLES + "Shape functions = moving least squares")
        self.assertGreater(least_squares, 0.05)
        self.assertIn("Advice: `Shape functions = cell averages` in the section of part \"block\"", printed)
        self.assertIn("%.3g %%" % (100 * least_squares), printed)
        other, _ = self.defect(PARTICLES + "Shape functions = moving least squares", ranks=3)
        self.assertAlmostEqual(least_squares, other, delta=1e-5)

    def test_cell_averages_have_none(self):
        for ranks in (1, 2):
            defect, printed = self.defect(ranks=ranks)
            self.assertLess(defect, 1e-12)
            self.assertNotIn("Advice: `Shape", printed)

    def test_only_what_the_scene_admits_is_advised(self):
        defect, printed = self.defect(PARTICLES + "Smoothing = fe matched")
        self.assertGreater(defect, 0.01)
        self.assertNotIn("Advice: `Shape", printed)

    def test_other_smoothings_of_elastic_particles_than_affine_are_advised_against(self):
        for smoothing, piece in (("paper", "`paper` damps waves"), ("fe matched", "a surface that a load leaves rings on"),
                                 ("phase", "rings on"), ("affine", ""), ("none", "")):
            _, printed = self.defect(PARTICLES + "Smoothing = " + smoothing)
            self.assertEqual(printed.count("Advice: `Smoothing = affine` in the section of part \"block\": "), 1 if piece else 0)
            self.assertIn(piece, printed)

    def test_the_dilatation_of_cells_is_advised_where_particles_lock(self):
        nearly_incompressible, dilatation = "Material: soft/elastic/Poisson's ratio = 0.49", PARTICLES + "Dilatation = of particles"
        for settings, count in (((nearly_incompressible,), 0), ((dilatation,), 0),
                                ((nearly_incompressible, dilatation), 1),
                                ((nearly_incompressible, PARTICLES + "Smoothing = fe matched"), 1)):
            _, printed = self.defect(*settings)
            self.assertEqual(printed.count("Advice: `Dilatation = of cells` in the section of part \"block\": "), count, settings)


class Warnings(command_line.Case):
    CONTACT = ["subsection Output", "subsection Contact: wall\n  set Surface = plane\n  subsection plane\n    set Point = "
               "-0.1, 0\n    set Normal = 1, 0\n  end\nend\nsubsection Initial condition: flight\n  set Velocity = %s; 0\n"
               "end\nsubsection Output"]
    FLIGHT = ["set Conditions       = pulse", "set Contacts = wall\nset Initial conditions = flight"]
    NO_PULSE = ["subsection Condition: pulse\n  set Where    = x < 1e-9\n  set Type     = traction\n"
                "  set Function = 0.1*sin(pi*t); 0\nend\n", ""]

    def dry_run(self, *changes, options=(), ranks=1):
        self.write_rod("case.prm", "output", *changes)
        return self.run_program("--dry-run", "case.prm", *options, ranks=ranks)

    def test_a_given_step_above_the_limit(self):
        piece = "of `Time step/Fixed` is above the limit"
        for step, count in (("0.25", 1), ("0.01", 0)):
            printed = self.dry_run(options=("--set", "Time step/Fixed = " + step), ranks=2)
            self.assertEqual(printed.count("Warning: The step"), count, printed)
            self.assertEqual(printed.count(piece), count)

    def test_the_number_of_steps_says_what_it_is_of(self):
        self.assertRegex(self.dry_run(), r"about \d+ steps at the initial step\n")
        self.assertRegex(self.dry_run(options=("--set", "Time step/Fixed = 0.01")), r"about 50 steps\n")

    def test_conditions_that_fight_for_a_node(self):
        wall = ["subsection Output", "subsection Condition: wall\n  set Where = x > 1.999\n  set Type = clamp\nend\n"
                "subsection Condition: floor\n  set Where = y < 1e-9\n  set Type = velocity\n"
                "  set Function = %s\nend\nsubsection Output"]
        names = ["set Conditions       = pulse", "set Conditions = pulse, wall, floor"]
        for ranks in (1, 2):
            printed = self.dry_run(names, [wall[0], wall[1] % "free; 0.1*t"], ranks=ranks)
            self.assertIn('Warning: The conditions "wall" and "floor" prescribe different motions (y) of the same nodes, for '
                          'example at (2, 0): "floor" acts there', printed)
        for function in ("free; 0", "free; free", "0; 0"):
            self.assertNotIn("prescribe different", self.dry_run(names, [wall[0], wall[1] % function]))

    def test_a_condition_that_begins_when_the_run_has_ended(self):
        for start, count in (("0.5", 1), ("0.49", 0)):
            printed = self.dry_run(["  set Type     = traction", "  set Type = traction\n  set Start = " + start])
            self.assertEqual(printed.count('Warning: The condition "pulse" does nothing: it begins at 0.5, and the run ends at 0.5.'),
                             count, printed)

    def test_initial_velocities_of_a_body_at_rest(self):
        for velocity, count in (("0.1; 0", 1), ("0; 0", 0)):
            self.write("bar.prm", run_cases.parameter_text({"file": "bar.prm", "replace": [
                ["set Parts            = bar", "set Initial conditions = motion\nset Parts            = bar"],
                ["subsection Output", f"subsection Initial condition: motion\n  set Velocity = {velocity}\nend\n\n"
                                      "subsection Output"]]}))
            printed = self.run_program("--dry-run", "bar.prm")
            self.assertEqual(printed.count("Warning: The initial velocities do nothing"), count, printed)

    def test_a_body_that_does_not_reach_a_wall(self):
        piece = 'Warning: The surface of the contact "wall" will hardly touch anything: until the end it comes no nearer than 0.05'
        for velocity, count in (("-0.1", 1), ("-0.3", 0)):
            printed = self.dry_run(self.FLIGHT, self.NO_PULSE, [self.CONTACT[0], self.CONTACT[1] % velocity], ranks=2)
            self.assertEqual(printed.count(piece), count, printed)
            self.assertEqual(printed.count("hardly"), count)

    def test_a_tool_that_moves_away(self):
        for way, count in (("-0.3*t; 0", 1), ("0.3*t; 0", 0)):
            printed = self.dry_run(self.FLIGHT, self.NO_PULSE, [self.CONTACT[0], self.CONTACT[1] % "0"], options=(
                "--set", "Contact: wall/plane/Displacement = " + way))
            self.assertEqual(printed.count("will hardly touch anything"), count, printed)

    def test_a_body_that_leaves_a_wall_at_once(self):
        for velocity, count in (("0.3", 1), ("-0.3", 0), ("0", 0)):
            printed = self.dry_run(self.FLIGHT, self.NO_PULSE, [self.CONTACT[0], self.CONTACT[1] % velocity], options=(
                "--set", "Contact: wall/plane/Point = 0, 0"))
            self.assertEqual(printed.count("will hardly touch anything: until the end it comes no nearer than 0, at t = 0"),
                             count, printed)

    def test_a_body_that_loads_move_is_not_judged(self):
        printed = self.dry_run(["set Conditions       = pulse", "set Conditions = pulse\n" + self.FLIGHT[1]],
                               [self.CONTACT[0], self.CONTACT[1] % "0"])
        self.assertNotIn("hardly", printed)

    def test_an_end_before_a_wave_has_crossed_the_body(self):
        piece = "before a wave has crossed the body"
        self.assertIn("Warning: The run ends at 0.5, " + piece, self.dry_run())
        self.assertNotIn(piece, self.dry_run(options=("--set", "End time = 5")))

    def test_wave_speeds_that_no_solid_has(self):
        piece = 'Warning: Waves would travel through part "left" at '
        density, modulus = "Material: steel/elastic/Density = %g", "Material: steel/elastic/Young's modulus = %g"
        for labels, rho, young, count in (("length: m, time: s", 7800, 210e9, 0), ("length: m, time: s", 7.8e-9, 210e3, 1),
                                          ("length: mm, time: s", 7.8e-9, 210e3, 0), ("length: mm, time: ms", 7.8, 210, 1),
                                          ("length: foot, time: s", 1, 1, 0), ("", 1, 1, 0)):
            options = ("--set", "Unit labels = " + labels, "--set", density % rho, "--set", modulus % young)
            self.assertEqual(self.dry_run(options=options if labels else options[2:]).count(piece), count, labels)

    def test_heat_capacities_that_no_solid_has(self):
        for labels, capacity, count in (("length: m, time: s", 460, 0), ("length: m, time: s", 0.46, 1),
                                        ("length: mm, time: s", 460e6, 0), ("length: mm, time: s", 460, 1),
                                        ("length: mm, time: ms", 460, 0), ("length: foot, time: s", 1, 0), ("", 1, 0)):
            with open(self.path("heat.prm"), "w") as file:
                file.write(run_cases.parameter_text({"file": "heat.prm"}).replace("@OUTPUT@", "output"))
            options = ["--set", f"Material: copper/Heat/Specific heat capacity = {capacity}"]
            options += ["--set", "Unit labels = " + labels] if labels else []
            printed = self.run_program("--dry-run", "heat.prm", *options)
            for part in ("left", "right"):
                self.assertEqual(printed.count(f'Warning: Part "{part}" has a specific heat capacity of '), count, printed)

    def test_an_initial_stress_at_which_the_material_flows(self):
        plastic = ["set Model = elastic\n  subsection elastic", "set Model = j2 plasticity\n  subsection j2 plasticity\n    set Flow "
                   "stress = linear hardening\n    subsection linear hardening\n      set Yield stress = %g\n      set Hardening "
                   "modulus = 0\n    end"]
        hot = plastic[1][:plastic[1].index("linear")] + (
            "johnson cook\n    set Taylor-Quinney coefficient = 0.9\n    set Specific heat capacity = 1\n    set Initial "
            "temperature = 800\n    subsection johnson cook\n      set Yield stress = 2\n      set Hardening coefficient = 0\n      "
            "set Hardening exponent = 1\n      set Rate coefficient = 0\n      set Reference rate = 1\n      set Thermal exponent "
            "= 1\n      set Reference temperature = 300\n      set Melting temperature = 1300\n    end")
        # Of the two parts.
        for material, stress, count in ((plastic[1] % 1, "0.9", 0), (plastic[1] % 1, "1.1", 2),
                                        (hot, "0.9", 0), (hot, "1.1", 2)):
            printed = self.dry_run([plastic[0], material], ["set Conditions       = pulse", "set Conditions = pulse\nset "
                                   "Initial conditions = start"], ["subsection Output", "subsection Initial condition: start\n  "
                                   "set Stress = 5*x; " + stress + "+5*x; 5*x; 0; 0; 0\nend\nsubsection Output"])
            self.assertEqual(printed.count("Warning: The von Mises stress at the start is 1.1 at ("), count, printed)

    def test_a_yield_stress_above_what_metals_have(self):
        plastic = ["set Model = elastic\n  subsection elastic", "set Model = j2 plasticity\n  subsection j2 plasticity\n    set Flow "
                   "stress = linear hardening\n    subsection linear hardening\n      set Yield stress = %g\n      set Hardening "
                   "modulus = 0\n    end"]
        for labels, stress, count in (("length: mm, time: s", 0.9, 0), ("length: mm, time: s", 11, 1), ("", 11, 0)):
            options = ("--set", "Unit labels = " + labels) if labels else ()
            printed = self.dry_run([plastic[0], plastic[1] % (10 * stress)], options=options)
            self.assertEqual(printed.count('Warning: Part "left" yields at '), count, printed)

    def test_smoothings_with_which_a_contact_of_few_particles_errs(self):
        plastic = [["set Model = elastic\n  subsection elastic", "set Model = j2 plasticity\n  subsection j2 plasticity\n    set Flow stress "
                    "= linear hardening\n    subsection linear hardening\n      set Yield stress = 10\n      set Hardening modulus = 0\n    end"]]
        wall = [["set Conditions       = pulse", "set Conditions = pulse\nset Contacts = wall"],
                ["subsection Output", "subsection Contact: wall\n  set Surface = plane\n  subsection plane\n    set Point = 0, -1\n    set "
                 "Normal = 0, 1\n  end\nend\nsubsection Output"]]
        fine = [["set Cells        = 10, 2", "set Cells = 40, 16"]]
        for smoothing, changes, count in (("paper", plastic + wall, 1), ("fe matched", plastic + wall, 1), ("fe matched", plastic, 0),
                                          ("fe matched", plastic + wall + fine, 0), ("affine", plastic + wall, 0)):
            printed = self.dry_run(["set Smoothing = affine", "set Smoothing = " + smoothing], *changes)
            self.assertEqual(printed.count("what a contact stores is not what it gives back"), count, printed)

    def test_a_scene_with_an_exact_solution_gets_no_advice(self):
        smoothing = ["set Smoothing = affine", "set Smoothing = paper"]
        exact = ["subsection Output", "subsection Exact solution\n  set Velocity = 0; 0\nend\nsubsection Output"]
        self.assertIn("Advice: ", self.dry_run(smoothing))
        printed = self.dry_run(smoothing, exact)
        self.assertNotIn("Advice: ", printed)
        self.assertNotIn("Warning: ", printed)

    def test_longer_steps_where_few_small_cells_set_the_step(self):
        small = ["set Cells        = 10, 2", "set Cells = 10 to 0.7 | 4 to 0.74 | 10 to 2; 6"]
        scene = [small, ["set Cells       = x < 1\n", "set Cells = x < 1.8\n"], ["set End time         = 0.5", "set End time = 100"]]
        advice = "Advice: `Time step/Subcycling/Largest ratio = 8`"
        self.assertIn(advice, self.dry_run(*scene))
        self.assertNotIn(advice, self.dry_run(*scene[1:]))
        self.assertNotIn(advice, self.dry_run(*scene, options=("--set", "Time step/Subcycling/Largest ratio = 2")))

    def test_bodies_at_rest_are_told_nothing_of_waves_and_steps(self):
        for formulation in ("fully integrated hexahedron", "momentum consistent particle"):
            for end in ("1e-3", "1", "1e5"):
                self.write("bar.prm", run_cases.parameter_text({"file": "bar.prm", "replace": [["set Times = 0, 0.5, 1", ""]]}))
                printed = self.run_program("--dry-run", "bar.prm", "--set", "End time = " + end, "--set",
                                           "Statics/Largest step = " + end, "--set", "Part: bar/Formulation = " + formulation,
                                           "--set", "Unit labels = length: m, time: s")
                self.assertNotIn("Warning", printed)
                self.assertNotIn("Advice", printed)

    def test_smoothings_that_strain_what_turns_in_a_body_that_spins(self):
        moves = ["subsection Output", "subsection Initial condition: motion\n  set %s\nend\nsubsection Output"]
        piece = "the body spins, its rim with 0.0879 of the speed of P waves"

        def printed(motion, smoothing, ranks=1):
            return self.dry_run(["set Conditions       = pulse", "set Initial conditions = motion"], self.NO_PULSE,
                                [moves[0], moves[1] % motion], ["Smoothing = affine", "Smoothing = " + smoothing], ranks=ranks)

        spin = "Spin = 0.1\n  set Centre of spin = %s, 0.2"
        for smoothing, centre, ranks, count in (("fe matched", "1", 1, 1), ("paper", "1", 2, 1), ("affine", "1", 1, 0),
                                                ("fe matched", "20", 1, 1), ("none", "1", 1, 0)):
            text = printed(spin % centre, smoothing, ranks)
            self.assertEqual(text.count(piece), count, text)
            self.assertEqual(text.count("Advice: `Smoothing"), count)
        self.assertNotIn("spins", printed("Velocity = 0; sin(2*pi*x)", "paper"))

    def test_the_smoothing_of_the_paper_in_fine_cuts(self):
        cut = os.path.join(command_line.SOURCE, "parameter_files", "machining", "cut_particles.prm")
        for smoothing, speed, count in (("paper", "10", 1), ("affine", "10", 0), ("paper", "0", 0)):
            printed = self.run_program("--dry-run", cut, "--set", "Part: work/momentum consistent particle/Smoothing = " + smoothing,
                                       "--set", "Contact: tool/Cutting speed = " + speed)
            self.assertEqual(printed.count("`paper` creates energy in fine cuts"), count, printed)
            self.assertEqual(printed.count("Here they are up to 0.000105 wide."), count)

    def test_a_slow_process_is_advised_to_be_scaled(self):
        for end, count in (("1e4", 1), ("10", 0)):
            printed = self.dry_run(options=("--set", "End time = " + end))
            self.assertEqual(printed.count("`Scaling/Process time factor` divides the steps"), count)
        self.assertNotIn("divides the steps", self.dry_run(options=(
            "--set", "End time = 1e4", "--set", "Scaling/Process time factor = 10")))


class Owner(command_line.Case):
    """A run replaces results of its own parameter file only."""

    PROBES = ["  set Times = 0.25", "  set Times = 0.25\n  subsection probes\n    set Locations = left: 0.2, 0.2\n  end"]

    def results(self):
        return {name: self.read("output", name) for name in os.listdir(self.path("output"))
                if os.path.isfile(self.path("output", name)) and name != "log.txt"}

    def test_a_run_that_ends_says_where_its_results_are_and_what_draws_them(self):
        self.write_rod("rod.prm", "my output")
        printed = self.run_program("--quiet", "rod.prm", ranks=2)
        self.assertIn("Results: my output. To look at them: scripts/report 'my output' (one page), scripts/plot 'my output' "
                      "(pictures).", printed)

    def test_results_of_another_file_are_kept(self):
        self.run_program("--quiet", "rod.prm", "--set", "Checkpoint/Step interval = 3")
        before = self.results(), os.listdir(self.path("output", "checkpoint"))
        self.write_rod("other.prm", "output", ["set Title            = Small rod", "set Title = Another"])
        for ranks in (1, 2):
            printed = self.run_program("--quiet", "other.prm", exits=1, ranks=ranks)
            self.assertEqual(printed.count("Error: "), 1)
            self.assertIn('other.prm:5: entry "Output directory" = "output": the directory has the results of another '
                          "parameter file, ", printed)
            self.assertIn('rod.prm" (Small rod). Name another directory, or replace them with --overwrite.', printed)
        self.assertEqual((self.results(), os.listdir(self.path("output", "checkpoint"))), before)
        self.run_program("--dry-run", "other.prm")
        self.run_program("--validate", "other.prm")
        self.assertEqual((self.results(), os.listdir(self.path("output", "checkpoint"))), before)
        self.run_program("--quiet", "--overwrite", "other.prm")
        self.assertEqual(json.loads(self.read("output", "summary.json"))["title"], "Another")
        self.assertFalse(os.listdir(self.path("output", "checkpoint")))
        self.run_program("--quiet", "rod.prm", exits=1)

    def test_a_run_that_has_not_come_to_its_end_is_kept(self):
        for ending in ("killed", "interrupted", "failed"):
            self.run_program("--quiet", "--overwrite", "rod.prm", "--set", "Checkpoint/Step interval = 3")
            if ending == "killed":
                os.remove(self.path("output", "summary.json"))
            else:
                with open(self.path("output", "summary.json"), "w") as file:
                    json.dump({"ended": ending}, file)
            before = self.results(), os.listdir(self.path("output", "checkpoint"))
            for ranks in (1, 2):
                printed = self.run_program("--quiet", "rod.prm", exits=1, ranks=ranks)
                self.assertIn('rod.prm:5: entry "Output directory" = "output": a run that has not come to its end is there',
                              " ".join(printed.split()))
                self.assertIn("--resume", printed)
                self.assertIn("--overwrite", printed)
            self.run_program("--dry-run", "rod.prm")
            self.assertEqual((self.results(), os.listdir(self.path("output", "checkpoint"))), before)
            self.run_program("--quiet", "--resume", "rod.prm")
            self.assertEqual(json.loads(self.read("output", "summary.json"))["ended"], "finished")
            self.run_program("--quiet", "rod.prm")  # what has finished may be replaced
        os.remove(self.path("output", "summary.json"))
        self.run_program("--quiet", "rod.prm")  # nothing could be resumed

    def test_a_chain_that_has_not_come_to_its_end_is_kept_from_its_first_stage_on(self):
        self.write("chain.prm", run_cases.parameter_text({"file": "bar.prm"}).replace("@OUTPUT@", "output") +
                   "set Stages = one, two\nsubsection Stage: one\nend\nsubsection Stage: two\nend\n"
                   "subsection Checkpoint\n  set Step interval = 1\nend\n")
        self.run_program("--quiet", "chain.prm")
        os.remove(self.path("output", "two", "summary.json"))
        before = self.read("output", "one", "summary.json")
        printed = self.run_program("--quiet", "chain.prm", exits=1)
        self.assertIn('two": a run that has not come to its end is there', " ".join(printed.split()))
        self.assertEqual(self.read("output", "one", "summary.json"), before)
        self.run_program("--quiet", "--resume", "chain.prm")
        self.run_program("--quiet", "chain.prm")

    def test_stages_of_a_scene_that_is_included(self):
        """Sections that a stage does not list are none of it, and stages can be changed, also from another file."""
        with open(self.path("base.prm"), "w") as file:
            file.write(run_cases.parameter_text({"file": "bar.prm"}).replace("@OUTPUT@", "output"))
        with open(self.path("chain.prm"), "w") as file:
            file.write("include base.prm\nset Stages = one, two\nsubsection Stage: one\nend\nsubsection Stage: two\n"
                       "  set Conditions = hold\n  set End time = 0.3\n  subsection Output\n    set Times = 0.1\n  end\nend\n")
        with open(self.path("changed.prm"), "w") as file:
            file.write("include chain.prm\nset Output directory = changed\nsubsection Stage: two\n  set End time = 0.2\nend\n")
        for name, directory, end in (("chain.prm", "output", 0.3), ("changed.prm", "changed", 0.2)):
            self.run_program("--quiet", name)
            for stage, forces, time in (("one", True, 1), ("two", False, end)):
                rows = self.read(directory, stage, "conditions.csv").splitlines()
                self.assertEqual("pull work" in rows[0], forces, stage)
                self.assertEqual(float(rows[-1].split(",")[0]), time)
                self.assertEqual(json.loads(self.read(directory, stage, "summary.json"))["ended"], "finished")
        self.assertNotIn("one, two", self.read("output", "two", "parameters.prm"))  # a run of its own

    def test_a_directory_of_the_command_line_is_that_of_all_stages(self):
        self.write("chain.prm", run_cases.parameter_text({"file": "bar.prm"}).replace("@OUTPUT@", "output") +
                   "set Stages = one, two\nsubsection Stage: one\nend\nsubsection Stage: two\n  set Output directory = own\nend\n")
        for options, first, second in (((), "output/one", "own"), (("--set", "Output directory = given"), "given/one", "given/two")):
            self.run_program("--quiet", "chain.prm", *options)
            for directory in (first, second):
                self.assertTrue(os.path.exists(self.path(directory, "summary.json")), directory)

    def test_the_same_file_may_change_and_be_run_again(self):
        self.run_program("--quiet", "rod.prm")
        self.write_rod("rod.prm", "output", ["set Title            = Small rod", "set Title = Changed"])
        self.run_program("--quiet", os.path.join(self.directory, "rod.prm"))
        self.assertEqual(json.loads(self.read("output", "summary.json"))["title"], "Changed")
        # Neither a copy of it nor what the run itself left is another scene.
        shutil.copy(self.path("rod.prm"), self.path("copy.prm"))
        self.run_program("--quiet", "copy.prm")
        self.run_program("--quiet", "output/parameters.prm")

    def test_no_table_of_an_earlier_scene_is_left(self):
        self.write_rod("rod.prm", "output", self.PROBES)
        self.run_program("--quiet", "rod.prm")
        self.assertIn("probes.csv", os.listdir(self.path("output")))
        with open(self.path("output", "notes.csv"), "w") as file:
            file.write("mine\n")
        self.write_rod("rod.prm", "output", ["set Conditions       = pulse\n", ""],
                       ["subsection Condition: pulse\n  set Where    = x < 1e-9\n  set Type     = traction\n"
                        "  set Function = 0.1*sin(pi*t); 0\nend\n", ""])
        self.run_program("--quiet", "rod.prm")
        left = os.listdir(self.path("output"))
        self.assertNotIn("probes.csv", left)
        self.assertNotIn("conditions.csv", left)
        self.assertIn("notes.csv", left)


if __name__ == "__main__":
    command_line.PROGRAM, command_line.MPIEXEC, command_line.SOURCE = sys.argv[1:4]
    loader = unittest.TestLoader()
    chosen = sys.argv[4:] or ["PatchTest", "Warnings", "Owner"]
    suite = unittest.TestSuite(loader.loadTestsFromTestCase(globals()[name]) for name in chosen)
    result = unittest.TextTestRunner(verbosity=2).run(suite)
    sys.exit(0 if result.wasSuccessful() and result.testsRun > 0 else 1)

#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Checkpoints: a resumed run is the uninterrupted one, and what cannot be resumed is refused.

    checkpoint.py PROGRAM MPIEXEC SOURCE_DIRECTORY SUBJECT

SUBJECT is ranks, interruption, refusals, or bitwise_ and one of rods, divisions, refills, kernels,
fragments, impacts, contacts and stages.
"""

import filecmp
import glob
import json
import os
import random
import re
import shutil
import signal
import subprocess
import sys
import time
import unittest

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import command_line
import loaded
import run_cases

REGRESSION = os.path.join(os.path.dirname(run_cases.HERE), "regression")
sys.path.insert(0, REGRESSION)
import body_meshes

# Entries of a summary on the machine and the time.
PROCESS_ENTRIES = re.compile("wall_seconds|step_(processor_)?seconds|seconds_per_phase|ns_per_.*|peak_memory_bytes|rank_balance|"
                             "resumed_from_step|earlier_wall_seconds")

PROBES = ("  set Times = 0.25", "  set Times = 0.25\n  subsection probes\n    set Locations = "
          "left: 0.2, 0.2; right: 2, 0.4\n    set Steps = 2\n  end")

PULSE = ("subsection Condition: pulse\n  set Where    = x < 1e-9\n  set Type     = traction\n"
         "  set Function = 0.1*sin(pi*t); 0\nend")
GRAVITY = [PULSE, "subsection Condition: pulse\n  set Type = body force\n  set Function = "
           "0.1*sin(pi*t)*x; -0.01\nend"]


def scaling(entries):
    return ["subsection Output", "subsection Scaling\n  %s\nend\nsubsection Output" % entries]


# The end that hits the wall becomes thinner, elements and particles alike: by half, where only a
# stress of large strains keeps the energy.
IMPACT = (PROBES, ["  set Formulation = hexahedron\n  set Material    = steel\n",
                   "  set Formulation = hexahedron\n  set Material    = steel\n  subsection hexahedron\n"
                   "    set Strain measure = logarithmic\n  end\n"], ["set End time         = 0.5", "set End time = 8"],
          ["set Conditions       = pulse", "set Contacts = wall\nset Initial conditions = flight"],
          [PULSE, "subsection Contact: wall\n  set Surface = plane\n  subsection plane\n    set Point = "
           "-0.01, 0\n    set Normal = 1, 0\n  end\nend\nsubsection Initial condition: flight\n  set "
           "Velocity = -0.4; 0\nend"],
          scaling("set Target time step = 0.25\n  set Interval = 3\nend\nsubsection Time step\n"
                  "  set Safety factor = 0.5"))


def scene_of_regression(name, *changes):
    text = run_cases.changed_file(os.path.join(REGRESSION, name), changes)
    return text + "set Output directory = output\n"


def block(smoothing="affine", cells="6, 4, 4"):
    """The stretched block of the regression cases, smaller, with a lattice filter."""
    return scene_of_regression(
        "stretch.prm", ("10, 6, 6", cells), ("Times = 10", "Times = 1, 3"),
        ("set Smoothing           = affine", "set Smoothing = " + smoothing),
        ("x > -1", "x < 1e-9 || x > 0.999"), ("= 0.1*x; 0; 0", "= 0.1*x; free; free"),
        ("set End time   = 10", "set End time   = 4"))


def torn_bar(end="16", *changes):
    """The bar that tears of the regression cases, its bonds breaking until half of the time."""
    return scene_of_regression("tear.prm", ("End time           = 60", "End time = " + end),
                               ("Number = 30", "Number = 4"), ("Fixed = 0.0625", "Fixed = 0.25"), *changes)


RENEWED = ("    set Bond failure", "    set Configuration = updated Lagrangian\n"
           "    set Rebuild interval = 7\n    set Bond failure")


class Case(command_line.Case):

    def write_colliding_bar(self, end, damping, configuration="total Lagrangian"):
        """The bar that tears and meets itself again, sooner than in the regression cases."""
        shutil.copy(os.path.join(REGRESSION, "tear.prm"), self.path("tear.prm"))
        text = scene_of_regression(
            "self_contact.prm", ("End time           = 350", "End time = " + end),
            ("Self-contact = true", "Self-contact = true\n    set Self-contact damping = " + damping +
             "\n    set Smoothing = paper\n    set Configuration = " + configuration),
            ("t < 70, 1e-3", "t < 70, 3e-3"), ("t < 70, -1e-3", "t < 70, -3e-3"))
        self.write("bar.prm", text + "set Largest energy error = 0\n"
                   "subsection Time step\n  set Fixed = 0.25\nend\nsubsection Output\n  set Number = 6\nend\n")

    def write_small_rod(self, *changes, checkpoints=""):
        self.write_rod("rod.prm", "output", *changes)
        with open(self.path("rod.prm"), "a") as file:
            file.write(checkpoints)

    def checkpoints(self, output="output"):
        return sorted(glob.glob(self.path(output, "checkpoint", "step_*.h5")))

    def assert_same_results(self, first, second):
        names = sorted(name for name in self.files(first))
        self.assertEqual(names, sorted(self.files(second)))
        for name in names:
            self.assertTrue(filecmp.cmp(self.path(first, name), self.path(second, name), False), name)
        summaries = []
        for directory in (first, second):
            summary = json.loads(self.read(directory, "summary.json"))
            summaries.append({key: value for key, value in summary.items()
                              if not PROCESS_ENTRIES.fullmatch(key)})
        self.assertEqual(summaries[0], summaries[1])

    def files(self, directory):
        """Results that two runs must share bit by bit."""
        found = glob.glob(self.path(directory, "*.csv")) + glob.glob(self.path(directory, "*.pvd"))
        found += glob.glob(self.path(directory, "solution", "*"))
        return [os.path.relpath(name, self.path(directory)) for name in found]

    def spoil_results(self, directory):
        """What a killed run may have written after its checkpoint."""
        for name in glob.glob(self.path(directory, "*.csv")):
            with open(name, "a") as file:
                file.write("1e9,later\n")
        last = sorted(glob.glob(self.path(directory, "solution", "*.pvtu")))[-1]
        with open(last, "w") as file:
            file.write("half a fi")


LONGER_STEPS = "subsection Time step\n  subsection Subcycling\n    set Largest ratio = 4\n  end\nend\n"


class BitwiseCase(Case):
    """Resumed on the same ranks, a run leaves the same bits."""

    def check(self, file, interval, which, ranks):
        self.run_program("--quiet", file, "--set", "Checkpoint/Step interval = %d" % interval,
                         "--set", "Checkpoint/Keep = 1000", ranks=ranks)
        written = self.checkpoints()
        self.assertGreater(len(written), 2)
        for fraction in which:
            checkpoint = written[int(fraction * (len(written) - 1))]
            # The resumed run writes none of those that follow: they change nothing, nor what one rank
            # has of the others.
            self.assertLess(checkpoint, written[-1])
            with self.subTest(checkpoint=os.path.basename(checkpoint), ranks=ranks):
                shutil.rmtree(self.path("resumed"), True)
                shutil.copytree(self.path("output"), self.path("resumed"))
                self.spoil_results("resumed")
                again = self.path("resumed", "checkpoint", os.path.basename(checkpoint))
                printed = self.run_program("--quiet", "--resume=" + again, file, "--set",
                                           "Output directory = resumed", ranks=ranks)
                self.assertIn("Resumed from " + again, printed)
                self.assert_same_results("output", "resumed")
                # Checkpoints of later steps were of the run that is no more.
                self.assertEqual(self.checkpoints("resumed"),
                                 [self.path("resumed", "checkpoint", os.path.basename(name))
                                  for name in written if name <= checkpoint])

    def check_on_ranks(self, file, interval, *which):
        """The first of which on one rank, the second on two."""
        for ranks, fractions in enumerate(which, 1):
            self.check(file, interval, fractions, ranks)


class BitwiseRods(BitwiseCase):
    def test_coupled_rod(self):
        self.write_small_rod(PROBES, ["set End time         = 0.5", "set End time = 3"],
                             ["set Conditions       = pulse", "set Conditions = pulse, wall"],
                             ["subsection Output", "subsection Condition: wall\n  set Where = x > 1.999\n"
                              "  set Type = clamp\nend\nsubsection Exact solution\n  set Velocity = "
                              "0.1*sin(t); 0\nend\nsubsection Output"])
        self.check_on_ranks("rod.prm", 4, (0, 0.3), (0.6,))

    def test_coupled_rod_with_the_smoothing_of_the_paper_and_a_filter(self):
        self.write_small_rod(PROBES, ["set End time         = 0.5", "set End time = 3"],
                             ["set Smoothing = affine", "set Smoothing = paper"],
                             ["subsection Output", "set Plugin libraries = liblattice_filter.so\n"
                              "subsection Lattice filter\n  set "
                              "Power = 2\n  set Interval = 3\nend\nsubsection Output"])
        self.check_on_ranks("rod.prm", 4, (0.4,), (0.2,))

    def test_rod_with_scaled_inertia(self):
        self.write_small_rod(PROBES, ["set End time         = 0.5", "set End time = 3"], GRAVITY,
                             scaling("set Mass factor = 0.2\n  set Process time factor = 1.7"))
        self.check_on_ranks("rod.prm", 4, (0.3,), (0.6,))

    def test_impact_with_mass_added_on_the_way(self):
        self.write_small_rod(*IMPACT)
        self.check_on_ranks("rod.prm", 4, (0.7,), (0.5,))

    def test_impact_of_cells_that_take_longer_steps(self):
        # The end that meets the wall has large cells: they have other steps once they touch it.
        self.write_small_rod(*IMPACT[:-1], ["set End time = 8", "set End time = 3"],
                             ["set Cells        = 10, 2", "set Cells = 4 to 0.7 | 6 to 1 | 5 to 2; 2"],
                             ["subsection Output", "subsection Time step\n  subsection Subcycling\n"
                              "    set Largest ratio = 4\n  end\nend\nsubsection Output"])
        self.check("rod.prm", 7, (0, 0.1, 0.4), 1)
        self.check("rod.prm", 6, (0.2, 0.5), 2)

    def test_cells_that_take_longer_steps_and_are_removed(self):
        self.write("torn.prm", f"include {REGRESSION}/torn_bar.prm\nset Output directory = output\n"
                   "subsection Mesh\n  subsection box\n    set Cells = 20 to 1 | 8 to 3; 3; 3\n  end\nend\n"
                   "subsection Part: left\n  set Cells = x < 1.25\nend\nsubsection Part: layer\n"
                   "  set Cells = x > 1.25 && x < 1.5\n  subsection hexahedron\n    set Erosion strain = 0.3\n"
                   "  end\nend\n" + LONGER_STEPS)
        self.check_on_ranks("torn.prm", 7, (0.3, 0.5), (0.3, 0.5))

    def test_cells_that_take_longer_steps_and_become_particles(self):
        self.write("converted.prm", f"include {REGRESSION}/conversion.prm\nset Output directory = output\n"
                   "subsection Mesh\n  subsection box\n    set Cells = 16 to 0.8 | 9 to 3; 3; 3\n  end\nend\n" + LONGER_STEPS)
        self.check_on_ranks("converted.prm", 7, (0.2, 0.6), (0.4,))

    def test_run_that_stops_before_its_next_output(self):
        # The summary has impulses and works of the last output, which was before the checkpoint.
        self.write_small_rod(["set End time         = 0.5", "set End time = 3"],
                             ["set Conditions       = pulse", "set Conditions = pulse\nset Contacts = wall"],
                             ["0.1*sin(pi*t); 0\nend", "if(t < 2, -0.1, sqrt(1 - t)); 0\nend\n"
                              "subsection Contact: wall\n  set Surface = plane\n  set Friction = 0.1\n"
                              "  subsection plane\n    set Point = 0, 0\n    set Normal = 1, 0\n  end\nend"])
        self.run_program("--quiet", "rod.prm", "--set", "Checkpoint/Step interval = 4", "--set",
                         "Checkpoint/Keep = 100", exits=2)
        whole = json.loads(self.read("output", "summary.json"))["results"]
        self.assertGreater(abs(whole["conditions"]["pulse"]["impulse"][0]), 0)
        self.assertGreater(abs(whole["contact"]["wall"]["impulse"][0]), 0)
        written = self.checkpoints()
        self.run_program("--quiet", "--resume=" + written[-1], "rod.prm", exits=2)
        resumed = json.loads(self.read("output", "summary.json"))["results"]
        for name in ("conditions", "contact"):
            self.assertEqual(whole[name], resumed[name])


class BitwiseDivisions(BitwiseCase):
    def test_impact_of_smoothed_cells_of_three_sizes(self):
        """With elements beside them, mass added on the way, and its contact."""
        self.write_small_rod(*IMPACT, ["set End time = 8", "set End time = 4"],
                             ["set Type = box", "set Type = box\n  set Refine where = x > 1.3; x > 1.7"
                                       "\n  set Refinement levels = 1; 2"],
                             ["  set Formulation = momentum consistent particle\n  set Material    = steel\n"
                              "  subsection momentum consistent particle\n    set Dilation  = 1.8\n    set Smoothing "
                              "= affine\n  end\n", "  set Formulation = smoothed cells\n  set Material    = steel\n"])
        self.check_on_ranks("rod.prm", 4, (0.4,), (0.6,))

    def test_impact_of_elements_of_two_sizes(self):
        """With particles beside them, mass added on the way, and contact, gently."""
        self.write_small_rod(*IMPACT, ["set End time = 8", "set End time = 4"],
                             ["Velocity = -0.4; 0", "Velocity = -0.1; 0"],
                             ["set Type = box", "set Type = box\n  set Refine where = x < 0.7"])
        self.check_on_ranks("rod.prm", 4, (0.4,), (0.6,))

    def test_cells_that_are_divided_and_joined_in_the_run(self):
        """With heat, a symmetry plane, and histories beside the pictures."""
        path = os.path.join(command_line.SOURCE, "parameter_files", "adaptive_refinement", "pulse.prm")
        text = run_cases.changed_file(path, (
            ("set End time         = 8", "set End time = 3"), ("Cells        = 40, 4", "Cells = 20, 2"),
            ("set Conditions       = pulse", "set Conditions = pulse, axis"),
            ("set Number = 8", "set Number = 3\n  subsection probes\n    set Locations = 5, 1\n  end"),
            ("subsection Exact solution", "subsection Condition: axis\n  set Type = symmetry\n"
             "  set Boundary = y min\nend\nsubsection Exact solution"),
            ("ratio = 0\n  end", "ratio = 0\n  end\n  subsection Heat\n    set Specific heat capacity = "
             "1\n    set Conductivity = 1\n    set Initial temperature = 300\n  end")))
        text = text[:text.index("set Output directory")] + text[text.index("set End time"):]
        self.write("pulse.prm", text + "set Output directory = output\n")
        self.check_on_ranks("pulse.prm", 5, (0.7,), (0.5,))

    def test_cells_that_are_divided_and_joined_beside_a_disc(self):
        """Springs of contact, friction, and a tool that receives heat."""
        for name in ("elements.prm", "adaptive.prm"):
            shutil.copy(os.path.join(command_line.SOURCE, "parameter_files", "ploughing", name), self.path(name))
        self.write("disc.prm", "include adaptive.prm\nset Output directory = output\nset End time = 60\n"
                   "subsection Contact: disc\n  set Friction = 0.3\n  set Conductance = 1e-4\n"
                   "  set Heat capacity = 0.01\n  set Tool temperature = 0\nend\n")
        self.check_on_ranks("disc.prm", 50, (0.7,), (0.5,))


class BitwiseRefills(BitwiseCase):
    def test_smoothed_cells_that_are_refilled(self):
        directory = os.path.join(command_line.SOURCE, "parameter_files", "trade_study", "scenes")
        text = run_cases.changed_file(os.path.join(directory, "sheared_block.prm"), (
            ("End time           = 1000", "End time           = 150"),
            ("Number         = 30", "Number         = 6"),
            ("Write solution = false", "Write solution = true")))
        self.write("block.prm", text + "set Output directory = output\n")
        self.check_on_ranks("block.prm", 250, (0.9,), (0.7,))
        # By interpolation, of cells with one point.
        stretch = "    set Refill stretch "
        self.assertIn(stretch, text)
        self.write("block.prm", text.replace(
            stretch, "    set Integration = one point\n    set Refill remap = interpolation\n" +
            stretch) + "set Plugin libraries = libinterpolated_remap.so\nset Output directory = output\n")
        self.check("block.prm", 250, (0.7,), 2)

    def test_smoothed_cells_that_are_refilled_beside_a_rigid_part(self):
        self.write("block.prm", f"include {REGRESSION}/refill_beside_rigid.prm\n"
                   "set Output directory = output\nsubsection Output\n  set Write solution = true\nend\n")
        self.check_on_ranks("block.prm", 3, (0.7,), (0.9,))

    def test_smoothed_cells_whose_surface_slides(self):
        directory = os.path.join(command_line.SOURCE, "parameter_files", "ploughing")
        self.write("block.prm", f"include {directory}/smoothed.prm\nset Output directory = output\n"
                   "set End time = 150\nsubsection Output\n  set Write solution = true\nend\n")
        self.check("block.prm", 100, (0.9,), 1)
        self.write("block.prm", self.read("block.prm") +
                   "subsection Part: block\n  subsection smoothed cells\n    set Refill motion = "
                   "0.02*max(t-60,0)*min(1,min(x/6,(24-x)/12))*min(1,y/6); 0\n  end\nend\n")
        self.check("block.prm", 100, (0.7,), 2)

    def test_cells_that_are_filled(self):
        directory = os.path.join(command_line.SOURCE, "parameter_files", "ploughing")
        self.write("wall.prm", f"include {directory}/folded_wall.prm\nset Output directory = output\n"
                   "set End time = 160\nsubsection Output\n  set Write solution = true\nend\n")
        self.check_on_ranks("wall.prm", 200, (0.8,), (0.8,))


class BitwiseKernels(BitwiseCase):
    def test_block_whose_kernels_are_rebuilt(self):
        self.write("block.prm", block())
        self.check_on_ranks("block.prm", 5, (0.6,), (0.4,))

    def test_smoothed_particles_with_pair_terms(self):
        self.write("body.prm", f"include {REGRESSION}/pair_body.prm\nset Output directory = output\n"
                   "set End time = 8\nsubsection Part: square\n  subsection smoothed particle\n"
                   "    set Artificial viscosity = true\n    set Artificial stress = true\n"
                   "    set XSPH = true\n  end\nend\nsubsection Material: rubber\n  subsection Heat\n"
                   "    set Specific heat capacity = 1e-3\n    set Conductivity = 0: 1e-4, 1: 3e-4\n"
                   "    set Initial temperature = 0\n  end\nend\nsubsection Output\n  set Number = 4\n  set Write solution = true\nend\n")
        self.check_on_ranks("body.prm", 4, (0.8,), (0.6,))

    def test_smoothed_particles_beside_elements_that_tear_and_heat(self):
        for configuration, ranks in (("total Lagrangian", 2), ("current", 2),
                                     ("current\n    set Gradient = paper", 1),
                                     ("updated Lagrangian\n    set Rebuild interval = 7", 2)):
            text = scene_of_regression(
                "smoothed_bar.prm", ("set Configuration = total Lagrangian", "set Configuration = " + configuration),
                ("End time           = 60", "End time = 12"), ("Fixed = 0.0625", "Fixed = 0.25"),
                ("Number         = 30", "Number = 4"), ("solution = false", "solution = true"))
            self.write("bar.prm", text + "set Largest energy error = 0\n")
            self.check("bar.prm", 6, (0.7,), ranks)


class BitwiseFragments(BitwiseCase):
    def test_bar_that_tears(self):
        self.write("bar.prm", torn_bar())
        self.check_on_ranks("bar.prm", 6, (0.8,), (0.6,))
        self.write("bar.prm", torn_bar("16", RENEWED))
        self.check("bar.prm", 6, (0.7,), 2)

    def test_fragments_that_feel_each_other(self):
        self.write_colliding_bar("120", "1")
        self.check_on_ranks("bar.prm", 40, (0.4,), (0.7,))
        self.write_colliding_bar("120", "1", "updated Lagrangian\n    set Rebuild interval = 7")
        self.check("bar.prm", 40, (0.7,), 2)

    def test_fragments_that_rub_and_conduct(self):
        self.write_colliding_bar("100", "1", "total Lagrangian\n    set Self-contact friction = 300: 0.4, "
                                 "301: 0.1\n    set Self-contact conductance = 0.01")
        with open(self.path("bar.prm"), "a") as file:
            file.write("\nsubsection Material: metal\n  subsection Heat\n    set Specific heat capacity = "
                       "0.01\n    set Conductivity = 0.001\n    set Initial temperature = 300\n  end\nend\n")
        self.check_on_ranks("bar.prm", 30, (0.8,), (0.7,))
        with open(self.path("resumed", "statistics.csv")) as file:
            header, *rows = [line.strip().split(",") for line in file]
        friction = next(i for i, name in enumerate(header) if name.startswith("self-contact friction"))
        self.assertGreater(float(rows[-1][friction]), 0.)


class BitwiseImpacts(BitwiseCase):
    def write_bar(self, end="1.2e-5"):
        """A quarter of the coarse Taylor bar: plasticity, contact, symmetry, specimen output."""
        directory = os.path.join(command_line.SOURCE, "parameter_files", "taylor_impact")
        for name in glob.glob(os.path.join(directory, "*.prm")):
            shutil.copy(name, self.path(os.path.basename(name)))
        with open(self.path("coarse_quarter.prm")) as file:
            text = file.read()
        with open(self.path("common.prm")) as file:
            common = file.read()
        self.write("common.prm", common.replace("End time           = 100e-6",
                                                "End time = " + end)
                   .replace("Interval        = 5e-6", "Interval = 4e-6")
                   .replace("Average from          = 90e-6", "Average from = 6e-6"))
        self.write("bar.prm", text.replace("output/taylor_impact/coarse_quarter", "output"))

    def test_bar_under_impact(self):
        self.write_bar()
        self.check_on_ranks("bar.prm", 20, (0.1, 0.9), (0.7,))

    def test_bar_under_impact_with_kinematic_contact(self):
        self.write_bar("6e-6")
        with open(self.path("bar.prm"), "a") as file:
            file.write("\nsubsection Contact: wall\n  set Method = kinematic\n  set Friction = 0.2\nend\n")
        self.check_on_ranks("bar.prm", 20, (0.8,), (0.6,))

    def test_bar_that_fails_by_damage(self):
        for scene in ("ductile_erosion", "ductile_conversion"):
            self.write("bar.prm", f"include {REGRESSION}/{scene}.prm\nset Output directory = output\n"
                       "set End time = 8e-6\nsubsection Output\n  set Number = 4\n  subsection point history\n"
                       "    set Locations = neck: 4.6e-3, 1.5e-3, 1.5e-3\n  end\nend\n")
            self.check_on_ranks("bar.prm", 20, (0.9,), (0.4,))

    def test_chip_that_forms(self):
        for scene, ranks in (("cut_smoothed", 2), ("cut_conversion", 1)):
            self.write("cut.prm", f"include {command_line.SOURCE}/parameter_files/machining/{scene}.prm\n"
                       "set Output directory = output\nset End time = 4e-5\n"
                       "subsection Output\n  set Number = 2\nend\n")
            self.check("cut.prm", 70, (0.6,), ranks)


class BitwiseContacts(BitwiseCase):
    def test_rigid_part_that_tumbles_and_bounces(self):
        self.write("rigid.prm", scene_of_regression(
            "rigid_drop.prm", ("set End time  = 0.5", "set End time  = 0.15"),
            ("set Damping   = 0", "set Friction  = 0.2"),
            ("= free\n", "= free\n    set Initial spin = 3, 10, -2\n"),
            ("solution = false", "solution = true"), ("rows = 1", "rows = 7")))
        self.check_on_ranks("rigid.prm", 240, (0.8,), (0.5,))

    def test_contact_with_the_surface_of_a_part_with_friction_and_heat(self):
        body_meshes.write("half_spaces.msh", self.path())
        self.write("part.prm", f"include {REGRESSION}/part_half_spaces.prm\n"
                   "set Output directory = output\nset End time = 0.004\n"
                   "subsection Contact: joint\n  set Friction = 0.3\n  set Heat fraction = by effusivity\nend\n"
                   "subsection Heat\n  subsection explicit\n    set Maximum = 4e-5\n  end\nend\n"
                   "subsection Condition: press\n  set Function = -0.05*min(t, 0.004); 2e-5*sin(2000*t)\nend\n"
                   "subsection Output\n  set Times = 0.002, 0.004\n  set Write solution = true\nend\n")
        self.check_on_ranks("part.prm", 20, (0.8,), (0.5,))

    def test_faces_below_cells_that_are_removed(self):
        self.write("punch.prm", f"include {REGRESSION}/punch.prm\nset Output directory = output\n"
                   "set End time = 0.3\nsubsection Contact: tool\n  set Method = surface\n"
                   "  set Conductance = 5\n  set Tool temperature = 100\nend\n")
        self.check_on_ranks("punch.prm", 20, (0.3, 0.6), (0.5,))

    def test_two_parts_that_collide(self):
        body_meshes.write("two_blocks.msh", self.path())
        self.write("parts.prm", scene_of_regression(
            "two_parts.prm", ("Write solution = false", "Write solution = true")))
        self.check_on_ranks("parts.prm", 200, (0.8,), (0.75,))
        self.write("parts.prm", f"include {REGRESSION}/two_parts_rub.prm\n"
                   "set Output directory = output\nsubsection Output\n  set Write solution = true\nend\n")
        self.check("parts.prm", 200, (0.6,), 2)

    def write_rubbing_blocks(self):
        """The blocks that rub of the regression cases; they conduct heat and bond where it is hot."""
        body_meshes.write("rubbing.msh", self.path())
        self.write("rubbing.prm", scene_of_regression(
            "rubbing.prm", ("Write solution = false", "Write solution = true"),
            ("  set Friction        = 0.3", "  set Friction = 0.3\n  set Conductance = 0.3\n"
             "  set Bonding temperature = 0.5")))

    def test_bodies_that_rub_conduct_and_bond(self):
        self.write_rubbing_blocks()
        self.check_on_ranks("rubbing.prm", 40, (0.7,), (0.5,))


class BitwiseStages(BitwiseCase):
    def check_chain(self, scene, ranks, columns):
        """A chain of two stages in contact goes on after any stage, and from a checkpoint in the
        second; forces between the bodies go on from one stage to the next."""
        self.write("chain.prm", f"include {command_line.SOURCE}/{scene}\n"
                   "set Output directory = output\nset Stages = press, hold\n"
                   "subsection Stage: press\n  set End time = 0.012\nend\n"
                   "subsection Stage: hold\n  set End time = 0.003\n  subsection Condition: top\n"
                   "    set Function = 1e4\n  end\nend\n"
                   "subsection Checkpoint\n  set Step interval = 60\n  set Keep = 100\nend\n"
                   "subsection Output\n  set Number = 3\n  set Write solution = true\n"
                   "  subsection contact history\n    set Steps between rows = 1\n  end\nend\n")
        self.run_program("--quiet", "chain.prm", ranks=ranks)
        shutil.copytree(self.path("output"), self.path("whole"))
        written = self.checkpoints("output/hold")
        self.assertGreater(len(written), 5)
        for name in [self.path("output", "hold", "summary.json"),
                     self.path("output", "hold", "checkpoint", "end.h5"), *written[3:]]:
            os.remove(name)
        self.run_program("--quiet", "--resume", "chain.prm", ranks=ranks)
        self.assert_same_results("whole/hold", "output/hold")
        shutil.rmtree(self.path("output", "hold"))
        self.run_program("--quiet", "--resume", "chain.prm", ranks=ranks)
        self.assert_same_results("whole/hold", "output/hold")
        for name in columns:
            before, after = (self.column_of(f"whole/{stage}/contact.csv", name)
                             for stage in ("press", "hold"))
            for value in after[1:]:
                self.assertLess(abs(value / before[-1] - 1), 0.02, name)

    def test_stages_that_divide_and_join_cells(self):
        """Levels count from the mesh of the file in every stage; one that divides none lies between."""
        def divides(criterion):
            return ("  subsection Mesh\n    subsection Adaptive refinement\n      set Criterion = stress gradient\n"
                    f"      set Levels = 1\n      set Steps between checks = 5\n{criterion}    end\n  end\n")

        stages = "".join(f"subsection Stage: {name}\n{lines}end\n" for name, lines in (
            ("push", divides("      set Refine above = 1e-7\n")), ("rest", ""),
            ("again", divides("      set Refine above = 1e-7\n")),
            ("join", divides("      set Refine above = 1\n      set Coarsen below = 0.9\n"))))
        self.write("square.prm", """
set Dimension = 2
set End time = 4
set Output directory = output
set Stages = push, rest, again, join
set Parts = a
set Materials = m
set Conditions = load, hold
subsection Mesh
  set Type = box
  set Refine where = x < 1 && y < 1
  subsection box
    set Upper corner = 4, 4
    set Cells = 4, 4
  end
end
subsection Part: a
  set Cells = all
  set Formulation = hexahedron
  set Material = m
end
subsection Material: m
  set Model = elastic
  subsection elastic
    set Density = 1
    set Young's modulus = 1
    set Poisson's ratio = 0.3
  end
end
subsection Condition: load
  set Type = traction
  set Boundary = x max
  set Function = 0.001; 0.0005
end
subsection Condition: hold
  set Type = clamp
  set Boundary = x min
end
subsection Checkpoint
  set Step interval = 2
  set Keep = 100
end
subsection Output
  set Number = 2
  set Write solution = true
end
""" + stages)
        for ranks in (1, 2):
            shutil.rmtree(self.path("whole"), True)
            self.run_program("--quiet", "square.prm", ranks=ranks)
            cells = {stage: self.column_of(f"output/{stage}/statistics.csv", "cells")
                     for stage in ("push", "again", "join")}
            self.assertEqual((cells["push"][0], cells["push"][-1], max(cells["again"])), (19, 64, 64))
            # Those of `Refine where` are of the mesh of the file.
            self.assertEqual((cells["join"][0], cells["join"][-1]), (64, 19))
            shutil.copytree(self.path("output"), self.path("whole"))
            for stage in ("again", "join"):
                written = self.checkpoints(f"output/{stage}")
                self.assertGreater(len(written), 3)
                for later in ("again", "join")[("again", "join").index(stage) + 1:]:
                    shutil.rmtree(self.path("output", later))
                for name in [self.path("output", stage, "summary.json"),
                             self.path("output", stage, "checkpoint", "end.h5"), *written[2:]]:
                    os.remove(name)
                self.run_program("--quiet", "--resume", "square.prm", ranks=ranks)
                self.assert_same_results("whole/again", "output/again")
                self.assert_same_results("whole/join", "output/join")

    def column_of(self, file, begin):
        with open(self.path(file)) as table:
            rows = [line.strip().split(",") for line in table]
        column = next(k for k, name in enumerate(rows[0]) if name.startswith(begin))
        return [float(row[column]) for row in rows[1:]]

    def test_stages_of_bodies_in_contact(self):
        self.check_chain("parameter_files/contact/pressed_plate.prm", 2,
                         ("below mean force y", "above mean force y"))

    def test_stages_of_a_plate_between_rigid_dies(self):
        self.check_chain("tests/regression/rigid_dies.prm", 1,
                         ("below mean force y", "above mean force y"))


class RanksCase(Case):
    """Resumed on other ranks, a run agrees to round-off."""

    def column(self, directory):
        with open(self.path(directory, "statistics.csv")) as file:
            rows = [line.strip().split(",") for line in file]
        return rows[0], [[float(value) if value else 0. for value in row] for row in rows[1:]]

    def check(self, file, before, after):
        shutil.rmtree(self.path("resumed"), True)
        self.run_program("--quiet", file, "--set", "Output directory = whole", ranks=before)
        self.run_program("--quiet", file, "--set", "Output directory = resumed", "--set",
                         "Checkpoint/Step interval = 9", "--set", "Checkpoint/Keep = 1000",
                         ranks=before)
        middle = self.checkpoints("resumed")[1]
        self.run_program("--quiet", "--resume=" + middle, file, "--set",
                         "Output directory = resumed", ranks=after)
        header, whole = self.column("whole")
        again, resumed = self.column("resumed")
        self.assertEqual(header, again)
        self.assertEqual(len(whole), len(resumed))
        # Components of a vector, and energies, are compared with the largest of their kind.
        kinds = [re.sub(r"( [xyz])?( \[.*)?$", "", name) for name in header]
        kinds = ["energy" if re.search("energy|work", kind) else kind for kind in kinds]
        largest = {kind: max(abs(row[i]) for row in whole for i in range(len(header))
                             if kinds[i] == kind) for kind in kinds}
        for row, other in zip(whole, resumed):
            for name, kind, value, its in zip(header, kinds, row, other):
                # Errors, drifts and shares are relative already.
                scale = 1. if re.search("drift|error|share", name) else largest[kind]
                self.assertLessEqual(abs(value - its), 1e-10 * scale, (name, value, its))


class Ranks(RanksCase):
    def test_rod(self):
        self.write_small_rod(["set End time         = 0.5", "set End time = 3"])
        self.check("rod.prm", 1, 2)
        self.check("rod.prm", 3, 1)

    def test_rod_with_scaled_inertia(self):
        self.write_small_rod(["set End time         = 0.5", "set End time = 3"], GRAVITY,
                             scaling("set Mass factor = 0.2\n  set Process time factor = 1.7"))
        self.check("rod.prm", 1, 3)

    def test_impact_with_mass_added_on_the_way(self):
        self.write_small_rod(*IMPACT)
        self.check("rod.prm", 1, 2)
        self.check("rod.prm", 3, 1)

    def test_block(self):
        self.write("block.prm", block())
        self.check("block.prm", 2, 3)

    def test_bar_that_tears(self):
        self.write("bar.prm", torn_bar("12", RENEWED))
        self.check("bar.prm", 2, 3)

    def test_fragments_that_feel_each_other(self):
        self.write_colliding_bar("50", "0.1")
        self.check("bar.prm", 1, 3)
        header, rows = self.column("whole")
        damping = next(i for i, name in enumerate(header) if name.startswith("self-contact damping"))
        self.assertGreater(rows[-1][damping], 0.)


class Interruption(Case):
    def start(self, *options):
        return subprocess.Popen([command_line.PROGRAM] + list(options), cwd=self.directory,
                                stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                                stderr=subprocess.STDOUT)

    LONG = (["set End time         = 0.5", "set End time = 30"], ["set Times = 0.25", "set Number = 3"])

    def test_kill_loses_at_most_one_interval(self):
        # A checkpoint after every step: most kills hit the writing of one.
        self.write_small_rod(*self.LONG)
        self.run_program("--quiet", "rod.prm", "--set", "Output directory = whole")
        generator = random.Random(7)
        n_killed = 0
        options = ["--quiet", "rod.prm", "--set", "Checkpoint/Step interval = 1"]
        while n_killed < 8:
            process = self.start(*(["--resume"] if self.checkpoints() else []), *options)
            before = self.checkpoints()
            while self.checkpoints() == before and process.poll() is None:
                time.sleep(0.002)
            time.sleep(generator.uniform(0.0, 0.08))
            process.kill()
            printed = process.communicate()[0].decode(errors="replace")
            if process.returncode == 0:
                if n_killed > 2:
                    break
                # The machine was busy elsewhere while the run went to its end.
                self.assert_same_results("whole", "output")
                shutil.rmtree(self.path("output"))
                continue
            self.assertEqual(process.returncode, -signal.SIGKILL, printed)
            n_killed += 1
            # Every checkpoint that has its name is whole, and the one of the step before is there.
            log = re.findall(r"Checkpoint .*step_0*(\d+)\.h5", self.read("output", "log.txt"))
            newest = int(re.findall(r"step_(\d+)", self.checkpoints()[-1])[-1])
            self.assertGreaterEqual(newest, int(log[-1]) if log else 0)
            printed = self.run_program("--dry-run", "--resume", *options)
            self.assertNotIn("Warning", printed)
            self.assertIn("step %d," % newest, printed)
        self.run_program("--resume", *options)
        self.assert_same_results("whole", "output")

    def check_signal(self, number, code, *overrides):
        self.write_small_rod(["set End time         = 0.5", "set End time = 3"],
                             ["set Times = 0.25", "set Number = 3"],
                             checkpoints="subsection Checkpoint\n  set Wall time interval = 1e6\nend\n"
                                         "subsection Time step\n  set Fixed = 5e-5\nend\n")
        process = None
        # Again, where the machine was busy elsewhere while the run went to its end.
        while process is None or process.returncode == 0:
            shutil.rmtree(self.path("output"), True)
            process = self.start("rod.prm", *overrides)
            while not os.path.exists(self.path("output", "statistics.csv")) and process.poll() is None:
                time.sleep(0.01)
            process.send_signal(number)
            printed = process.communicate()[0].decode(errors="replace")
        self.assertEqual(process.returncode, code, printed)
        self.assertEqual(len(self.checkpoints()), 1)
        self.assertIn(json.loads(self.read("output", "summary.json"))["ended"],
                      ("interrupted", "terminated"))
        at = float(self.read("output", "statistics.csv").strip().splitlines()[-1].split(",")[0])
        # The command that the program prints, as a shell reads it.
        command = re.search(r"To continue: (.*) \(output/checkpoint/step_\d+\.h5\)", printed).group(1)
        again = subprocess.run(command, shell=True, cwd=self.directory, stdout=subprocess.PIPE,
                               stderr=subprocess.STDOUT, env=loaded.environment(1), check=False)
        printed = again.stdout.decode(errors="replace")
        self.assertEqual(again.returncode, 0, printed)
        # What was done before counts.
        first = re.search(r"^ *([\d.]+) %  t = ", printed, re.M).group(1)
        self.assertGreaterEqual(float(first), round(100 * at / 3, 1) - 0.11)
        self.run_program("--quiet", "rod.prm", "--set", "Output directory = whole", *overrides)
        self.assert_same_results("whole", "output")

    def test_a_termination_leaves_a_checkpoint_from_which_the_run_goes_on(self):
        self.check_signal(signal.SIGTERM, 143)

    def test_an_interrupt_leaves_a_checkpoint_from_which_the_run_goes_on(self):
        self.check_signal(signal.SIGINT, 130, "--set", "Condition: pulse/Function = 0.2*sin(pi*t); 0",
                          "--set", "Title = It's another")

    def test_a_finished_run_can_be_extended(self):
        self.write_small_rod(checkpoints="subsection Checkpoint\n  set Step interval = 100000\nend\n")
        self.run_program("--quiet", "rod.prm")
        self.run_program("--quiet", "--resume", "rod.prm", "--set", "End time = 1")
        summary = json.loads(self.read("output", "summary.json"))
        self.assertEqual(summary["simulated_time"], 1)
        self.assertGreater(summary["resumed_from_step"], 0)

    def test_wall_time_asks_for_checkpoints_and_old_ones_go(self):
        self.write_small_rod(["set End time         = 0.5", "set End time = 3"],
                             checkpoints="subsection Checkpoint\n  set Wall time interval = 1e-9\n"
                                         "  set Keep = 3\nend\n")
        self.run_program("--quiet", "rod.prm", ranks=2)
        self.assertEqual(len(self.checkpoints()), 3)
        self.assertEqual(self.read("output", "log.txt").count("Checkpoint ") > 3, True)

    def test_a_state_at_the_start_of_a_run_that_continues_another_has_the_time_of_its_velocities(self):
        self.write_small_rod(["set End time         = 0.5", "set End time = 1"])
        options = ["--quiet", "rod.prm", "--set", "Checkpoint/Wall time interval = 1e-9", "--set", "Checkpoint/Keep = 1000"]
        self.run_program(*options, "--set", "Checkpoint/End state = true")
        for state, output in (("output/checkpoint", "second"), ("second/checkpoint/step_000000000000.h5", "third")):
            self.run_program(*options, "--set", "Initial state = " + state, "--set", "Output directory = " + output)
        self.assertEqual(self.read("second", "statistics.csv"), self.read("third", "statistics.csv"))

    def test_a_run_anew_removes_checkpoints_of_an_earlier_one(self):
        self.write_small_rod(checkpoints="subsection Checkpoint\n  set Step interval = 3\nend\n")
        self.run_program("--quiet", "rod.prm")
        self.assertTrue(self.checkpoints())
        self.run_program("--quiet", "rod.prm", "--set", "Checkpoint/Step interval = 0")
        self.assertFalse(self.checkpoints())


class Refusals(Case):
    def setUp(self):
        super().setUp()
        self.write_small_rod(PROBES,
                             checkpoints="subsection Checkpoint\n  set Step interval = 3\nend\n")

    def refused(self, *options, ranks=1, expected=()):
        printed = " ".join(self.run_program(*options, exits=1, ranks=ranks).split())
        self.assertEqual(len(re.findall(r"\bError: ", printed)), 1, printed)
        for piece in expected:
            self.assertEqual(printed.count(piece), 1, "%r in %s" % (piece, printed))

    def test_without_a_checkpoint(self):
        for ranks in (1, 2):
            self.refused("--quiet", "--resume", "rod.prm", ranks=ranks,
                         expected=("there is no checkpoint in output/checkpoint",))
        self.refused("--quiet", "--resume=nowhere.h5", "rod.prm", expected=("nowhere.h5", "No such file"))
        self.refused("--quiet", "--resume=", "rod.prm", expected=("needs the name",))
        self.write("text.h5", "no checkpoint")
        self.refused("--quiet", "--resume=text.h5", "rod.prm",
                     expected=("truncated, damaged or no checkpoint",))

    def test_changes_of_the_model_are_named(self):
        self.run_program("--quiet", "rod.prm")
        def results():
            return [self.read("output", name) for name in ("statistics.csv", "conditions.csv", "summary.json")
                    ] + os.listdir(self.path("output", "checkpoint"))

        before = results()
        for change, expected in (
                ("Material: steel/elastic/Density = 101", 'was written with "100".'),
                ("Mesh/box/Cells = 10, 3", 'was written with "10, 2".'),
                ("Part: right/momentum consistent particle/Dilation = 1.7", 'was written with "1.8".'),
                ("Part: right/momentum consistent particle/Kernel = quintic spline",
                 'was written with'),
                ("Part: left/Formulation = fully integrated hexahedron", 'was written with "hexahedron".'),
                ("Condition: pulse/Function = 0.2*sin(pi*t); 0", 'was written with "0.1*sin(pi*t); 0".'),
                ("Part: left/Cells = x < 0.7", 'was written with "x < 1".'),
                ("Output/probes/Locations = other: 1, 0.2", 'was written with "left: '),
                ("End time = 0.1", "is of the later time 0.5")):
            extra = ["--set", "Output/Times = 0.05"] if change.startswith("End time") else []
            self.refused("--quiet", "--resume", "rod.prm", "--set", change, *extra,
                         expected=('Error: --set "%s' % change.split(" =")[0], expected))
        self.refused("--quiet", "--resume", "rod.prm", "--set", "Conditions =", "--set",
                     "Material: steel/elastic/Density = 99", ranks=2, expected=())
        self.refused("--quiet", "--resume", "rod.prm", "--set", "Output/condition history/Columns = *force x",
                     expected=("The columns of output/conditions.csv are not those of the run that is resumed",))
        self.assertEqual(results(), before)

    def test_a_mesh_file_that_has_changed_is_noticed(self):
        mesh = ("# vtk DataFile Version 3.0\nstrip\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS %d double\n"
                "%s\nCELLS %d %d\n%s\nCELL_TYPES %d\n%s\n")

        def write(n, height):
            points = "\n".join("%g %g 0" % (2 * i / n, y) for i in range(n + 1) for y in (0, height))
            cells = "\n".join("4 %d %d %d %d" % (2 * i, 2 * i + 2, 2 * i + 3, 2 * i + 1)
                              for i in range(n))
            self.write("strip.vtk", mesh % (2 * n + 2, points, n, 5 * n, cells, n,
                                            "\n".join(["9"] * n)))

        box = "  set Type = box\n  subsection box\n    set Upper corner = 2, 0.4\n    set Cells        = " \
              "10, 2\n  end"
        self.write_small_rod([box, "  set Type = file\n  subsection file\n    set File = strip.vtk\n  end"],
                             checkpoints="subsection Checkpoint\n  set Step interval = 3\nend\n")
        write(10, 0.2)
        self.run_program("--quiet", "rod.prm")
        write(10, 0.21)
        self.refused("--quiet", "--resume", "rod.prm", expected=("is of another mesh", "up to 0.01 apart"))
        write(12, 0.2)
        self.refused("--quiet", "--resume", "rod.prm", ranks=2,
                     expected=("is of another model", 'rows of "node"'))

    def test_a_truncated_or_damaged_file_is_refused_and_the_one_before_is_taken(self):
        self.run_program("--quiet", "rod.prm", "--set", "Output directory = whole")
        self.run_program("--quiet", "rod.prm")
        newest, before = self.checkpoints()[::-1]
        whole = open(newest, "rb").read()
        name = os.path.relpath(newest, self.directory)
        with open(newest, "wb") as file:
            file.write(whole[:len(whole) // 2])
        self.refused("--quiet", "--resume=" + name, "rod.prm", ranks=2,
                     expected=("truncated, damaged or no checkpoint",))
        printed = self.run_program("--quiet", "--resume", "rod.prm", ranks=1)
        self.assertEqual(printed.count(" The one before it is tried."), 1)
        self.assertIn("Resumed from " + os.path.relpath(before, self.directory), printed)
        self.assert_same_results("whole", "output")

        # Bits of a position, found by its value.
        newest = self.checkpoints()[-1]
        damaged = bytearray(open(newest, "rb").read())
        index = damaged.find(bytes("0.1*sin(pi*t)", "ascii"))
        self.assertGreater(index, 0)
        damaged[index] ^= 1
        with open(newest, "wb") as file:
            file.write(damaged)
        self.refused("--quiet", "--resume=" + os.path.relpath(newest, self.directory), "rod.prm",
                     ranks=2, expected=('its field "parameters" does not have its checksum',))
        for checkpoint in self.checkpoints():
            with open(checkpoint, "wb") as file:
                file.write(damaged)
        self.refused("--quiet", "--resume", "rod.prm", expected=("there is no whole checkpoint in",))


if __name__ == "__main__":
    command_line.PROGRAM, command_line.MPIEXEC, command_line.SOURCE, subject = sys.argv[1:5]
    suite = unittest.defaultTestLoader.loadTestsFromTestCase(
        globals()["".join(word.capitalize() for word in subject.split("_"))])
    sys.exit(not unittest.TextTestRunner(verbosity=2).run(suite).wasSuccessful())

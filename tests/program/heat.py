#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Scenes with heat: what they leave behind, what they leave alone, and their checkpoints.

    heat.py PROGRAM MPIEXEC SOURCE_DIRECTORY runs|bitwise|ranks
"""

import csv
import glob
import os
import re
import shutil
import sys
import unittest

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import checkpoint
import command_line
import run_cases

RADIATION = """
subsection Condition: sky
  set Type                      = radiation
  set Boundary                  = y max
  set Emissivity                = 0.8
  set Ambient temperature       = 5
  set Stefan-Boltzmann constant = 1e-8
end
"""
COOLED = """
subsection Condition: cooled
  set Type     = temperature
  set Where    = x > 1.7 && y < 1e-9
  set Function = 20 - 10*t
end
"""
PROBES = ("  set Times = 0.25", "  set Times = 0.25\n  subsection probes\n    set Locations = "
          "left: 0.2, 0.2; right: 1.6, 0.4\n    set Steps = 2\n  end")
HEAT = """  subsection Heat
    set Specific heat capacity = 3
    set Conductivity           = 0
    set Initial temperature    = 20
  end
"""
EXPLICIT = "set Time integration = explicit"
IMPLICIT = """set Time integration = %s
  subsection %s
    set Step      = 0.02
    set Tolerance = 1e-12
  end"""
# Capacity and conductivity over the temperature, radiation and a prescribed temperature.
TABLES = (["capacity = 3", "capacity = 0: 2, 20: 3, 40: 4"],
          ["set Conductivity           = 6", "set Conductivity = 0: 4, 20: 6, 40: 9"],
          [EXPLICIT, "set Absolute zero = -273.15\n  " + EXPLICIT],
          ["= burner, air", "= burner, air, sky, cooled"],
          ["subsection Output", RADIATION + COOLED + "\nsubsection Output"])


def implicit(method):
    return [EXPLICIT, IMPLICIT % (method, method)]


class Scenes:
    """Writes the parameter files of this directory, with changes."""

    def write_scene(self, file, *changes, name="case.prm"):
        text = run_cases.parameter_text({"file": file, "replace": changes})
        self.write(name, text.replace("@OUTPUT@", "output"))

    def statistics(self, directory):
        with open(self.path(directory, "statistics.csv")) as file:
            return list(csv.DictReader(file))

    def fields_of_pictures(self, directory):
        names = set()
        for piece in glob.glob(self.path(directory, "solution", "*.pvtu")):
            with open(piece) as file:
                names.update(re.findall(r'Name="([^"]*)"', file.read()))
        return names


class Runs(checkpoint.Case, Scenes):
    def run_scene(self, file, *changes, ranks=1, output="output"):
        self.write_scene(file, *changes)
        self.run_program("--quiet", "case.prm", "--set", "Output directory = " + output, ranks=ranks)
        return self.statistics(output)

    def test_heat_alone_writes_nothing_of_mechanics(self):
        row = self.run_scene("heat.prm")[-1]
        for name in row:
            self.assertIsNone(re.search("kinetic|elastic|momentum|speed|stress|external|lattice", name),
                              name)
        self.assertTrue(any(name.startswith("enthalpy") for name in row))
        fields = self.fields_of_pictures("output")
        self.assertTrue(any("temperature" in name for name in fields), fields)
        for name in fields:
            self.assertIsNone(re.search("velocity|stress|displacement|force|acceleration", name), name)

    def test_mechanics_alone_write_nothing_of_heat(self):
        row = self.run_scene("rod.prm")[-1]
        fields = self.fields_of_pictures("output")
        self.assertTrue(any("velocity" in name for name in fields), fields)
        for name in list(row) + sorted(fields):
            self.assertIsNone(re.search("temperature|heat|enthalpy|thermal step", name), name)

    def check_zero_conductivity(self, change, ranks):
        """Without conduction every node keeps what reaches it: the heat of the burner is exact."""
        row = self.run_scene("heat.prm", ["set Conductivity           = 6", "set Conductivity = 0"],
                             ["5*sin(pi*t)^2", "5"], change, ["Smoothing = affine", "Smoothing = none"],
                             ranks=ranks)[-1]
        burner, air, enthalpy = [float(value) for key in ("heat through burner", "heat through air",
                                                          "enthalpy")
                                 for name, value in row.items() if name.startswith(key)]
        self.assertAlmostEqual(burner, 5 * 0.4 * 0.5, delta=1e-13)
        self.assertLess(air, -0.1)
        self.assertAlmostEqual(enthalpy, burner + air, delta=1e-12)
        # Nodes of the heated face: capacity 2*3*0.04 for a length of 0.2, half of that in a corner,
        # where as much less enters.
        largest = float([value for name, value in row.items() if name.startswith("largest nodal")][0])
        self.assertAlmostEqual(largest, 20 + burner / (2 * 3 * 0.1 * 0.4), delta=1e-11)
        return float([value for name, value in row.items() if name.startswith("smallest nodal")][0])

    def test_zero_conductivity_with_explicit_steps(self):
        for ranks in (1, 2):
            self.check_zero_conductivity(
                [EXPLICIT, EXPLICIT + "\n  subsection explicit\n    set Maximum = 0.01\n  end"], ranks)

    def test_zero_conductivity_with_implicit_steps(self):
        for method in ("backward Euler", "Crank-Nicolson"):
            for ranks in (1, 2):
                self.check_zero_conductivity(implicit(method), ranks)

    def test_zero_conductivity_without_conditions_changes_nothing(self):
        for change in ([EXPLICIT, EXPLICIT], implicit("backward Euler")):
            rows = self.run_scene("heat.prm", ["set Conductivity           = 6", "set Conductivity = 0"],
                                  ["set Conditions       = burner, air", ""],
                                  ["subsection Condition: burner\n  set Type     = heat flux\n  set "
                                   "Boundary = x min\n  set Function = 5*sin(pi*t)^2\nend\n", ""],
                                  ["subsection Condition: air\n  set Type                = convection\n"
                                   "  set Where               = x > 1.999\n  set Film coefficient    = 2"
                                   "\n  set Ambient temperature = 15 + t\nend\n", ""], change)
            for name, value in rows[-1].items():
                if "nodal temperature" in name:
                    self.assertAlmostEqual(float(value), 20, delta=1e-12)
                if name.startswith("enthalpy"):
                    self.assertAlmostEqual(float(value), 0, delta=1e-12)

    def test_heat_that_nothing_feels_changes_no_bit_of_the_mechanics(self):
        probes = ("  set Times = 0.25", "  set Times = 0.25\n  subsection probes\n    set Locations = "
                  "left: 0.2, 0.2; right: 2, 0.4\n    set Steps = 1\n  end")
        long = ["set End time         = 0.5", "set End time = 9"]
        ratio = "    set Poisson's ratio = 0.3\n  end\n"
        for ranks in (1, 2):
            cold = self.run_scene("rod.prm", probes, long, ranks=ranks, output="cold")
            warm = self.run_scene("rod.prm", probes, long, [ratio, ratio + HEAT], ranks=ranks,
                                  output="warm")
            self.assertEqual(len(cold), len(warm))
            self.assertGreater(float(cold[-1]["step"]), 50)
            for row, other in zip(cold, warm):
                self.assertEqual(row, {name: other[name] for name in row})
            for name in ("position", "displacement", "velocity"):
                self.assertTrue(any(name in column for column in self.probes("cold")[0]), name)
            for row, other in zip(self.probes("cold"), self.probes("warm")):
                self.assertEqual(row, {name: other[name] for name in row})

    def test_heat_of_all_kinds_together_is_neither_lost_nor_doubled(self):
        for ranks in (1, 2):
            for smoothing in ("affine", "paper"):
                row = self.run_scene("pulled.prm", *SLIDING,
                                     ["Smoothing = affine", "Smoothing = " + smoothing],
                                     ranks=ranks)[-1]
                for name in ("friction heat of bodies", "plastic heat", "heat through air"):
                    share, = [float(value) for key, value in row.items() if key.startswith(name)]
                    self.assertGreater(abs(share), 1e-3, name)
                self.assertLess(abs(float(row["heat balance error"])), 1e-13, (smoothing, ranks))

    def test_heat_of_cells_that_are_removed_is_lost_and_not_doubled(self):
        for ranks in (1, 2):
            for method in ("explicit", "backward Euler"):
                change = [EXPLICIT, EXPLICIT] if method == "explicit" else implicit(method)
                row = self.run_scene("pulled.prm", *SLIDING, *ERODING, change, ranks=ranks)[-1]
                for name, least in (("eroded cells", 1), ("eroded heat", 1e-3), ("eroded mass", 1e-2)):
                    value, = [float(value) for key, value in row.items() if key.startswith(name)]
                    self.assertGreater(value, least, name)
                self.assertLess(abs(float(row["heat balance error"])), 1e-13, (method, ranks))
                self.assertLess(abs(float(row["momentum drift"])), 1e-12, (method, ranks))

    def test_heat_of_a_tool_and_of_the_body_that_it_rubs_is_that_of_friction(self):
        for ranks in (1, 2, 3):
            row = self.run_scene("pulled.prm", *SLIDING, *ON_TOOL, ranks=ranks)[-1]
            with open(self.path("output", "contact.csv")) as file:
                tool = list(csv.DictReader(file))[-1]
            friction, body_heat, tool_heat, conducted, temperature = [
                float(value) for key in ("friction heat", "heat of bodies", "heat of tool",
                                         "conducted heat", "tool temperature")
                for name, value in tool.items() if name.startswith("floor " + key)]
            self.assertGreater(friction, 1e-4)
            self.assertGreater(conducted, 1e-3)
            self.assertAlmostEqual(body_heat, 0.7 * friction + conducted, delta=1e-13)
            self.assertAlmostEqual(tool_heat, 0.05 * (temperature - 60), delta=1e-13)
            self.assertAlmostEqual(body_heat + tool_heat, friction, delta=1e-13)
            self.assertLess(abs(float(row["heat balance error"])), 1e-13, ranks)
            self.assertLess(abs(float(row["energy error"])), 0.01, ranks)

    def test_heat_that_a_contact_has_left_at_the_end_of_a_stage_is_given_in_the_next(self):
        """Few thermal steps, the last of which is not at the end; nothing else heats the block, and nothing cools it."""
        self.write_scene("pulled.prm", *SLIDING, *ON_TOOL, ["Quinney coefficient = 0.9", "Quinney coefficient = 0"],
                         name="case.prm")
        self.write("chain.prm", "include case.prm\nset End time = 0.27\nsubsection Output\n  set Times = 0.1\nend\nset Stages = rub, rest\n"
                   "subsection Stage: rub\nend\n"
                   "subsection Stage: rest\n  set Contacts =\n  set Conditions = hold\n  set End time = 0.2\nend\n")
        for ranks in (1, 2):
            self.run_program("--quiet", "chain.prm", ranks=ranks)
            last, rows = self.statistics("output/rub")[-1], self.statistics("output/rest")
            pending, enthalpy = (float(last[name + " [M L^2/T^2]"]) for name in ("pending heat", "enthalpy"))
            self.assertGreater(abs(pending), 1e-4)
            for row in rows:
                self.assertAlmostEqual(float(row["enthalpy [M L^2/T^2]"]), enthalpy + pending, delta=1e-13)

    def probes(self, directory):
        with open(self.path(directory, "probes.csv")) as file:
            return list(csv.DictReader(file))


class Bitwise(checkpoint.BitwiseCase, Scenes):
    def check_scene(self, file, interval, first, *changes):
        self.write_scene(file, *changes)
        self.check_on_ranks("case.prm", interval, (first,), (0.6,))

    def test_heat_alone_with_explicit_steps(self):
        self.check_scene("heat.prm", 5, 0.1, PROBES)

    def test_heat_alone_with_tables_and_explicit_steps(self):
        self.check_scene("heat.prm", 3, 0.2, PROBES, *TABLES)

    def test_explicit_steps_that_a_film_shortens_when_it_comes(self):
        self.write_scene("heat.prm", PROBES, ["= 2\n  set Ambient", "= 2 + 400*(t > 0.4)\n  set Ambient"])
        # Some are before the step that includes it, and some after.
        self.check("case.prm", 1, [k / 100 for k in range(36, 50, 2)], 1)

    def test_heat_alone_with_implicit_steps(self):
        self.check_scene("heat.prm", 5, 0.2, PROBES, implicit("backward Euler"))

    def check_among_writers(self, file, interval, which, ranks, *changes):
        """The preconditioner of what is not linear is made anew after a checkpoint, by the run that
        writes it and by the one that reads it: runs that write the same checkpoints are compared."""
        self.write_scene(file, *changes)
        options = ["--quiet", "case.prm", "--set", "Checkpoint/Step interval = %d" % interval, "--set",
                   "Checkpoint/Keep = 1000"]
        self.run_program(*options, "--set", "Output directory = whole", ranks=ranks)
        written = self.checkpoints("whole")
        self.assertGreater(len(written), 2)
        for fraction in which:
            checkpoint = written[int(fraction * (len(written) - 1))]
            with self.subTest(checkpoint=os.path.basename(checkpoint), ranks=ranks):
                shutil.rmtree(self.path("resumed"), True)
                shutil.copytree(self.path("whole"), self.path("resumed"))
                self.spoil_results("resumed")
                again = self.path("resumed", "checkpoint", os.path.basename(checkpoint))
                self.run_program("--resume=" + again, *options, "--set", "Output directory = resumed",
                                 ranks=ranks)
                self.assert_same_results("whole", "resumed")

    def test_heat_alone_with_tables_and_implicit_steps(self):
        for method, ranks in (("backward Euler", 2), ("Crank-Nicolson", 1)):
            self.check_among_writers("heat.prm", 5, (0.2, 0.6), ranks, PROBES, *TABLES, implicit(method))

    def test_plastic_block_with_explicit_steps_of_heat(self):
        self.check_scene("pulled.prm", 9, 0.2)

    def test_plastic_block_with_implicit_steps_of_heat(self):
        self.check_among_writers("pulled.prm", 9, (0.3,), 2, implicit("backward Euler"))

    def test_plastic_block_that_slides(self):
        self.check_scene("pulled.prm", 9, 0.5, *SLIDING)

    def test_plastic_block_that_erodes(self):
        self.check_scene("pulled.prm", 9, 0.5, *ERODING)
        self.check_among_writers("pulled.prm", 9, (0.3,), 2, *ERODING, implicit("backward Euler"))

    def test_plastic_block_that_slides_and_erodes(self):
        self.check_scene("pulled.prm", 9, 0.5, *SLIDING, *ERODING)

    def test_plastic_block_that_becomes_particles(self):
        for kernel in CURRENT_KERNEL, INITIAL_KERNEL:
            self.check_scene("pulled.prm", 9, 0.5, *CONVERTING, kernel)

    def test_plastic_block_that_slides_and_becomes_particles(self):
        self.check_scene("pulled.prm", 9, 0.5, *SLIDING, *CONVERTING, INITIAL_KERNEL)

    def test_plastic_block_that_becomes_particles_near_the_floor(self):
        self.check_scene("pulled.prm", 9, 0.5, *SLIDING, *SPLIT, *CONVERTING, INITIAL_KERNEL,
                         ["set Conversion strain = 0.1",
                          "set Conversion gap = 0.2\n    set Conversion contact = floor"])

    def test_plastic_block_on_a_hot_tool_that_forces_move(self):
        self.check_scene("pulled.prm", 9, 0.5, *SLIDING, *ON_TOOL)


class Ranks(checkpoint.RanksCase, Scenes):
    def check_scene(self, file, *changes):
        self.write_scene(file, *changes)
        self.check("case.prm", 1, 2)
        self.check("case.prm", 3, 1)

    def test_heat_alone_with_explicit_steps(self):
        self.check_scene("heat.prm", *TABLES)

    def test_heat_alone_with_implicit_steps(self):
        self.check_scene("heat.prm", implicit("backward Euler"))

    def test_heat_alone_with_tables_and_implicit_steps(self):
        self.check_scene("heat.prm", *TABLES, implicit("Crank-Nicolson"))

    def test_plastic_block(self):
        self.check_scene("pulled.prm")
        self.check_scene("pulled.prm", implicit("backward Euler"))

    def test_plastic_block_that_slides(self):
        self.check_scene("pulled.prm", *SLIDING)

    def test_plastic_block_that_erodes(self):
        self.check_scene("pulled.prm", *ERODING)
        self.check_scene("pulled.prm", *SLIDING, *ERODING)

    def test_plastic_block_that_becomes_particles(self):
        for kernel in CURRENT_KERNEL, INITIAL_KERNEL:
            self.check_scene("pulled.prm", *CONVERTING, kernel)
        self.check_scene("pulled.prm", *SLIDING, *CONVERTING, INITIAL_KERNEL)

    def test_plastic_block_on_a_hot_tool_that_forces_move(self):
        self.check_scene("pulled.prm", *SLIDING, *ON_TOOL)


# Elements that are pulled by so much are removed, at the clamped end and beside the particles.
ERODING = (["set Formulation = fully integrated hexahedron",
            "set Formulation = fully integrated hexahedron\n  subsection fully integrated hexahedron\n"
            "    set Erosion strain = 0.1\n  end"],)


# They become particles instead.
CONVERTING = (["set Formulation = fully integrated hexahedron",
               "set Formulation = fully integrated hexahedron\n  subsection fully integrated hexahedron\n"
               "    set Conversion strain = 0.1\n    set Conversion layers = 0\n  end"],
              ["= left, right", "= left, right, torn"],
              ["subsection Material: metal", """subsection Part: torn
  set Cells       = from left
  set Formulation = momentum consistent particle
  set Material    = metal
  subsection momentum consistent particle
    set Configuration = KERNEL
  end
end

subsection Material: metal"""])
INITIAL_KERNEL = ["= KERNEL", "= total Lagrangian"]
CURRENT_KERNEL = ["= KERNEL", "= updated Lagrangian\n    set Rebuild interval = 7"]


# A rigid floor on which the block slides, with symmetry in its middle.
SLIDING = (["= hold, pull, air", "= hold, pull, air, push, middle\nset Contacts = floor"],
           ["subsection Output", """subsection Contact: floor
  set Surface       = plane
  set Stiffness     = 0.3
  set Friction      = 0.3
  set Damping       = 0.1
  set Heat fraction = 0.7
  subsection plane
    set Point  = 0, 0, 0
    set Normal = 0, 0, 1
  end
end

subsection Condition: push
  set Type     = traction
  set Boundary = z max
  set Function = 0; 0; -0.3
end

subsection Condition: middle
  set Type     = symmetry
  set Boundary = y max
end

subsection Output"""])

# The floor as a tool with a mass and a temperature of its own.
# Friction of which the traction is limited, and whose heat is split by effusivities.
SPLIT = (["  set Heat fraction = 0.7",
          "  set Heat fraction   = by effusivity\n  set Tool effusivity = 3\n  set Shear limit     = 0.05"],)
ON_TOOL = (["  set Friction      = 0.3", """  set Friction         = 0: 0.4, 40: 0.2
  set Conductance      = 0: 0.02, 5: 0.2
  set Tool temperature = 60
  set Heat capacity    = 0.05"""],
           ["    set Normal = 0, 0, 1", """    set Normal = 0, 0, 1
    set Mass             = 0.3
    set Force            = 0; 0; 0.1*(1 - exp(-5*t))
    set Initial velocity = 0, 0, 0.01
    set Directions       = 0, 0, 1"""])


if __name__ == "__main__":
    command_line.PROGRAM, command_line.MPIEXEC, command_line.SOURCE, subject = sys.argv[1:5]
    suite = unittest.defaultTestLoader.loadTestsFromTestCase(
        {"runs": Runs, "bitwise": Bitwise, "ranks": Ranks}[subject])
    sys.exit(not unittest.TextTestRunner(verbosity=2).run(suite).wasSuccessful())

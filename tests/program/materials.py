#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""The shipped materials: each has a source for every value, and runs in a small scene with all that it has.

    materials.py PROGRAM PROJECT_DIRECTORY
"""

import csv
import glob
import os
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

sys.path.insert(0, os.path.join(os.path.dirname(os.path.dirname(os.path.abspath(__file__))), "loaded"))
import loaded

PROGRAM, PROJECT = sys.argv[1:3]
FOLDER = os.path.join(PROJECT, "parameter_files", "materials")
FURTHER = ("adiabatic", "heat", "damage", "shock")

SCENE = """set Dimension          = 2
set Parts              = elements, particles
set Materials          = metal
set Initial conditions = flight
set End time           = 2e-7
set Output directory   = @OUTPUT@
subsection Mesh
  set Type = box
  subsection box
    set Upper corner = 2e-3, 1e-3
    set Cells        = 8, 4
  end
end
subsection Part: elements
  set Cells       = x < 1e-3
  set Formulation = hexahedron
  set Material    = metal
end
subsection Part: particles
  set Cells       = otherwise
  set Formulation = momentum consistent particle
  set Material    = metal
end
subsection Material: metal
@INCLUDES@
end
subsection Initial condition: flight
  set Velocity = 1e5*(x-1e-3); -3e4*y
end
subsection Output
  set Number = 2
end
"""


def names():
    """The materials, without the files that add to them."""
    files = [os.path.basename(name)[:-len(".prm")] for name in glob.glob(os.path.join(FOLDER, "*.prm"))]
    return sorted(name for name in files if name.rpartition("_")[2] not in FURTHER)


class Materials(unittest.TestCase):
    def setUp(self):
        self.directory = tempfile.mkdtemp(prefix="tombolo_materials_")
        self.addCleanup(shutil.rmtree, self.directory, True)

    def run_scene(self, *pieces):
        """Runs it with these files of a material; the last row of the statistics by name."""
        scene, output = (os.path.join(self.directory, name) for name in ("scene.prm", "output"))
        shutil.rmtree(output, ignore_errors=True)
        includes = "\n".join(f"  include {os.path.join(FOLDER, piece)}.prm" for piece in pieces)
        with open(scene, "w", encoding="utf-8") as file:
            file.write(SCENE.replace("@INCLUDES@", includes).replace("@OUTPUT@", output))
        result = subprocess.run([*loaded.start_of(PROGRAM), scene], env=loaded.environment(1), capture_output=True,
                                text=True, check=False)
        self.assertEqual(result.returncode, 0, result.stdout + result.stderr)
        with open(os.path.join(output, "statistics.csv"), newline="", encoding="utf-8") as file:
            rows = list(csv.reader(file))
        return {re.sub(r" \[[^]]*\]$", "", head): float(value) for head, value in zip(rows[0], rows[-1])}

    def test_all_that_are_documented_are_there(self):
        with open(os.path.join(PROJECT, "doc", "materials.md"), encoding="utf-8") as file:
            text = file.read()
        self.assertEqual(len(names()), 8)
        for name in names():
            self.assertIn(f"`{name}`", text)

    def test_every_value_has_a_source(self):
        for name in glob.glob(os.path.join(FOLDER, "*.prm")):
            with open(name, encoding="utf-8") as file:
                for number, line in enumerate(file, 1):
                    match = re.match(r"\s*set ([^=]*\S)\s*= ([^#]*)(#.*)?$", line)
                    if not match or match.group(1) in ("Model", "Flow stress", "Damage", "Equation of state",
                                                       "Initial temperature"):
                        continue
                    self.assertRegex(match.group(3) or "", r"\[(seen|recalled|assumed)\]",
                                     f"{os.path.basename(name)}:{number}: {line}")

    def test_each_runs_with_all_that_it_has(self):
        for name in names():
            has = {piece for piece in FURTHER if os.path.exists(os.path.join(FOLDER, f"{name}_{piece}.prm"))}
            self.assertIn("heat", has)
            further = [f"{name}_damage"] if "damage" in has else []
            with self.subTest(material=name, with_heat=True):
                last = self.run_scene(name, name + "_heat", *further)
                self.assertLess(abs(last["energy error"]), 1e-2)
                self.assertLess(abs(last["heat balance error"]), 1e-9)
            if "adiabatic" not in has:
                continue
            if "shock" in has:
                further.append(f"{name}_shock")
            with self.subTest(material=name, with_heat=False):
                last = self.run_scene(name, name + "_adiabatic", *further)
                self.assertLess(abs(last["energy error"]), 1e-2)
                self.assertGreater(last["largest effective plastic strain"], 1e-3)
                self.assertGreater(last["largest temperature"], 290)
                self.assertEqual("largest damage" in last, "damage" in has)
                if "damage" in has:
                    self.assertGreater(last["largest damage"], 0)


unittest.main(argv=sys.argv[:1], verbosity=1)

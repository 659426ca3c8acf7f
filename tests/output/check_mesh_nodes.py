# SPDX-License-Identifier: LGPL-2.1-or-later
"""Probes at nodes by their numbers in the mesh file: two strips that touch and fly apart, of elements, some of
them refined, and of particles.

    check_mesh_nodes.py RANKS MPIEXEC PROGRAM SCRIPTS
"""

import random
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

RANKS, MPIEXEC, PROGRAM, SCRIPTS = sys.argv[1:5]
sys.path[:0] = [SCRIPTS, str(Path(__file__).resolve().parents[1] / "loaded")]
import loaded  # noqa: E402
import tombolo  # noqa: E402

N_X, N_Y = 8, 3
SCALE = 0.5

SCENE = """
set Title              = Two strips
set Dimension          = 2
set End time           = 0.05
set Parts              = left, right
set Materials          = rubber
set Initial conditions = from left, from right
set Output directory   = output

subsection Mesh
  set Type         = file
  set Refine where = x < 0.3
  subsection file
    set File  = @FILE@
    set Scale = 0.5
  end
end

subsection Part: left
  set Cells       = material 1
  set Formulation = hexahedron
  set Material    = rubber
end

subsection Part: right
  set Cells       = material 2
  set Formulation = momentum consistent particle
  set Material    = rubber
end

subsection Material: rubber
  set Model = elastic
  subsection elastic
    set Density         = 1
    set Young's modulus = 1
    set Poisson's ratio = 0.3
  end
end

subsection Initial condition: from left
  set Part     = left
  set Velocity = -1; 0
end

subsection Initial condition: from right
  set Part     = right
  set Velocity = 1; 0
end

subsection Output
  set Number         = 2
  set Write solution = false
  subsection probes
    set Mesh nodes = @NODES@
    set Steps      = 1
  end
end
"""


def strips():
    """Coordinates of nodes, those of the second strip after those of the first, and cells by node, with materials."""
    points, cells = [], []
    for strip in range(2):
        first = len(points)
        points += [(strip + i / N_X, j / N_X) for j in range(N_Y + 1) for i in range(N_X + 1)]
        for j in range(N_Y):
            for i in range(N_X):
                corner = first + j * (N_X + 1) + i
                cells.append(((corner, corner + 1, corner + N_X + 2, corner + N_X + 1), strip + 1))
    return points, cells


class MeshNodes(unittest.TestCase):
    def setUp(self):
        self.temporary = tempfile.TemporaryDirectory()
        self.addCleanup(self.temporary.cleanup)
        self.directory = Path(self.temporary.name)
        self.points, self.cells = strips()
        generator = random.Random(5)
        self.tags = generator.sample(range(1, 1000), len(self.points))
        self.order = generator.sample(range(len(self.points)), len(self.points))

    def gmsh(self):
        lines = ["$MeshFormat", "2.2 0 8", "$EndMeshFormat", "$Nodes", str(len(self.points) + 1)]
        lines.append("1001 7 7 0")  # which no cell has
        lines += [f"{self.tags[n]} {self.points[n][0]} {self.points[n][1]} 0" for n in self.order]
        lines += ["$EndNodes", "$Elements", str(len(self.cells))]
        lines += [f"{c} 3 2 {material} {material} " + " ".join(str(self.tags[node]) for node in nodes)
                  for c, (nodes, material) in enumerate(self.cells, 1)]
        return "\n".join(lines + ["$EndElements", ""])

    def vtk(self):
        lines = ["# vtk DataFile Version 3.0", "strips", "ASCII", "DATASET UNSTRUCTURED_GRID", f"POINTS {len(self.points)} double"]
        lines += [f"{x} {y} 0" for x, y in self.points]
        lines += [f"CELLS {len(self.cells)} {5 * len(self.cells)}"] + ["4 " + " ".join(map(str, nodes)) for nodes, _ in self.cells]
        lines += [f"CELL_TYPES {len(self.cells)}"] + ["9"] * len(self.cells)
        lines += [f"CELL_DATA {len(self.cells)}", "SCALARS MaterialID int", "LOOKUP_TABLE default"]
        return "\n".join(lines + [str(material) for _, material in self.cells] + [""])

    def run_scene(self, file, text, nodes, *options):
        (self.directory / file).write_text(text, "utf-8")
        scene = self.directory / "scene.prm"
        scene.write_text(SCENE.replace("@FILE@", file).replace("@NODES@", ", ".join(map(str, nodes))), "utf-8")
        command = [] if RANKS == "1" else [MPIEXEC, "-n", RANKS]
        finished = subprocess.run([*command, *loaded.start_of(PROGRAM), "scene.prm", *options], cwd=self.directory,
                                  env=loaded.environment(int(RANKS)), capture_output=True, text=True, check=False)
        return finished.returncode, finished.stdout + finished.stderr

    def check(self, file, text, numbers):
        """The numbers are those of the nodes, in their order."""
        wanted = [3, N_X, 2 * N_X + 1, (N_X + 1) * (N_Y + 1), len(self.points) - 1, 0, (N_X + 1) * (N_Y + 1) + N_X + 1]
        code, printed = self.run_scene(file, text, [numbers[n] for n in wanted])
        self.assertEqual(code, 0, printed)
        probes = tombolo.Run(self.directory / "output").probes
        self.assertEqual(sum(name.endswith(" position x") for name in probes), len(wanted))
        for n in wanted:
            for axis, coordinate in zip("xy", self.points[n]):
                self.assertAlmostEqual(probes[f"mesh node {numbers[n]} position {axis}"][0], SCALE * coordinate, delta=1e-15)
            # Nodes of both strips lie where these touch.
            sign = -1 if n < (N_X + 1) * (N_Y + 1) else 1
            self.assertAlmostEqual(sign * probes[f"mesh node {numbers[n]} velocity x"][-1], 1, delta=1e-12)

    def test_tags_of_gmsh(self):
        self.check("strips.msh", self.gmsh(), self.tags)

    def test_points_of_vtk_and_a_resumed_run(self):
        self.check("strips.vtk", self.vtk(), range(len(self.points)))
        options = ("--set", "Checkpoint/Step interval = 2", "--set", "Output/probes/Where = x > 0.999",
                   "--set", "Output/probes/Nodes = 0")
        code, printed = self.run_scene("strips.vtk", self.vtk(), [5, 2], "--overwrite", *options)
        self.assertEqual(code, 0, printed)
        before = (self.directory / "output/probes.csv").read_bytes()
        names = [name.removesuffix(" position x") for name in tombolo.Run(self.directory / "output").probes
                 if name.endswith(" position x")]
        self.assertEqual(names[:3], ["node 0", "mesh node 5", "mesh node 2"])
        self.assertEqual(len(names), 3 + N_Y + 1)
        code, printed = self.run_scene("strips.vtk", self.vtk(), [5, 2], "--resume", *options)
        self.assertEqual(code, 0, printed)
        self.assertEqual((self.directory / "output/probes.csv").read_bytes(), before)

    def test_numbers_that_are_not_there_are_refused(self):
        free = next(number for number in range(2, 1000) if number not in self.tags)
        code, printed = self.run_scene("strips.msh", self.gmsh(), [free], "--dry-run")
        self.assertEqual(code, 1)
        nearest = min(self.tags, key=lambda tag: abs(tag - free))
        self.assertRegex(printed, f"no cell of the mesh file has a corner with the number {free}; the nearest number is")
        self.assertTrue(any(f"the nearest number is {tag}" in printed for tag in self.tags
                            if abs(tag - free) == abs(nearest - free)), printed)
        code, printed = self.run_scene("strips.msh", self.gmsh(), [1001], "--dry-run")
        self.assertEqual(code, 1)
        self.assertIn(f"number 1001; the nearest number is {max(self.tags)}", printed)


if __name__ == "__main__":
    del sys.argv[1:]
    unittest.main(verbosity=2)

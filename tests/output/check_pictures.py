# SPDX-License-Identifier: LGPL-2.1-or-later
"""Runs sheared.prm and checks its pictures with VTK, as ParaView would show them.

    check_pictures.py RANKS MPIEXEC PROGRAM
"""

import sys
import subprocess
import tempfile
import unittest
import xml.etree.ElementTree as ElementTree
from pathlib import Path

import numpy as np
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkFiltersCore import vtkCellCenters, vtkTensorGlyph
from vtkmodules.vtkFiltersSources import vtkSphereSource
from vtkmodules.vtkIOXML import vtkXMLPUnstructuredGridReader, vtkXMLUnstructuredGridReader

RANKS, MPIEXEC, PROGRAM = sys.argv[1:4]
sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "loaded"))
import loaded  # noqa: E402

SCENE = Path(__file__).with_name("sheared.prm")
SHEAR = 0.5


def run(directory, *settings):
    """A run of the scene with further entries; what it prints."""
    scene = Path(directory) / "scene.prm"
    output = Path(directory) / "output"
    scene.write_text(SCENE.read_text("utf-8").replace("@OUTPUT@", str(output)), "utf-8")
    command = [] if RANKS == "1" else [MPIEXEC, "-n", RANKS]
    command += [*loaded.start_of(PROGRAM), str(scene)] + [word for entry in settings for word in ("--set", entry)]
    return output, subprocess.run(command, env=loaded.environment(int(RANKS)), capture_output=True, text=True, check=False)


def read(path):
    reader = (vtkXMLPUnstructuredGridReader if path.suffix == ".pvtu" else vtkXMLUnstructuredGridReader)()
    errors = []
    reader.AddObserver("ErrorEvent", lambda *_: errors.append(1))
    reader.SetFileName(str(path))
    reader.Update()
    assert not errors, path
    return reader.GetOutput()


def arrays(data):
    return {data.GetArrayName(i): vtk_to_numpy(data.GetArray(i)) for i in range(data.GetNumberOfArrays())}


def strings(grid, name):
    values = grid.GetFieldData().GetAbstractArray(name)
    return [values.GetValue(i) for i in range(values.GetNumberOfValues())]


def extents_of_glyphs(points):
    """The extents of a small sphere that is stretched by the stress at the first point."""
    points.GetPointData().SetActiveTensors("stress")
    sphere = vtkSphereSource()
    sphere.SetRadius(0.5)
    sphere.SetThetaResolution(32)
    sphere.SetPhiResolution(33)
    glyph = vtkTensorGlyph()
    glyph.SetInputData(points)
    glyph.SetSourceConnection(sphere.GetOutputPort())
    glyph.ColorGlyphsOff()
    glyph.ExtractEigenvaluesOn()
    glyph.Update()
    corners = vtk_to_numpy(glyph.GetOutput().GetPoints().GetData())
    first = corners[: len(corners) // points.GetNumberOfPoints()]
    return np.ptp(first, axis=0)


class Pictures(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.temporary = tempfile.TemporaryDirectory()
        cls.output, finished = run(cls.temporary.name)
        if finished.returncode != 0:
            raise RuntimeError(finished.stdout + finished.stderr)

    @classmethod
    def tearDownClass(cls):
        cls.temporary.cleanup()

    def grid(self, kind, number=0):
        suffix = "vtu" if kind == "tools" else "pvtu"
        return read(self.output / "solution" / f"{kind}_{number:04}.{suffix}")

    def test_glyphs_of_a_pure_xz_shear_lie_in_the_xz_plane(self):
        centres = vtkCellCenters()
        centres.SetInputData(self.grid("cells"))
        centres.Update()
        for points in (centres.GetOutput(), self.grid("particles")):
            x, y, z = extents_of_glyphs(points)
            self.assertGreater(x, 0.3)
            self.assertAlmostEqual(x, z, places=6)
            self.assertLess(y, 1e-3 * x)

    def test_the_first_eigenvector_of_a_pure_xz_shear_bisects_x_and_z(self):
        # XX, YY, ZZ, XY, YZ, XZ: the order of VTK, whatever the names of the components are.
        for kind, data in (("cells", self.grid("cells").GetCellData()),
                           ("particles", self.grid("particles").GetPointData())):
            xx, yy, zz, xy, yz, xz = arrays(data)["stress"][0]
            values, vectors = np.linalg.eigh([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
            np.testing.assert_allclose(values, [-SHEAR, 0, SHEAR], atol=1e-12)
            np.testing.assert_allclose(np.abs(vectors[:, 2]), [np.sqrt(0.5), 0, np.sqrt(0.5)], atol=1e-12)
            names = [data.GetArray("stress").GetComponentName(c) for c in range(6)]
            self.assertEqual(names, ["xx", "yy", "zz", "xy", "yz", "xz"], kind)

    def test_reactions_stand_at_what_is_held_and_contact_forces_at_what_is_touched(self):
        for number in (0, 1):
            data = arrays(self.grid("cells", number).GetPointData())
            start, reaction = data["initial position"], data["reaction"]
            is_held = start[:, 0] < 1e-9
            self.assertTrue(np.any(reaction[is_held] != 0))
            self.assertFalse(np.any(reaction[~is_held]))
        self.assertFalse(np.any(arrays(self.grid("cells", 0).GetPointData())["contact force"]))
        # The tip of the drill presses a node of elements down, the ball one of particles.
        data = arrays(self.grid("cells", 1).GetPointData())
        below_tip = np.linalg.norm(data["initial position"] - [0.5, 0.5, 1], axis=1) < 1e-9
        self.assertLess(data["contact force"][below_tip].max(axis=0)[2], -1e-3)
        data = arrays(self.grid("particles", 1).GetPointData())
        below_ball = np.linalg.norm(data["initial position"] - [1.5, 0.5, 1], axis=1) < 1e-9
        self.assertEqual(np.count_nonzero(below_ball), 1)
        self.assertLess(data["contact force"][below_ball][0, 2], -1e-3)
        self.assertFalse(np.any(data["contact force"][data["initial position"][:, 2] == 0.5]))

    def test_tools_and_walls_are_a_series_of_their_own(self):
        entries = ElementTree.parse(self.output / "tools.pvd").getroot().findall("Collection/DataSet")
        self.assertEqual([float(entry.get("timestep")) for entry in entries], [0, 0.02])
        self.assertEqual([entry.get("file") for entry in entries],
                         ["solution/tools_0000.vtu", "solution/tools_0001.vtu"])
        self.assertNotIn("tools", (self.output / "solution.pvd").read_text("utf-8"))
        for number, time in enumerate((0, 0.02)):
            grid = self.grid("tools", number)
            self.assertEqual(strings(grid, "contact names"), ["floor", "ball", "drill"])
            points = vtk_to_numpy(grid.GetPoints().GetData())
            contact = arrays(grid.GetCellData())["contact"]
            corners = np.array([[grid.GetCell(i).GetPointId(k) for k in range(3)]
                                for i in range(grid.GetNumberOfCells())])
            self.assertTrue(all(grid.GetCellType(i) == 5 for i in range(len(corners))))
            floor, ball, drill = (points[np.unique(corners[contact == c])] for c in range(3))
            # The wall covers the body.
            np.testing.assert_allclose(floor[:, 2], 0, atol=1e-12)
            self.assertTrue(np.all(floor[:, :2].min(axis=0) < 0))
            self.assertTrue(np.all(floor[:, :2].max(axis=0) > [2, 1]))
            np.testing.assert_allclose(
                np.linalg.norm(ball - [1.5, 0.5, 1.5 - 0.5 * time], axis=1), 0.5, atol=1e-12)
            self.assertAlmostEqual(drill[:, 2].min(), 1 - time)
            self.assertAlmostEqual(drill[:, 2].max(), 2 - time)
            radius = np.linalg.norm(drill[:, :2] - 0.5, axis=1)
            self.assertAlmostEqual(radius.max(), 0.2)
            # Normals point out of the tools.
            sides = points[corners]
            normal = np.cross(sides[:, 1] - sides[:, 0], sides[:, 2] - sides[:, 0])
            self.assertTrue(np.all(np.linalg.norm(normal, axis=1) > 0))
            middle = sides.mean(axis=1)
            self.assertTrue(np.all(normal[contact == 0][:, 2] > 0))
            outwards = middle[contact == 1] - [1.5, 0.5, 1.5 - 0.5 * time]
            self.assertTrue(np.all(np.sum(outwards * normal[contact == 1], axis=1) > 0))
            outwards = middle[contact == 2] - [0.5, 0.5, 1.5 - time]
            self.assertTrue(np.all(np.sum(outwards * normal[contact == 2], axis=1) > 0))
        force = arrays(grid.GetCellData())["force on the bodies"]
        self.assertLess(force[contact == 1][0, 2], 0)
        self.assertIn("force on the bodies [kN]", strings(grid, "units"))

    def test_units_stand_in_the_field_data(self):
        units = strings(self.grid("particles"), "units")
        for heading in ("Points [mm]", "velocity [mm/ms]", "stress [GPa]", "contact force [kN]", "reaction [kN]",
                        "mass [kg]"):
            self.assertIn(heading, units)

    def test_fields_of_no_meaning_by_themselves_are_there_on_request_alone(self):
        names = set(arrays(self.grid("cells").GetCellData()))
        self.assertFalse([name for name in names if name.startswith(("hourglass", "log", "principal"))])
        with tempfile.TemporaryDirectory() as directory:
            output, finished = run(directory, "Output/visualization/Further fields = internal fields, "
                                   "logarithmic strain, principal stresses")
            self.assertEqual(finished.returncode, 0, finished.stderr)
            data = read(output / "solution" / "cells_0001.pvtu").GetCellData()
            self.assertTrue({"hourglass force 1", "hourglass force 4", "logarithmic strain",
                             "principal stress 1"} <= set(arrays(data)))
            strain = arrays(read(output / "solution" / "particles_0000.pvtu").GetPointData())["logarithmic strain"]
            np.testing.assert_allclose(strain, 0, atol=1e-12)

    def test_a_field_that_does_not_exist_is_refused_with_the_allowed_ones(self):
        with tempfile.TemporaryDirectory() as directory:
            _, finished = run(directory, "Output/visualization/Further fields = principle stresses")
        self.assertNotEqual(finished.returncode, 0)
        for words in ('"principle stresses"', 'did you mean "principal stresses"?',
                      "Allowed: logarithmic strain, principal stresses, internal fields"):
            self.assertIn(words, finished.stderr)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])

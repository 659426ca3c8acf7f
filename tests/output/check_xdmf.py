# SPDX-License-Identifier: LGPL-2.1-or-later
"""Pictures in HDF5 (`Format = xdmf`) beside those of VTK's own format, of sheared.prm.

    check_xdmf.py RANKS MPIEXEC PROGRAM SCRIPTS PVPYTHON

PVPYTHON is a Python with ParaView's readers of XDMF, which Debian's VTK has not; without one the cases that
need them are skipped.
"""

import json
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import numpy as np

RANKS, MPIEXEC, PROGRAM, SCRIPTS, PVPYTHON = sys.argv[1:6]
sys.path[:0] = [SCRIPTS, str(Path(__file__).resolve().parents[1] / "loaded")]
import loaded  # noqa: E402
from plotting.results import PlotError, Results  # noqa: E402

SCENE = Path(__file__).with_name("sheared.prm")
XDMF = "Output/visualization/Format = xdmf"
FEW_CELLS = "Mesh/box/Cells = 2, 1, 1"  # some ranks have no cells, or no particles

# Prints what a reader of ParaView makes of a file, at its last time.
READ = """
import json, sys
kind, path = sys.argv[1:3]
from vtkmodules.vtkCommonExecutionModel import vtkStreamingDemandDrivenPipeline as Pipeline
from vtkmodules.vtkFiltersCore import vtkCellCenters, vtkTensorGlyph
from vtkmodules.vtkFiltersSources import vtkSphereSource
if kind == "2":
    from vtkmodules.vtkIOXdmf2 import vtkXdmfReader as Reader
else:
    from vtkmodules.vtkIOXdmf3 import vtkXdmf3Reader as Reader
reader = Reader()
reader.SetFileName(path)
reader.UpdateInformation()
information = reader.GetOutputInformation(0)
times = [information.Get(Pipeline.TIME_STEPS(), i) for i in range(information.Length(Pipeline.TIME_STEPS()))]
reader.UpdateTimeStep(times[-1])
grid = reader.GetOutputDataObject(0)
result = {"times": times, "points": grid.GetNumberOfPoints(), "cells": grid.GetNumberOfCells()}
for name, data in (("point_data", grid.GetPointData()), ("cell_data", grid.GetCellData())):
    arrays = [data.GetArray(i) for i in range(data.GetNumberOfArrays())]
    result[name] = {array.GetName(): [list(array.GetTuple(k)) for k in range(array.GetNumberOfTuples())]
                    for array in arrays}
def glyph(points):
    points.GetPointData().SetActiveTensors("stress")
    sphere = vtkSphereSource()
    sphere.SetRadius(0.5)
    sphere.SetThetaResolution(32)
    sphere.SetPhiResolution(33)
    glyphs = vtkTensorGlyph()
    glyphs.SetInputData(points)
    glyphs.SetSourceConnection(sphere.GetOutputPort())
    glyphs.ColorGlyphsOff()
    glyphs.ExtractEigenvaluesOn()
    glyphs.Update()
    corners = glyphs.GetOutput().GetPoints()
    n = corners.GetNumberOfPoints() // points.GetNumberOfPoints()
    places = [corners.GetPoint(k) for k in range(n)]
    return [max(place[d] for place in places) - min(place[d] for place in places) for d in range(3)]
if "stress" in result["cell_data"]:
    centers = vtkCellCenters()
    centers.SetInputData(grid)
    centers.Update()
    result["glyph"] = glyph(centers.GetOutput())
elif "stress" in result["point_data"]:
    result["glyph"] = glyph(grid)
print("RESULT" + json.dumps(result))
"""


class Pictures(unittest.TestCase):
    def setUp(self):
        self.temporary = tempfile.TemporaryDirectory()
        self.addCleanup(self.temporary.cleanup)
        self.directory = Path(self.temporary.name)

    def run_scene(self, name, *settings, options=(), ranks=RANKS):
        output = self.directory / name
        scene = self.directory / "scene.prm"
        scene.write_text(SCENE.read_text("utf-8").replace("@OUTPUT@", str(output)), "utf-8")
        command = [] if ranks == "1" else [MPIEXEC, "-n", ranks]
        command += [*loaded.start_of(PROGRAM), str(scene), *options] + [word for entry in settings for word in ("--set", entry)]
        finished = subprocess.run(command, env=loaded.environment(int(ranks)), capture_output=True, text=True, check=False)
        self.assertEqual(finished.returncode, 0, finished.stdout + finished.stderr)
        return output, finished.stdout

    def check_same(self, one, other):
        """Two grids with the same entities in the same order."""
        np.testing.assert_array_equal(one.points, other.points)
        np.testing.assert_array_equal(one.cells, other.cells)
        self.assertEqual(one.units, {**other.units, **{name: one.units[name] for name in ("Points", "TimeValue")}})
        for one_data, other_data in ((one.point_data, other.point_data), (one.cell_data, other.cell_data)):
            self.assertEqual(set(one_data), set(other_data))
            for name, values in one_data.items():
                np.testing.assert_array_equal(values.astype(other_data[name].dtype), other_data[name], err_msg=name)

    def test_both_formats_have_the_same_content(self):
        for settings in (("Output/visualization/Precision = single", "Output/visualization/Further fields = "
                          "logarithmic strain, principal stresses, internal fields"), (FEW_CELLS,)):
            vtu, _ = self.run_scene("vtu", "Output/Number = 2", *settings)
            xdmf, _ = self.run_scene("xdmf", "Output/Number = 2", XDMF, *settings)
            self.assertFalse((xdmf / "solution").exists())
            self.assertFalse((xdmf / "solution.pvd").exists())
            first, second = Results(vtu), Results(xdmf)
            self.assertEqual(list(first.files), list(second.files))
            self.assertEqual(len(first.files), 3)
            for time in first.files:
                for kind in ("cells", "particles"):
                    self.check_same(first.grid(time, kind), second.grid(time, kind))
            first.files, second.files = first.read_series("tools.pvd"), second.read_series("tools.pvd")
            self.assertEqual(list(first.files), list(second.files))
            for time in first.files:
                self.check_same(first.grid(time, "tools"), second.grid(time, "tools"))
            names = {path.name for path in xdmf.iterdir() if path.suffix in (".h5", ".xdmf")}
            self.assertEqual(names, {f"{kind}.{suffix}" for kind in ("cells", "particles", "tools")
                                     for suffix in ("h5", "xdmf")})

    def test_a_resumed_run_continues_the_series(self):
        settings = ("Output/Number = 4", "Checkpoint/Step interval = 3", "Checkpoint/Keep = 1000", XDMF,
                    "Mesh/box/Cells = 4, 2, 2")
        output, _ = self.run_scene("output", *settings)
        indices = {kind: (output / f"{kind}.xdmf").read_bytes() for kind in ("cells", "particles", "tools")}
        grids = {(time, kind): Results(output).grid(time, kind) for time in Results(output).files
                 for kind in ("cells", "particles")}
        checkpoints = sorted((output / "checkpoint").glob("*.h5"))
        self.run_scene("output", *settings, options=(f"--resume={checkpoints[len(checkpoints) // 2]}",))
        for kind, before in indices.items():
            self.assertEqual((output / f"{kind}.xdmf").read_bytes(), before, kind)
        results = Results(output)
        self.assertEqual(len(grids), 2 * len(results.files))
        for (time, kind), before in grids.items():
            self.check_same_values(before, results.grid(time, kind))
        # What cannot be read is put aside, and not written over.
        (output / "cells.h5").write_bytes(b"no HDF5 at all")
        _, printed = self.run_scene("output", *settings, options=(f"--resume={checkpoints[len(checkpoints) // 2]}",))
        self.assertIn("cells.damaged.h5", printed)
        self.assertEqual((output / "cells.damaged.h5").read_bytes(), b"no HDF5 at all")
        later = Results(output)
        kinds = [set(files) for files in later.files.values()]
        self.assertEqual(kinds[0], {"particles"})
        self.assertEqual(kinds[-1], {"cells", "particles"})

    def check_same_values(self, one, other):
        for one_data, other_data in ((one.point_data, other.point_data), (one.cell_data, other.cell_data)):
            self.assertEqual(set(one_data), set(other_data))
            for name, values in one_data.items():
                np.testing.assert_array_equal(values, other_data[name], err_msg=name)

    @unittest.skipUnless(RANKS == "1", "one number of ranks is enough")
    def test_results_of_an_earlier_run_go(self):
        output, _ = self.run_scene("output", XDMF)
        (output / "cells.h5").unlink()
        elsewhere = self.directory / "elsewhere"
        elsewhere.write_text("mine", "utf-8")
        (output / "cells.h5").symlink_to(elsewhere)
        self.run_scene("output", XDMF)
        self.assertFalse((output / "cells.h5").is_symlink())
        self.run_scene("output")
        self.assertEqual([path.name for path in output.iterdir() if path.suffix in (".h5", ".xdmf")], [])
        self.assertEqual(elsewhere.read_text("utf-8"), "mine")

    @unittest.skipUnless(RANKS == "1", "one number of ranks is enough")
    def test_damaged_files_are_told_by_the_scripts(self):
        output, _ = self.run_scene("output", XDMF)
        (output / "cells.h5").write_bytes((output / "cells.h5").read_bytes()[:3000])
        results = Results(output)
        with self.assertRaisesRegex(PlotError, "cells.h5 is damaged"):
            results.grid(list(results.files)[0], "cells")
        (output / "cells.xdmf").write_text("<Xdmf>", "utf-8")
        with self.assertRaisesRegex(PlotError, "cells.xdmf is damaged"):
            Results(output)

    def test_readers_of_paraview_read_them_right(self):
        if not Path(PVPYTHON).is_file():
            self.skipTest("there is no pvpython")
        output, _ = self.run_scene("output", "Output/Number = 2", XDMF)
        results = Results(output)
        last = list(results.files)[-1]
        for reader in "23":
            for kind in ("cells", "particles", "tools"):
                finished = subprocess.run([PVPYTHON, "-c", READ, reader, str(output / f"{kind}.xdmf")],
                                          capture_output=True, text=True, check=False)
                self.assertIn("RESULT", finished.stdout, finished.stdout + finished.stderr)
                read = json.loads(finished.stdout.partition("RESULT")[2])
                self.assertEqual(len(read["times"]), 3)
                if kind == "tools":
                    self.assertEqual(set(read["cell_data"]), {"contact", "force on the bodies", "penetration"})
                    continue
                grid = results.grid(last, kind)
                self.assertEqual((read["points"], read["cells"]), (grid.n_points, grid.n_cells))
                for own, data in ((grid.point_data, read["point_data"]), (grid.cell_data, read["cell_data"])):
                    self.assertEqual(set(own), set(data))
                    for name, values in own.items():
                        np.testing.assert_array_equal(np.array(data[name]).reshape(values.shape), values, err_msg=name)
        # A pure xz shear stretches in the xz plane.
        start, _ = self.run_scene("start", "End time = 1e-9", "Output/Number = 1", XDMF)
        for reader in "23":
            for kind in ("cells", "particles"):
                finished = subprocess.run([PVPYTHON, "-c", READ, reader, str(start / f"{kind}.xdmf")],
                                          capture_output=True, text=True, check=False)
                x, y, z = json.loads(finished.stdout.partition("RESULT")[2])["glyph"]
                self.assertLess(y, 1e-2 * min(x, z))
                self.assertLess(abs(x / z - 1), 0.1)


if __name__ == "__main__":
    del sys.argv[1:]
    unittest.main(verbosity=2)

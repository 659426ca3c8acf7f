# SPDX-License-Identifier: LGPL-2.1-or-later
"""Runs write_solution on some ranks, reads what it wrote with VTK, and compares every array with the
functions of the initial position in mock_scene.h.

    check_solution.py DIMENSION DEGREE FIRST_X all|one RANKS MPIEXEC PROGRAM
"""

import os
import shutil
import subprocess
import sys
import xml.etree.ElementTree as ElementTree

import numpy as np
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkIOXML import vtkXMLPUnstructuredGridReader

FAILURES = []


def check(condition, text):
    if not condition:
        FAILURES.append(text)


def check_close(name, value, expected, tolerance):
    value, expected = np.asarray(value, float), np.asarray(expected, float)
    if value.shape != expected.shape:
        check(False, f"{name}: shape {value.shape}, expected {expected.shape}")
    else:
        same = np.isnan(value) & np.isnan(expected)
        difference = np.max(np.where(same, 0, np.abs(value - expected)), initial=0)
        check(difference <= tolerance, f"{name}: differs by {difference}")


def read(path):
    reader = vtkXMLPUnstructuredGridReader()
    errors = []
    reader.AddObserver("ErrorEvent", lambda *_: errors.append(1))
    reader.SetFileName(path)
    reader.Update()
    check(not errors, f"{path}: VTK reports an error")
    return reader.GetOutput()


def arrays(data):
    return {
        data.GetArrayName(i): vtk_to_numpy(data.GetArray(i)) for i in range(data.GetNumberOfArrays())
    }


def stress_of(x):
    """XX, YY, ZZ, XY, YZ, XZ of the stress with xx, yy, zz, yz, xz, xy = 1 ... 6 times x."""
    return np.outer(x, [1, 2, 3, 6, 4, 5])


def matrices(stress):
    """As VTK understands six components."""
    xx, yy, zz, xy, yz, xz = stress.T
    return np.stack([xx, xy, xz, xy, yy, yz, xz, yz, zz], axis=1).reshape(-1, 3, 3)


def check_further_fields(data, x, is_requested, dimension, tolerance):
    names = {"principal stress 1", "principal stress 2", "principal stress 3", "logarithmic strain", "memory"}
    check(names & set(data) == (names if is_requested else set()), "fields on request")
    if not is_requested:
        return
    principal = np.linalg.eigvalsh(matrices(data["stress"]))[:, ::-1]
    for i in range(3):
        check_close("principal stress", data[f"principal stress {i + 1}"], principal[:, i], 1e-12)
    strain = np.zeros((len(x), 6))
    strain[:, :dimension] = np.log(1.1)
    check_close("logarithmic strain", data["logarithmic strain"], strain, 1e-12)
    check_close("memory", data["memory"], np.full(len(x), 8.0), tolerance)


def check_stress(data, x, tolerance):
    check_close("stress", data["stress"], stress_of(x), tolerance)
    check_close("exact stress", data["exact stress"], stress_of(x), tolerance)
    check_close("pressure", data["pressure"], -2 * x, tolerance)
    # Differences of the diagonal 1, 1, -2; shear 4, 5, 6.
    check_close("von Mises", data["von Mises stress"], x * np.sqrt(3 + 3 * (16 + 25 + 36)), tolerance)
    check_close("volume ratio", data["volume ratio"], 1 + x / 100, tolerance)


def check_motion(data, points, tolerance):
    start = data["initial position"]
    check_close("points", points, 1.1 * start, tolerance)
    check_close("displacement", data["displacement"], 0.1 * start, tolerance)
    velocity = np.stack([start[:, 0], np.full(len(start), 2.0), start[:, 1]], axis=1)
    check_close("velocity", data["velocity"], velocity, tolerance)
    reaction = np.outer(start[:, 0], [0, 1, 0])
    check_close("reaction", data["reaction"], reaction, tolerance)
    return start, velocity


def check_names(grid, kind):
    names = grid.GetFieldData().GetAbstractArray("part names")
    check(names is not None and names.GetValue(0) == '<left> & "right"', f"{kind}: part names")
    check(grid.GetFieldData().GetArray("TimeValue").GetValue(0) == 0.1, f"{kind}: TimeValue")
    units = grid.GetFieldData().GetAbstractArray("units")
    units = {units.GetValue(i) for i in range(units.GetNumberOfValues())}
    own = "element variable" if kind == "cells" else "particle variable"
    expected = {"Points [mm]", "TimeValue [ms]", "displacement [mm]", "velocity [mm/ms]", "stress [MPa]",
                "pressure [MPa]", "reaction [M mm/ms^2]", own + " [M/ms^2]"}
    check(expected <= units, f"{kind}: units {sorted(units)}")
    check(not any(name.split(" [")[0] in ("part", "volume ratio", "common variable") for name in units), f"{kind}: units")


def main():
    dimension, degree, first_x, kind, ranks = sys.argv[1:6]
    command = sys.argv[6:]
    directory = "solution_" + "_".join(sys.argv[1:6])
    shutil.rmtree(directory, ignore_errors=True)
    subprocess.run(
        command[:-1] + ["-n", ranks, command[-1], dimension, degree, first_x, kind, directory], check=True
    )
    dimension, degree, ranks = int(dimension), int(degree), int(ranks)
    first_x, one_cell = float(first_x), kind == "one"
    tolerance = 1e-13 if degree == 1 else 1e-5

    entries = ElementTree.parse(directory + "/solution.pvd").getroot().findall("Collection/DataSet")
    check(
        [(float(e.get("timestep")), e.get("name")) for e in entries]
        == [(0.0, "cells"), (0.0, "particles"), (0.1, "cells"), (0.1, "particles")],
        "solution.pvd",
    )
    for entry in entries:
        check(os.path.exists(os.path.join(directory, entry.get("file"))), entry.get("file"))

    n_particle_cells = (4 - int(first_x)) * (1 if one_cell else 2 ** (dimension - 1))
    n_cells = (4 * 2 ** (dimension - 1) - n_particle_cells) * degree**dimension

    grid = read(directory + "/solution/cells_0001.pvtu")
    check(grid.GetNumberOfCells() == n_cells, f"{grid.GetNumberOfCells()} cells, not {n_cells}")
    check_names(grid, "cells")
    points = vtk_to_numpy(grid.GetPoints().GetData())
    start, _ = check_motion(arrays(grid.GetPointData()), points, tolerance)
    data = arrays(grid.GetCellData())
    cell_type = 9 if dimension == 2 else 12
    centres = np.empty((n_cells, 3))
    measure = 0.0
    for i in range(n_cells):
        cell = grid.GetCell(i)
        check(cell.GetCellType() == cell_type, "cell type")
        corners = start[[cell.GetPointId(k) for k in range(cell.GetNumberOfPoints())]]
        centres[i] = corners.mean(axis=0)
        lower, upper = corners.min(axis=0), corners.max(axis=0)
        measure += np.prod((upper - lower)[:dimension])
        # Round the faces of a box in VTK's order.
        signs = np.array([[0, 0], [1, 0], [1, 1], [0, 1]])
        expected = lower[:2] + signs * (upper - lower)[:2]
        check_close("order of corners", corners[:4, :2], expected, 1e-6)
        if dimension == 3:
            check_close("order of corners", corners[4:, :2], expected, 1e-6)
            check(np.all(corners[:4, 2] < corners[4:, 2]), "order of layers")
    check_close("volume", measure, n_cells / degree**dimension, 1e-5)
    check_stress(data, centres[:, 0], tolerance)
    check_further_fields(data, centres[:, 0], degree == 1, dimension, tolerance)
    check(set(data["part"]) == {0}, "part of cells")
    check(set(data["owner rank"]) <= set(range(ranks)), "owner rank of cells")
    check("particle variable" not in data and "volume" not in data, "arrays of cells")
    check_close("element variable", data["element variable"], np.full(n_cells, 7.0), tolerance)

    grid = read(directory + "/solution/particles_0001.pvtu")
    check_names(grid, "particles")
    points = vtk_to_numpy(grid.GetPoints().GetData())
    data = arrays(grid.GetPointData())
    start, velocity = check_motion(data, points, tolerance)
    n_particles = ((4 - int(first_x)) * degree + 1) * ((1 if one_cell else 2) * degree + 1) ** (dimension - 1)
    check(len(points) == n_particles, f"{len(points)} particles, not {n_particles}")
    check(grid.GetNumberOfCells() == n_particles, "a vertex per particle")
    check(all(grid.GetCellType(i) == 1 for i in range(n_particles)), "vertices")
    x = start[:, 0]
    check_stress(data, x, tolerance)
    check_further_fields(data, x, degree == 1, dimension, tolerance)
    check_close("unsmoothed velocity", data["unsmoothed velocity"], 3 * velocity, tolerance)
    check_close("common variable", data["common variable"], x**2, tolerance)
    check_close("particle variable", data["particle variable"], np.full(n_particles, 7.0), tolerance)
    check_close("volume", data["volume"], np.full(n_particles, 0.5), tolerance)
    check_close("mass", data["mass"], np.full(n_particles, 0.25), tolerance)
    support = 0.1 * start
    support[:, dimension - 1] = 5
    check_close("support", data["support"], support, tolerance)
    check(set(data["part"]) == {1}, "part of particles")
    check(data["persistent id"].dtype == np.uint64, "persistent id is an integer")
    check(len(set(data["persistent id"])) == n_particles, "persistent ids are unique")
    shared = np.isclose(x, first_x)
    if one_cell:
        shared |= np.isclose(start[:, 1], 1)
        if dimension == 3:
            shared |= np.isclose(start[:, 2], 1)
    check_close("shared node", data["shared node"], shared, 0)

    for failure in FAILURES:
        print("FAILED:", failure)
    if not FAILURES:
        shutil.rmtree(directory)
    return 1 if FAILURES else 0


sys.exit(main())

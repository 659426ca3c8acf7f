# SPDX-License-Identifier: LGPL-2.1-or-later
"""Writes an output directory as a run would: a wave in a rod, half elements and half particles."""

import json
from pathlib import Path

import numpy
from vtk import (VTK_HEXAHEDRON, VTK_QUAD, VTK_VERTEX, vtkCellArray, vtkPoints, vtkUnstructuredGrid,
                 vtkXMLUnstructuredGridWriter)
from vtk.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray

TIMES = (0, 4, 6, 9)
LENGTH, INTERFACE, SPACING = 10.0, 5.0, 0.4


def pulse(x, time):
    phase = time - x
    return numpy.where((phase > 0) & (phase < 4), -0.1 * numpy.sin(numpy.pi * phase / 4)**2, 0.0)


def stress(x, time):
    return numpy.outer(pulse(x, time), [1, 0, 0, 0, 0, 0])


def lattice(dim, start, end):
    """Nodes, and cells that name their corners in the order of VTK."""
    widths = (end - start, 1.2, 1.2)[:dim]
    counts = [round(width / SPACING) for width in widths]
    axes = [numpy.linspace(0, width, count + 1) for width, count in zip(widths, counts)]
    index = numpy.arange(numpy.prod([count + 1 for count in counts])).reshape(
        [count + 1 for count in counts])
    nodes = numpy.stack(numpy.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, dim)
    nodes[:, 0] += start
    low, high = slice(None, -1), slice(1, None)
    corners = [(low, low), (high, low), (high, high), (low, high)]
    if dim == 3:
        corners = [corner + (side,) for side in (low, high) for corner in corners]
    cells = numpy.stack([index[corner].reshape(-1) for corner in corners], axis=1)
    return numpy.pad(nodes, ((0, 0), (0, 3 - dim))), cells


def write_grid(path, nodes, cells, cell_type, point_data, cell_data):
    grid = vtkUnstructuredGrid()
    points = vtkPoints()
    points.SetData(numpy_to_vtk(point_data["initial position"] + point_data["displacement"],
                                deep=True))
    grid.SetPoints(points)
    array = vtkCellArray()
    n_corners = cells.shape[1]
    array.SetData(numpy_to_vtkIdTypeArray(numpy.arange(0, cells.size + 1, n_corners), deep=True),
                  numpy_to_vtkIdTypeArray(cells.reshape(-1).astype(numpy.int64), deep=True))
    grid.SetCells(cell_type, array)
    for target, data in ((grid.GetPointData(), point_data), (grid.GetCellData(), cell_data)):
        for name, values in data.items():
            values = numpy_to_vtk(numpy.ascontiguousarray(values), deep=True)
            values.SetName(name)
            target.AddArray(values)
    writer = vtkXMLUnstructuredGridWriter()
    writer.SetFileName(str(path))
    writer.SetInputData(grid)
    writer.Write()


def write_parallel(path, arrays, pieces):
    """The .pvtu that names the pieces; arrays: {"PPointData": {name: values}, "PCellData": ...}."""
    kinds = {"f": "Float64", "i": "Int64"}
    lines = ['<?xml version="1.0"?>',
             '<VTKFile type="PUnstructuredGrid" version="0.1" byte_order="LittleEndian">',
             '<PUnstructuredGrid GhostLevel="0">',
             '<PPoints><PDataArray type="Float64" NumberOfComponents="3"/></PPoints>']
    for section, data in arrays.items():
        lines.append(f"<{section}>")
        for name, values in data.items():
            n_components = 1 if values.ndim == 1 else values.shape[1]
            lines.append(f'<PDataArray type="{kinds[values.dtype.kind]}" Name="{name}" '
                         f'NumberOfComponents="{n_components}"/>')
        lines.append(f"</{section}>")
    lines += [f'<Piece Source="{piece.name}"/>' for piece in pieces]
    lines += ["</PUnstructuredGrid>", "</VTKFile>"]
    path.write_text("\n".join(lines), encoding="utf-8")


def motion(nodes, time):
    zeros = numpy.zeros(len(nodes))
    return {"initial position": nodes,
            "displacement": numpy.stack([0.1 * pulse(nodes[:, 0], time), zeros, zeros], axis=1),
            "velocity": numpy.stack([-pulse(nodes[:, 0], time), zeros, zeros], axis=1),
            "contact force": numpy.stack([numpy.where(nodes[:, 0] == 0, 0.1 * time, 0), zeros, zeros], axis=1)}


def write_cells(directory, number, dim, time):
    nodes, cells = lattice(dim, 0, INTERFACE)
    middle = nodes[cells].mean(axis=1)[:, 0]
    cell_data = {"stress": 1.02 * stress(middle, time), "exact stress": stress(middle, time)}
    half = len(cells) // 2
    pieces = []
    # Two ranks with cells and one without.
    for rank, chosen in enumerate((slice(0, half), slice(half, None), slice(0, 0))):
        own, renumbered = numpy.unique(cells[chosen], return_inverse=True)
        pieces.append(directory / f"cells_{number:04}.{rank:04}.vtu")
        own_cells = renumbered.reshape(-1, cells.shape[1])
        write_grid(pieces[-1], nodes[own], own_cells, VTK_QUAD if dim == 2 else VTK_HEXAHEDRON,
                   motion(nodes[own], time),
                   {name: values[chosen] for name, values in cell_data.items()})
    write_parallel(directory / f"cells_{number:04}.pvtu",
                   {"PPointData": motion(nodes, time), "PCellData": cell_data}, pieces)


def write_particles(directory, number, dim, time):
    nodes, _ = lattice(dim, INTERFACE, LENGTH)
    x = nodes[:, 0]
    # A spread across the section, which the profile shows as a range.
    point_data = dict(motion(nodes, time),
                      **{"stress": (0.95 + 0.05 * nodes[:, 1:2]) * stress(x, time),
                         "exact stress": stress(x, time),
                         "persistent id": numpy.arange(len(nodes)),
                         "support": numpy.full((len(nodes), 3), 1.8 * SPACING),
                         "volume": numpy.full(len(nodes), SPACING**dim),
                         "shared node": (x == INTERFACE).astype(numpy.int64)})
    piece = directory / f"particles_{number:04}.0000.vtu"
    write_grid(piece, nodes, numpy.arange(len(nodes))[:, None], VTK_VERTEX, point_data, {})
    write_parallel(directory / f"particles_{number:04}.pvtu", {"PPointData": point_data}, [piece])


def write_tables(directory):
    time = numpy.linspace(0, 9, 10)
    columns = {
        "time [ms]": time, "step": time * 10, "kinetic energy [mJ]": 1 - numpy.exp(-time),
        "elastic energy [mJ]": 1 - numpy.exp(-time / 2), "plastic dissipation [mJ]": 0 * time,
        "external work [mJ]": 2 - numpy.exp(-time) - numpy.exp(-time / 2),
        "total energy [mJ]": 2 - numpy.exp(-time) - numpy.exp(-time / 2),
        "energy error": 1e-4 * numpy.sin(time), "momentum x [kg mm/ms]": time / 9,
        "momentum y [kg mm/ms]": 0 * time, "impulse x [kg mm/ms]": time / 9,
        "momentum drift": 1e-16 * time, "lattice mode share": 1e-3 * numpy.sin(time)**2}
    write_table(directory / "statistics.csv", columns)
    fine = numpy.linspace(0, 9, 200)
    write_table(directory / "probes.csv", {
        "time [ms]": fine, "step": numpy.arange(200), "tip displacement x [mm]": numpy.sin(fine),
        "\"middle, left velocity x [mm/ms]\"": numpy.cos(fine)})
    write_table(directory / "conditions.csv", {
        "time [ms]": fine, "step": numpy.arange(200), "wall mean force x [N]": numpy.sin(fine),
        "wall mean moment z [mJ]": numpy.cos(fine), "wall work [mJ]": 0 * fine,
        "load mean force x [N]": -numpy.sin(fine), "load mean moment z [mJ]": -numpy.cos(fine)})
    write_table(directory / "specimen.csv", {
        "time [ms]": fine, "step": numpy.arange(200), "length [mm]": 10 - numpy.sin(fine),
        "mean error": 0.1 * numpy.exp(-fine)})


def write_table(path, columns):
    rows = [",".join(columns)]
    rows += [",".join(repr(float(value)) for value in row) for row in zip(*columns.values())]
    # An entry that the run did not have in its first row is empty.
    path.write_text("\n".join(rows) + "\n", encoding="utf-8")


def make_output(directory, dim):
    directory = Path(directory)
    solution = directory / "solution"
    solution.mkdir(parents=True)
    entries = []
    for number, time in enumerate(TIMES):
        write_cells(solution, number, dim, time)
        write_particles(solution, number, dim, time)
        entries += [f'<DataSet timestep="{time}" group="" part="{part}" name="{kind}" '
                    f'file="solution/{kind}_{number:04}.pvtu"/>'
                    for part, kind in enumerate(("cells", "particles"))]
    (directory / "solution.pvd").write_text(
        '<?xml version="1.0"?>\n<VTKFile type="Collection" version="0.1"><Collection>\n'
        + "\n".join(entries) + "\n</Collection></VTKFile>\n", encoding="utf-8")
    (directory / "summary.json").write_text(json.dumps(
        {"title": "rod", "units": {"length": "mm", "time": "ms", "stress": "GPa"}}))
    write_tables(directory)

# SPDX-License-Identifier: LGPL-2.1-or-later
"""What a run left behind: tables, summary and the solution at each output."""

import copy
import csv
import io
import json
import re
import xml.etree.ElementTree
from pathlib import Path

import numpy
from vtk import (vtkLogger, vtkOutputWindow, vtkStringOutputWindow, vtkXMLPUnstructuredGridReader,
                 vtkXMLUnstructuredGridReader)
from vtk.util.numpy_support import vtk_to_numpy

from . import xdmf

TENSOR_COMPONENTS = ("xx", "yy", "zz", "xy", "yz", "xz")  # the order of VTK
AXES = ("x", "y", "z")

# Units of the fields that have one, in terms of length, mass and time, as in the headers of a run.
FIELD_UNITS = {
    "initial position": "L",
    "displacement": "L",
    "velocity": "L/T",
    "unsmoothed velocity": "L/T",
    "stress": "M/(L T^2)",
    "pressure": "M/(L T^2)",
    "von Mises stress": "M/(L T^2)",
    "exact stress": "M/(L T^2)",
    "principal stress 1": "M/(L T^2)",
    "principal stress 2": "M/(L T^2)",
    "principal stress 3": "M/(L T^2)",
    "contact force": "M L/T^2",
    "reaction": "M L/T^2",
    "density": "M/L^3",
    "temperature": "K",
    "nodal temperature": "K",
}
PIECE = re.compile(r'<Piece Source="([^"]*)"')

UNIT_QUANTITIES = {"L": "length", "M": "mass", "T": "time", "K": "temperature", "L/T": "velocity",
                   "M/(L T^2)": "stress", "M L/T^2": "force", "M/L^3": "density"}


class PlotError(Exception):
    """Something that the user can mend; printed without a trace."""


def heading(name, unit):
    """`name [unit]` for an axis, with powers set as powers."""
    unit = re.sub(r"\^(-?\d+)", r"$^{\1}$", unit)
    return f"{name} [{unit}]" if unit else name


class Table:
    """A CSV file whose header is made of `name [unit]`. Rows that are no numbers, of another length
    than the header, or without the end of their line, are refused, or left out and listed in
    `damaged_rows`."""

    def __init__(self, path, leaves_out_damaged_rows=False):
        text = Path(path).read_text("utf-8", errors="replace").replace("\0", "?")
        rows = [row for row in csv.reader(io.StringIO(text, newline="")) if row]
        if not rows:
            raise PlotError(f"{path} is empty")
        self.units = {}
        self.columns = {}
        values = []
        self.damaged_rows = []
        for number, row in enumerate(rows[1:], start=1):
            try:
                is_cut = number + 1 == len(rows) and not text.endswith("\n")
                if len(row) != len(rows[0]) or is_cut:
                    raise ValueError
                values.append([float(entry) if entry else numpy.nan for entry in row])
            except ValueError:
                self.damaged_rows.append(number)
        if self.damaged_rows and not leaves_out_damaged_rows:
            raise PlotError(f"row {self.damaged_rows[0]} of {path} is not a line of {len(rows[0])} "
                            "numbers, as its header asks for: the file is damaged")
        for index, title in enumerate(rows[0]):
            name, unit = re.fullmatch(r"\s*(.*?)\s*(?:\[([^\[\]]*)\])?\s*", title).groups()
            self.units[name] = unit or ""
            self.columns[name] = numpy.array([row[index] for row in values])

    def __contains__(self, name):
        return name in self.columns

    def __getitem__(self, name):
        return self.columns[name]

    def heading(self, name):
        return heading(name, self.units[name])


class Field:
    """An array by name and what is drawn of it: a component, or one number of all."""

    def __init__(self, text):
        self.text = text
        words = text.split()
        self.component = None
        if len(words) > 1 and words[-1] in TENSOR_COMPONENTS + AXES:
            self.component = words.pop()
        if len(words) > 1 and words[-1] == "magnitude":
            words.pop()
        self.array = " ".join(words)

    @property
    def file_name(self):
        return re.sub(r"[^A-Za-z0-9]+", "_", self.text).strip("_")

    def label(self, units):
        unit = FIELD_UNITS.get(self.array, "")
        return heading(self.text, units.label(unit) if unit else "")

    def of(self, values):
        """One number per row of an array."""
        if values.ndim == 1 or values.shape[1] == 1:
            if self.component:
                raise PlotError(f'"{self.array}" has no component {self.component}')
            return values.reshape(len(values))
        names = {3: AXES, 6: TENSOR_COMPONENTS}.get(values.shape[1], ())
        if self.component is None:
            return von_mises(values) if values.shape[1] == 6 else numpy.linalg.norm(values, axis=1)
        if self.component not in names:
            raise PlotError(f'"{self.array}" has no component {self.component}; it has '
                            f'{", ".join(names)}')
        return values[:, names.index(self.component)]

    @property
    def is_signed(self):
        return self.component is not None or self.array.startswith(("pressure", "principal"))


def von_mises(stress):
    xx, yy, zz, xy, yz, xz = stress.T
    return numpy.sqrt(0.5 * ((xx - yy)**2 + (yy - zz)**2 + (zz - xx)**2)
                      + 3 * (yz**2 + xz**2 + xy**2))


class Units:
    """The names of the units; the symbols L, M, T, K where the run gave none."""

    def __init__(self, labels):
        self.labels = labels

    def label(self, unit):
        quantity = UNIT_QUANTITIES.get(unit)
        if quantity in self.labels:
            return self.labels[quantity]
        return "".join(self.labels.get(UNIT_QUANTITIES.get(symbol), symbol) for symbol in unit)


def check_whole(path):
    """Refuses a VTK file, or one of its pieces, that is missing or ends early: VTK would return what
    is there, or nothing."""
    if not path.exists():
        raise PlotError(f"{path} is missing")
    with open(path, "rb") as file:
        file.seek(max(0, path.stat().st_size - 64))
        is_whole = file.read().rstrip().endswith(b"</VTKFile>")
    if not is_whole:
        raise PlotError(f"{path} ends early: it is damaged, or was not written to its end")
    if path.suffix == ".pvtu":
        for piece in PIECE.findall(path.read_text("utf-8", errors="replace")):
            check_whole(path.parent / piece)


class Grid:
    """Cells or particles of one output, as numpy arrays."""

    def __init__(self, path):
        """Of a VTK file, or of a grid in HDF5 (xdmf.Place)."""
        if isinstance(path, xdmf.Place):
            self.read_xdmf(path)
        else:
            self.read_vtk(path)
        if self.cells.shape[1] > 1:
            self.join_pieces()

    def read_xdmf(self, place):
        try:
            read = xdmf.Reader(place)
        except xdmf.Damaged as error:
            raise PlotError(str(error)) from error
        self.points, self.cells = read.points.astype(float), read.cells
        self.point_data, self.cell_data, self.units = read.point_data, read.cell_data, read.units
        self.n_points, self.n_cells = len(self.points), len(self.cells)

    def read_vtk(self, path):
        check_whole(path)
        reader = (vtkXMLPUnstructuredGridReader() if path.suffix == ".pvtu"
                  else vtkXMLUnstructuredGridReader())
        reader.SetFileName(str(path))
        # VTK returns what it can read, and prints the rest: here it becomes an error.
        vtkLogger.SetStderrVerbosity(vtkLogger.VERBOSITY_OFF)
        messages = vtkStringOutputWindow()
        vtkOutputWindow.SetInstance(messages)
        reader.Update()
        vtkOutputWindow.SetInstance(None)
        if "ERROR" in messages.GetOutput():
            raise PlotError(f"{path} is damaged: {messages.GetOutput().strip().splitlines()[-1]}")
        data = reader.GetOutput()
        self.n_points = data.GetNumberOfPoints()
        self.n_cells = data.GetNumberOfCells()
        self.points = (vtk_to_numpy(data.GetPoints().GetData()).astype(float) if self.n_points
                       else numpy.zeros((0, 3)))
        self.point_data = self.arrays_of(data.GetPointData())
        self.cell_data = self.arrays_of(data.GetCellData())
        self.units = self.units_of(data.GetFieldData())
        if self.n_cells:
            offsets = vtk_to_numpy(data.GetCells().GetOffsetsArray())
            connectivity = vtk_to_numpy(data.GetCells().GetConnectivityArray())
            # All cells of a file are of one kind.
            self.cells = connectivity.reshape(len(offsets) - 1, -1)
        else:
            self.cells = numpy.zeros((0, 1), dtype=int)

    def join_pieces(self):
        """Cells of different ranks have points of their own where they touch: lets them share one of
        those that are, and were at the start, in one place."""
        places = numpy.hstack([self.initial_points(), self.points])
        _, first, number = numpy.unique(places, axis=0, return_index=True, return_inverse=True)
        self.cells = first[number.reshape(-1)][self.cells]

    @staticmethod
    def arrays_of(data):
        arrays = (data.GetArray(index) for index in range(data.GetNumberOfArrays()))
        return {array.GetName(): vtk_to_numpy(array) for array in arrays if array is not None}

    @staticmethod
    def units_of(data):
        """The units of the arrays that have one, {name: unit}."""
        array = data.GetAbstractArray("units")
        titles = [array.GetValue(index) for index in range(array.GetNumberOfValues())] if array else []
        matches = (re.fullmatch(r"(.*) \[([^\[\]]*)\]", title) for title in titles)
        return dict(match.groups() for match in matches if match)

    def has(self, name):
        return name in self.point_data or name in self.cell_data

    def initial_points(self):
        return self.point_data.get("initial position", self.points).astype(float)

    def samples(self, name):
        """Initial positions and values where an array lives: at points, or at the middle of cells."""
        if name in self.cell_data:
            return self.initial_points()[self.cells].mean(axis=1), self.cell_data[name]
        return self.initial_points(), self.point_data[name]

    def beyond(self, axis, place):
        """What lies at larger initial coordinates than the place: whole cells, or points."""
        if not self.n_points:
            return copy.copy(self)
        coordinate = self.initial_points()[:, axis]
        if self.cells.shape[1] > 1:
            return self.only(coordinate[self.cells].mean(axis=1) > place)
        return self.only(coordinate >= place - 1e-9 * max(numpy.ptp(coordinate), abs(place)))

    def only(self, kept):
        """Some of the cells with all points, or some of the particles."""
        result = copy.copy(self)
        if self.cells.shape[1] == 1:
            result.points = self.points[kept]
            result.point_data = {name: values[kept] for name, values in self.point_data.items()}
            result.n_points = len(result.points)
        result.n_cells = int(numpy.count_nonzero(kept))
        result.cells = (self.cells[kept] if self.cells.shape[1] > 1
                        else numpy.arange(result.n_points)[:, None])
        result.cell_data = {name: values[kept] for name, values in self.cell_data.items()}
        return result


class Results:
    def __init__(self, directory):
        self.directory = Path(directory)
        if not self.directory.is_dir():
            raise PlotError(f"there is no directory {directory}")
        self.summary = {}
        if (self.directory / "summary.json").exists():
            try:
                self.summary = json.loads((self.directory / "summary.json").read_text("utf-8"))
            except ValueError as error:
                raise PlotError(f"{self.directory / 'summary.json'} is damaged: {error}") from error
        self.units = Units(self.summary.get("units") or {})
        self.files = self.read_series()
        self.grids = {}

    def read_series(self, name="solution.pvd"):
        """{time: {"cells": file, "particles": file}} of solution.pvd, {"tools": file} of tools.pvd, and
        what cells.xdmf, particles.xdmf and tools.xdmf have at further times."""
        series = self.directory / name
        files = {}
        if series.exists():
            try:
                entries = list(xml.etree.ElementTree.parse(series).iter("DataSet"))
            except xml.etree.ElementTree.ParseError as error:
                raise PlotError(f"{series} is damaged: {error}") from error
            for entry in entries:
                path = self.directory / entry.get("file")
                kind = path.name.partition("_")[0]
                kind = kind if kind in ("particles", "tools") else "cells"
                files.setdefault(float(entry.get("timestep")), {})[kind] = path
        for kind in ("tools",) if name == "tools.pvd" else ("cells", "particles"):
            try:
                for time, place in xdmf.read_series(self.directory, kind).items():
                    files.setdefault(time, {}).setdefault(kind, place)
            except xdmf.Damaged as error:
                raise PlotError(str(error)) from error
        return dict(sorted(files.items()))

    def table(self, name):
        path = self.directory / name
        return Table(path) if path.exists() else None

    def grid(self, time, kind):
        """Cells or particles at an output time, or None where the run has none."""
        path = self.files[time].get(kind)
        if path is None:
            return None
        if path not in self.grids:
            self.grids[path] = Grid(path)
        grid = self.grids[path]
        return grid if grid.n_points else None

    def grids_at(self, time):
        grids = {kind: self.grid(time, kind) for kind in ("cells", "particles")}
        return {kind: grid for kind, grid in grids.items() if grid is not None}

    def times(self, wanted):
        """The outputs nearest to the wanted times; all but the start where none are wanted."""
        available = list(self.files)
        if not wanted:
            return available[1:] if len(available) > 1 else available
        return sorted({min(available, key=lambda time: abs(time - one)) for one in wanted})

    def array_names(self):
        grids = self.grids_at(next(iter(self.files))).values()
        return sorted({name for grid in grids for name in (*grid.point_data, *grid.cell_data)})

    def longest_axis(self):
        points = numpy.vstack([grid.initial_points()
                               for grid in self.grids_at(next(iter(self.files))).values()])
        return int(numpy.argmax(numpy.ptp(points, axis=0)))

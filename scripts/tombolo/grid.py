# SPDX-License-Identifier: LGPL-2.1-or-later
"""Cells and particles of a run at each output."""

import copy
import re
import xml.etree.ElementTree

import numpy
from vtk import (vtkLogger, vtkOutputWindow, vtkStringOutputWindow, vtkXMLPUnstructuredGridReader,
                 vtkXMLUnstructuredGridReader)
from vtk.util.numpy_support import vtk_to_numpy

from . import xdmf
from .errors import TomboloError

PIECE = re.compile(r'<Piece Source="([^"]*)"')


def check_whole(path):
    """Refuses a VTK file, or one of its pieces, that is missing or ends early: VTK would return what
    is there, or nothing."""
    if not path.exists():
        raise TomboloError(f"{path} is missing")
    with open(path, "rb") as file:
        file.seek(max(0, path.stat().st_size - 64))
        is_whole = file.read().rstrip().endswith(b"</VTKFile>")
    if not is_whole:
        raise TomboloError(f"{path} ends early: it is damaged, or was not written to its end")
    if path.suffix == ".pvtu":
        for piece in PIECE.findall(path.read_text("utf-8", errors="replace")):
            check_whole(path.parent / piece)


class Grid:
    """Cells or particles of one output, as numpy arrays."""

    def __init__(self, path):
        """Of a VTK file, or of a grid in HDF5 (xdmf.GridEntry)."""
        if isinstance(path, xdmf.GridEntry):
            self.read_xdmf(path)
        else:
            self.read_vtk(path)
        if self.cells.shape[1] > 1:
            self.join_pieces()

    def read_xdmf(self, grid_entry):
        try:
            read = xdmf.Reader(grid_entry)
        except xdmf.Damaged as error:
            raise TomboloError(str(error)) from error
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
            raise TomboloError(f"{path} is damaged: {messages.GetOutput().strip().splitlines()[-1]}")
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
        """Cells of different ranks have points of their own where they touch: joins those that
        are, and were at the start, at one position."""
        positions = numpy.hstack([self.initial_points(), self.points])
        _, first, number = numpy.unique(positions, axis=0, return_index=True, return_inverse=True)
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
        """Initial positions and values where an array is defined: at points, or at the middle of cells."""
        if name in self.cell_data:
            return self.initial_points()[self.cells].mean(axis=1), self.cell_data[name]
        return self.initial_points(), self.point_data[name]

    def beyond(self, axis, bound):
        """What lies at larger initial coordinates than the bound: whole cells, or points."""
        if not self.n_points:
            return copy.copy(self)
        coordinate = self.initial_points()[:, axis]
        if self.cells.shape[1] > 1:
            return self.only(coordinate[self.cells].mean(axis=1) > bound)
        return self.only(coordinate >= bound - 1e-9 * max(numpy.ptp(coordinate), abs(bound)))

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


def read_series(directory, name="solution.pvd"):
    """{time: {"cells": file, "particles": file}} of solution.pvd, {"tools": file} of tools.pvd, and
    what cells.xdmf, particles.xdmf and tools.xdmf have at further times."""
    series = directory / name
    files = {}
    if series.exists():
        try:
            entries = list(xml.etree.ElementTree.parse(series).iter("DataSet"))
        except xml.etree.ElementTree.ParseError as error:
            raise TomboloError(f"{series} is damaged: {error}") from error
        for entry in entries:
            path = directory / entry.get("file")
            kind = path.name.partition("_")[0]
            kind = kind if kind in ("particles", "tools") else "cells"
            files.setdefault(float(entry.get("timestep")), {})[kind] = path
    for kind in ("tools",) if name == "tools.pvd" else ("cells", "particles"):
        try:
            for time, grid_entry in xdmf.read_series(directory, kind).items():
                files.setdefault(time, {}).setdefault(kind, grid_entry)
        except xdmf.Damaged as error:
            raise TomboloError(str(error)) from error
    return dict(sorted(files.items()))

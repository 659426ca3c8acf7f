# SPDX-License-Identifier: LGPL-2.1-or-later
"""What a run left behind: tables, summary and the solution at each output."""

import functools
import re

import numpy
from tombolo.errors import TomboloError
from tombolo.grid import Grid, read_series
from tombolo.histories import has_table
from tombolo.run import Run
from tombolo.table import Table, heading

TENSOR_COMPONENTS = ("xx", "yy", "zz", "xy", "yz", "xz")  # the order of VTK
AXES = ("x", "y", "z")

UNIT_QUANTITIES = {"L": "length", "M": "mass", "T": "time", "M L/T^2": "force"}


PlotError = TomboloError


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

    def label(self, grids):
        """With the unit that the array has in one of the grids."""
        return heading(self.text, next((grid.units[self.array] for grid in grids
                                        if self.array in grid.units), ""))

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
    """The names of the units; the symbols L, M, T, K where the run has none."""

    def __init__(self, labels):
        self.labels = labels

    def label(self, unit):
        quantity = UNIT_QUANTITIES.get(unit)
        if quantity in self.labels:
            return self.labels[quantity]
        return "".join(self.labels.get(UNIT_QUANTITIES.get(symbol), symbol) for symbol in unit)


class Results(Run):
    """A run with labels of units; its summary and grids are kept once they are read."""

    @functools.cached_property
    def summary(self):
        return super().summary

    def __init__(self, directory):
        super().__init__(directory)
        self.units = Units(self.summary.get("units") or {})
        self.files = self.read_series()
        self.grids = {}

    def read_series(self, name="solution.pvd"):
        return read_series(self.directory, name)

    def table(self, name):
        path = self.directory / name
        return Table(path) if has_table(path) else None

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
        """The outputs nearest to the requested times; all but the start where none are requested."""
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

# SPDX-License-Identifier: LGPL-2.1-or-later
"""What is to be seen of the bodies at an output: faces, particles, contact forces, tools."""

from dataclasses import dataclass, field

import numpy
from plotting.fields import outer_faces
from plotting.particle_shapes import particle_shapes
from plotting.results import AXES, Field, Grid, PlotError

from . import units
from .probe import fatal_items

MAXIMUM_ARROWS = 400
MAXIMUM_FIELDS = 7
# An arrow of a large contact force is as long as this share of the body; none is longer than 2.5 of them.
ARROW_LENGTH, LONGEST_ARROW = 0.1, 2
FIELD_TITLES = {"nodal temperature": "temperature", "stress": "von Mises stress"}


@dataclass
class Snapshot:
    """Coordinates and forces are in units of the run. Values are one number per face or particle."""
    time: float
    points: numpy.ndarray = field(default_factory=lambda: numpy.zeros((0, 3)))
    faces: numpy.ndarray = field(default_factory=lambda: numpy.zeros((0, 4), dtype=int))
    face_values: dict = field(default_factory=dict)
    centres: numpy.ndarray = field(default_factory=lambda: numpy.zeros((0, 3)))
    shapes: numpy.ndarray = field(default_factory=lambda: numpy.zeros((0, 3, 3)))  # of the ellipsoids that particles are
    particle_values: dict = field(default_factory=dict)
    force_points: numpy.ndarray = field(default_factory=lambda: numpy.zeros((0, 3)))
    forces: numpy.ndarray = field(default_factory=lambda: numpy.zeros((0, 3)))
    tool_points: numpy.ndarray = field(default_factory=lambda: numpy.zeros((0, 3)))
    tool_faces: numpy.ndarray = field(default_factory=lambda: numpy.zeros((0, 3), dtype=int))
    n_cells: int = 0
    particle_step: int = 1  # every so many particles are kept

    def all_points(self):
        return numpy.vstack([self.points, self.centres])

    def values(self, text):
        return numpy.concatenate([self.face_values.get(text, numpy.zeros(0)),
                                  self.particle_values.get(text, numpy.zeros(0))])


@dataclass
class ShownField:
    """A field with the range of its colours and its scale."""
    text: str
    title: str
    unit: str
    colours: str
    low: float = 0.0
    high: float = 1.0
    least: float = 0.0
    largest: float = 0.0
    has_full_range: bool = False
    scale: units.Scale = None

    def range_text(self):
        ends = [units.number(value * self.scale.factor, 3) for value in (self.least, self.largest)]
        span = "whole range" if self.has_full_range else "colours span the 1st to 99th percentile"
        return f"{span}; least {ends[0]}, largest {ends[1]}{' ' + self.scale.label if self.scale.label else ''}"


class Bodies:
    """The outputs of a run as snapshots. What cannot be read is noted and left out."""

    def __init__(self, run, cut=None, wanted_fields=None):
        self.run, self.cut = run, cut
        self.times = list(run.results.files)
        self.snapshots = {}
        self.failed = set()
        for time in fatal_items(self.times, self.read_all):
            self.failed.add(time)
            self.run.note("error", f"The picture at t = {self.time_text(time)} is left out: its files are damaged, VTK cannot "
                          "read them.")
        self.fields = []
        self.grid_units = {}
        first = next((grids for time in self.times if (grids := self.grids_at(time))), None)
        if first is None:
            self.times = []
            return
        points = numpy.vstack([grid.initial_points() for grid in first.values()])
        self.is_flat = numpy.ptp(points[:, 2]) <= 1e-9 * max(numpy.ptp(points, axis=0).max(), 1e-300)
        self.axis = int(numpy.argmax(numpy.ptp(points, axis=0)))
        self.fields = self.chosen_fields(wanted_fields)

    def read_all(self, time):
        """Reads all files of an output, for what it does to the process."""
        self.run.results.grids.clear()
        try:
            self.run.results.grids_at(time)
        finally:
            if time in self.run.tools:
                Grid(self.run.tools[time])

    def grids_at(self, time):
        """Cells and particles at a time, {} where they cannot be read."""
        if time in self.failed:
            return {}
        results = self.run.results
        results.grids.clear()
        try:
            grids = results.grids_at(time)
        except (PlotError, OSError, ValueError, KeyError, IndexError) as error:
            self.failed.add(time)
            self.run.note("error", f"The picture at t = {self.time_text(time)} is left out: {self.run.relative(error)}.")
            return {}
        for grid in grids.values():
            self.grid_units.update(grid.units)
        if self.cut is not None:
            grids = {kind: grid.beyond(*self.cut) for kind, grid in grids.items()}
        return {kind: grid for kind, grid in grids.items() if grid.n_cells}

    def time_text(self, time):
        return units.quantity(time, self.run.results.units.label("T"))

    def chosen_fields(self, wanted):
        """The requested fields, or those of interest that exist. The last readable output has those
        of parts that appear in the run."""
        names = set()
        for time in (self.times[0], self.times[-1]):
            for grid in self.grids_at(time).values():
                names.update(grid.point_data, grid.cell_data)
        if wanted:
            for text in wanted:
                if Field(text).array not in names:
                    raise PlotError(f'no file has a field "{Field(text).array}"; there are: {", ".join(sorted(names))}')
            texts = wanted
        else:
            along = f"stress {AXES[self.axis] * 2}"
            temperature = "nodal temperature" if "nodal temperature" in names else "temperature"
            stress = "von Mises stress" if "von Mises stress" in names else "stress"
            texts = [text for text in (stress, "effective plastic strain", temperature, along, "velocity",
                                       "displacement", "pressure") if Field(text).array in names]
        return [self.described(text) for text in texts[:MAXIMUM_FIELDS]]

    def described(self, text):
        array = Field(text).array
        unit = self.grid_units.get(array, "")
        colours = ("RdBu_r" if Field(text).is_signed else "plasma" if array.endswith("temperature") else "viridis")
        title = FIELD_TITLES.get(text, text)
        return ShownField(text, title[:1].upper() + title[1:], unit, colours)

    def snapshot(self, time):
        """What is to be seen at a time, or None where it cannot be read."""
        if time not in self.snapshots:
            grids = self.grids_at(time)
            try:
                self.snapshots[time] = self.made(time, grids) if grids else None
            except (PlotError, ValueError, IndexError, KeyError, TypeError) as error:
                self.snapshots[time] = None
                self.failed.add(time)
                self.run.note("error", f"The picture at t = {self.time_text(time)} is left out: its files are damaged ({error}).")
        return self.snapshots[time]

    def made(self, time, grids):
        shot = Snapshot(time)
        if "cells" in grids:
            self.add_cells(shot, grids["cells"])
        if "particles" in grids:
            self.add_particles(shot, grids["particles"])
        self.add_forces(shot, grids.values())
        self.add_tools(shot)
        return shot

    def add_cells(self, shot, grid):
        corners = grid.cells[:, :4 if self.is_flat else 8]  # of curved cells the corners come first
        if corners.shape[1] == 8:
            faces, owner = outer_faces(corners)
        else:
            faces, owner = corners, numpy.arange(len(corners))
        for one in self.fields:
            chosen = Field(one.text)
            if chosen.array in grid.cell_data:
                shot.face_values[one.text] = chosen.of(grid.cell_data[chosen.array])[owner].astype(float)
            elif chosen.array in grid.point_data:
                shot.face_values[one.text] = chosen.of(grid.point_data[chosen.array])[faces].mean(axis=1)
            else:
                shot.face_values[one.text] = numpy.full(len(faces), numpy.nan)
        used, renumbered = numpy.unique(faces, return_inverse=True)
        shot.points, shot.faces = grid.points[used], renumbered.reshape(faces.shape)
        shot.n_cells = grid.n_cells

    def add_particles(self, shot, grid):
        shot.centres, shot.shapes = grid.points, particle_shapes(grid)
        for one in self.fields:
            chosen = Field(one.text)
            shot.particle_values[one.text] = (
                chosen.of(grid.point_data[chosen.array]).astype(float) if chosen.array in grid.point_data
                else numpy.full(grid.n_points, numpy.nan))

    @staticmethod
    def add_forces(shot, grids):
        """Those of shared nodes are in both files: one of them is kept."""
        both = [numpy.hstack([grid.points, grid.point_data["contact force"]]) for grid in grids
                if "contact force" in grid.point_data]
        if not both:
            return
        rows = numpy.vstack(both)
        rows = numpy.unique(rows[numpy.isfinite(rows).all(axis=1) & rows[:, 3:].any(axis=1)], axis=0)
        largest = numpy.argsort(-numpy.linalg.norm(rows[:, 3:], axis=1), kind="stable")[:MAXIMUM_ARROWS]
        shot.force_points, shot.forces = rows[largest, :3], rows[largest, 3:]

    def add_tools(self, shot):
        path = self.run.tools.get(shot.time)
        if path is None:
            return
        try:
            grid = Grid(path)
        except (PlotError, OSError, ValueError) as error:
            self.run.note("warning", f"The tools at t = {self.time_text(shot.time)} are not drawn: "
                          f"{self.run.relative(error)}.")
            return
        if grid.n_cells and grid.cells.shape[1] in (2, 3):
            shot.tool_points, shot.tool_faces = grid.points, grid.cells

    def readable_times(self, times):
        return [time for time in times if self.snapshot(time) is not None]

    def set_ranges(self, times):
        """The colours of each field over the snapshots of these times; fields that are the same
        everywhere and always are left out. The scale of the arrows."""
        shots = [self.snapshot(time) for time in times]
        kept = []
        for one in self.fields:
            values = numpy.concatenate([shot.values(one.text) for shot in shots])
            values = values[numpy.isfinite(values)]
            if not len(values):
                continue
            one.least, one.largest = float(values.min()), float(values.max())
            one.low, one.high = (float(value) for value in numpy.percentile(values, (1, 99)))
            span = one.largest - one.least
            one.has_full_range = one.high - one.low <= 1e-3 * span
            if one.has_full_range:
                one.low, one.high = one.least, one.largest
            if span <= 1e-9 * max(abs(one.least), abs(one.largest)):
                continue
            if one.colours == "RdBu_r":
                one.high = max(abs(one.low), abs(one.high))
                one.low = -one.high
            one.scale = units.scale_for(max(abs(one.low), abs(one.high)), one.unit)
            kept.append(one)
        self.fields = kept
        self.set_frame(shots)

    def set_frame(self, shots):
        """The box of the picture and the length of arrows. The few that flew far away would make the
        rest small: the box holds all points at the start, and later 99 % of those of the faces and the
        bulk of the particles, along each axis."""
        low, high = numpy.nanmin(shots[0].all_points(), axis=0), numpy.nanmax(shots[0].all_points(), axis=0)
        for shot in shots:
            for points, share, reach in ((shot.points, 0.5, 0.0), (shot.centres, 5, 0.25)):
                if len(points):
                    ends = numpy.nanpercentile(points, (share, 100 - share), axis=0)
                    margin = reach * (ends[1] - ends[0])
                    low = numpy.fmin(low, numpy.fmax(ends[0] - margin, numpy.nanmin(points, axis=0)))
                    high = numpy.fmax(high, numpy.fmin(ends[1] + margin, numpy.nanmax(points, axis=0)))
        self.box = low, high
        self.size = float(numpy.linalg.norm(high - low)) or 1.0
        strength = numpy.concatenate([numpy.linalg.norm(shot.forces, axis=1) for shot in shots])
        strength = strength[strength > 0]
        self.large_force = float(numpy.percentile(strength, 95)) if len(strength) else 0.0

    def arrows(self, shot):
        """Tails and tips of the contact forces: an arrow ends at the node that is pushed."""
        if not self.large_force:
            return numpy.zeros((0, 3)), numpy.zeros((0, 3))
        length = numpy.linalg.norm(shot.forces, axis=1)
        kept = length > 0.02 * self.large_force
        relative = shot.forces[kept] / self.large_force
        excess = numpy.maximum(length[kept] / self.large_force / LONGEST_ARROW, 1)[:, None]
        tips = shot.force_points[kept]
        return tips - ARROW_LENGTH * self.size * relative / excess, tips

    def arrow_text(self):
        if not self.large_force:
            return ""
        unit = self.run.results.units.label("M L/T^2")
        return (f"Arrows are contact forces on nodes. One of {units.quantity(self.large_force, unit, digits=3)} is "
                f"{units.quantity(ARROW_LENGTH * self.size, self.run.results.units.label('L'), digits=3)} long; longer "
                f"ones end at {LONGEST_ARROW:g} times that.")


def evenly(times, count):
    """At most `count` of the times, the first and the last among them."""
    if len(times) <= count:
        return list(times)
    chosen = numpy.linspace(0, len(times) - 1, max(count, 1)).round().astype(int)
    return [times[index] for index in dict.fromkeys(chosen.tolist())] if count > 1 else [times[-1]]

# SPDX-License-Identifier: LGPL-2.1-or-later
"""Fields in colour on the deformed body: elements as faces, particles as ellipsoids.

Drawn as polygons by matplotlib and not rendered, because a machine without a display has no OpenGL.
"""

import numpy
from matplotlib.cm import ScalarMappable
from matplotlib.collections import PolyCollection
from matplotlib.colors import Normalize

from . import style
from .particle_shapes import particle_shapes, particle_sizes, silhouettes
from .results import AXES, PlotError, heading

MAXIMUM_PICTURES = 6

HEXAHEDRON_FACES = numpy.array([[0, 3, 2, 1], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5],
                                [2, 3, 7, 6], [3, 0, 4, 7]])


class Camera:
    """An oblique parallel view with the longest axis to the right; in two dimensions from above.
    The axis of a cut, where there is one, points away from the viewer."""

    def __init__(self, extents, cut_axis=None):
        self.is_flat = extents[2] <= 1e-9 * max(extents)
        if self.is_flat:
            self.matrix = numpy.eye(3)
            return
        extents = numpy.array(extents, dtype=float)
        if cut_axis is not None:
            extents[cut_axis] = 0
        right = int(numpy.argmax(extents))
        # Cyclic, so that the system stays right-handed; against the cycle one axis is reversed.
        order = [right, (right + 1) % 3, (right + 2) % 3]
        is_reversed = cut_axis == order[2]
        if is_reversed:
            order[1:] = reversed(order[1:])
        turn, tilt = numpy.radians(-20), numpy.radians(20)
        # Rows: to the right, up, towards the viewer; the second axis points away from the viewer.
        right_row = [numpy.cos(turn), -numpy.sin(turn), 0]
        away = numpy.array([numpy.sin(turn), numpy.cos(turn), 0])
        up_row = numpy.sin(tilt) * away + [0, 0, numpy.cos(tilt)]
        towards = -numpy.cos(tilt) * away + [0, 0, numpy.sin(tilt)]
        self.matrix = numpy.zeros((3, 3))
        self.matrix[:, order] = [right_row, up_row, towards]
        if is_reversed:
            self.matrix[:, right] *= -1

    def project(self, points):
        """Columns: right, up, towards the viewer."""
        return points @ self.matrix.T

    def normal_towards(self, polygons):
        """The share of each polygon's unit normal towards the viewer."""
        normal = numpy.cross(polygons[:, 2] - polygons[:, 0], polygons[:, 3] - polygons[:, 1])
        length = numpy.linalg.norm(normal, axis=1)
        return normal[:, 2] / numpy.where(length > 0, length, 1)

    @property
    def axes(self):
        """Names of the axes to the right and up where the picture has both, or None."""
        return AXES[:2] if self.is_flat else None


class SliceCamera(Camera):
    """Looks along an axis: the other two are those of the picture."""

    def __init__(self, axis):
        self.is_flat = False
        # Right, up, towards the viewer, so that z is up wherever it can be.
        rows = {0: (1, 2, 0), 1: (0, 2, 1), 2: (0, 1, 2)}[axis]
        self.matrix = numpy.zeros((3, 3))
        self.matrix[(0, 1, 2), rows] = 1, 1, -1 if axis == 1 else 1
        self.shown = tuple(AXES[row] for row in rows[:2])

    @property
    def axes(self):
        return self.shown


def positions(grid, magnify):
    displacement = grid.point_data.get("displacement")
    if displacement is None or magnify == 1:
        return grid.points
    return grid.points + (magnify - 1) * displacement


def outer_faces(cells):
    """Vertices of the faces that belong to one hexahedron only, and these hexahedra."""
    faces = cells[:, HEXAHEDRON_FACES].reshape(-1, 4)
    owner = numpy.repeat(numpy.arange(len(cells)), len(HEXAHEDRON_FACES))
    _, first, counts = numpy.unique(numpy.sort(faces, axis=1), axis=0, return_index=True,
                                    return_counts=True)
    outer = first[counts == 1]
    return faces[outer], owner[outer]


def element_polygons(grid, field, camera, magnify):
    """Polygons in the view (n, 4, 3), their values and brightness."""
    if grid.cells.shape[1] == 8:
        corners, owner = outer_faces(grid.cells)
    else:
        corners, owner = grid.cells, numpy.arange(len(grid.cells))
    if field.array in grid.cell_data:
        values = field.of(grid.cell_data[field.array])[owner]
    else:
        values = field.of(grid.point_data[field.array])[corners].mean(axis=1)
    polygons = camera.project(positions(grid, magnify))[corners]
    towards = camera.normal_towards(polygons)
    if camera.is_flat:
        return polygons, values, numpy.ones(len(values))
    front = towards > 0
    return polygons[front], values[front], 0.72 + 0.28 * towards[front]


def particle_polygons(grid, field, camera, magnify):
    values = field.of(grid.point_data[field.array])
    shapes = particle_shapes(grid, magnify)
    polygons = camera.project(positions(grid, magnify))[:, None, :] + silhouettes(shapes, camera.matrix)
    return polygons, values, numpy.ones(len(values))


def colour_range(results, field, times):
    """Limits over all times, and the map of colours: diverging for values of both signs."""
    lowest, highest = numpy.inf, -numpy.inf
    for time in times:
        for grid in results.grids_at(time).values():
            if grid.has(field.array):
                values = field.of(grid.samples(field.array)[1])
                lowest = min(lowest, numpy.nanmin(values))
                highest = max(highest, numpy.nanmax(values))
    if field.is_signed:
        largest = max(abs(lowest), abs(highest)) or 1.0
        return Normalize(-largest, largest), "RdBu_r"
    if field.array.endswith("temperature") and highest > lowest:
        return Normalize(lowest, highest), "inferno"
    return Normalize(min(lowest, 0.0), highest if highest > 0 else 1.0), "viridis"


def draw_body(plot, grids, field, camera, norm, colours, magnify):
    mapping = ScalarMappable(norm, colours)
    polygons, shades, depths = [], [], []
    for kind, grid in grids.items():
        if not grid.has(field.array) or (kind == "particles"
                                         and field.array not in grid.point_data):
            continue
        make = particle_polygons if kind == "particles" else element_polygons
        shape, values, brightness = make(grid, field, camera, magnify)
        shade = mapping.to_rgba(values)
        shade[:, :3] *= brightness[:, None]
        polygons += list(shape[:, :, :2])
        shades.append(shade)
        depths.append(shape[:, :, 2].mean(axis=1))
    if not polygons:
        return
    shades = numpy.vstack(shades)
    # Painter's order: what is nearer to the viewer comes later.
    order = numpy.argsort(numpy.concatenate(depths), kind="stable")
    n_polygons = len(order)
    edge = 0.15 if n_polygons < 20000 else 0.0
    plot.add_collection(PolyCollection([polygons[index] for index in order],
                                       facecolors=shades[order], linewidths=edge,
                                       edgecolors="#00000060" if edge else "face"))
    plot.autoscale_view()


def cut_open(grids, cut):
    """The grids, or what lies beyond the cut, an axis and a coordinate on it."""
    if cut is None:
        return grids
    parts = {kind: grid.beyond(*cut) for kind, grid in grids.items()}
    return {kind: grid for kind, grid in parts.items() if grid.n_cells}


def sliced(grids, slice_):
    """What now lies in a slice: cells that its plane passes through, particles that reach it. The
    slice is an axis and a coordinate on it."""
    axis, position = slice_
    result = {}
    for kind, grid in grids.items():
        coordinate = grid.points[:, axis]
        if grid.cells.shape[1] > 1:
            corners = coordinate[grid.cells]
            kept = (corners.min(axis=1) <= position) & (corners.max(axis=1) > position)
        else:
            radius = 0.5 * particle_sizes(grid)
            kept = (coordinate - radius <= position) & (coordinate + radius > position)
        if kept.any():
            result[kind] = grid.only(kept)
    return result


def draw_field(results, field, times, magnify, path, cut=None, limits=None, frame=None,
               slice_=None):
    """Writes the picture of one field; None where no file has it. The colours span the limits, or
    what there is. The pictures show all that there is, or as many times the initial size of the
    body by the size of the frame: what flew away would make the rest small."""
    times = [time for time in times
             if any(grid.has(field.array) for grid in results.grids_at(time).values())]
    if not times:
        return None
    if len(times) > MAXIMUM_PICTURES:
        chosen = numpy.linspace(0, len(times) - 1, MAXIMUM_PICTURES).round().astype(int)
        times = [times[index] for index in chosen]

    def shown_at(time):
        grids = cut_open(results.grids_at(time), cut)
        return sliced(grids, slice_) if slice_ else grids

    grids = shown_at(times[0])
    if not grids:
        raise PlotError("nothing of the body lies in the slice" if slice_ else
                        "nothing of the body lies beyond the cut")
    points = numpy.vstack([grid.points for grid in grids.values()])
    camera = (SliceCamera(slice_[0]) if slice_ else
              Camera(numpy.ptp(points, axis=0), cut[0] if cut else None))
    start = camera.project(numpy.vstack([grid.initial_points() for grid in grids.values()])
                           if frame else points)
    view = numpy.ptp(start, axis=0)
    # Few long bodies above each other, others side by side.
    is_long = view[0] > 2.2 * view[1]
    n_columns = (1 if len(times) <= 3 else 2) if is_long else min(len(times), 3)
    width = {1: 7.0, 2: 5.0}.get(n_columns, 3.4) if is_long else 3.4
    height = min(max(width * view[1] / max(view[0], 1e-300), 0.8), 5.0) + 0.45
    if camera.axes:
        height += 0.35  # numbers along the axis
    figure, plots = style.panels(len(times), n_columns, width, height, sharex=True, sharey=True)
    norm, colours = colour_range(results, field, times)
    if limits:
        norm = Normalize(*limits)
    for plot, time in zip(plots, times):
        draw_body(plot, shown_at(time), field, camera, norm, colours, magnify)
        plot.set_aspect("equal")
        if frame:
            middle = 0.5 * (start.min(axis=0) + start.max(axis=0))
            reach = 0.5 * frame * view
            plot.set_xlim(middle[0] - reach[0], middle[0] + reach[0])
            plot.set_ylim(middle[1] - reach[1], middle[1] + reach[1])
        plot.set_title(f"t = {style.number(time)} {results.units.label('T')}", loc="left")
        if not camera.axes:
            plot.axis("off")
    if camera.axes:
        for label, set_label in zip(camera.axes, (figure.supxlabel, figure.supylabel)):
            set_label(heading(label, results.units.label("L")), fontsize=9)
    grids = [grid for time in times for grid in results.grids_at(time).values()]
    figure.colorbar(ScalarMappable(norm, colours), ax=plots, label=field.label(grids),
                    shrink=0.9, aspect=30, pad=0.02)
    return style.save(figure, path)

# SPDX-License-Identifier: LGPL-2.1-or-later
"""Pictures of the bodies over time, with axes, contact forces and tools, as PNG in base64."""

import base64
import io

import numpy
from plotting import style
from plotting.fields import Camera
from plotting.particle_shapes import silhouettes

from matplotlib.cm import ScalarMappable  # noqa: E402  style chooses the backend first
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.colors import Normalize

from . import units
from .bodies import evenly
from .charts import tick_text, ticks

MAXIMUM_TIMES, FEWEST_TIMES = 9, 3
MAXIMUM_FIELDS = 3
POLYGONS = 400_000  # of all times of a field, which need about half a minute
MANY_PARTICLES = 20_000
WIDTH, LEAST_HEIGHT, LARGEST_HEIGHT, RESOLUTION = 5.2, 1.6, 3.9, 155  # inches, pixels per inch
# Grey that is readable on white and on black.
INK, FAINT = "#7d8590", "#9aa2ad60"
FORCE_COLOUR, TOOL_COLOUR, MISSING_COLOUR = "#d6336c", "#8893a0", "#999999"


def picture_times(bodies):
    last = next((shot for time in reversed(bodies.times) if (shot := bodies.snapshot(time))), None)
    if last is None:
        return []
    n_polygons = max(len(last.faces) // 2 + len(last.centres), 1)
    return evenly(bodies.times, int(numpy.clip(POLYGONS // n_polygons, FEWEST_TIMES, MAXIMUM_TIMES)))


def silhouette_edges(matrix, low, high):
    """One edge of the box for each axis: on the outline of the view, below or to the left. Yields the
    axis and the two ends."""
    centre = matrix @ (0.5 * (low + high))
    for axis in range(3):
        others = [other for other in range(3) if other != axis]
        edges = []
        for sides in ((0, 0), (0, 1), (1, 0), (1, 1)):
            is_front = [(matrix[2, other] > 0) == bool(side) for other, side in zip(others, sides)]
            ends = numpy.array([low, high])
            for other, side in zip(others, sides):
                ends[:, other] = (low, high)[side][other]
            middle = matrix @ ends.mean(axis=0) - centre
            if is_front[0] != is_front[1]:
                edges.append((middle[1] + 0.35 * middle[0], ends))
        if edges:
            yield axis, min(edges, key=lambda edge: edge[0])[1]


def in_front(centres, reaches):
    """Which particles are not behind several others: those near the nearest one in their square of the
    view. Of large bodies most are inside."""
    size = 1.5 * float(numpy.median(reaches))
    if len(centres) < MANY_PARTICLES or not size > 0:
        return numpy.ones(len(centres), bool)
    squares = numpy.floor(centres[:, :2] / size)
    _, square = numpy.unique(squares, axis=0, return_inverse=True)
    square = square.reshape(-1)
    nearest = numpy.full(square.max() + 1, -numpy.inf)
    numpy.maximum.at(nearest, square, centres[:, 2])
    return centres[:, 2] >= nearest[square] - 6 * size


class Painter:
    """Draws snapshots from one point of view."""

    def __init__(self, bodies):
        self.bodies = bodies
        low, high = bodies.box
        self.camera = Camera(high - low, bodies.cut[0] if bodies.cut else None)
        if bodies.is_flat:
            self.camera.is_flat, self.camera.matrix = True, numpy.eye(3)
        corners = numpy.array([[(low, high)[side][axis] for axis, side in enumerate(sides)]
                               for sides in numpy.ndindex(2, 2, 2)])
        view = self.camera.project(corners)
        self.low, self.high = view.min(axis=0), view.max(axis=0)
        self.length = units.scale_for(bodies.size, bodies.run.results.units.label("L"))

    def body(self, plot, shot, one):
        """Faces and particles, those nearer to the viewer later."""
        mapping = ScalarMappable(Normalize(one.low, one.high), one.colours)
        mapping.get_cmap().set_bad(MISSING_COLOUR)
        shapes, shades, depths = [], [], []
        if len(shot.faces):
            polygons = self.camera.project(shot.points)[shot.faces]
            towards = self.camera.normal_towards(polygons)
            front = numpy.ones(len(polygons), bool) if self.camera.is_flat else towards > 0
            brightness = 1 if self.camera.is_flat else 0.72 + 0.28 * towards[front, None]
            colour = mapping.to_rgba(numpy.ma.masked_invalid(shot.face_values[one.text][front]))
            colour[:, :3] *= brightness
            shapes += list(polygons[front][:, :, :2])
            shades.append(colour)
            depths.append(polygons[front][:, :, 2].mean(axis=1))
        if len(shot.centres):
            centres = self.camera.project(shot.centres)
            polygons = silhouettes(shot.shapes, self.camera.matrix)
            seen = in_front(centres, polygons[:, 0, 2])
            polygons = centres[seen, None] + polygons[seen]
            shapes += list(polygons[:, :, :2])
            shades.append(mapping.to_rgba(numpy.ma.masked_invalid(shot.particle_values[one.text][seen])))
            depths.append(polygons[:, 0, 2])
        if not shapes:
            return
        order = numpy.argsort(numpy.concatenate(depths), kind="stable")
        edge = 0.3 if len(order) < 20000 else 0.0
        plot.add_collection(PolyCollection([shapes[index] for index in order], linewidths=edge,
                                           facecolors=numpy.vstack(shades)[order],
                                           edgecolors="#00000060" if edge else "face"))

    def tools(self, plot, shot):
        if not len(shot.tool_faces):
            return
        shapes = self.camera.project(shot.tool_points)[shot.tool_faces][:, :, :2]
        if shapes.shape[1] == 2:
            plot.add_collection(LineCollection(list(shapes), colors=TOOL_COLOUR, linewidths=1.6))
        else:
            shapes = shapes[numpy.abs(numpy.cross(shapes[:, 1] - shapes[:, 0], shapes[:, 2] - shapes[:, 0])) > 0]
            plot.add_collection(PolyCollection(list(shapes), facecolors=TOOL_COLOUR, alpha=0.16, linewidths=0))

    def forces(self, plot, shot):
        tails, tips = self.bodies.arrows(shot)
        if not len(tips):
            return
        tail, tip = (self.camera.project(points)[:, :2] for points in (tails, tips))
        plot.quiver(*tail.T, *(tip - tail).T, angles="xy", scale_units="xy", scale=1, color=FORCE_COLOUR, width=1.6,
                    units="dots", headwidth=4, headlength=5, headaxislength=4.5, zorder=5)

    def axes(self, plot):
        """Edges of the box with numbers; in two dimensions the usual axes."""
        low, high = self.bodies.box
        if self.camera.is_flat:
            low, high = low + [0, 0, 0], high + [0, 0, 1e-3 * self.bodies.size]
        centre = self.camera.project(0.5 * (low + high)[None])[0, :2]
        matrix = self.camera.matrix
        if self.camera.is_flat:  # seen from straight above, edges have no silhouette: those below and to the left
            edges = [(0, numpy.array([low, [high[0], low[1], low[2]]])), (1, numpy.array([low, [low[0], high[1], low[2]]]))]
        else:
            edges = silhouette_edges(matrix, low, high)
        for axis, ends in edges:
            seen = self.camera.project(ends)[:, :2]
            direction = seen[1] - seen[0]
            extent = high[axis] - low[axis]
            seen_length = float(numpy.linalg.norm(direction))
            if extent <= 0 or seen_length < 0.02 * self.bodies.size:
                continue
            outward = numpy.array([direction[1], -direction[0]]) / seen_length
            if outward @ (seen.mean(axis=0) - centre) < 0:
                outward = -outward
            tick = 0.012 * self.view_size
            plot.plot(*seen.T, color=INK, linewidth=0.8)
            count = int(numpy.clip(12 * seen_length / self.view_size, 2, 8))
            values, digits = ticks(low[axis] * self.length.factor, high[axis] * self.length.factor, count)
            for value in values:
                tick_point = seen[0] + direction * (value / self.length.factor - low[axis]) / extent
                plot.plot(*numpy.array([tick_point, tick_point + tick * outward]).T, color=INK, linewidth=0.8)
                plot.annotate(tick_text(value, digits), tick_point, 11 * outward, textcoords="offset points", color=INK,
                              fontsize=8, ha="center", va="center")
            plot.annotate(f"{'xyz'[axis]} [{self.length.label}]" if self.length.label else "xyz"[axis],
                          seen.mean(axis=0), 30 * outward * (1.25, 0.9), textcoords="offset points", color=INK, fontsize=8.5,
                          ha="center", va="center")

    def draw(self, shot, one):
        """One picture as a data address."""
        margin = numpy.array([0.24, 0.13]) * float(max(self.high[:2] - self.low[:2]))
        low, high = self.low[:2] - margin, self.high[:2] + margin
        self.view_size = float(numpy.linalg.norm(high - low))
        width, height = high - low
        figure_height = float(numpy.clip(WIDTH * height / width, LEAST_HEIGHT, LARGEST_HEIGHT))
        # The figure has room to spare in one of the two directions.
        spare = numpy.maximum([height * WIDTH / figure_height - width, width * figure_height / WIDTH - height], 0)
        low, high = low - 0.5 * spare, high + 0.5 * spare
        figure = style.pyplot.figure(figsize=(WIDTH, figure_height), dpi=RESOLUTION)
        plot = figure.add_axes([0, 0, 1, 1])
        plot.axis("off")
        plot.set_xlim(low[0], high[0])
        plot.set_ylim(low[1], high[1])
        self.body(plot, shot, one)
        self.tools(plot, shot)
        self.forces(plot, shot)
        self.axes(plot)
        plot.set_autoscale_on(False)
        file = io.BytesIO()
        figure.savefig(file, dpi=RESOLUTION, transparent=True, format="png")
        style.pyplot.close(figure)
        return "data:image/png;base64," + base64.b64encode(file.getvalue()).decode("ascii")


def make_pictures(bodies, times):
    """[(field, [(time, picture)])] of the first fields."""
    shots = [shot for time in times if (shot := bodies.snapshot(time))]
    if not shots or not bodies.fields:
        return []
    painter = Painter(bodies)
    return [(one, [(bodies.time_text(shot.time), painter.draw(shot, one)) for shot in shots])
            for one in bodies.fields[:MAXIMUM_FIELDS]]

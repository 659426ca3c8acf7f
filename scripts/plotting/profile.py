# SPDX-License-Identifier: LGPL-2.1-or-later
"""Values of a field over an initial coordinate, at each output time."""

import numpy

from . import style
from .results import AXES, heading

MAXIMUM_PANELS = 12


class Section:
    """Samples over a coordinate. Where many share a coordinate (a structured body), their mean with
    the range from smallest to largest, so that the picture shows a profile and not a cloud."""

    def __init__(self, coordinate, values, resolution):
        keys = numpy.round(coordinate / resolution).astype(numpy.int64)
        _, first, inverse, counts = numpy.unique(keys, return_index=True, return_inverse=True,
                                                 return_counts=True)
        self.is_grouped = len(first) * 3 <= len(keys)
        if self.is_grouped:
            self.coordinate = coordinate[first]
            self.values = numpy.bincount(inverse, weights=values) / counts
            self.lowest = numpy.full(len(first), numpy.inf)
            self.highest = numpy.full(len(first), -numpy.inf)
            numpy.minimum.at(self.lowest, inverse, values)
            numpy.maximum.at(self.highest, inverse, values)
        else:
            self.coordinate, self.values = coordinate, values


def interface_position(grids, axis, extent):
    """Where elements and particles meet, if that is a plane across the axis, or None."""
    particles = grids.get("particles")
    if particles is None or "cells" not in grids or not particles.n_points:
        return None
    is_shared = particles.point_data.get("shared node")
    if is_shared is None or not numpy.any(is_shared):
        return None
    positions = particles.initial_points()[numpy.asarray(is_shared, dtype=bool), axis]
    return positions.mean() if numpy.ptp(positions) < 1e-3 * extent else None


def draw_samples(plot, grid, field, axis, resolution, is_particles):
    """One kind of samples with its range; the exact samples (coordinates, values) or None."""
    positions, values = grid.samples(field.array)
    section = Section(positions[:, axis], field.of(values.astype(float)), resolution)
    colour = style.PARTICLE_COLOUR if is_particles else style.ELEMENT_COLOUR
    size = 3.2 if len(section.coordinate) < 400 else 1.2
    if section.is_grouped:
        plot.vlines(section.coordinate, section.lowest, section.highest, color=colour, alpha=0.35,
                    linewidth=1.6)
    plot.plot(section.coordinate, section.values, linestyle="none",
              marker="o" if is_particles else "s", markersize=size, markerfacecolor="none",
              markeredgewidth=0.8, color=colour,
              label="particles" if is_particles else "finite elements")
    exact = "exact " + field.array
    if not grid.has(exact):
        return None
    positions, values = grid.samples(exact)
    return positions[:, axis], field.of(values.astype(float))


def draw_exact(plot, exact):
    coordinate = numpy.concatenate([one[0] for one in exact])
    values = numpy.concatenate([one[1] for one in exact])
    # One point of the curve for each coordinate.
    coordinate, first = numpy.unique(coordinate, return_index=True)
    plot.plot(coordinate, values[first], color=style.EXACT_COLOUR, linewidth=1.0, zorder=1,
              label="exact")


def draw_profiles(results, field, axis, times, path):
    """Writes the picture of one field; None where no file has it."""
    times = [time for time in times
             if any(grid.has(field.array) for grid in results.grids_at(time).values())]
    if not times:
        return None
    if len(times) > MAXIMUM_PANELS:
        chosen = numpy.linspace(0, len(times) - 1, MAXIMUM_PANELS).round().astype(int)
        times = [times[index] for index in chosen]

    first = results.grids_at(times[0]).values()
    extent = numpy.ptp(numpy.concatenate([grid.initial_points()[:, axis] for grid in first]))
    n_columns = 3 if len(times) > 4 else min(len(times), 2)
    figure, plots = style.panels(len(times), n_columns, 3.6, 2.4, sharex=True, sharey=True)
    labels = {}
    for plot, time in zip(plots, times):
        grids = results.grids_at(time)
        exact = []
        for kind, grid in grids.items():
            if grid.has(field.array):
                exact.append(draw_samples(plot, grid, field, axis, 1e-6 * extent,
                                          kind == "particles"))
        exact = [one for one in exact if one is not None]
        if exact:
            draw_exact(plot, exact)
        interface = interface_position(grids, axis, extent)
        if interface is not None:
            plot.axvline(interface, color=style.INTERFACE_COLOUR, linestyle="--", linewidth=0.9,
                         zorder=0, label="interface")
        plot.set_title(f"t = {style.number(time)} {results.units.label('T')}")
        handles, names = plot.get_legend_handles_labels()
        labels.update(zip(names, handles))
    figure.supxlabel(heading("initial " + AXES[axis], results.units.label("L")), fontsize=9)
    figure.supylabel(field.label(first), fontsize=9)
    style.legend_above(figure, labels)
    return style.save(figure, path)

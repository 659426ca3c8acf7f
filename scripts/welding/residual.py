# SPDX-License-Identifier: LGPL-2.1-or-later
"""The stresses that a weld along x leaves, and how it distorts the plate: of the last output of runs."""

import argparse
import json
import sys
from pathlib import Path

import numpy

from cutting.measure import show
from plotting.results import PlotError, Results

# Six simplices of a hexahedron, in the order of corners of VTK.
SIMPLICES = ((0, 1, 2, 6), (0, 2, 3, 6), (0, 3, 7, 6), (0, 7, 4, 6), (0, 4, 5, 6), (0, 5, 1, 6))


def volumes_of(corners):
    """Of hexahedra: corners by cell, corner and component."""
    total = numpy.zeros(len(corners))
    for a, b, c, d in SIMPLICES:
        origin = corners[:, a]
        total += numpy.einsum("ij,ij->i", corners[:, d] - origin,
                              numpy.cross(corners[:, b] - origin, corners[:, c] - origin)) / 6
    return numpy.abs(total)


class Plate:
    """Positions, volumes and stresses (xx, yy, zz, xy, yz, xz) of all cells and particles."""

    def __init__(self, directory):
        results = Results(directory)
        if not results.files:
            raise PlotError(f"{directory} has no output")
        positions, stresses, volumes = [], [], []
        for kind, grid in results.grids_at(max(results.files)).items():
            if kind == "cells":
                corners = grid.points[grid.cells]
                positions.append(corners.mean(axis=1))
                stresses.append(grid.cell_data["stress"])
                volumes.append(volumes_of(corners))
            else:
                positions.append(grid.points)
                stresses.append(grid.point_data["stress"])
                volumes.append(grid.point_data["volume"].reshape(-1))
            if kind == "cells":  # particles of the weld were stirred away from where they began
                self.node = grid.initial_points()
                self.displacement = grid.point_data["displacement"].astype(float)
                self.reaction = grid.point_data["reaction"].astype(float)
        self.position = numpy.concatenate(positions)
        self.stress = numpy.concatenate(stresses).astype(float)
        self.volume = numpy.concatenate(volumes).astype(float)

    def imbalance(self, component):
        """The integral of a stress component over that of its magnitude: zero where nothing pulls at
        the plate."""
        share = self.volume * self.stress[:, component]
        return abs(share.sum()) / numpy.abs(share).sum()

    def largest_reaction(self):
        """The largest force of a support over the force in the cross sections, ∫|σ_xx| dA: their mean."""
        carried = (self.volume * numpy.abs(self.stress[:, 0])).sum() / numpy.ptp(self.node[:, 0])
        return numpy.linalg.norm(self.reaction, axis=1).max() / carried

    def profile(self, begin, end, width):
        """Middles of strips across the weld, and the mean longitudinal stress of what lies in them
        from x = begin to end."""
        inside = (self.position[:, 0] >= begin) & (self.position[:, 0] <= end)
        strip = numpy.floor(self.position[inside, 1] / width + 0.5).astype(int)
        middles, means = [], []
        for number in range(strip.min(), strip.max() + 1):
            chosen = strip == number
            if not chosen.any():
                continue
            middles.append(number * width)
            means.append(numpy.average(self.stress[inside, 0][chosen],
                                       weights=self.volume[inside][chosen]))
        return numpy.array(middles), numpy.array(means)

    def distortion(self):
        """By how much the nodes of cells at the lower face are out of the plane that fits them best, and
        how much shorter the face has become along x in the middle of its width."""
        lowest = self.node[:, 2].min()
        face = self.node[:, 2] < lowest + 1e-9 + 1e-6 * numpy.ptp(self.node[:, 2])
        node, rise = self.node[face], self.displacement[face, 2]
        plane = numpy.column_stack([node[:, 0], node[:, 1], numpy.ones(len(node))])
        left = rise - plane @ numpy.linalg.lstsq(plane, rise, rcond=None)[0]

        def mean_at(x):
            middle = numpy.ptp(node[:, 1]) / 4
            chosen = (numpy.abs(node[:, 0] - x) < 1e-9) & (numpy.abs(node[:, 1]) < middle)
            return self.displacement[face, 0][chosen].mean()

        return numpy.ptp(left), mean_at(node[:, 0].min()) - mean_at(node[:, 0].max())


def measure(plate, arguments):
    begin, end = arguments.section
    middles, means = plate.profile(begin, end, arguments.width)
    weld = numpy.abs(middles) <= arguments.weld
    result = {f"balance of {name}": plate.imbalance(index)
              for index, name in enumerate(("xx", "yy", "zz"))}
    result["largest reaction"] = plate.largest_reaction()
    result["largest longitudinal stress of a strip"] = means.max()
    result["at y"] = middles[means.argmax()]
    result["mean longitudinal stress of the weld"] = means[weld].mean()
    result["in its middle"] = means[numpy.abs(middles).argmin()]
    result["smallest longitudinal stress of a strip"] = means.min()
    result["at y of the smallest"] = middles[means.argmin()]
    result["out of plane"], result["shortening of the lower face"] = plate.distortion()
    return result


def draw(plates, arguments, path):
    from plotting import style

    figure, (plot,) = style.panels(1, 1, 7, 3.4)
    for (name, plate), colour in zip(plates, ("#d1602a", "#1f5f99", "#3a8f4d")):
        middles, means = plate.profile(*arguments.section, arguments.width)
        plot.plot(middles * 1e3, means / 1e6, "o-", markersize=3, color=colour, label=name)
    plot.axhline(0, color="#888888", linewidth=0.8)
    for side in (-1, 1):
        plot.axvline(side * arguments.weld * 1e3, color="#888888", linewidth=0.8, linestyle=":")
    plot.set_xlabel("y across the weld [mm]")
    plot.set_ylabel("longitudinal stress [MPa]")
    plot.legend()
    style.save(figure, path)


def numbers(text):
    values = tuple(float(item) for item in text.split(","))
    if len(values) != 2:
        raise argparse.ArgumentTypeError("allowed are 2 numbers separated by a comma")
    return values


def main():
    parser = argparse.ArgumentParser(prog="scripts/measure_residual_stress")
    parser.add_argument("runs", nargs="+")
    parser.add_argument("--section", type=numbers, default=(26e-3, 34e-3))
    parser.add_argument("--width", type=float, default=2e-3)
    parser.add_argument("--weld", type=float, default=9e-3)
    parser.add_argument("--json", metavar="FILE")
    parser.add_argument("--picture", metavar="FILE")
    arguments = parser.parse_args()
    try:
        plates = [(Path(run).name, Plate(run)) for run in arguments.runs]
    except (PlotError, KeyError) as error:
        sys.exit(f"error: {error}")
    results = {name: measure(plate, arguments) for name, plate in plates}
    for name, result in results.items():
        print(name)
        show(result, None)
    if arguments.json:
        Path(arguments.json).write_text(json.dumps(results, indent=2) + "\n", encoding="utf-8")
    if arguments.picture:
        draw(plates, arguments, arguments.picture)


if __name__ == "__main__":
    main()

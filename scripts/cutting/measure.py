# SPDX-License-Identifier: LGPL-2.1-or-later
"""What a cut is measured by, from the tables of a run."""

import json
import math
from pathlib import Path

import tombolo
from tombolo import TomboloError
from tombolo.table import interpolated


CutError = TomboloError


class Table(tombolo.Table):
    """A table of a run with at least two rows, as lists."""

    def __init__(self, path):
        super().__init__(path, arrays=False, least_rows=2)


def largest_of(table, names):
    """The largest magnitudes of those columns that there are."""
    return {f"largest {name}": max(abs(value) for value in table[name] if not math.isnan(value))
            for name in names if name in table}


def costs(directory):
    """Steps and seconds of a run that has ended."""
    summary = tombolo.Run(directory).summary
    return {name: summary[entry] for name, entry in (("steps", "steps"), ("seconds", "wall_seconds"))
            if entry in summary}


def mean_over(times, values, begin, end):
    """The mean of a piecewise linear function over an interval."""
    knots = [begin] + [time for time in times if begin < time < end] + [end]
    at_knots = [interpolated(times, values, time) for time in knots]
    area = sum(0.5 * (at_knots[k] + at_knots[k - 1]) * (knots[k] - knots[k - 1])
               for k in range(1, len(knots)))
    return area / (end - begin)


def forces(table, contact, begin, end, width):
    """Mean cutting and feed force per width from the impulses at the ends of an interval."""
    times = table["time"]
    impulse = {axis: table[f"{contact} impulse {axis}"] for axis in "xy"}
    change = {axis: interpolated(times, impulse[axis], end) - interpolated(times, impulse[axis], begin)
              for axis in "xy"}
    elapsed = (end - begin) * width
    return change["x"] / elapsed, -change["y"] / elapsed


def measure(directory, contact="tool", window=(0.4, 1.0), width=1.0):
    """The numbers of a run, by name."""
    directory = Path(directory)
    table = Table(directory / "contact.csv")
    times = table["time"]
    start, stop = 0.0, times[-1]
    begin, end = (start + share * (stop - start) for share in window)
    result = {"time": stop}
    result["cutting force"], result["feed force"] = forces(table, contact, begin, end, width)
    (result["cutting force over the travel"],
     result["feed force over the travel"]) = forces(table, contact, start, stop, width)
    position = table[f"{contact} position x"]
    result["travel"] = position[-1] - position[0]
    for what in ("mean", "largest"):
        column = f"{contact} contact {what} temperature"
        if column not in table:
            continue
        pairs = [(t, value) for t, value, n in zip(times, table[column], table[f"{contact} nodes"])
                 if n > 0]
        if len(pairs) < 2:
            continue
        contact_times, values = zip(*pairs)
        result[f"{what} temperature of the contact"] = mean_over(
            contact_times, values, max(begin, contact_times[0]), end)
        result[f"{what} temperature of the contact over the travel"] = mean_over(
            contact_times, values, contact_times[0], stop)
    statistics = Table(directory / "statistics.csv")
    result.update(largest_of(statistics, ("energy error", "heat balance error")))
    if "particles that fly off" in statistics:
        result["particles that fly off"] = max(statistics["particles that fly off"])
    return {**result, **costs(directory)}


def show(result, json_file):
    """Prints the numbers of a run by name, and writes them to a file where one is given."""
    width = max(len(name) for name in result)
    for name, value in result.items():
        print(f"{name:{width}}  {value:.6g}")
    if json_file:
        Path(json_file).write_text(json.dumps(result, indent=2) + "\n", "utf-8")


def chip_speed(points, velocities, forces_on_nodes, edge, depth, rake):
    """The mean speed along the rake face, away from the edge, of the nodes that the face presses
    higher than 0.3 depths above the edge; None without such. Velocities are relative to the tool."""
    along = (-math.sin(rake), math.cos(rake))
    across = (math.cos(rake), math.sin(rake))
    speeds = [velocity[0] * along[0] + velocity[1] * along[1]
              for point, velocity, force in zip(points, velocities, forces_on_nodes)
              if point[1] - edge[1] > 0.3 * depth
              and force[0] * across[0] + force[1] * across[1] > 0.0]
    return sum(speeds) / len(speeds) if speeds else None


def chip_speed_ratio(directory, contact="tool", window=(0.4, 1.0), depth=1.0, rake=0.0):
    """The speed of the chip along the rake face over that of the tool, mean over the pictures in the
    window; None where no particle is so high."""
    from plotting.results import PlotError, Results  # needs numpy and vtk

    try:
        results = Results(directory)
        table = Table(Path(directory) / "contact.csv")
        times = table["time"]
        begin, end = (share * times[-1] for share in window)
        ratios = []
        for time in results.times(None):
            if not begin <= time <= end * (1 + 1e-9):
                continue
            edge = [interpolated(times, table[f"{contact} position {axis}"], time) for axis in "xy"]
            position = table[f"{contact} position x"]
            speed = (position[-1] - position[0]) / (times[-1] - times[0])
            for grid in results.grids_at(time).values():
                if not all(grid.has(name) for name in ("velocity", "contact force")):
                    continue
                relative = grid.point_data["velocity"].astype(float).copy()
                relative[:, 0] -= speed
                measured_speed = chip_speed(grid.points, relative, grid.point_data["contact force"], edge,
                                            depth, rake)
                if measured_speed is not None:
                    ratios.append(measured_speed / speed)
    except PlotError as error:
        raise CutError(str(error)) from error
    return sum(ratios) / len(ratios) if ratios else None

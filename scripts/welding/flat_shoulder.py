# SPDX-License-Identifier: LGPL-2.1-or-later
"""A run of flat_shoulder_304L.prm beside the curves of the public example that it follows."""

import argparse
import json
import sys
from pathlib import Path

import numpy

from cutting.measure import CutError, Table, interpolated, mean_over
from plotting.results import PlotError, Results

# Time [s], largest temperature of the plates [°C], heat of friction and of plastic work [W].
CURVES = ((2.11, 268, 276, 0.002), (3.10, 600, 666, 1.2), (4.16, 836, 739, 1.6), (5.11, 942, 729, 1.3),
          (6.50, 1013, 658, 1.2), (8.09, 1038, 612, 2.0), (10.2, 1052, 636, 2.9), (13.1, 1129, 762, 4.4),
          (15.1, 1187, 813, 7.0), (17.1, 1257, 820, 6.6), (18.9, 1282, 805, 4.7), (21.0, 1271, 800, 7.1),
          (24.6, 1253, 722, 3.7), (29.0, 1101, 543, 1.5))
# At 19.2 s across the plates, 27 mm along the joint: distance from it [mm], temperatures at the right
# and the left of it [°C].
PROFILE_TIME, PROFILE_Y = 19.2, 27e-3
PROFILE = ((0.57, 1242, 1207), (4.21, 977, 975), (5.13, 892, 900), (7.17, 735, 722), (9.55, 546, 525),
           (12.33, 342, 324), (15.57, 176, 165), (17.39, 119, 111))
# Heat in plates and tool [J] that the published fields of temperature hold, with the density of the scene.
ENTHALPY = ((6.5, 3395), (29.0, 16790))
# The curves swing from row to row: they are compared as means over this time, but not over the start of the motion.
WINDOW = 0.5
START_OF_MOTION = 6.5


def rate(times, values, begin, end):
    return (interpolated(times, values, end) - interpolated(times, values, begin)) / (end - begin)


def curves(directory):
    """Rows of time, and of temperature, heat of friction and plastic heat, each of the run and of the example."""
    statistics = Table(Path(directory) / "statistics.csv")
    contact = Table(Path(directory) / "contact.csv")
    times = statistics["time"]
    rows = []
    for time, temperature, friction, plastic in CURVES:
        begin, end = max(times[0], time - 0.5 * WINDOW), min(times[-1], time + 0.5 * WINDOW)
        if time <= START_OF_MOTION:
            end = min(end, START_OF_MOTION)
        else:
            begin = max(begin, START_OF_MOTION)
        if time > times[-1] * (1 + 1e-6):
            break
        rows.append((time, mean_over(times, statistics["largest nodal temperature"], begin, end), temperature,
                     rate(contact["time"], contact["shoulder friction heat"], begin, end), friction,
                     rate(times, statistics["plastic heat"], begin, end), plastic))
    return rows


def enthalpies(directory):
    """Rows of time and of the heat in plates and tool, of the run and of the example."""
    statistics = Table(Path(directory) / "statistics.csv")
    times = statistics["time"]
    return [(time, interpolated(times, statistics["enthalpy"], time), reference)
            for time, reference in ENTHALPY if time <= times[-1] * (1 + 1e-6)]


def line_across(directory):
    """Positions across and temperatures of the upper faces of both plates on the line of nodes next to that of the
    example, by the sign of x, at the output next to its time."""
    results = Results(directory)
    if not results.files:
        raise PlotError(f"{directory} has no output")
    time = min(results.files, key=lambda one: abs(one - PROFILE_TIME))
    if abs(time - PROFILE_TIME) > 0.1:
        raise PlotError(f"{directory} has no output at {PROFILE_TIME:g}")
    grid = results.grids_at(time)["cells"]
    position = grid.initial_points()
    temperature = grid.point_data["nodal temperature"].reshape(-1)
    plates = position[grid.cells].mean(axis=1)
    sides = {}
    for sign in (1, -1):
        side_nodes = numpy.unique(grid.cells[(sign * plates[:, 0] > 0) & (plates[:, 2] < 0)])
        top = side_nodes[numpy.abs(position[side_nodes, 2]) < 1e-9]
        away = numpy.abs(position[top, 1] - PROFILE_Y)
        line = top[away < away.min() + 1e-9]
        line = line[numpy.argsort(sign * position[line, 0])]
        sides[sign] = (sign * position[line, 0], temperature[line])
    return sides


def profile(sides):
    """Rows of the distance, and of temperatures right and left, each of the run and of the example."""
    return [(distance, numpy.interp(distance * 1e-3, *sides[1]), right,
             numpy.interp(distance * 1e-3, *sides[-1]), left) for distance, right, left in PROFILE]


def difference(value, reference):
    return f"{100 * (value / reference - 1):+6.1f} %"


def show(time_rows, enthalpy, across):
    print("time   largest temperature      heat of friction        plastic heat")
    for time, t, t_of, f, f_of, p, p_of in time_rows:
        print(f"{time:5.2f}  {t:5.0f} ({t_of:4.0f} {difference(t, t_of)})  {f:5.0f} ({f_of:4.0f} {difference(f, f_of)})"
              f"  {p:6.2f} ({p_of:5.3g})")
    for time, value, reference in enthalpy:
        print(f"{time:5.2f}  heat in plates and tool {value:6.0f} ({reference:5.0f} {difference(value, reference)})")
    for distance, right, right_of, left, left_of in across:
        print(f"{distance:5.2f} mm  right {right:5.0f} ({right_of:4.0f} {difference(right, right_of)})"
              f"  left {left:5.0f} ({left_of:4.0f} {difference(left, left_of)})")


def draw(directory, sides, path):
    from plotting import style

    statistics = Table(Path(directory) / "statistics.csv")
    contact = Table(Path(directory) / "contact.csv")
    times = statistics["time"]
    figure, plots = style.panels(3 if sides else 2, 3, 4.2, 3.2)
    reference = numpy.array(CURVES)
    plots[0].plot(times, statistics["largest nodal temperature"], color="#d1602a", label="computed")
    plots[0].plot(reference[:, 0], reference[:, 1], "o", markersize=3.5, color="#222222", label="example")
    plots[0].set_ylabel("largest temperature [°C]")
    middles = numpy.arange(0.5, times[-1], 0.25)
    heat = [rate(contact["time"], contact["shoulder friction heat"], time - 0.5 * WINDOW,
                 min(times[-1], time + 0.5 * WINDOW)) for time in middles]
    plots[1].plot(middles, heat, color="#d1602a", label="computed")
    plots[1].plot(reference[:, 0], reference[:, 2], "o", markersize=3.5, color="#222222", label="example")
    plots[1].set_ylabel("heat of friction [W]")
    for plot in plots[:2]:
        plot.set_xlabel("time [s]")
    if sides:
        across = numpy.array(PROFILE)
        for sign, column in ((1, 1), (-1, 2)):
            plots[2].plot(sign * sides[sign][0] * 1e3, sides[sign][1], color="#d1602a",
                          label="computed" if sign > 0 else None)
            plots[2].plot(sign * across[:, 0], across[:, column], "o", markersize=3.5, color="#222222",
                          label="example" if sign > 0 else None)
        plots[2].set_xlabel("x across the weld [mm]")
        plots[2].set_ylabel(f"temperature at {PROFILE_TIME:g} s [°C]")
    for plot in plots:
        plot.legend()
    style.save(figure, path)


def main():
    parser = argparse.ArgumentParser(prog="scripts/measure_flat_shoulder")
    parser.add_argument("run")
    parser.add_argument("--json", metavar="FILE")
    parser.add_argument("--picture", metavar="FILE")
    arguments = parser.parse_args()
    try:
        time_rows = curves(arguments.run)
        enthalpy = enthalpies(arguments.run)
        has_profile = time_rows and time_rows[-1][0] > PROFILE_TIME
        sides = line_across(arguments.run) if has_profile else None
        across = profile(sides) if sides else []
    except (CutError, PlotError, KeyError) as error:
        sys.exit(f"error: {error}")
    show(time_rows, enthalpy, across)
    if arguments.json:
        numbers = {"curves": time_rows, "enthalpy": enthalpy, "profile": across}
        Path(arguments.json).write_text(json.dumps(numbers, indent=2) + "\n", encoding="utf-8")
    if arguments.picture:
        draw(arguments.run, sides, arguments.picture)


if __name__ == "__main__":
    main()

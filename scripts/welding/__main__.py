# SPDX-License-Identifier: LGPL-2.1-or-later
"""Command line of scripts/measure_weld."""

import argparse
import sys

from cutting.measure import show
from welding.measure import Weld, WeldError, binned, measure


def numbers(count):
    def parse(text):
        values = tuple(float(item) for item in text.split(","))
        if len(values) != count:
            raise argparse.ArgumentTypeError(f"allowed are {count} numbers separated by commas")
        return values
    return parse


def parse_arguments():
    parser = argparse.ArgumentParser(prog="scripts/measure_weld")
    parser.add_argument("run")
    parser.add_argument("--contact", default="tool")
    parser.add_argument("--material", default="aluminium")
    parser.add_argument("--window", type=numbers(2))
    parser.add_argument("--plunge", type=float, default=0.05)
    parser.add_argument("--tool", type=numbers(4), default=(9e-3, 3e-3, 4e-3, 10))
    parser.add_argument("--json", metavar="FILE")
    parser.add_argument("--picture", metavar="FILE")
    parser.add_argument("--smooth", type=float, default=2e-3)
    return parser.parse_args()


def draw(weld, path, width):
    """Torque beside that of a metal that sticks, forces, and temperatures over time."""
    from plotting import style

    figure, plots = style.panels(3, 1, 7.5, 2.3, sharex=True)
    colours = ("#1f5f99", "#d1602a", "#3a8f4d")

    def line(plot, values, label, colour, dashes="-"):
        plot.plot(*binned(weld.times, values, width), dashes, color=colour, label=label)

    line(plots[0], weld.torque(), "computed", colours[0])
    line(plots[0], weld.sticking_torque(), "Schmidt and Hattel", "#222222", "--")
    plots[0].set_ylabel("torque [N m]")
    for axis, colour in zip("xyz", colours):
        line(plots[1], [-value / 1e3 for value in weld.column(f"mean force {axis}")], axis, colour)
    plots[1].set_ylabel("force on the tool [kN]")
    line(plots[2], weld.column("contact largest temperature"), "contact, largest", colours[1])
    line(plots[2], weld.column("contact mean temperature"), "contact, mean", colours[0])
    if f"{weld.contact} tool temperature" in weld.table:
        line(plots[2], weld.column("tool temperature"), "tool", colours[2])
    plots[2].set_ylabel("temperature [°C]")
    plots[2].set_xlabel("time [s]")
    for plot in plots:
        plot.legend(fontsize=7, loc="upper left", bbox_to_anchor=(1.0, 1.02), borderaxespad=0.3)
    style.save(figure, path)


def main():
    arguments = parse_arguments()
    try:
        weld = Weld(arguments.run, arguments.contact, arguments.material, arguments.tool)
        result = measure(weld, arguments.window, arguments.plunge)
    except WeldError as error:
        sys.exit(f"error: {error}")
    show(result, arguments.json)
    if arguments.picture:
        draw(weld, arguments.picture, arguments.smooth)


if __name__ == "__main__":
    main()

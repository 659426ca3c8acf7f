# SPDX-License-Identifier: LGPL-2.1-or-later
"""Command line of scripts/measure_cut."""

import argparse
import math
import sys
from pathlib import Path

from cutting.measure import CutError, Table, chip_speed_ratio, measure, show


def parse_window(text):
    try:
        begin, end = (float(item) for item in text.split(","))
    except ValueError as error:
        raise argparse.ArgumentTypeError("allowed are two numbers, such as 0.4,1") from error
    if not 0.0 <= begin < end <= 1.0:
        raise argparse.ArgumentTypeError("allowed are two increasing numbers from 0 to 1")
    return begin, end


def positive(text):
    try:
        value = float(text)
    except ValueError:
        value = 0.0
    if not (value > 0.0 and math.isfinite(value)):
        raise argparse.ArgumentTypeError(f"\"{text}\": allowed is a number above 0")
    return value


def parse_arguments():
    parser = argparse.ArgumentParser(prog="scripts/measure_cut")
    parser.add_argument("run")
    parser.add_argument("--contact", default="tool")
    parser.add_argument("--without-heat", metavar="DIR")
    parser.add_argument("--window", type=parse_window, default=(0.4, 1.0))
    parser.add_argument("--width", type=positive, default=1.0)
    parser.add_argument("--depth", type=positive)
    parser.add_argument("--rake", type=float, default=0.0)
    parser.add_argument("--json", metavar="FILE")
    parser.add_argument("--picture", metavar="FILE")
    return parser.parse_args()


def draw_forces(arguments):
    """Cutting and feed force over the travel, with and without heat."""
    import matplotlib
    matplotlib.use("Agg")
    from matplotlib import pyplot

    figure, plot = pyplot.subplots(figsize=(6.0, 3.6), constrained_layout=True)
    runs = [(arguments.run, "with heat" if arguments.without_heat else "", "C3")]
    if arguments.without_heat:
        runs.append((arguments.without_heat, "without heat", "C0"))
    for directory, label, colour in runs:
        table = Table(Path(directory) / "contact.csv")
        position = table[f"{arguments.contact} position x"]
        travel = [x - position[0] for x in position]
        for axis, sign, what, line in (("x", 1.0, "cutting", "-"), ("y", -1.0, "feed", "--")):
            force = [sign * value / arguments.width
                     for value in table[f"{arguments.contact} mean force {axis}"]]
            plot.plot(travel, force, line, color=colour, linewidth=1.0,
                      label=f"{what} force {label}".strip())
    plot.set_xlabel("travel of the tool")
    plot.set_ylabel("force per width")
    plot.axhline(0.0, color="0.8", linewidth=0.6)
    plot.legend(frameon=False)
    figure.savefig(arguments.picture, dpi=130)


def main():
    arguments = parse_arguments()
    try:
        result = measure(arguments.run, arguments.contact, arguments.window, arguments.width)
        if arguments.without_heat:
            cold = measure(arguments.without_heat, arguments.contact, arguments.window,
                           arguments.width)
            for name in ("cutting force", "cutting force over the travel", "feed force over the travel"):
                if cold[name] != 0.0:
                    result[f"{name}, with heat over without"] = result[name] / cold[name]
        if arguments.depth:
            ratio = chip_speed_ratio(arguments.run, arguments.contact, arguments.window,
                                     arguments.depth, math.radians(arguments.rake))
            if ratio is not None:
                result["speed of the chip over the cutting speed"] = ratio
    except CutError as error:
        sys.exit(f"error: {error}")
    show(result, arguments.json)
    if arguments.picture:
        draw_forces(arguments)


if __name__ == "__main__":
    main()

# SPDX-License-Identifier: LGPL-2.1-or-later
"""The command line of scripts/plot."""

import argparse
import difflib
import signal
import sys
from pathlib import Path

from . import fields, histories, profile
from .results import AXES, Field, PlotError, Results

PICTURES_OF_TABLES = [("statistics.csv", histories.draw_energies, "energies.png"),
                      ("statistics.csv", histories.draw_heat, "heat.png"),
                      ("conditions.csv", histories.draw_conditions, "conditions.png"),
                      ("sections.csv", histories.draw_conditions, "sections.png"),
                      ("probes.csv", histories.draw_probes, "probes.png"),
                      ("points.csv", histories.draw_probes, "points.png"),
                      ("links.csv", histories.draw_probes, "links.png"),
                      ("specimen.csv", histories.draw_probes, "specimen.png")]


def parse_cut(text):
    """An axis and a coordinate on it, from "x" or "x=1.5"."""
    axis, _, coordinate = text.partition("=")
    if axis.strip() not in AXES:
        raise argparse.ArgumentTypeError(f'"{axis}" is not one of {", ".join(AXES)}')
    return AXES.index(axis.strip()), float(coordinate or 0)


def parse_slice(text):
    """An axis and a coordinate on it, from "x=1.5"."""
    if "=" not in text:
        raise argparse.ArgumentTypeError(f'"{text}" has no place, such as x=1.5')
    return parse_cut(text)


def parse_frame(text):
    """A number above zero."""
    frame = float(text)
    if not 0 < frame < float("inf"):
        raise argparse.ArgumentTypeError(f'"{text}" is not a number above zero')
    return frame


def parse_arguments():
    parser = argparse.ArgumentParser(prog="plot")
    parser.add_argument("directory", type=Path)
    parser.add_argument("--times", type=lambda text: [float(one) for one in text.split(",")])
    parser.add_argument("--fields", type=lambda text: text.split(","))
    parser.add_argument("--profiles", type=lambda text: text.split(","))
    parser.add_argument("--axis", choices=AXES)
    parser.add_argument("--magnify", type=float, default=1)
    parser.add_argument("--cut", type=parse_cut)
    parser.add_argument("--slice", type=parse_slice)
    parser.add_argument("--frame", type=parse_frame)
    parser.add_argument("--range", type=lambda text: [float(one) for one in text.split(",")])
    parser.add_argument("--output", type=Path)
    return parser.parse_args()


def chosen_fields(wanted, default, results):
    """The requested fields, each of which must exist, or the default."""
    names = results.array_names()
    result = []
    for text in wanted or default:
        field = Field(text.strip())
        if wanted and field.array not in names:
            nearest = difflib.get_close_matches(field.array, names, n=1)
            hint = f', did you mean "{nearest[0]}"?' if nearest else ""
            raise PlotError(f'no file has a field "{field.array}"{hint} '
                            f'There are: {", ".join(names)}')
        result.append(field)
    return result


def moves(results, times):
    """Whether anything has a velocity: bodies at rest have none."""
    return any(grid.has("velocity") and grid.samples("velocity")[1].any()
               for time in times for grid in results.grids_at(time).values())


def draw_all(arguments):
    """Writes all pictures; their paths."""
    results = Results(arguments.directory)
    if not results.files and not any(results.table(name) for name, _, _ in PICTURES_OF_TABLES):
        stages = sorted(str(file.parent) for file in arguments.directory.glob("*/statistics.csv"))
        raise PlotError(f"{arguments.directory} has neither solution.pvd nor tables to draw" +
                        (f"; directories in it have: {', '.join(stages)}" if stages else ""))
    pictures = arguments.output or arguments.directory / "pictures"
    pictures.mkdir(parents=True, exist_ok=True)
    written = []
    if results.files:
        times = results.times(arguments.times)
        axis = AXES.index(arguments.axis) if arguments.axis else results.longest_axis()
        along = f"stress {AXES[axis] * 2}"
        names = results.array_names()
        temperature = "nodal temperature" if "nodal temperature" in names else "temperature"
        over_axis = chosen_fields(arguments.profiles, [along, temperature], results)
        in_colour = chosen_fields(arguments.fields,
                                  [along, "velocity", "displacement", temperature], results)
        if not arguments.fields and not moves(results, times):
            in_colour = [field for field in in_colour if field.array != "velocity"]
        for field in over_axis:
            written.append(profile.draw_profiles(results, field, axis, times,
                                                 pictures / f"profile_{field.file_name}.png"))
        for field in in_colour:
            written.append(fields.draw_field(results, field, times, arguments.magnify,
                                             pictures / f"field_{field.file_name}.png",
                                             arguments.cut, arguments.range, arguments.frame,
                                             arguments.slice))
    elif arguments.times or arguments.fields or arguments.profiles:
        raise PlotError(f"{arguments.directory} has no solution.pvd")
    for table_name, draw, picture in PICTURES_OF_TABLES:
        table = results.table(table_name)
        if table is not None:
            if "time" not in table:
                raise PlotError(f'{table_name} has no column "time"')
            written.append(draw(table, pictures / picture))
    return [path for path in written if path is not None]


def main():
    arguments = parse_arguments()
    try:
        written = draw_all(arguments)
    except PlotError as error:
        sys.exit(f"plot: {error}")
    for path in written:
        print(path)


if __name__ == "__main__":
    signal.signal(signal.SIGPIPE, signal.SIG_DFL)  # as other commands: a reader may have enough
    main()

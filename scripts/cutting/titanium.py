# SPDX-License-Identifier: LGPL-2.1-or-later
"""The measured cuts of Ti6Al4V, run, extrapolated and drawn: scripts/cut_titanium."""

import argparse
import csv
import math
import os
import subprocess
import sys
from pathlib import Path

from cutting.measure import CutError, chip_speed_ratio, measure
from tombolo import Run, TomboloError

ROOT = Path(os.environ.get("TOMBOLO_ROOT", Path(__file__).resolve().parents[2]))
SCENE = ROOT / "parameter_files/machining/titanium_smoothed.prm"
TESTS = ROOT / "parameter_files/machining/titanium_tests.csv"
RAKE = 15.0
WIDTH, BELOW, TRAVEL = 0.6e-3, 0.2e-3, 0.32e-3  # of the work piece, metal below the edge, of the tool
RUN_SPEED = 50.0  # of the tool in the time that governs the inertia [m/s]
TOOL_EFFUSIVITY = 17320.0
QUANTITIES = ("cutting force", "feed force", "chip ratio")


def positive(row, name):
    """The number in a column."""
    try:
        value = float(row[name])
    except ValueError:
        value = math.nan
    if not 0.0 < value < math.inf:
        raise CutError(f'the column "{name}" has "{row[name]}"; allowed is a number above 0')
    return value


def read_tests(path=TESTS):
    """The rows by condition, (speed [m/min], thickness [um])."""
    with open(path, newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    return {(positive(row, "speed [m/min]"), positive(row, "thickness [um]")):
            {name.partition(" [")[0]: float(value) for name, value in row.items()} for row in rows}


def name_of(condition):
    """Of directories, and for --conditions: "30-60"."""
    return "-".join(f"{value:.15g}" for value in condition)


def has_finished(directory):
    """Whether a run has come to its end there."""
    try:
        return Run(directory).summary.get("ended") == "finished"
    except TomboloError:
        return False


def lattice(thickness, spacing):
    """The spacing nearest to the requested one at which the edge is between two rows, and the spacings
    in the depth, a number and a half."""
    in_depth = max(1, round(thickness / spacing - 0.5 + 1e-9)) + 0.5
    return thickness / in_depth, in_depth


def settings(condition, spacing, friction):
    """Entries of the scene for a condition and a spacing [um]."""
    speed, thickness = condition[0] / 60.0, condition[1] * 1e-6
    dp, in_depth = lattice(thickness, spacing * 1e-6)
    below = round(BELOW / dp - 0.5) + 0.5
    height = (below + in_depth) * dp
    time = TRAVEL / speed
    columns = round(WIDTH / dp)
    conductance = 2.0 * TOOL_EFFUSIVITY / math.sqrt(math.pi * time)
    return dp, {
        "End time": f"{time:.6e}",
        "Mesh/box/Lower corner": f"0, {-height:.8e}",
        "Mesh/box/Upper corner": f"{columns * dp:.8e}, 0",
        "Mesh/box/Cells": f"{columns}, {round(below + in_depth)}",
        "Condition: base/Where": f"y < {-height + 0.1 * dp:.8e}",
        "Condition: end/Where": f"x > {(columns - 0.1) * dp:.8e}",
        "Contact: tool/Radius": f"{0.499 * dp:.8e}",
        "Contact: tool/Friction": f"{friction}",
        "Contact: tool/Cutting speed": f"{speed:.8e}",
        "Contact: tool/Conductance": f"{conductance:.4e}",
        "Contact: tool/polyline/Origin": f"{-0.52 * dp - 1e-6:.8e}, {-thickness:.8e}",
        "Contact: tool/polyline/Displacement": f"{speed:.8e}*t; 0",
        "Scaling/Process time factor": f"{RUN_SPEED / speed:.8g}",
        "Output/Number": "20",
        "Output/Statistics interval": f"{time / 100:.6e}",
    }


def run(program, directory, entries, extra):
    """Runs the scene unless its results are there. Returns whether it finished."""
    if has_finished(directory):
        return True
    command = [program, str(SCENE), "--quiet", "--overwrite",
               "--set", f"Output directory={directory}"]
    for name, value in entries.items():
        command += ["--set", f"{name}={value}"]
    for setting in extra:
        command += ["--set", setting]
    directory.mkdir(parents=True, exist_ok=True)
    with open(directory / "log", "w", encoding="utf-8") as log:
        return subprocess.run(command, stdout=log, stderr=subprocess.STDOUT,
                              check=False).returncode == 0


def numbers_of(directory, thickness):
    """The measured numbers of a run, forces in N/mm."""
    result = measure(directory)
    result["cutting force"] /= 1e3
    result["feed force"] /= 1e3
    speed = chip_speed_ratio(directory, depth=thickness * 1e-6, rake=math.radians(RAKE))
    result["chip ratio"] = 1.0 / speed if speed else math.nan
    return result


def extrapolated(values):
    """The straight line through the values at the two finest of (spacing, value), at zero."""
    finest = sorted(pair for pair in values if not math.isnan(pair[1]))[:2]
    if len(finest) < 2:
        return math.nan
    (fine, at_fine), (coarse, at_coarse) = finest
    return at_fine - fine * (at_coarse - at_fine) / (coarse - fine)


def print_table(tests, results):
    print("| m/min, um | spacing um | F_c (test) | F_f (test) | chip (test) | hottest | energy | fly off "
          "| s |")
    print("|---|---|---|---|---|---|---|---|---|")
    for condition, spacing_results in results.items():
        test = tests[condition]
        rows = [(f"{dp * 1e6:.2f}", numbers) for dp, numbers in sorted(spacing_results.items(), reverse=True)]
        limit = {name: extrapolated([(dp, numbers[name]) for dp, numbers in spacing_results.items()])
                 for name in QUANTITIES}
        for spacing, numbers in rows + [("0", limit)]:
            shown = " | ".join(f"{numbers[name]:.4g} ({test[name]:g})" for name in QUANTITIES)
            rest = " | ".join(f"{numbers.get(name, math.nan):.3g}" for name in (
                "largest temperature of the contact", "largest energy error",
                "particles that fly off", "seconds"))
            print(f"| {name_of(condition).replace('-', ', ')} | {spacing} | {shown} | {rest} |")


def draw(tests, results, picture):
    """Forces and ratio over the thickness, a column for each speed."""
    import matplotlib
    matplotlib.use("Agg")
    from matplotlib import pyplot

    speeds = sorted({speed for speed, _ in tests})
    figure, plots = pyplot.subplots(3, len(speeds), figsize=(9.0, 8.0), sharex=True, sharey="row",
                                    constrained_layout=True)
    for column, speed in enumerate(speeds):
        thicknesses = sorted(thickness for v, thickness in tests if v == speed)
        speed_tests = [tests[speed, thickness] for thickness in thicknesses]
        for row, name in enumerate(QUANTITIES):
            plot = plots[row][column]
            values = [test[name] for test in speed_tests]
            if row == 0:
                below = [v - test["lower end of two sigma"] for v, test in zip(values, speed_tests)]
                above = [test["upper end of two sigma"] - v for v, test in zip(values, speed_tests)]
                plot.errorbar(thicknesses, values, [below, above], fmt="ko", capsize=4,
                              label="tests, two sigma")
                plot.plot(thicknesses,
                          [test["cutting force of the published model"] for test in speed_tests],
                          "s", color="0.6", label="published model, 5 um")
                plot.set_title(f"{speed:g} m/min")
            else:
                plot.plot(thicknesses, values, "ko")
            draw_results(plot, speed, thicknesses, results, name)
            if column == 0:
                plot.set_ylabel(name + (" [N/mm]" if row < 2 else ""))
            plot.set_ylim(bottom=0)
        plots[-1][column].set_xlabel("uncut thickness [um]")
    figure.legend(*plots[0][-1].get_legend_handles_labels(), frameon=False, fontsize=8, ncol=4,
                  loc="upper center", bbox_to_anchor=(0.5, 0.0))
    figure.savefig(picture, dpi=110, bbox_inches="tight")


def draw_results(plot, speed, thicknesses, results, name):
    """The runs from coarse to fine, beside each other, and the extrapolated value."""
    # Side by side, since all belong to the same thickness.
    colours = ("#c9dcf0", "#7fb0dc", "#3a7ebf", "#1f4f8a")
    for thickness in thicknesses:
        spacing_results = results.get((speed, thickness), {})
        order = sorted(spacing_results, reverse=True)
        for k, dp in enumerate(order):
            shade = colours[len(colours) - len(order) + k] if len(order) <= len(colours) else colours[-1]
            first = thickness == thicknesses[-1]
            plot.plot(thickness + 1.5 * (k + 1), spacing_results[dp][name], "^", color=shade,
                      label=f"here, {('coarse', 'middle', 'fine', 'finest')[min(k, 3)]}" if first else None)
        limit = extrapolated([(dp, numbers[name]) for dp, numbers in spacing_results.items()])
        if not math.isnan(limit):
            plot.plot(thickness + 1.5 * (len(order) + 1), limit, "*", color="C3", markersize=9,
                      label="here, extrapolated" if thickness == thicknesses[-1] else None)


def parse_arguments():
    parser = argparse.ArgumentParser(prog="scripts/cut_titanium")
    parser.add_argument("--spacings", default="20,10,7",
                        type=lambda text: [float(item) for item in text.split(",")])
    parser.add_argument("--conditions", default=[],
                        type=lambda text: [tuple(map(float, item.split("-"))) for item in text.split(",")])
    parser.add_argument("--directory", type=Path, default=Path("output/machining/titanium_tests"))
    parser.add_argument("--set", action="append", default=[], dest="extra")
    parser.add_argument("--program", default=str(ROOT / "build/bin/tombolo"))
    parser.add_argument("--picture")
    parser.add_argument("--draw", action="store_true")
    return parser.parse_args()


def main():
    arguments = parse_arguments()
    try:
        tests = read_tests()
    except CutError as error:
        sys.exit(f"error: {TESTS}: {error}")
    wanted = arguments.conditions or list(tests)
    unknown = [condition for condition in wanted if condition not in tests]
    if unknown:
        sys.exit(f"error: --conditions: \"{name_of(unknown[0])}\": allowed are {', '.join(map(name_of, tests))}")
    results = {}
    for spacing in arguments.spacings:
        for condition in wanted:
            name = name_of(condition)
            dp, entries = settings(condition, spacing, tests[condition]["friction"])
            directory = arguments.directory / f"{name}-{spacing:g}"
            if not arguments.draw and not run(arguments.program, directory, entries, arguments.extra):
                print(f"{name} at {spacing:g} um did not finish: {directory}/log", file=sys.stderr)
            try:
                results.setdefault(condition, {})[dp] = numbers_of(directory, condition[1])
            except CutError as error:
                print(f"{name} at {spacing:g} um: {error}", file=sys.stderr)
    results = {condition: spacing_results for condition, spacing_results in results.items() if spacing_results}
    if not results:
        sys.exit("error: there are no results")
    print_table(tests, results)
    draw(tests, results, arguments.picture or arguments.directory / "titanium_tests.png")


if __name__ == "__main__":
    main()

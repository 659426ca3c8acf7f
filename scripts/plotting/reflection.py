# SPDX-License-Identifier: LGPL-2.1-or-later
"""The picture and the tables of a reflection study: the command line of scripts/plot_reflection."""

import argparse
import csv
import math
import sys
from fractions import Fraction
from pathlib import Path

from .style import EXACT_COLOUR, panels, pyplot, save

# What distinguishes the series of a panel: column and the format of its values.
SETTINGS = {
    "element": "{}",
    "spacing_ratio": "spacing {}",
    "dilation": "dilation {}",
    "smoothing": "{}",
    "bridge": "{} bridge",
    "filter_power": "filter p = {}",
    "filter_strength": "β = {}",
    "poissons_ratio": "ν = {}",
    "wave": "{} wave",
    "angle [degrees]": "{}°",
}
TABLE_COLUMNS = {
    "pair": "pair",
    "element": "element",
    "spacing_ratio": "spacing ratio",
    "dilation": "dilation",
    "smoothing": "smoothing",
    "bridge": "bridge",
    "filter": "filter p, β",
    "poissons_ratio": "ν",
    "wave": "wave",
    "angle [degrees]": "angle",
    "wavelength [h]": "λ/h",
    "reflection [%]": "\\|R\\|",
    "converted [%]": "converted",
    "total [%]": "total",
    "smoothed [%]": "v",
    "unsmoothed [%]": "v̂",
    "exact [%]": "exact",
    "reference [%]": "expected",
}
DEFAULTS = {"element": "fully integrated hexahedron", "spacing_ratio": "1", "dilation": "1.8",
            "smoothing": "paper", "bridge": "paper", "wavelength [h]": "20", "poissons_ratio": "0", "wave": "P", "angle [degrees]": "0",
            "converted [%]": "0"}
PERCENT = [name for name in TABLE_COLUMNS if name.endswith("[%]")]


class TableError(Exception):
    """A table that cannot be drawn."""


def read_table(path):
    """The rows of reflection.csv, with two columns for people added."""
    if path.is_dir():
        path = path / "reflection.csv"
    try:
        with open(path, newline="", encoding="utf-8") as file:
            rows = list(csv.DictReader(file))
    except OSError as error:
        raise TableError(f"{path} cannot be read: {error.strerror}") from error
    if not rows or "reflection [%]" not in rows[0]:
        raise TableError(f"{path} is not the table of a reflection study")
    for row in rows:
        row["pair"] = f'{row["left"]}-{row["right"]}'
        has_filter = row["filter_power"] != "0"
        row["filter"] = f'{row["filter_power"]}, {row["filter_strength"]}' if has_filter else "–"
        if not has_filter:
            row["filter_strength"] = "–"
    return path, rows


def exact_reflection(wavelength, ratio):
    """|R| in percent of elements whose spacing changes by a ratio, for small time steps; the
    wavelength over the coarser spacing."""
    left = min(1, 1 / ratio)
    right = min(1, ratio)
    omega = 2 / left * math.sin(math.pi * left / wavelength)
    if omega * max(left, right) >= 2:
        return 100
    impedances = [math.sqrt(1 - (omega * h / 2) ** 2) for h in (left, right)]
    return 100 * abs(impedances[0] - impedances[1]) / sum(impedances)


def draw_exact(axis, ratio, wavelengths, label):
    low, high = math.log(min(wavelengths)), math.log(max(wavelengths))
    samples = [math.exp(low + (high - low) * i / 100) for i in range(101)]
    axis.plot(samples, [exact_reflection(sample, ratio) for sample in samples], color=EXACT_COLOUR,
              linewidth=0.8, label=label)


def series_of(rows):
    """{settings: {wavelength: row}} of those with three wavelengths or more."""
    series = {}
    for row in rows:
        key = tuple(row[name] for name in SETTINGS)
        series.setdefault(key, {})[float(row["wavelength [h]"])] = row
    return {key: row_at for key, row_at in series.items() if len(row_at) >= 3}


def label_of(key, varied):
    """What distinguishes a series; strengths of no filter and the like are left out."""
    parts = []
    for index in varied:
        column = list(SETTINGS)[index]
        if key[index] == "–":
            continue
        no_filter = column == "filter_power" and key[index] == "0"
        parts.append("no filter" if no_filter else SETTINGS[column].format(key[index]))
    return ", ".join(parts)


def draw_group(axis, name, pair, series):
    varied = [index for index in range(len(SETTINGS)) if len({key[index] for key in series}) > 1]
    wavelengths = sorted({wavelength for row_at in series.values() for wavelength in row_at})
    if pair == "FE-FE":
        ratio_index = list(SETTINGS).index("spacing_ratio")
        for number, ratio in enumerate(sorted({Fraction(key[ratio_index]) for key in series})):
            draw_exact(axis, float(ratio), wavelengths, None if number else "exact")
    else:
        draw_exact(axis, 0.5, wavelengths, "exact, elements 2:1")
    markers = "os^Dv<>ph*"
    colours = pyplot.rcParams["axes.prop_cycle"].by_key()["color"]
    has_short_waves = pair.startswith("particles")
    for number, (key, row_at) in enumerate(series.items()):
        style = {"color": colours[number % len(colours)], "marker": markers[number % len(markers)],
                 "markersize": 3.5, "linestyle": "none" if pair == "FE-FE" else "-",
                 "label": label_of(key, varied) or None}
        lines = {"smoothed [%]": style}
        if has_short_waves:
            lines["unsmoothed [%]"] = {"color": style["color"], "linestyle": ":"}
        for column, how in lines.items():
            # Below there is round-off only.
            points = [(wavelength, float(row[column])) for wavelength, row in sorted(row_at.items())
                      if row[column] and float(row[column]) > 1e-5]
            if points:
                axis.plot(*zip(*points), **how)
    axis.set_xscale("log")
    axis.set_yscale("log")
    ticks = [wavelength for wavelength in (5, 7, 10, 14, 20, 28, 40, 60, 80)
             if wavelengths[0] <= wavelength <= wavelengths[-1]]
    axis.set_xticks(ticks, [str(tick) for tick in ticks])
    axis.set_xticks([], minor=True)
    axis.yaxis.set_major_formatter("{x:g}")
    axis.set_xlabel("wavelength over the coarser spacing, λ/h")
    axis.set_ylabel("|R| (%)")
    axis.set_title(name + (" (dotted: in v̂)" if has_short_waves else ""))
    axis.legend(fontsize=7)


def draw(rows, wanted, picture):
    """Writes the picture of the requested groups, of all if None; its path, or None where there
    is nothing to draw."""
    groups = {}
    for row in rows:
        groups.setdefault(row["group"], []).append(row)
    for name in wanted or []:
        if name not in groups:
            raise TableError(f'there is no group "{name}". There are: {", ".join(groups)}')
    drawn = {}
    for name in wanted or groups:
        for pair in dict.fromkeys(row["pair"] for row in groups[name]):
            series = series_of([row for row in groups[name] if row["pair"] == pair])
            if series:
                drawn[name, pair] = series
    if not drawn:
        return None
    figure, axes = panels(len(drawn), 2 if len(drawn) < 5 else 3, 3.9, 3.2)
    for axis, ((name, pair), series) in zip(axes, drawn.items()):
        draw_group(axis, name, pair, series)
    with pyplot.rc_context({"savefig.dpi": 105}):
        return save(figure, picture)


def cell_text(row, column):
    return f"{float(row[column]):.3f}" if column in PERCENT and row[column] else row[column] or "–"


def needs(column, rows):
    """Whether a table must have a column: not for settings that are the default, nor for amplitudes
    that are those of the column before."""
    before = {"total [%]": "reflection [%]", "smoothed [%]": "total [%]",
              "unsmoothed [%]": "smoothed [%]"}.get(column)
    return (any(row[column] not in ("", "–") for row in rows)
            and not all(row[column] == DEFAULTS.get(column) for row in rows)
            and not (before and all(cell_text(row, column) == cell_text(row, before) for row in rows)))


def print_tables(rows):
    groups = {}
    for row in rows:
        groups.setdefault(row["group"], []).append(row)
    for name, group_rows in groups.items():
        columns = [column for column in TABLE_COLUMNS if needs(column, group_rows)]
        print(f"\n**{name}**\n")
        print("| " + " | ".join(TABLE_COLUMNS[column] for column in columns) + " |")
        print("|" + " --- |" * len(columns))
        for row in group_rows:
            print("| " + " | ".join(cell_text(row, column) for column in columns) + " |")


def main():
    parser = argparse.ArgumentParser(prog="plot_reflection")
    parser.add_argument("table", type=Path)
    parser.add_argument("picture", type=Path, nargs="?")
    parser.add_argument("--groups", type=lambda text: [name.strip() for name in text.split(",")])
    arguments = parser.parse_args()
    try:
        path, rows = read_table(arguments.table)
        picture = draw(rows, arguments.groups,
                       arguments.picture or path.with_name("reflection.png"))
    except TableError as error:
        sys.exit(f"plot_reflection: {error}")
    print_tables(rows)
    if picture is None:
        print("\nNo series of cases has three wavelengths: no picture.")
    else:
        print(f"\n{picture}")


if __name__ == "__main__":
    main()

# SPDX-License-Identifier: LGPL-2.1-or-later
"""The picture of a trade study: the command line of scripts/study."""

import argparse
import itertools
import json
import math
import sys
from pathlib import Path

from .style import panels, pyplot, save

COLOURS = ["#1f5f99", "#d1602a", "#3a8a4d", "#8a4fa3", "#b58a00", "#5a5a5a", "#c2406e", "#2b9aa0"]
MARKERS = ["o", "s", "^", "D", "v", "P", "X", "<", ">", "p"]
LABELS_A_COLUMN = 46


class StudyError(Exception):
    """A study that cannot be drawn."""


def number_of(text):
    """The number that a label begins with, or None."""
    for end in range(len(text), 0, -1):
        try:
            value = float(text[:end])
        except ValueError:
            continue
        return value if math.isfinite(value) else None
    return None


class Study:
    """study.json."""

    def __init__(self, path):
        self.path = path / "study.json" if path.is_dir() else path
        try:
            with open(self.path, encoding="utf-8") as file:
                self.data = json.load(file)
        except (OSError, ValueError) as error:
            raise StudyError(f"{self.path} cannot be read: {error}") from error
        self.factors = self.data["knobs"]
        self.runs = self.data["members"]
        self.by_choice = {tuple(run["choice"]): run for run in self.runs}

    def label(self, run, without=()):
        """What a run is called: its values, without those of some factors."""
        parts = []
        for number, (factor, value) in enumerate(zip(self.factors, run["choice"])):
            if value is None or number in without:
                continue
            text = factor["labels"][value]
            is_bare = number_of(text) is not None or text in ("yes", "no", "none")
            parts.append(f'{factor["name"]} {text}' if is_bare else text)
        return ", ".join(parts)

    def run(self, choice):
        """The run with these values, {factor: value}."""
        return self.by_choice[tuple(choice.get(k) for k in range(len(self.factors)))]


def pareto(study):
    """Error over cost; runs by number, with the list of them beside."""
    runs = [m for m in study.runs if m["error"] is not None and m["error"] > 0]
    if not runs:
        raise StudyError("no run has an error and a cost")
    runs.sort(key=lambda m: (m["choice"][0] is None, m["choice"][0] or 0, m["cost"]))
    n_columns = -(-len(runs) // LABELS_A_COLUMN)
    figure, (axis, text_axis) = pyplot.subplots(
        1, 2, layout="constrained", figsize=(6.8 + 3.2 * n_columns, 6.4),
        width_ratios=[6.8, 3.2 * n_columns])
    factor = study.factors[0]
    for value in sorted({m["choice"][0] for m in runs}, key=lambda v: (v is None, v or 0)):
        some = [m for m in runs if m["choice"][0] == value]
        name = "others" if value is None else factor["labels"][value]
        axis.plot([m["cost"] for m in some], [m["error"] for m in some], linestyle="none",
                  marker="*" if value is None else MARKERS[value % len(MARKERS)], markersize=5,
                  color="#888888" if value is None else COLOURS[value % len(COLOURS)], label=name)
    front = sorted((m for m in runs if m["on_front"]), key=lambda m: m["cost"])
    axis.step([m["cost"] for m in front], [m["error"] for m in front], where="post",
              color="#222222", linewidth=0.9, label="front")
    for number, run in enumerate(runs, start=1):
        axis.annotate(str(number), (run["cost"], run["error"]), xytext=(3, 3),
                      textcoords="offset points", fontsize=6)
    axis.set_xscale("log")
    axis.set_yscale("log")
    axis.set_xlabel(study.data["cost_name"])
    axis.set_ylabel(study.data["error_name"])
    axis.set_title(study.data["title"])
    axis.legend()
    text_axis.axis("off")
    for number, run in enumerate(runs):
        column, row = divmod(number, LABELS_A_COLUMN)
        text_axis.text(column / n_columns, 1 - (row + 1) / (LABELS_A_COLUMN + 1),
                       f"{number + 1}  {study.label(run)}", fontsize=5.6,
                       transform=text_axis.transAxes, va="center",
                       weight="bold" if run["on_front"] else "normal")
    return figure


def coordinates(labels):
    """Coordinates of labels: their numbers, or 0, 1, ...; and whether they are numbers."""
    numbers = [number_of(label) for label in labels]
    if None in numbers:
        return list(range(len(labels))), False
    return numbers, True


def is_wide(numbers):
    return min(numbers) > 0 and max(numbers) / min(numbers) > 20


def scale_values(study, axis, values):
    if study.data["logarithmic_values"] and values and min(values) > 0:
        axis.set_yscale("log")


def lines(study):
    """A panel for each grid: the value over its first factor, a line for each choice of the others. Without
    logarithms all panels have the same scale of values."""
    grids = study.data["grids"]
    # What is compared on a linear scale is compared across the panels, too.
    figure, axes = panels(len(grids), 2, 4.6, 3.4, sharey=not study.data["logarithmic_values"])
    for grid, axis in zip(grids, axes):
        first, *others = grid["axes"]
        factor = study.factors[first["knob"]]
        labels = [factor["labels"][v] for v in first["values"]]
        x, are_numbers = coordinates(labels)
        values = []
        combinations = list(itertools.product(*(o["values"] for o in others)))
        for index, combination in enumerate(combinations):
            choice = {o["knob"]: v for o, v in zip(others, combination)}
            points, lost = [], []
            for x_value, value in zip(x, first["values"]):
                run = study.run({**choice, first["knob"]: value})
                if run["error"] is None:
                    lost.append(x_value)
                else:
                    points.append((x_value, abs(run["error"])))
            name = study.label(study.run({**choice, first["knob"]: first["values"][0]}),
                               without=(first["knob"],))
            style = {"color": COLOURS[index % len(COLOURS)],
                     "marker": MARKERS[index // len(COLOURS) % len(MARKERS)], "markersize": 4}
            axis.plot([p[0] for p in points], [p[1] for p in points], label=name or None, **style)
            for x_value in lost:  # no result: a cross at the lower edge
                axis.plot(x_value, 0.02 + 0.03 * (index % 8), marker="x", markersize=5, clip_on=False,
                          color=style["color"], transform=axis.get_xaxis_transform())
            values += [p[1] for p in points]
        scale_values(study, axis, values)
        if are_numbers:
            if is_wide(x):
                axis.set_xscale("log")
        else:
            axis.set_xticks(x, labels, rotation=20, ha="right")
        axis.set_xlabel(factor["name"])
        axis.set_ylabel(study.data["error_name"])
        if others and (len(combinations) > 1 or len(grids) > 1):
            axis.legend(fontsize=7)
    figure.suptitle(study.data["title"], fontsize=10)
    return figure


def maps(study):
    """A panel for each grid and each choice of its factors after the second: colours over the first
    two, with the numbers written in."""
    tasks = []
    for grid in study.data["grids"]:
        first, second, *others = grid["axes"]
        for combination in itertools.product(*(o["values"] for o in others)):
            tasks.append((first, second, {o["knob"]: v for o, v in zip(others, combination)}))
    widest = max(len(first["values"]) for first, _, _ in tasks)
    figure, axes = panels(len(tasks), 2, max(4.2, 0.5 * widest + 1.6), 3.6)
    for (first, second, choice), axis in zip(tasks, axes):
        table = [[study.run({**choice, first["knob"]: v, second["knob"]: w})
                  for v in first["values"]] for w in second["values"]]
        values = [[math.nan if m["error"] is None else abs(m["error"]) for m in row]
                  for row in table]
        shown = [[math.log10(v) if study.data["logarithmic_values"] and v > 0 else v for v in row]
                 for row in values]
        axis.imshow(shown, aspect="auto", origin="lower", cmap="viridis")
        axis.grid(False)
        for (j, row), i in itertools.product(enumerate(values), range(len(first["values"]))):
            text = table[j][i]["state"] if math.isnan(row[i]) else f"{row[i]:.2g}"
            axis.text(i, j, text, ha="center", va="center", fontsize=6,
                      color="#bb2222" if math.isnan(row[i]) else "white")
        for axis_of, of in ((axis.xaxis, first), (axis.yaxis, second)):
            labels = [study.factors[of["knob"]]["labels"][v] for v in of["values"]]
            axis_of.set_ticks(range(len(labels)), labels, fontsize=7)
            axis_of.set_label_text(study.factors[of["knob"]]["name"])
        name = study.label(table[0][0], without=(first["knob"], second["knob"]))
        axis.set_title(name or study.data["error_name"])
    figure.suptitle(study.data["title"], fontsize=10)
    return figure


DRAWINGS = {"pareto": pareto, "lines": lines, "map": maps}


def main():
    parser = argparse.ArgumentParser(prog="scripts/study", description=__doc__)
    parser.add_argument("study", type=Path, help="output directory of the study")
    parser.add_argument("picture", type=Path, nargs="?", help="default: study.png beside study.json")
    arguments = parser.parse_args()
    try:
        study = Study(arguments.study)
        figure = DRAWINGS[study.data["picture"]](study)
        print(save(figure, arguments.picture or study.path.with_name("study.png")))
    except StudyError as error:
        sys.exit(f"Error: {error}")


if __name__ == "__main__":
    main()

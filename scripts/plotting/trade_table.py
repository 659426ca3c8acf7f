# SPDX-License-Identifier: LGPL-2.1-or-later
"""Tables of a trade study: the command line of scripts/study --table."""

import argparse
import csv
import sys
from pathlib import Path

NONE = "–"
# Columns of members.csv after those of the factors.
STATE = "state"


class TableError(Exception):
    """A table that cannot be made."""


def parts_of(text, separator=","):
    return [part.strip() for part in text.split(separator) if part.strip()]


def rounded(text, digits):
    """A number with so many digits, a whole number or a text as it is."""
    try:
        value = float(text)
    except ValueError:
        return text or NONE
    if text.lstrip("-").isdigit():
        return text
    if 1e-3 <= abs(value) < 10**digits:
        return f"{value:#.{digits}g}".rstrip(".")
    if 1 <= abs(value) < 1e6:
        return f"{value:.0f}"
    mantissa, _, exponent = f"{value:.{digits - 1}e}".partition("e")
    return f"{mantissa}e{int(exponent)}"


class Members:
    """members.csv."""

    def __init__(self, directory):
        path = directory / "members.csv" if directory.is_dir() else directory
        try:
            with open(path, newline="", encoding="utf-8") as file:
                rows = list(csv.reader(file))
        except OSError as error:
            raise TableError(f"{path} cannot be read: {error}") from error
        if len(rows) < 2 or STATE not in rows[0]:
            raise TableError(f"{path} is no table of a study with runs")
        self.path = path
        self.headings = rows[0]
        state = self.headings.index(STATE)
        self.factors = self.headings[1:state]
        # The meaning of short names.
        self.short = {"error": self.headings[state + 1], "cost": self.headings[state + 2]}
        self.runs = [dict(zip(self.headings, row)) for row in rows[1:]]
        # The order of values is that in which they come first.
        self.label_indices = {factor: {} for factor in self.factors}
        for run in self.runs:
            for factor, label_indices in self.label_indices.items():
                label_indices.setdefault(run[factor], len(label_indices))

    def key(self, run, factors):
        return tuple(run[factor] for factor in factors)

    def in_order(self, keys, factors):
        return sorted(keys, key=lambda key: [self.label_indices[f][label] for f, label in zip(factors, key)])

    def column(self, name, among=None):
        known = among if among is not None else self.headings
        name = self.short.get(name, name)
        if name in known:
            return name
        endings = [heading for heading in dict.fromkeys(known) if heading.endswith("/" + name)]
        if len(endings) != 1:
            raise TableError(f'{self.path} has {"no" if not endings else "more than one"} column "{name}"; '
                             f'it has {", ".join(known)}')
        return endings[0]

    def select(self, conditions):
        """Keeps the runs with one of these values of a factor, "cells = 50 / 100"."""
        for condition in conditions:
            factor, equals, labels = condition.partition("=")
            factor = self.column(factor.strip(), self.factors)
            if not equals:
                raise TableError(f'"{condition}" is not FACTOR = VALUE')
            # An empty one means a factor that the run leaves as the file has it.
            wanted = [label.strip() for label in labels.split(" / ")]
            self.runs = [run for run in self.runs if run[factor] in wanted]
        if not self.runs:
            raise TableError("no run is left")


def table(members, rows, columns, values, digits):
    """Lines in markdown: a row for each choice of some factors, a column for each choice of others."""
    rows, columns = ([members.column(name, members.factors) for name in names] for names in (rows, columns))
    values = [members.column(name) for name in values]
    cells = {}
    for run in members.runs:
        row, column = members.key(run, rows), members.key(run, columns)
        if (row, column) in cells:
            other = cells[row, column]
            differing = [f for f in members.factors if f not in rows + columns and run[f] != other[f]]
            raise TableError(f'two runs are in the same place of the table: they differ in '
                             f'{", ".join(differing)}; name it among rows, columns or conditions')
        cells[row, column] = run
    row_keys = members.in_order({row for row, _ in cells}, rows)
    column_keys = members.in_order({column for _, column in cells}, columns)

    def text_of(run):
        if run is None:
            return NONE
        if run[STATE] != "measured":
            return run[STATE]
        return ", ".join(rounded(run[value], digits) for value in values)

    head = [", ".join(label or NONE for label in key) for key in column_keys]
    lines = ["| " + " | ".join(rows + head) + " |", "|" + "---|" * (len(rows) + len(head))]
    for row in row_keys:
        texts = [label or NONE for label in row] + [text_of(cells.get((row, column))) for column in column_keys]
        lines.append("| " + " | ".join(texts) + " |")
    return lines


def list_table(members, rows, values, digits):
    """Lines in markdown: a row for each choice of some factors, a column for each value."""
    rows = [members.column(name, members.factors) for name in rows]
    values = [members.column(name) for name in values]
    lines = ["| " + " | ".join(rows + [value.rpartition("/")[2] for value in values]) + " |",
             "|" + "---|" * (len(rows) + len(values))]
    order = {key: index for index, key in enumerate(
        members.in_order({members.key(run, rows) for run in members.runs}, rows))}
    for run in sorted(members.runs, key=lambda run: order[members.key(run, rows)]):
        texts = [rounded(run[value], digits) for value in values]
        if run[STATE] != "measured":
            texts = [run[STATE]] + [NONE] * (len(values) - 1)
        lines.append("| " + " | ".join([run[f] or NONE for f in rows] + texts) + " |")
    return lines


def main():
    parser = argparse.ArgumentParser(
        prog="scripts/study --table", description="A table in markdown of a study that has run.",
        epilog="`error` and `cost` are short for their columns of members.csv, and what follows the last slash "
               "of a column for the column.")
    parser.add_argument("study", type=Path, help="output directory of the study")
    parser.add_argument("--rows", default="", metavar="FACTOR,...", help="default: all that are no columns")
    parser.add_argument("--columns", default="", metavar="FACTOR,...", help="default: a column for each value")
    parser.add_argument("--values", default="error|cost", metavar="NAME|...")
    parser.add_argument("--where", action="append", default=[], metavar="'FACTOR = VALUE / VALUE'")
    parser.add_argument("--digits", type=int, default=3)
    arguments = parser.parse_args()
    try:
        members = Members(arguments.study)
        members.select(arguments.where)
        columns, values = parts_of(arguments.columns), parts_of(arguments.values, "|")
        rows = parts_of(arguments.rows) or [f for f in members.factors if f not in columns]
        make = table(members, rows, columns, values, arguments.digits) if columns else \
            list_table(members, rows, values, arguments.digits)
    except TableError as error:
        sys.exit(f"Error: {error}")
    print("\n".join(make))


if __name__ == "__main__":
    main()

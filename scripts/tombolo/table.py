# SPDX-License-Identifier: LGPL-2.1-or-later
"""Tables that a run leaves behind: columns by name."""

import csv
import io
import math
import re
from bisect import bisect_left
from pathlib import Path

from . import histories
from .errors import TomboloError, nearest

try:
    import numpy
except ImportError:
    numpy = None


def interpolated(abscissas, values, abscissa):
    """Of a piecewise linear function whose abscissas rise; constant beyond its ends."""
    if abscissa <= abscissas[0]:
        return values[0]
    if abscissa > abscissas[-1]:
        return values[-1]
    k = bisect_left(abscissas, abscissa)
    share = (abscissa - abscissas[k - 1]) / (abscissas[k] - abscissas[k - 1])
    return values[k - 1] + share * (values[k] - values[k - 1])


class Table:
    """A CSV file whose header is made of `name [unit]`: `columns` and `units` by name, an empty entry
    being no number. Columns are arrays where numpy is there and `arrays` is true, and lists else. Rows
    that are no numbers, of another length than the header, or without the end of their line, are
    refused, or left out and listed in `damaged_rows`. Where `ends_its_lines` is false the file may end
    without the end of its last line, as those of editors and spreadsheets do. `number` makes numbers of
    texts, and throws ValueError where one is none. Where there is no such file, the table of this name in
    the histories.h5 beside it is used."""

    def __init__(self, path, leaves_out_damaged_rows=False, arrays=True, least_rows=0, ends_its_lines=True, number=float):
        self.path = Path(path)
        if not histories.has_table(self.path):
            raise TomboloError(f"there is no {path}")
        self.units, self.columns, self.damaged_rows = {}, {}, []
        if self.path.exists():
            self.read_text(leaves_out_damaged_rows, least_rows, ends_its_lines, number)
        else:
            names, units, rows = histories.read_table(self.path)
            self.check_length(len(rows), least_rows)
            self.units = dict(zip(names, units))
            self.columns = {name: [row[index] for row in rows] for index, name in enumerate(names)}
        if numpy and arrays:
            self.columns = {name: numpy.array(column) for name, column in self.columns.items()}

    def check_length(self, n_rows, least_rows):
        if n_rows < least_rows:
            raise TomboloError(f"{self.path} has {n_rows} rows, and at least {least_rows} are needed")

    def read_text(self, leaves_out_damaged_rows, least_rows, ends_its_lines, number):
        path = self.path
        text = self.path.read_text("utf-8", errors="replace").replace("\0", "?")
        rows = [row for row in csv.reader(io.StringIO(text, newline="")) if row]
        self.check_length(max(0, len(rows) - 1), least_rows)
        if not rows:
            raise TomboloError(f"{path} is empty")
        values = []
        for row_number, row in enumerate(rows[1:], start=1):
            try:
                is_cut = ends_its_lines and row_number + 1 == len(rows) and not text.endswith("\n")
                if len(row) != len(rows[0]) or is_cut:
                    raise ValueError
                values.append([number(entry) if entry else math.nan for entry in row])
            except ValueError:
                self.damaged_rows.append(row_number)
        if self.damaged_rows and not leaves_out_damaged_rows:
            raise TomboloError(f"row {self.damaged_rows[0]} of {path} is not a line of {len(rows[0])} "
                               "numbers, as its header asks for: the file is damaged")
        for index, title in enumerate(rows[0]):
            name, unit = re.fullmatch(r"\s*(.*?)\s*(?:\[([^\[\]]*)\])?\s*", title).groups()
            self.units[name] = unit or ""
            self.columns[name] = [row[index] for row in values]

    def __contains__(self, name):
        return name in self.columns

    def __getitem__(self, name):
        if name not in self.columns:
            raise TomboloError(f'{self.path} has no column "{name}".' + nearest(name, self.columns))
        return self.columns[name]

    def __iter__(self):
        return iter(self.columns)

    def __len__(self):
        return len(self.columns)

    def heading(self, name):
        return heading(name, self.units[name])

    def frame(self):
        """A DataFrame of pandas, which must be installed."""
        import pandas  # only where it is needed
        return pandas.DataFrame(self.columns)


def heading(name, unit):
    """`name [unit]` for an axis, with powers set as powers."""
    unit = re.sub(r"\^(-?\d+)", r"$^{\1}$", unit)
    return f"{name} [{unit}]" if unit else name

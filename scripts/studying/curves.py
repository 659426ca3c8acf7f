# SPDX-License-Identifier: LGPL-2.1-or-later
"""How far a curve of a run is from a measured one."""

import math
import re
from pathlib import Path

from tombolo.errors import TomboloError
from tombolo.table import Table, interpolated
from .quantities import NoValue

BEGINNING = "distance of "


class Curve:
    """A column of a table over the first one, linear between rows; rows where one of them is no number are left out.
    Throws TomboloError where it is no curve."""

    def __init__(self, table, column):
        self.name, self.column = table.path.name, column
        values, self.abscissa = table[column], next(iter(table))
        self.units = {name: table.units[name] for name in (self.abscissa, column)}
        points = [point for point in zip(table[self.abscissa], values) if all(map(math.isfinite, point))]
        if len(points) < 2:
            raise TomboloError(f'{table.path} has no two rows with numbers in "{self.abscissa}" and "{column}"')
        for (x, _), (next_x, _) in zip(points, points[1:]):
            if not x < next_x:
                raise TomboloError(f'the first column "{self.abscissa}" of {table.path} does not rise: {next_x:g} follows {x:g}')
        self.x, self.y = zip(*points)

    def range(self):
        return max(self.y) - min(self.y)

    def text_of_ends(self):
        return f'"{self.abscissa}" is from {self.x[0]:g} to {self.x[-1]:g} in {self.name}'


def distance(curve, measured):
    """sqrt(1/(b - a) ∫ (curve - measured)² dx) over the range of the measured values, where [a, b] is what both have of
    the abscissa. Throws NoValue where the curves cannot be compared."""
    for one, other in zip(curve.units, measured.units):
        units = curve.units[one], measured.units[other]
        if all(units) and units[0] != units[1]:
            raise NoValue(f'"{one}" is in {units[0]} in {curve.name}, and "{other}" in {units[1]} in {measured.name}')
    begin, end = max(curve.x[0], measured.x[0]), min(curve.x[-1], measured.x[-1])
    if not begin < end:
        raise NoValue(f"the curves do not overlap: {curve.text_of_ends()}, and {measured.text_of_ends()}")
    abscissas = sorted({begin, end, *(x for x in curve.x + measured.x if begin < x < end)})
    differences = [interpolated(curve.x, curve.y, x) - interpolated(measured.x, measured.y, x) for x in abscissas]
    # Exact: the difference is linear between the abscissas.
    integral = sum((next_x - x) / 3 * (one**2 + one * other + other**2)
                   for x, next_x, one, other in zip(abscissas, abscissas[1:], differences, differences[1:]))
    return math.sqrt(max(integral, 0) / (end - begin)) / measured.range()


class Distance:
    """`distance of FILE.csv/COLUMN from MEASURED.csv/COLUMN`: a table of the run, and one relative to the directory of the
    study file. Throws ValueError where a text is something else or the measured curve is none."""

    def __init__(self, text, directory):
        self.text = text
        match = re.fullmatch(BEGINNING + r"(.+?\.csv)/(.+) from (.+?\.csv)/(.+)", text)
        if not match:
            raise ValueError(f'"{text}" does not name two curves: expected is {BEGINNING}FILE.csv/COLUMN from MEASURED.csv/COLUMN')
        self.file, self.column, measured, column = match.groups()
        path = Path(directory) / measured
        try:
            self.measured = Curve(Table(path, arrays=False, ends_its_lines=False), column)
            # A measured curve that has changed makes another quantity.
            self.key = f"{text}\n{path.read_text('utf-8')}"
        except (TomboloError, OSError) as error:
            raise ValueError(str(error)) from error
        if not self.measured.range():
            raise ValueError(f'"{column}" of {path} has one value only: a distance is a share of its range')

    def value(self, directory):
        """The number; throws NoValue where it is not there."""
        try:
            table = Table(Path(directory) / self.file, leaves_out_damaged_rows=True, arrays=False)
            return distance(Curve(table, self.column), self.measured)
        except (TomboloError, OSError) as error:
            raise NoValue(str(error)) from error

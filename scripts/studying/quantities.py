# SPDX-License-Identifier: LGPL-2.1-or-later
"""Quantities of interest: numbers in the files that a run leaves behind."""

import json
import math
import re
from pathlib import Path

from tombolo.errors import TomboloError, nearest
from tombolo.histories import has_table
from tombolo.table import Table


class NoValue(Exception):
    """A quantity that a run does not have."""


def number_of(text):
    """NaN where the text is no number: an undefined error is written so."""
    try:
        return float(text)
    except (TypeError, ValueError):
        return math.nan


class Quantity:
    """`FILE.json/KEY/KEY`, `FILE.csv/COLUMN`, `FILE.csv/COLUMN at TIME`, `largest of FILE.csv/COLUMN` or `mean of
    FILE.csv/COLUMN`. Throws ValueError where a text is none of them."""

    def __init__(self, text):
        self.text = self.key = text
        rest, self.selection, self.time = text, "last", None
        for selection in ("largest", "mean"):
            if rest.startswith(f"{selection} of "):
                self.selection, rest = selection, rest.removeprefix(f"{selection} of ")
        self.file, _, self.name = rest.partition("/")
        self.is_table = self.file.endswith(".csv")
        if not self.name or not (self.is_table or self.file.endswith(".json")):
            raise ValueError(f'"{text}" does not name a value: expected is FILE.csv/COLUMN or FILE.json/KEY/KEY')
        if not self.is_table and self.selection != "last":
            raise ValueError(f'"{text}": only a column of a table has a largest or a mean value')
        name, at, time = self.name.rpartition(" at ")
        if self.is_table and at and math.isfinite(number_of(time)):
            if self.selection != "last":
                raise ValueError(f'"{text}" asks for a time and for all times')
            self.selection, self.name, self.time = "at time", name, float(time)

    def value(self, directory):
        """The number; throws NoValue where it is not there or not finite."""
        path = Path(directory) / self.file
        try:
            value = self.table_value(path) if self.is_table else self.json_value(path)
        except (OSError, ValueError) as error:
            raise NoValue(f"{self.file} cannot be read: {getattr(error, 'strerror', None) or error}") from error
        if not math.isfinite(value):
            raise NoValue(f'"{self.text}" is not a finite number')
        return value

    def json_value(self, path):
        value = json.loads(path.read_text("utf-8"))
        for key in self.name.split("/"):
            key = key.strip()
            if isinstance(value, dict) and key in value:
                value = value[key]
            elif isinstance(value, list) and re.fullmatch(r"\d{1,9}", key) and int(key) < len(value):
                value = value[int(key)]
            else:
                raise NoValue(f'{self.file} has no value "{self.name}"' + nearest(key, list(value) if isinstance(value, dict) else []))
        return float(value) if isinstance(value, (int, float)) and not isinstance(value, bool) else number_of(value)

    def table_value(self, path):
        try:
            if not has_table(path):
                path.stat()  # throws OSError
            table = Table(path, leaves_out_damaged_rows=True, arrays=False, number=number_of)
            values = table[self.name]
            if self.selection == "at time":
                values = [value for value, time in zip(values, table["time"]) if abs(time - self.time) <= 1e-9 * abs(self.time)]
        except TomboloError as error:
            raise NoValue(str(error).replace(str(path), self.file)) from error
        if self.selection in ("last", "at time"):
            return values[-1] if values else math.nan
        finite = [value for value in values if math.isfinite(value)]
        if not finite:
            return math.nan
        return max(map(abs, finite)) if self.selection == "largest" else sum(finite) / len(finite)

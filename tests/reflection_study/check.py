#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Checks what a reflection study wrote.

usage: check.py TABLE OTHER_TABLE

The reflections between elements are within 2 % of the exact ones, those into particles are what the
smoothings promise, and both tables (of one rank and of two) hold the same numbers to ten digits.
"""

import csv
import sys


def read(path):
    with open(path, newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def value(row, column):
    return float(row[column]) if row[column] else None


def problems(rows, others):
    if len(rows) != len(others):
        yield f"{len(rows)} cases in one table, {len(others)} in the other"
    for number, (row, other) in enumerate(zip(rows, others), start=1):
        for column in row:
            if column.startswith("wall_time") or row[column] == other[column]:
                continue
            try:
                one, two = float(row[column]), float(other[column])
            except ValueError:
                one, two = 0, 1
            # Percentages below 1e-9 are round-off.
            if abs(one - two) > 1e-7 * abs(one) + 1e-9:
                yield f"case {number}: {column} is {row[column]} and {other[column]}"
    exact = [row for row in rows if row["exact [%]"]]
    if not exact:
        yield "no case has an exact reflection"
    for row in exact:
        ratio = value(row, "reflection [%]") / value(row, "exact [%]")
        if abs(ratio - 1) > 0.02:
            yield f'ratio {row["spacing_ratio"]}: {ratio} of the exact reflection'

    def single(**wanted):
        found = [row for row in rows
                 if all(row[key] == text for key, text in wanted.items()) and row["wave"] == "P"]
        if len(found) != 1:
            raise SystemExit(f"{len(found)} cases with {wanted}")
        return found[0]

    into = {"left": "FE", "right": "particles"}
    if abs(value(single(smoothing="paper", **into), "reflection [%]") - 1.4) > 0.05:
        yield "the paper's smoothing does not reflect 1.4 % of a wave of 20 spacings"
    for smoothing in ("fe matched", "affine"):
        if value(single(smoothing=smoothing, **into), "total [%]") > 0.15:
            yield f"{smoothing} reflects more than 0.15 % into particles"
    back = {"left": "particles", "right": "FE", "smoothing": "affine"}
    for column in ("smoothed [%]", "unsmoothed [%]"):
        if value(single(filter_power="4", **back), column) > 0.2:
            yield f"with the filter more than 0.2 % come back among particles ({column})"
    if value(single(filter_power="0", **back), "unsmoothed [%]") < 1:
        yield "without the filter hardly any short waves come back"


def main():
    found = list(problems(read(sys.argv[1]), read(sys.argv[2])))
    for problem in found:
        print(problem)
    sys.exit(1 if found else 0)


if __name__ == "__main__":
    main()

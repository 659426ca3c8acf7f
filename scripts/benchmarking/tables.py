# SPDX-License-Identifier: LGPL-2.1-or-later
"""Prints tables and numbers."""

import sys


def print_table(title, columns, rows):
    rows = [[str(entry) for entry in row] for row in rows]
    widths = [max(map(len, column)) for column in zip(columns, *rows)]
    print(f"\n{title}\n")
    for row in [columns, ["-" * width for width in widths], *rows]:
        print("  ".join([row[0].ljust(widths[0])]
                        + [entry.rjust(width) for entry, width in zip(row[1:], widths[1:])]))
    sys.stdout.flush()


def number(value):
    return "" if value is None else f"{value:,.0f}" if abs(value) >= 100 else f"{value:.3g}"

# SPDX-License-Identifier: LGPL-2.1-or-later
"""Text of decks: lines with their places, files that files name, numbers of Fortran."""

import re
from pathlib import Path

# Fortran needs no letter before the exponent: 7.85-09.
NUMBER = re.compile(r"([+-]?(?:\d+\.?\d*|\.\d+))(?:[eEdD]([+-]?\d+)|([+-]\d+))?")
BLANKS = " \t\r\f\v"
DEEPEST_INCLUDE = 50
LONGEST_WORD = 40


class DeckError(Exception):
    """Something that the user can mend; printed without a trace."""


def value_of(text):
    """The value of a number of Fortran; None for other text."""
    try:
        return float(text) if text[-1:].isdigit() or text[-1:] == "." else None
    except ValueError:
        match = NUMBER.fullmatch(text)
        return float(f"{match[1]}e{match[2] or match[3] or 0}") if match else None


def shown(text):
    return f'"{text[:LONGEST_WORD]}{"..." if len(text) > LONGEST_WORD else ""}"'


class Line:
    """A line of a file; the place names the file where it is not that of the user."""

    __slots__ = ("file", "number", "text")

    def __init__(self, file, number, text):
        self.file, self.number, self.text = file, number, text

    @property
    def place(self):
        return f"line {self.number}" + (f' of "{self.file}"' if self.file else "")

    def fail(self, message):
        raise DeckError(f"{self.place}: {message}")

    def real(self, text, what="a number"):
        value = value_of(text)
        if value is None:
            end = self.text.find(text) + len(text)
            beyond = " What goes on behind it is beyond the columns of the field." \
                if self.text[end:end + 1] not in ("", " ", ",", "\t") else ""
            self.fail(f"{shown(text)} stands where {what} should.{beyond}")
        if abs(value) == float("inf"):
            self.fail(f"{shown(text)} is not finite, and stands where {what} should.")
        return value

    def integer(self, text, what="a number"):
        try:
            return int(text)
        except ValueError:
            value = value_of(text)
            if value is None or abs(value) == float("inf") or value != int(value):
                self.fail(f"{shown(text)} stands where {what} should.")
            return int(value)


def lines_of(path):
    """The lines of a file without a byte-order mark; those that are not UTF-8 are read as Latin-1."""
    content = path.read_bytes()
    if content[:2] in (b"\xff\xfe", b"\xfe\xff"):
        raise DeckError(f"{path.name} is UTF-16 text. Save it as UTF-8 or Latin-1.")
    lines = content.removeprefix(b"\xef\xbb\xbf").split(b"\n")
    if lines and not lines[-1]:
        lines.pop()
    for line in lines:
        try:
            yield line.decode("utf-8").rstrip(BLANKS)
        except UnicodeDecodeError:
            yield line.decode("latin-1").rstrip(BLANKS)


class Files:
    """A deck and the files that it names. A reader says by take() what becomes of a line; it may read a further
    file, or end the present one by returning False."""

    def __init__(self, path):
        self.path = Path(path)
        self.open_files = []
        self.further_directories = []

    def read(self, path, name=""):
        self.open_files.append(path)
        for number, text in enumerate(lines_of(path), 1):
            if self.take(Line(name, number, text)) is False:
                break
        self.open_files.pop()

    def take(self, line):
        raise NotImplementedError

    def include(self, line, file):
        """Reads a file that a line names: relative to the file of the line, or to the deck."""
        relative = file.replace("\\", "/")
        for directory in (self.open_files[-1].parent, self.path.parent, *self.further_directories):
            included = directory / relative
            if included.is_file():
                break
        else:
            line.fail(f'"{file}", relative to the file that names it: There is no such file.')
        if included.resolve() in [path.resolve() for path in self.open_files] or \
                len(self.open_files) > DEEPEST_INCLUDE:
            line.fail(f'"{file}" includes itself.')
        self.read(included, file)

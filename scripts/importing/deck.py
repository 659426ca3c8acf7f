# SPDX-License-Identifier: LGPL-2.1-or-later
"""An LS-DYNA keyword file: its keywords, each with its cards, and records of named fields."""

import re
from pathlib import Path

from .layouts import PARTS, REPEATED, n_cards_of, name_of_field

# Fortran needs no letter before the exponent: 7.85-09.
NUMBER = re.compile(r"([+-]?(?:\d+\.?\d*|\.\d+))(?:[eEdD]([+-]?\d+)|([+-]\d+))?")
PARAMETER = re.compile(rf"([RI])\s*([A-Z]\w*)\s+({NUMBER.pattern.replace('(', '(?:').replace('(?:?:', '(?:')})")
BLANKS = " \t"
DEEPEST_INCLUDE = 50


class KeywordError(Exception):
    """Something that the user can mend; printed without a trace."""


def value_of(text):
    """The value of a number of Fortran; None for other text."""
    match = NUMBER.fullmatch(text)
    return float(f"{match[1]}e{match[2] or match[3] or 0}") if match else None


def number_at(line, text):
    value = value_of(text)
    if value is None:
        raise KeywordError(f'{line.place}: "{text}" stands where a number should.')
    return value


class Line:
    """A line of a file; the place names the file where it is not that of the user."""

    __slots__ = ("file", "number", "text")

    def __init__(self, file, number, text):
        self.file, self.number, self.text = file, number, text

    @property
    def place(self):
        return f"line {self.number}" + (f" of {self.file}" if self.file else "")


class Field:
    """A field of a card, and whether anything has read it."""

    __slots__ = ("line", "name", "text", "default", "is_read")

    def __init__(self, line, name, text, default):
        self.line, self.name, self.text, self.default = line, name, text, default
        self.is_read = False

    def says_something(self):
        """Whether it is neither blank nor zero nor what stands for a blank."""
        value = value_of(self.text)
        return bool(self.text) and value != 0 and self.text.upper() != self.default and \
            (value is None or value != value_of(self.default))


class Record:
    """The cards of one thing, whose fields are read by their names."""

    def __init__(self, section, title, lines, name):
        self.section, self.title, self.lines, self.name = section, title, lines, name
        self.line = lines[0] if lines else section.line
        self.fields = {}
        for k, line in enumerate(lines):
            for n, text in enumerate(section.fields(line)):
                field, default = name_of_field(name, k, n)
                self.fields[field] = Field(line, field, text, default)

    def text(self, name):
        field = self.fields.get(name)
        if field is None:
            return ""
        field.is_read = True
        return field.text

    def peek(self, name):
        """A number that does not count as read."""
        field = self.fields.get(name)
        return 0.0 if field is None or not field.text else number_at(field.line, field.text)

    def number(self, name, default=0.0):
        """A number, the default where it is blank."""
        return self.peek(name) if self.text(name) else default

    def integer(self, name, default=0):
        value = self.number(name, default)
        if value != int(value):
            raise KeywordError(f'{self.fields[name].line.place}: "{self.text(name)}" stands where an integer '
                               "should.")
        return int(value)

    def unused(self):
        """The fields that say something and that nothing has read."""
        return [field for field in self.fields.values() if not field.is_read and field.says_something()]


class Section:
    """A keyword with its cards. The name is without _ID and _TITLE."""

    def __init__(self, deck, line, keyword, is_long, has_wide_integers):
        self.deck, self.line, self.keyword, self.is_long = deck, line, keyword, is_long
        self.integer_width = 20 if is_long else 10 if has_wide_integers else 8
        self.name, self.has_title, self.has_id = keyword, False, False
        while self.name.endswith(("_ID", "_TITLE")):
            self.has_id = self.has_id or self.name.endswith("_ID")
            self.has_title = self.has_title or self.name.endswith("_TITLE")
            self.name = self.name[:self.name.rindex("_")]
        self.lines = []

    def raw_fields(self, line, width=10, n_fields=8):
        """The fields of a card, fixed or between commas. What stands behind the last field of fixed width is a
        remark."""
        width = 20 if self.is_long else width
        end = width * n_fields
        text = line.text
        if "," in text[:end]:
            fields = text.split(",")
        else:
            if "\t" in text:
                text = expanded(line, width, end)
            text = text[:end].rstrip()
            fields = [text[begin:begin + width] for begin in range(0, len(text), width)]
        return [field.strip(BLANKS) for field in fields]

    def fields(self, line, width=10):
        """The same with the values of parameters."""
        return [self.deck.with_parameter(field, line) for field in self.raw_fields(line, width)]

    def values(self, line, width=10):
        """The same as numbers, two at least; zero where they are blank."""
        values = [number_at(line, field) if field else 0.0 for field in self.fields(line, width)]
        return values + [0.0] * (2 - len(values))

    def titled(self, lines):
        """Title and further lines of what begins with these lines."""
        if self.has_title or self.name in PARTS:
            return lines[0].text.strip(BLANKS), lines[1:]
        if not self.is_head(lines):
            return "", lines
        end = 20 if self.is_long else 10
        text = lines[0].text
        return (text.partition(",")[2] if "," in text[:end] else text[end:]).strip(BLANKS), lines[1:]

    def is_head(self, lines):
        """Whether a card has number and title of a keyword with _ID: the first one, and others with fields that
        are no numbers."""
        return self.has_id and (lines[0] is self.lines[0] or any(
            field and "&" not in field and value_of(field) is None for field in self.raw_fields(lines[0])))

    def records(self):
        """The things that the keyword defines."""
        lines = self.lines
        while lines and not lines[-1].text.strip():
            lines = lines[:-1]
        while lines:
            name = self.name
            title, lines = self.titled(lines)
            if lines and name in REPEATED and n_cards_of(name) == 1 and not lines[0].text.strip():
                lines = lines[1:]
                continue
            if name == "SECTION_SOLID" and lines and self.fields(lines[0])[1:2] == ["47"]:
                name = "SECTION_SOLID_SPG"
            n_cards = n_cards_of(name) if self.name in REPEATED else len(lines)
            yield Record(self, title, lines[:n_cards], name)
            lines = lines[n_cards:]

    def head(self):
        """The first card as a record, and the lines of the others."""
        title, lines = self.titled(self.lines) if self.lines else ("", [])
        return Record(self, title, lines[:1], self.name), lines[1:]


def expanded(line, width, end):
    """A card with blanks for its tabs, which lead to every eighth column."""
    text = line.text.expandtabs(8)
    for column in range(width, min(end, len(text)), width):
        if text[column - 1] != " " and text[column] != " ":
            raise KeywordError(f"{line.place}: the card has tabs, by which a field does not begin in its columns. "
                               "Write blanks, or commas between the fields.")
    return text


def lines_of(path):
    """The lines of a file without a byte-order mark; those that are not UTF-8 are read as Latin-1."""
    content = path.read_bytes()
    if content[:2] in (b"\xff\xfe", b"\xfe\xff"):
        raise KeywordError(f"{path.name} is UTF-16 text. Save it as UTF-8 or Latin-1.")
    for line in content.removeprefix(b"\xef\xbb\xbf").split(b"\n"):
        try:
            yield line.decode("utf-8").rstrip("\r")
        except UnicodeDecodeError:
            yield line.decode("latin-1").rstrip("\r")


class Deck:
    """The sections of a keyword file and of those that it includes, in their order."""

    def __init__(self, path):
        self.path = Path(path)
        self.sections = []
        self.parameters = {}
        self.open_files = []
        self.read(self.path, "", False, False)
        for section in self.sections:
            if section.name in ("PARAMETER", "PARAMETER_LOCAL"):
                self.read_parameters(section)
        if not any(section.name == "NODE" for section in self.sections):
            raise KeywordError("there is no section *NODE.")

    def read(self, path, name, is_long_file, has_wide_integers):
        """Reads one file; fields are as wide as in the file that names it, unless its *KEYWORD says more."""
        self.open_files.append(path.resolve())
        section, path_so_far = None, ""
        for number, text in enumerate(lines_of(path), 1):
            line = Line(name, number, text.rstrip(BLANKS))
            if text.startswith("$"):
                continue
            if text.startswith("*"):
                words = text[1:].upper().split()
                keyword = words[0].rstrip("+-%") if words else ""
                if keyword == "END":
                    break
                if keyword == "KEYWORD":
                    is_long_file, has_wide_integers = "LONG=Y" in words, "I10=Y" in words
                is_long = (is_long_file or line.text.endswith("+")) and not line.text.endswith("-")
                section = Section(self, line, keyword, is_long, has_wide_integers)
                self.refuse(section)
                self.sections.append(section)
            elif section is None:
                if text.strip():
                    raise KeywordError(f"{line.place}: this stands before the first keyword.")
            elif section.name != "INCLUDE":
                section.lines.append(line)
            elif text.strip():
                # A plus sign at the end continues the name.
                path_so_far += line.text.strip().removesuffix(" +")
                if not line.text.endswith(" +"):
                    self.include(line, path, path_so_far, is_long_file, has_wide_integers)
                    path_so_far = ""
        self.open_files.pop()

    def include(self, line, path, file, is_long, has_wide_integers):
        included = path.parent / file.replace("\\", "/")
        if not included.is_file():
            raise KeywordError(f'{line.place}: *INCLUDE: there is no file "{file}" in the directory of {path.name}.')
        if included.resolve() in self.open_files or len(self.open_files) > DEEPEST_INCLUDE:
            raise KeywordError(f'{line.place}: *INCLUDE: "{file}" includes itself.')
        self.read(included, file, is_long, has_wide_integers)

    @staticmethod
    def refuse(section):
        if section.name.startswith("INCLUDE_") and not section.name.startswith("INCLUDE_PATH"):
            raise KeywordError(f"{section.line.place}: *{section.keyword} is not allowed: the mesh could be in the "
                               "file that it names. Write all into one file, or name the file by *INCLUDE.")

    def read_parameters(self, section):
        """Pairs of type and name, "R young", and value, in fields or apart by blanks."""
        for line in section.lines:
            fields = section.raw_fields(line)
            pairs = [(name[:1].upper(), name[1:].strip(), value) for name, value in zip(fields[::2], fields[1::2])]
            if any(kind in "RI" and value_of(value) is None for kind, _, value in pairs):
                pairs = PARAMETER.findall(line.text.upper())
                if PARAMETER.sub("", line.text.upper()).strip():
                    raise KeywordError(f"{line.place}: *PARAMETER: a card has pairs of type (R, I or C) with name, and "
                                       "value, each 10 columns wide.")
            self.parameters.update((name.lower(), value) for _, name, value in pairs)

    def with_parameter(self, text, line):
        """The text, or the value of the parameter that it names."""
        sign, ampersand, name = text.partition("&")
        if not ampersand or sign not in ("", "-"):
            return text
        if name.strip().lower() not in self.parameters:
            raise KeywordError(f'{line.place}: there is no parameter "{name}" of type R, I or C in *PARAMETER '
                               "(expressions are not read). Write its value.")
        value = self.parameters[name.strip().lower()]
        return value if not sign else value[1:] if value.startswith("-") else "-" + value

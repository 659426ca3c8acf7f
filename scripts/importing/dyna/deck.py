# SPDX-License-Identifier: LGPL-2.1-or-later
"""An LS-DYNA keyword file: its keywords, each with its cards, and records of named fields."""

import re

from ..text import BLANKS, NUMBER, DeckError, Files, value_of
from .cards import OFFSETS, PARTS, REPEATED, n_cards_of, name_of_field
from .expressions import ExpressionError, value_of_expression
from .transform import Transform

PARAMETER = re.compile(rf"([RI])\s*([A-Z]\w*)\s+({NUMBER.pattern.replace('(', '(?:').replace('(?:?:', '(?:')})")
OF_THE_MESH = ("NODE", "ELEMENT_SOLID", "ELEMENT_SHELL", "ELEMENT_BEAM", "ELEMENT_MASS", "ELEMENT_DISCRETE", "SET_")


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
        return 0.0 if field is None or not field.text else field.line.real(field.text)

    def number(self, name, default=0.0):
        """A number, the default where it is blank."""
        return self.peek(name) if self.text(name) else default

    def integer(self, name, default=0):
        value = self.number(name, default)
        if value != int(value):
            self.fields[name].line.fail(f'"{self.text(name)}" stands where an integer should.')
        return self.section.transform.number(OFFSETS.get(name), int(value))

    def integer_of(self, name, kind):
        """The same, of a field that names several kinds of things."""
        return self.section.transform.number(kind, int(self.number(name)))

    def unused(self):
        """The fields that say something and that nothing has read."""
        return [field for field in self.fields.values() if not field.is_read and field.says_something()]


class Section:
    """A keyword with its cards. The name is without _ID and _TITLE."""

    def __init__(self, deck, line, keyword, form, transform):
        self.deck, self.line, self.keyword, self.transform = deck, line, keyword, transform
        self.is_long = form.is_long
        self.integer_width = 20 if form.is_long else 10 if form.has_wide_integers else 8
        self.name, self.has_title, self.has_id = keyword, False, False
        while self.name.endswith(("_ID", "_TITLE")):
            self.has_id = self.has_id or self.name.endswith("_ID")
            self.has_title = self.has_title or self.name.endswith("_TITLE")
            self.name = self.name[:self.name.rindex("_")]
        if keyword.startswith("CONTACT_"):
            # Their options stand in any order.
            self.has_id = self.has_id or "_ID_" in self.name
            self.has_title = self.has_title or "_TITLE_" in self.name
            self.name = self.name.replace("_ID_", "_").replace("_TITLE_", "_")
        self.is_of_the_mesh = keyword.startswith(OF_THE_MESH)
        self.lines = []

    def columns(self, line, widths, n_fields):
        """The fields of a card, fixed or between commas, blank ones at the end left out; the last width is that of
        all further ones. What stands behind the last field of fixed width is a remark."""
        text = line.text
        begins = [0]
        for k in range(n_fields):
            begins.append(begins[-1] + widths[min(k, len(widths) - 1)])
        if "," in text[:begins[-1]]:
            fields = [field.strip(BLANKS) for field in text.split(",")]
        else:
            if "\t" in text:
                text = expanded(line, begins)
            fields = [text[a:b].strip() for a, b in zip(begins, begins[1:]) if a < len(text)]
        while fields and not fields[-1]:
            fields.pop()
        if "&" in text:
            fields = [self.deck.with_parameter(field, line) for field in fields]
        return fields

    def fields(self, line, width=10, n_fields=8):
        return self.columns(line, [20 if self.is_long else width], n_fields)

    def values(self, line, width=10):
        """The same as numbers, two at least; zero where they are blank."""
        values = [line.real(field) if field else 0.0 for field in self.fields(line, width)]
        return values + [0.0] * (2 - len(values))

    def integers(self, line, width=10, n_fields=8, what="a number of a set"):
        return [line.integer(field, what) if field else 0 for field in self.fields(line, width, n_fields)]

    def titled(self, lines):
        """Title and further lines of what begins with these lines."""
        if self.has_title or self.name in PARTS:
            return lines[0].text.strip(BLANKS), lines[1:]
        if not self.is_head(lines):
            return "", lines
        return self.number_and_title(lines[0])[1], lines[1:]

    def number_and_title(self, line):
        """The first field of a card, in a list, and the text behind it, in which there may be commas."""
        end = 20 if self.is_long else 10
        text, _, title = line.text.partition(",") if "," in line.text[:end] else (line.text[:end], "", line.text[end:])
        return [text.strip(BLANKS)], title.strip(BLANKS)

    def is_head(self, lines):
        """Whether a card has number and title of a keyword with _ID: the first one, and others with fields that
        are no numbers."""
        if not self.has_id or lines[0] is self.lines[0]:
            return self.has_id
        text = lines[0].text
        fields = text.split(",") if "," in text else [text[k:k + 10] for k in range(0, min(len(text), 80), 10)]
        return any(field.strip() and "&" not in field and value_of(field.strip()) is None for field in fields)

    def records(self, more=0):
        """The things that the keyword defines, each with further optional cards where it has one alone."""
        lines = self.lines
        while lines and not lines[-1].text.strip():
            lines = lines[:-1]
        while lines:
            name = self.name
            title, lines = self.titled(lines)
            if name.startswith("CONTACT_") and "_MPP" in name:
                lines = self.without_cards_of_ranks(lines)
            if lines and name in REPEATED and n_cards_of(name) == 1 and not lines[0].text.strip():
                lines = lines[1:]
                continue
            if name == "SECTION_SOLID" and lines and self.fields(lines[0])[1:2] == ["47"]:
                name = "SECTION_SOLID_SPG"
            if name.startswith("BOUNDARY_PRESCRIBED_MOTION_") and name in REPEATED and lines and self.has_axis(lines[0]):
                name += "_ABOUT"
            n_cards = n_cards_of(name) if self.name in REPEATED else len(lines)
            yield Record(self, title, lines[:n_cards], name)
            lines = lines[n_cards:]

    def without_cards_of_ranks(self, lines):
        """The cards of a contact with _MPP behind those that say how ranks search; a second one begins with &."""
        n = 2 if lines[1:] and lines[1].text.lstrip().startswith("&") else 1
        for line in lines[:n]:
            if line.text.strip(BLANKS + "&0., "):
                self.deck.report.unused(line.place, self.keyword, f'the card of MPP "{line.text.strip()}"')
        return lines[n:]

    def has_axis(self, line):
        """Whether a prescribed motion has a second card."""
        values = [value_of(text) for text in self.fields(line)[1:3]]
        return (values[:1] and abs(values[0] or 0) in (9, 10, 11)) or values[1:] == [4]

    def head(self):
        """The first card as a record, and the lines of the others."""
        title, lines = self.titled(self.lines) if self.lines else ("", [])
        return Record(self, title, lines[:1], self.name), lines[1:]


def expanded(line, begins):
    """A card with blanks for its tabs, which lead to every eighth column."""
    text = line.text.expandtabs(8)
    for column in begins[1:]:
        if column < len(text) and text[column - 1] != " " and text[column] != " ":
            line.fail("The card has tabs, by which a field does not begin in its columns. Write blanks, or commas "
                      "between the fields.")
    return text


def number_of_type(text):
    """The value of a parameter, an integer where it is written as one; None for words."""
    return int(text) if re.fullmatch(r"[+-]?\d+", text) else value_of(text)


class Format:
    """How wide the fields of a file are; a file has the format of that which includes it."""

    def __init__(self, is_long=False, has_wide_integers=False):
        self.is_long, self.has_wide_integers = is_long, has_wide_integers


class Deck(Files):
    """The sections of a keyword file and of those that it includes, in their order."""

    def __init__(self, path):
        super().__init__(path)
        self.sections = []
        self.parameters = {}
        self.formats = [Format()]
        self.transforms = [Transform()]
        self.section = None
        self.name_so_far = ""
        self.read(self.path)
        for section in self.sections:
            if section.name in ("PARAMETER", "PARAMETER_LOCAL"):
                self.read_parameters(section)
            elif section.name in ("PARAMETER_EXPRESSION", "PARAMETER_EXPRESSION_LOCAL"):
                self.read_expressions(section)
        if not any(section.name == "NODE" for section in self.sections):
            raise DeckError("There is no section *NODE.")

    def named(self, *names):
        return [section for section in self.sections if section.name in names]

    def read(self, path, name=""):
        outer, self.section = self.section, None
        self.formats.append(self.formats[-1])
        super().read(path, name)
        self.formats.pop()
        self.section = outer

    def take(self, line):
        text = line.text
        if text.startswith("$"):
            return None
        if text.startswith("*"):
            return self.begin(line, re.sub(r"\s*=\s*", "=", text[1:].upper()).split())
        if self.section is None:
            if text.strip():
                line.fail(f'"{text[:40]}" stands before the first keyword (*KEYWORD, *NODE, ...).')
        elif self.section.name == "INCLUDE" and text.strip():
            # A plus sign at the end continues the name.
            self.name_so_far += text.strip().removesuffix(" +")
            if not text.endswith(" +"):
                name, self.name_so_far = self.name_so_far, ""
                self.include(line, name)
        elif self.section.name.startswith("INCLUDE_PATH") and text.strip():
            self.further_directories.append(self.open_files[-1].parent / text.strip().replace("\\", "/"))
        elif self.section.name != "INCLUDE":
            self.section.lines.append(line)
            if self.section.name == "INCLUDE_TRANSFORM" and len(self.section.lines) == 5:
                self.include_transformed(self.section)
        return None

    def begin(self, line, words):
        keyword = words[0].rstrip("+-%") if words else ""
        if keyword == "END":
            return False
        if keyword == "KEYWORD":
            self.formats[-1] = Format("LONG=Y" in words, "I10=Y" in words)
        form = self.formats[-1]
        form = Format((form.is_long or line.text.endswith("+")) and not line.text.endswith("-"),
                      form.has_wide_integers or line.text.endswith("%"))
        self.section = Section(self, line, keyword, form, self.transforms[-1])
        if keyword.startswith("INCLUDE_") and not keyword.startswith(("INCLUDE_PATH", "INCLUDE_TRANSFORM")):
            line.fail(f"*{keyword} is not allowed: the mesh could be in the file that it names. Write all into one file, "
                      "name the file by *INCLUDE, or make the lines comments ($) if that file has nothing of the "
                      "mesh.")
        if keyword.startswith(("NODE_TRANSFORM", "NODE_MERGE", "PART_MOVE", "PART_DUPLICATE", "ELEMENT_GENERATE",
                               "ELEMENT_SOLID_NURBS")):
            line.fail(f"*{keyword} is not allowed: it makes or moves nodes or elements. Write the mesh with *NODE and "
                      "*ELEMENT_SOLID alone.")
        self.sections.append(self.section)
        return None

    def include_transformed(self, section):
        transform = Transform.of_section(section, self.transforms[-1])
        self.transforms.append(transform)
        self.include(section.lines[0], section.lines[0].text.strip())
        self.transforms.pop()

    def read_parameters(self, section):
        """Pairs of type and name, "R young", and value, in fields or apart by blanks."""
        for line in section.lines:
            fields = section.fields(line)
            pairs = [(name[:1].upper(), name[1:].strip(), value) for name, value in zip(fields[::2], fields[1::2])]
            if any(kind in "RI" and value_of(value) is None for kind, _, value in pairs):
                pairs = PARAMETER.findall(line.text.upper())
                if PARAMETER.sub("", line.text.upper()).strip():
                    line.fail("*PARAMETER: a card has pairs of type (R, I or C) with name, and value, each 10 columns "
                              "wide.")
            for _, name, value in pairs:
                self.define(line, name.lower(), value)

    def define(self, line, name, value):
        """A parameter; of two of one name LS-DYNA takes the first."""
        if self.parameters.setdefault(name, value) != value:
            line.fail(f'There are two parameters "{name}", {self.parameters[name]} and {value}.')

    def read_expressions(self, section):
        """On each card type and name, "R young", in 10 columns or before a comma, then an expression of those before.
        One that ends without a closed bracket goes on behind the ten columns of the next card."""
        lines = [line for line in section.lines if line.text.strip()]
        while lines:
            line = lines.pop(0)
            head, comma, text = line.text.partition(",")
            if not comma or len(head) > 10:
                head, text = line.text[:10], line.text[10:]
            while text.count("(") > text.count(")") and lines and not lines[0].text[:10].strip():
                text += lines.pop(0).text[10:]
            kind, name = head.strip()[:1].upper(), head.strip()[1:].strip().lower()
            if kind not in ("R", "I") or not re.fullmatch(r"[a-z]\w*", name):
                line.fail("*PARAMETER_EXPRESSION: a card begins with type (R or I) and name in 10 columns.")
            known = {name: number_of_type(value) for name, value in self.parameters.items()}
            try:
                value = value_of_expression(text, {name: value for name, value in known.items() if value is not None})
            except ExpressionError as error:
                line.fail(f"*PARAMETER_EXPRESSION: {error}.")
            self.define(line, name, str(int(value)) if kind == "I" else repr(float(value)))

    def with_parameter(self, text, line):
        """The text, or the value of the parameter that it names."""
        sign, ampersand, name = text.partition("&")
        if not ampersand or sign not in ("", "-"):
            return text
        if name.strip().lower() not in self.parameters:
            line.fail(f'there is no parameter "{name}" of type R, I or C in *PARAMETER. '
                      "Write its value.")
        value = self.parameters[name.strip().lower()]
        return value if not sign else value[1:] if value.startswith("-") else "-" + value

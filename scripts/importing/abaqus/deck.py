# SPDX-License-Identifier: LGPL-2.1-or-later
"""An input file of Abaqus or CalculiX: its keywords, each with its options and data lines."""

from ..text import BLANKS, Files, value_of

SILENT = ("HEADING", "PREPRINT", "END PART", "ASSEMBLY", "END ASSEMBLY", "END INSTANCE", "END STEP")
OF_THE_MESH = ("NODE", "ELEMENT", "NSET", "ELSET", "SURFACE", "NGEN", "NFILL", "ELGEN")


def key(name):
    """Names do not differ by case."""
    return name.upper()


def without_quotes(text):
    return text[1:-1].strip(BLANKS) if len(text) >= 2 and text[0] == text[-1] == '"' else text


def fields_of(text):
    """The fields of a data or keyword line; a comma at its end opens no further field."""
    fields = [field.strip(BLANKS) for field in text.split(",")]
    return fields[:-1] if not fields[-1] else fields


class Row:
    """A data line, whose fields are read by their places."""

    def __init__(self, line):
        self.line = line
        self.fields = fields_of(line.text)
        self.is_read = [False] * len(self.fields)

    def __len__(self):
        return len(self.fields)

    def text(self, k):
        if k >= len(self.fields):
            return ""
        self.is_read[k] = True
        return self.fields[k]

    def number(self, k, default=0.0):
        text = self.text(k)
        return self.line.real(text) if text else default

    def numbers(self):
        return [self.number(k) for k in range(len(self.fields))]

    def unused(self):
        return [(k, text) for k, text in enumerate(self.fields)
                if not self.is_read[k] and text and value_of(text) != 0]


class Section:
    """A keyword. What of its options was asked for counts as used."""

    def __init__(self, line, text, scope):
        fields = fields_of(text[1:]) or [""]
        self.line, self.scope = line, scope
        self.keyword = self.name = key(" ".join(fields[0].split()))
        self.options = {}
        for field in fields[1:]:
            option, equals, value = field.partition("=")
            self.options[key(option.strip(BLANKS))] = without_quotes(value.strip(BLANKS)) if equals else ""
        self.known = set(self.options) if self.name in SILENT else {"UNSORTED"}
        self.lines = []
        self.is_read = self.name in SILENT
        self.is_of_the_mesh = self.name in OF_THE_MESH
        self.rows_so_far = None

    def has(self, option):
        self.known.add(option)
        return option in self.options

    def get(self, option, default=""):
        self.known.add(option)
        return self.options.get(option, default)

    def name_in(self, option):
        """The value of an option that must be there."""
        name = self.get(option)
        if not name:
            self.line.fail(f"*{self.name} has no {option}.")
        return name

    def number(self, option, default):
        return self.line.real(self.get(option)) if self.get(option) else default

    def rows(self):
        self.is_read = True
        if self.rows_so_far is None:
            self.rows_so_far = [Row(line) for line in self.lines]
        return self.rows_so_far

    def report_unused(self, report):
        for option, value in self.options.items():
            if option not in self.known:
                report.unused(self.line.place, self.keyword, option + (f"={value}" if value else ""))
        for row in self.rows_so_far or ():
            for k, text in row.unused():
                report.unused(row.line.place, self.keyword, f"{text} (field {k + 1})")


class Scope:
    """A part, an instance, or what stands outside of them (no name)."""

    def __init__(self, name="", line=None, part=""):
        self.name, self.line, self.part = name, line, part
        self.placement = None  # the section of an instance


class Deck(Files):
    """The sections in their order, each with its scope."""

    def __init__(self, path):
        super().__init__(path)
        self.outside = Scope()
        self.scope = self.outside
        self.parts, self.instances, self.sections = {}, {}, []
        self.pending = None  # a keyword whose line ends with a comma
        self.read(self.path)
        self.begin()

    def take(self, line):
        line.text = text = line.text.strip(BLANKS)
        if not text or text.startswith("**"):
            return
        if self.pending:
            self.pending = self.pending[0], self.pending[1] + text
        elif text.startswith("*"):
            self.pending = line, text
        elif not self.sections:
            line.fail(f'"{text[:40]}" belongs to no keyword (*NODE, *ELEMENT, ...).')
        else:
            self.sections[-1].lines.append(line)
        if self.pending and not self.pending[1].endswith(","):
            self.begin()

    def begin(self):
        """Opens the section of the pending keyword."""
        if not self.pending:
            return
        (line, text), self.pending = self.pending, None
        section = Section(line, text, self.scope)
        if section.name == "INCLUDE":
            self.include(line, section.name_in("INPUT"))
            return
        self.sections.append(section)
        if section.name == "PART":
            self.open_scope(section, self.parts)
        elif section.name == "INSTANCE":
            self.open_scope(section, self.instances)
            self.scope.part = section.get("PART")
            self.scope.placement = section
        elif section.name in ("END PART", "END INSTANCE"):
            self.scope = self.outside
        section.scope = self.scope
        if section.get("INPUT"):
            self.include(line, section.get("INPUT"))

    def open_scope(self, section, scopes):
        section.is_read = True
        if self.scope is not self.outside:
            section.line.fail(f'*{section.name} stands inside of "{self.scope.name}", which does not end.')
        name = section.name_in("NAME")
        if key(name) in scopes:
            section.line.fail(f'There are two of *{section.name} called "{name}".')
        self.scope = scopes[key(name)] = Scope(name, section.line)

    def named(self, *names):
        return [section for section in self.sections if section.name in names]

    def has(self, *names):
        return bool(self.named(*names))

# SPDX-License-Identifier: LGPL-2.1-or-later
"""Parameter files of scripts: which entries there are, what they allow, and what they mean."""

import math
import re
from dataclasses import dataclass

from .errors import nearest
from .parameter_file import InputError

MANDATORY = object()


@dataclass(frozen=True)
class ListOf:
    """The check of a list of at least one element, separated by commas, by that of its elements."""
    check: object = None


def is_number(text):
    try:
        return math.isfinite(float(text))
    except ValueError:
        return False


def parts_of(text, separator):
    return [part.strip() for part in text.split(separator)]


class DescribedFile:
    """The entries of a ParameterFile. `entries` of a subclass is {path: (default, check,
    documentation)}; the entry `names` lists the sections "`kind`: NAME", whose entries are those of
    `entries_of_each`. A check is the texts that are allowed, a range of numbers (type, low, high),
    a ListOf or None. Throws InputError, with all that is wrong."""
    entries, kind, names, entries_of_each = {}, "", "", {}

    def __init__(self, file):
        self.file = file
        self.refuse_unknown()

    def fail(self, entry, message):
        value, where = self.file.entries.get(entry, (None, str(self.file.path)))
        is_set = f' = "{value}"' if value is not None else ""
        end = "" if message.endswith((".", "?")) else "."
        raise InputError(f'{where}: entry "{entry}"{is_set}: {message}{end}')

    def description(self, entry):
        if entry.startswith(f"{self.kind}: "):
            name, _, rest = entry.removeprefix(f"{self.kind}: ").rpartition("/")
            return self.entries_of_each.get(rest) if name in self.list_of(self.names) else None
        return self.entries.get(entry)

    def known(self):
        return list(self.entries) + [f"{self.kind}: {name}/{entry}"
                                     for name in self.list_of(self.names)
                                     for entry in self.entries_of_each]

    def refuse_unknown(self):
        mistakes = []
        for entry, (value, where) in self.file.entries.items():
            described = self.description(entry)
            if described is None:
                mistakes.append(f'{where}: there is no entry "{entry}".'
                                + nearest(entry, self.known()))
                continue
            check, listed = described[1], ""
            values = [value]
            if isinstance(check, ListOf):
                check, listed, values = check.check, "a list of ", self.list_of(entry)
                if not values:
                    mistakes.append(f'{where}: entry "{entry}": the list is empty.')
            for one in values:
                reason = self.refusal(check, one, listed)
                if reason:
                    mistakes.append(f'{where}: entry "{entry}" = "{value}": {reason}')
        mistakes += [
            f'{self.file.path}: the entry "{entry}" is missing.' for entry in self.known()
            if self.description(entry)[0] is MANDATORY and entry not in self.file.entries]
        if mistakes:
            raise InputError("\n".join(mistakes))

    @staticmethod
    def refusal(check, value, listed):
        """What is allowed where a value is not."""
        if check and isinstance(check[0], str):
            allowed = f'allowed is {listed}{", ".join(check)}.'
            return "" if value in check else allowed + nearest(value, check)
        if check:
            kind, low, high = check
            is_right = re.fullmatch(r"[+-]?\d+", value) if kind is int else is_number(value)
            if not is_right or not low <= float(value) <= high:
                whole = "whole " if kind is int else ""
                return f"allowed is a {whole}number from {low:g} to {high:g}."
        return ""

    def get(self, entry):
        if entry in self.file.entries:
            return self.file.entries[entry][0]
        default = self.description(entry)[0]
        return "" if default is MANDATORY else default

    def list_of(self, entry):
        return [part for part in parts_of(self.get(entry), ",") if part]

    def number(self, entry, text):
        if not is_number(text):
            self.fail(entry, f'"{text}" is not a number')
        return float(text)

    def listing(self, documents):
        """The entries as a parameter file, with documentation or without."""
        lines, inside = [], ""
        known = sorted(self.known(), key=lambda entry: ("/" in entry, entry.rpartition("/")[0]))
        for entry in known:
            section, _, name = entry.rpartition("/")
            if section != inside:
                lines += ["end", ""] * bool(inside) + [f"subsection {section}"]
                inside = section
            indent = "  " * bool(section)
            if documents:
                lines.append(f"{indent}# {self.description(entry)[2]}")
            lines.append(f"{indent}set {name} = {self.get(entry)}")
        return "\n".join(lines + ["end"] * bool(inside)) + "\n"

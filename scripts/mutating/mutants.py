# SPDX-License-Identifier: LGPL-2.1-or-later
"""The list of mistakes, and a source with its mistakes in it.

A mistake replaces a text of a source. All mistakes are in one program, each as a choice at run time:

    an expression   (tombolo_mutant(3) ? (mutated) : (original))
    a statement     { if (tombolo_mutant(3)) { mutated } else { original } }

The environment variable TOMBOLO_MUTANT has the number of the one that is made.
"""

import json
import re
from dataclasses import dataclass
from pathlib import Path

HEADER = Path("include/tombolo/base/mutant.h")
VARIABLE = "TOMBOLO_MUTANT"

HEADER_TEXT = f"""// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <cstdlib>

inline const int tombolo_chosen_mutant =
    std::getenv("{VARIABLE}") != nullptr ? std::atoi(std::getenv("{VARIABLE}")) : -1;

inline bool tombolo_mutant(const int number)
{{
  return tombolo_chosen_mutant == number;
}}
"""

ENTRIES = {"name", "mistake", "file", "after", "original", "mutated", "tests"}
BEFORE_STATEMENT = re.compile(r"([;{})]|\belse|\*/|//[^\n]*\n)\s*\Z")
NO_EXPRESSION = re.compile(r"\A\s*(if|for|while|return)\b|[-+*/=<>&|,?:(]\s*\Z|[^=!<>]=[^=]")
BODY_WITHOUT_BRACES = re.compile(r"(\)|\belse)\s*\Z")
DECLARATION = re.compile(r"\A\s*(const|constexpr|auto|bool|double|unsigned)\b")
TESTS = re.compile(r"(unit|regression|program)\.[\w/]+(\.mpirun=\d+)?")


class ListError(Exception):
    """Something is wrong with the list, or it does not fit to the sources any more."""


@dataclass(frozen=True)
class Mutant:
    """A mistake. Its number is its index in the list."""

    number: int
    name: str
    mistake: str
    file: str
    original: str
    mutated: str
    tests: tuple
    after: str = ""

    @property
    def is_statement(self):
        return self.original.rstrip().endswith(";")

    def fail(self, what):
        raise ListError(f'mutant "{self.name}": {what}')

    def span_in(self, text):
        """Begin and end of what is replaced. Layout does not count."""
        begin = 0
        if self.after:
            begin = self.only_match(self.after, text).end()
            match = pattern_of(self.original).search(text, begin)
            if match is None:
                self.fail(f"{self.file} does not have its original after `{self.after}`.")
        else:
            match = self.only_match(self.original, text)
        if DECLARATION.search(self.original):
            self.fail(f"`{self.original}` declares what follows uses; an original is its value alone.")
        if not self.is_statement and NO_EXPRESSION.search(self.original):
            self.fail(f"`{self.original}` is neither a whole expression nor whole statements.")
        if self.is_statement and not BEFORE_STATEMENT.search(text[:match.start()]):
            self.fail(f"`{self.original}` is the end of a statement of {self.file}; an original is "
                      "whole statements, or an expression without the semicolon.")
        if (self.is_statement and self.original.rstrip(" ;").count(";") > 0
                and BODY_WITHOUT_BRACES.search(text[:match.start()])):
            self.fail(f"of `{self.original}` only the first statement belongs to the `if` before it.")
        return match.span()

    def only_match(self, words, text):
        matches = list(pattern_of(words).finditer(text))
        if len(matches) != 1:
            self.fail(f"{self.file} has `{words}` {len(matches)} times; it must have it once. "
                      "An entry \"after\" tells places apart.")
        return matches[0]

    def choice(self, original):
        if not self.is_statement:
            return f"(tombolo_mutant({self.number}) ? ({self.mutated}) : ({original}))"
        return f"{{ if (tombolo_mutant({self.number})) {{ {self.mutated} }} else {{ {original} }} }}"


def pattern_of(words):
    """Matches the words with any space between them."""
    return re.compile(r"\s+".join(re.escape(word) for word in words.split()))


def read(path):
    """The mutants of the list in a file."""
    mutants, names = [], set()
    for entry in json.loads(Path(path).read_text("utf-8"))["mutants"]:
        name = entry.get("name", "")
        missing = ENTRIES - {"after"} - entry.keys()
        if missing or entry.keys() - ENTRIES:
            raise ListError(f'mutant "{name}": its entries are not those of the others: '
                            + ", ".join(sorted(missing | (entry.keys() - ENTRIES))))
        if name in names:
            raise ListError(f'there are two mutants "{name}"')
        names.add(name)
        mutant = Mutant(number=len(mutants), **{**entry, "tests": tuple(entry["tests"])})
        if not mutant.tests or not all(TESTS.fullmatch(test) for test in mutant.tests):
            mutant.fail("it needs names of unit tests, regression cases or tests of the program.")
        if pattern_of(mutant.original).fullmatch(mutant.mutated):
            mutant.fail("it changes nothing.")
        if not mutant.is_statement and (not mutant.mutated or ";" in mutant.mutated):
            mutant.fail("its original is an expression, but what replaces it is not.")
        mutants.append(mutant)
    return mutants


def with_mutants(text, mutants):
    """A source with the choices of its mutants."""
    spans = sorted(((*mutant.span_in(text), mutant) for mutant in mutants),
                   key=lambda span: span[:2])
    for (_, end, one), (begin, _, other) in zip(spans, spans[1:]):
        if begin < end:
            other.fail(f'it changes the same text as "{one.name}".')
    for begin, end, mutant in reversed(spans):
        text = text[:begin] + mutant.choice(text[begin:end]) + text[end:]
    first_line, rest = text.split("\n", 1)
    return f"{first_line}\n#include <tombolo/base/mutant.h>\n{rest}"


def sources_with_mutants(root, mutants):
    """The text of each file that differs from that of the project, by its path in it."""
    by_file = {}
    for mutant in mutants:
        by_file.setdefault(mutant.file, []).append(mutant)
    result = {HEADER: HEADER_TEXT}
    for file, file_mutants in by_file.items():
        path = Path(root) / file
        if not path.is_file():
            file_mutants[0].fail(f"there is no {file}.")
        result[Path(file)] = with_mutants(path.read_text("utf-8"), file_mutants)
    return result

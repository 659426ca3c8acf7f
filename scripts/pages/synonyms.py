# SPDX-License-Identifier: LGPL-2.1-or-later
"""Terms that the search treats as equal."""

from pathlib import Path

FILE = Path(__file__).parent / "synonyms.txt"


class SynonymError(Exception):
    pass


def read(file=FILE):
    """{term: [other terms, the nearest first]}. A line is `term, term = other term, other term`; # begins a remark."""
    found = {}
    for number, line in enumerate(Path(file).read_text("utf-8").splitlines(), 1):
        line = line.partition("#")[0].strip()
        if not line:
            continue
        terms, sign, others = line.partition("=")
        terms, others = ([word.strip() for word in words.split(",")] for words in (terms, others))
        if not sign or not all(terms + others):
            raise SynonymError(f"{file}:{number}: expected `term, term = other term, other term`")
        for term in terms:
            if term in found:
                raise SynonymError(f"{file}:{number}: {term!r} stands twice")
            found[term] = others
    return found

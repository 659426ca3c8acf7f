#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Decks that are changed at random are refused with a sentence, or read.

    broken_decks.py PROJECT_DIRECTORY [NUMBER [FIRST]]
"""

import random
import re
import sys
import tempfile
import traceback
from pathlib import Path

from deck_testing import DECKS, DeckError, convert

NUMBER, FIRST = (int(text) for text in (sys.argv[2:] + ["1500", "1"][len(sys.argv) - 2:]))
WORDS = ("0", "-1", "1e999", "nan", "x", "99999999999", "", "&a", "7.85-09", "1.5", ",", "*", "*END", "*INCLUDE", "*NODE",
         "*SET_NODE_ADD", "*ELSET, ELSET=a, GENERATE", "*END PART", "*STEP", "\t", "ü", "\0")


def changed(text, chance):
    lines = text.split("\n")
    for _ in range(chance.choice((1, 1, 1, 2, 5))):
        k = chance.randrange(len(lines))
        kind = chance.randrange(7)
        if kind == 0:
            del lines[k]
        elif kind == 1:
            lines.insert(k, lines[chance.randrange(len(lines))])
        elif kind == 2:
            lines = lines[:k + 1]
        elif kind == 3:
            lines[k] = lines[k][:chance.randrange(len(lines[k]) + 1)]
        else:
            # A word, or what is between two places of a line.
            words = [match.span() for match in re.finditer(r"[^\s,=]+", lines[k])]
            begin, end = chance.choice(words) if words and kind < 6 else sorted(
                chance.randrange(len(lines[k]) + 1) for _ in range(2))
            word = chance.choice(WORDS) if chance.random() < 0.7 else chance.choice(text.split() or [""])
            lines[k] = lines[k][:begin] + word.rjust(end - begin) + lines[k][end:]
        lines = lines or [""]
    return "\n".join(lines)


def main():
    decks = sorted(path for path in DECKS.iterdir() if path.suffix in (".k", ".inp"))
    refused = failed = 0
    with tempfile.TemporaryDirectory() as directory:
        for seed in range(FIRST, FIRST + NUMBER):
            chance = random.Random(seed)
            deck = chance.choice(decks)
            path = Path(directory, "deck" + deck.suffix)
            path.write_text(changed(deck.read_text(encoding="utf-8"), chance), encoding="utf-8")
            try:
                convert(path, path.with_suffix(".prm"), chance.choice((None,) * 9 + (2,)), chance.random() < 0.2).files()
            except DeckError:
                refused += 1
            except Exception:  # what this test is after
                failed += 1
                print(f"change {seed} of {deck.name}:")
                traceback.print_exc(limit=-3)
    print(f"{NUMBER} changed decks: {refused} refused, {failed} not caught")
    return 1 if failed or not refused else 0


sys.exit(main())

#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Runs the commands of the tutorials and those that comments of other pages name, and compares what they print with what
the pages quote. And a number that is changed is detected.

usage: quotes_test.py PROGRAM STRIP_OPERATORS
"""

import re
import sys
import tempfile
import unittest
from pathlib import Path

import quotes
from quotes import PROJECT

PROGRAM, STRIP_OPERATORS = (Path(sys.argv.pop(1)).resolve() for _ in range(2))
PAGES = [path for path in [PROJECT / "README.md", *sorted(PROJECT.glob("doc/**/*.md"))]
         if path.name.startswith("tutorial_") or quotes.MARK.search(path.read_text("utf-8"))]


class PagesTest(unittest.TestCase):
    def test_pages_quote_what_their_commands_print(self):
        self.assertGreater(len(PAGES), 2)
        n_compared = 0
        for path in PAGES:
            page = path.relative_to(PROJECT).as_posix()
            found = quotes.quotes_of(path.read_text("utf-8"), path.name.startswith("tutorial_"))
            n_compared += sum(quote.kind != "run" for quote in found)
            with self.subTest(page), tempfile.TemporaryDirectory() as directory:
                shell = quotes.Shell(directory, PROGRAM, STRIP_OPERATORS)
                wrong = quotes.wrong_quotes(page, found, shell)
                self.assertFalse(wrong, "\n".join(["", *wrong]))
                self.notice_changes(found, shell)
        self.assertGreater(n_compared, 10)

    def notice_changes(self, found, shell):
        """The first digit of each number of a quoted block of code is changed, by more than it may differ."""
        for quote in found:
            if quote.kind != "prints":
                continue
            printed = shell.run(quote.commands)
            for number in re.finditer(quotes.NUMBER, quote.quoted):
                digit = re.search(r"[1-9]", number[0])
                if not digit or abs(quotes.value_of(number[0])) < quotes.ROUND_OFF:
                    continue
                index = number.start() + digit.start()
                changed = quote.quoted[:index] + str((int(digit[0]) + 4) % 9 + 1) + quote.quoted[index + 1:]
                self.assertNotEqual(quotes.wrong_lines(changed, printed), [], changed)


PAGE = """# A page

    scripts/run a.prm

prints

      mass 2.500 of 12 nodes, ...

and, of a scene that takes long,

<!-- not run: an hour -->

    scripts/run b.prm

this:

      mass 7

<!-- numbers of:
value output/a error 100
-->

| error | 1.4 % |
|---|---|

    set Cells = 3
"""


class QuotesTest(unittest.TestCase):
    def test_blocks_are_found(self):
        found = [(quote.kind, quote.line, quote.commands.strip(), quote.quoted.strip()) for quote in quotes.quotes_of(PAGE, True)]
        self.assertEqual(found, [("run", 3, "scripts/run a.prm", ""),
                                 ("prints", 7, "scripts/run a.prm", "mass 2.500 of 12 nodes, ..."),
                                 ("numbers", 23, "value output/a error 100", "| error | 1.4 % |\n|---|---|")])
        self.assertEqual([quote.kind for quote in quotes.quotes_of(PAGE, False)], ["numbers"])

    def test_digits_that_are_shown_are_compared(self):
        for printed, is_right in (("mass 2.5 of 12 nodes, and more", True), ("mass 2.501 of 12 nodes, and", True),
                                  ("mass 2.51 of 12 nodes, and", False), ("mass 2.5 of 13 nodes, and", False),
                                  ("Mass 2.5 of 12 nodes, and", False), ("a\n  mass 2.5 of 12 nodes, and\nb", True)):
            self.assertEqual(quotes.wrong_lines("  mass 2.500 of 12 nodes, ...", printed) == [], is_right, printed)
        self.assertEqual(quotes.wrong_lines("drift 9.27e-16", "drift -3e-15"), [])
        self.assertEqual(quotes.wrong_lines("5.000000000000001 1", "5 1"), [])
        self.assertNotEqual(quotes.wrong_lines("drift 9.27e-16", "drift -3e-8"), [])
        self.assertEqual(len(quotes.wrong_lines("a 1\nb 2", "b 2\na 1")), 1)

    def test_numbers_of_a_text_are_rounded_and_in_order(self):
        for printed, is_right in (("1.4 2618", True), ("1.44", True), ("1.46", False), ("2618 1.4", False), ("none", False)):
            self.assertEqual(quotes.wrong_numbers("grew from 1.4 to 2,618, L2", printed) == [], is_right, printed)

    def test_a_command_that_fails_is_told(self):
        with tempfile.TemporaryDirectory() as directory:
            shell = quotes.Shell(directory, "/bin/false")
            wrong, = quotes.wrong_quotes("a.md", quotes.quotes_of("    scripts/run a.prm\n", True), shell)
            self.assertIn("a.md:1: scripts/run a.prm\nended with 1", wrong)


if __name__ == "__main__":
    unittest.main()

# SPDX-License-Identifier: LGPL-2.1-or-later
"""What the result does not have of a deck: keywords, cards and fields, each with its line."""

MOST_CARDS = 20  # of a keyword, as comments
MOST_FIELDS = 100


class Report:
    def __init__(self):
        self.is_written = True  # at the end of a parameter file
        self.left_out = []  # a section, lines of it, and what is said about it
        self.notes = []
        self.n_fields = 0
        self.rest = {}      # notes without their lines: how many, and the first one

    def leave_out(self, section, lines, reason=""):
        """A keyword that is not used, or cards of it."""
        self.left_out.append((section, lines, reason))

    def note(self, place, text):
        self.notes.append(f"{place}: {text}")

    def remark(self, text):
        self.notes.append(text)

    def count(self, place, text):
        """A note that many lines can give: it is written once."""
        n, first = self.rest.get(text, (0, place))
        self.rest[text] = (n + 1, first)

    def unused(self, place, keyword, text):
        """A field that is not used."""
        self.n_fields += 1
        if self.n_fields <= MOST_FIELDS:
            self.note(place, f"*{keyword}: {text} is not used.")

    def keywords(self):
        """Keywords that are left out: how many times, and the first line."""
        counts = {}
        for section, _, _ in self.left_out:
            n, first = counts.get(section.keyword, (0, section.line.place))
            counts[section.keyword] = (n + 1, first)
        for keyword, (n, first) in sorted(counts.items()):
            yield f"*{keyword} ({n} {'time,' if n == 1 else 'times, first on'} {first})"

    def all_notes(self):
        yield from self.notes
        if self.n_fields > MOST_FIELDS:
            yield f"{self.n_fields - MOST_FIELDS} further fields are not used."
        for text, (n, first) in self.rest.items():
            yield f"{first}: {text}" + (f" ({n} times)" if n > 1 else "")

    def comments(self):
        """Lines for the end of the parameter file."""
        notes = list(self.all_notes())
        if notes:
            yield from ("", "# What is not as in the deck:")
            yield from (f"#   {note}" for note in notes)
        if self.left_out:
            yield from ("", "# Not used, with the line in the deck:")
        for section, lines, reason in self.left_out:
            yield f"#   {section.line.place}: *{section.keyword}" + (f": {reason}" if reason else "")
            if section.is_of_the_mesh:
                yield f"#     {len(lines)} cards"
                continue
            yield from (f"#     {line.text}" for line in lines[:MOST_CARDS])
            if len(lines) > MOST_CARDS:
                yield f"#     ... and {len(lines) - MOST_CARDS} cards more"

    def summary(self):
        """Lines for the terminal."""
        n = len(self.left_out)
        if n == 0:
            yield "all keywords were used"
        else:
            where = ", at the end of the file as comments" if self.is_written else ""
            yield f"{n} keyword{'s were' if n != 1 else ' was'} not used{where}: " + ", ".join(self.keywords())
        yield from (f"*{section.keyword}: {reason}" for section, _, reason in self.left_out if reason)
        yield from self.all_notes()

# SPDX-License-Identifier: LGPL-2.1-or-later
"""What a parameter file does not have of a keyword file: keywords, cards and fields, each with its line."""

MOST_CARDS = 20  # of a keyword, as comments
MOST_FIELDS = 100


class Report:
    def __init__(self):
        self.left_out = []  # pairs of a section and of what is said about it
        self.notes = []
        self.n_fields = 0
        self.rest = {}      # notes without their lines: how many, and the first one

    def leave_out(self, section, lines, reason=""):
        """A keyword that is not understood, or cards of it."""
        self.left_out.append((section, lines, reason))

    def note(self, place, text):
        self.notes.append(f"{place}: {text}")

    def count(self, place, text):
        """A note that many lines can give: it is written once."""
        n, first = self.rest.get(text, (0, place))
        self.rest[text] = (n + 1, first)

    def unused_fields(self, keyword, fields):
        for field in fields:
            self.n_fields += 1
            if self.n_fields <= MOST_FIELDS:
                self.note(field.line.place, f"*{keyword}: {field.name} = {field.text} is not used.")

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
            yield from ("", "# Not used, with the line in the keyword file:")
            yield from (f"#   {note}" for note in notes)
        if self.left_out:
            yield from ("", "# Not understood, with the line in the keyword file:")
        for section, lines, reason in self.left_out:
            if section.name.startswith("CONTACT"):
                yield ("# Contact here is with rigid surfaces (section \"Contact: NAME\"), between bodies (\"Body contact: "
                       "NAME\"), and between fragments of a part of particles (Self-contact, without friction).")
            yield f"#   {section.line.place}: *{section.keyword}" + (f": {reason}" if reason else "")
            if section.name.startswith("ELEMENT"):
                yield f"#     {len(lines)} cards"
                continue
            yield from (f"#     {line.text}" for line in lines[:MOST_CARDS])
            if len(lines) > MOST_CARDS:
                yield f"#     ... and {len(lines) - MOST_CARDS} cards more"

    def summary(self):
        """Lines for the terminal."""
        keywords = list(self.keywords())
        n = len(self.left_out)
        if n == 0:
            yield "all keywords were understood"
        else:
            yield (f"{n} keyword{'s were' if n != 1 else ' was'} not understood" +
                   ", at the end of the file as comments: " + ", ".join(keywords))
        yield from (f"*{section.keyword}: {reason}" for section, _, reason in self.left_out if reason)
        yield from self.all_notes()

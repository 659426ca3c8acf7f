# SPDX-License-Identifier: LGPL-2.1-or-later
"""An LS-DYNA keyword file: its keywords, each with its cards."""


class KeywordError(Exception):
    """Something that the user can mend; printed without a trace."""


class Section:
    """A keyword with its cards, pairs of line number and text without comments."""

    def __init__(self, name, line, is_long):
        self.name = name
        self.line = line
        self.is_long = is_long
        self.cards = []

    def fields(self, card, widths=(10,)):
        """The fields of a card, fixed or between commas, without the blanks around them."""
        text = self.cards[card][1] if card < len(self.cards) else ""
        if "," in text:
            return [field.strip() for field in text.split(",")]
        fields, begin = [], 0
        while begin < len(text):
            width = 20 if self.is_long else widths[min(len(fields), len(widths) - 1)]
            fields.append(text[begin:begin + width].strip())
            begin += width
        return fields

    def number(self, card, field, default=0.0, widths=(10,)):
        """A number of a card, 0 where it is blank."""
        fields = self.fields(card, widths)
        if field >= len(fields) or not fields[field]:
            return default
        try:
            return float(fields[field].replace("D", "e").replace("d", "e"))
        except ValueError:
            line = self.cards[card][0] if card < len(self.cards) else self.line
            raise KeywordError(f'line {line}: "{fields[field]}" stands where a number should.') from None

    def integer(self, card, field, default=0):
        return int(self.number(card, field, default))

    def title_and_rest(self):
        """The title of a keyword with _TITLE, and the section without it."""
        if not self.name.endswith("_TITLE"):
            return "", self
        rest = Section(self.name[:-len("_TITLE")], self.line, self.is_long)
        rest.cards = self.cards[1:]
        return (self.cards[0][1].strip() if self.cards else ""), rest


def read_deck(text):
    """The sections of a keyword file in their order."""
    sections = []
    is_long_file = False
    for number, line in enumerate(text.splitlines(), 1):
        if line.startswith("$"):
            continue
        if line.startswith("*"):
            words = line[1:].upper().split()
            keyword = words[0] if words else ""
            if keyword == "END":
                break
            if keyword == "KEYWORD":
                is_long_file = "LONG=Y" in words
            is_long = (is_long_file or line.rstrip().endswith("+")) and not line.rstrip().endswith("-")
            sections.append(Section(keyword.rstrip("+-%"), number, is_long))
        elif sections:
            sections[-1].cards.append((number, line.rstrip()))
        elif line.strip():
            raise KeywordError(f"line {number}: this stands before the first keyword.")
    if not any(section.name == "NODE" for section in sections):
        raise KeywordError("there is no section *NODE.")
    return sections

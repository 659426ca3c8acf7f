# SPDX-License-Identifier: LGPL-2.1-or-later
"""*INCLUDE_TRANSFORM: numbers and places of what a file says."""

from math import cos, radians, sin, sqrt

from ..text import DeckError

OFFSETS = ("N", "E", "P", "M", "S", "F", "D")  # of nodes, elements, parts, materials, sets, functions, definitions


class Transform:
    def __init__(self, offsets=None, scale=1.0, number=0, outer=None):
        self.offsets, self.scale, self.transformation, self.outer = offsets or {}, scale, number, outer

    @classmethod
    def of_section(cls, section, outer):
        """By the five cards of the keyword, the first of which names the file."""
        cards = [section.integers(section.lines[1], 10, 7, "an offset"), section.integers(section.lines[2], 10, 1),
                 section.values(section.lines[3]), section.values(section.lines[4])]
        offsets = dict(zip(OFFSETS, cards[0]))
        offsets["R"] = (cards[1] + [0])[0]
        factors = section.fields(section.lines[3])
        values = [section.lines[3].real(text) if text else 1.0 for text in factors] + [1.0] * 4
        for k, name in ((0, "FCTMAS"), (1, "FCTTIM"), (3, "FCTTEM")):
            if values[k] not in (0.0, 1.0) and not (name == "FCTTEM" and len(factors) < 4):
                section.lines[3].fail(f"{name} of *INCLUDE_TRANSFORM is not allowed: write the file in the units of the "
                                      "deck.")
        return cls(offsets, values[2] or 1.0, int(cards[3][0]), outer)

    def lengths(self):
        """The factor of all lengths."""
        return self.scale * (self.outer.lengths() if self.outer else 1.0)

    def moves(self):
        return bool(self.transformation or (self.outer and self.outer.moves()))

    def number(self, kind, value):
        """A number of a kind of things that are named with offsets."""
        if value > 0:
            value += self.offsets.get(kind, 0)
        return self.outer.number(kind, value) if self.outer else value

    def point(self, point, transformations):
        if self.scale != 1.0:
            point = [self.scale * x for x in point]
        if self.transformation:
            if self.transformation not in transformations:
                raise DeckError(f"There is no *DEFINE_TRANSFORMATION {self.transformation}.")
            for option in transformations[self.transformation]:
                point = option(point)
        return self.outer.point(point, transformations) if self.outer else point


def transformations_of(sections):
    """*DEFINE_TRANSFORMATION: functions of points by number, in their order."""
    result = {}
    for section in sections:
        record, lines = section.head()
        result[record.integer_of("field 1 of card 1", "D")] = [option_of(section, line) for line in lines
                                                               if line.text.strip()]
    return result


def option_of(section, line):
    fields = section.fields(line)
    name = fields[0].upper()
    a = [line.real(text) if text else 0.0 for text in fields[1:]] + [0.0] * 7
    if name == "TRANSL":
        return lambda p: [x + y for x, y in zip(p, a)]
    if name == "SCALE":
        return lambda p: [x * (y or 1.0) for x, y in zip(p, a)]
    if name == "ROTATE" and any(a[:3]):
        return lambda p: turned(p, a[3:6], a[:3], a[6])
    return line.fail(f"{name} of *DEFINE_TRANSFORMATION is not read. Allowed are TRANSL, SCALE, and ROTATE with a "
                     "direction, a point and an angle.")


def turned(point, origin, axis, degrees):
    """A point turned about an axis through another point (Rodrigues' formula)."""
    length = sqrt(sum(x * x for x in axis))
    axis = [x / length for x in axis]
    arm = [x - y for x, y in zip(point, origin)]
    along = sum(x * y for x, y in zip(axis, arm))
    # The usual angles give exact coordinates.
    sine, cosine = (round(x) if abs(x - round(x)) < 1e-15 else x for x in (sin(radians(degrees)), cos(radians(degrees))))
    return [origin[d] + cosine * arm[d] + sine * (axis[d - 2] * arm[d - 1] - axis[d - 1] * arm[d - 2]) +
            (1 - cosine) * along * axis[d] for d in range(3)]

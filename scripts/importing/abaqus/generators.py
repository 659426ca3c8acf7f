# SPDX-License-Identifier: LGPL-2.1-or-later
"""*NGEN, *NFILL and *ELGEN: nodes between nodes, and elements like others."""

from math import acos, cos, degrees, radians, sin, sqrt

from ..dyna.transform import turned
from .deck import fields_of, key

GENERATORS = ("NGEN", "NFILL", "ELGEN")
MOST_MADE = 100000000


def cartesian(point, system):
    """Of r, angle in degrees, z; or of a sphere r, angle, angle from the plane."""
    radius, angle, third = point
    x, y = cos(radians(angle)), sin(radians(angle))
    if system == "C":
        return [radius * x, radius * y, third]
    up = radians(third)
    return [radius * cos(up) * x, radius * cos(up) * y, radius * sin(up)]


def integers(line, fields, what):
    return [line.integer(text, what) if text else 0 for text in fields]


def node_of(content, number, line):
    if number not in content.nodes:
        line.fail(f"There is no node of number {number}.")
    return content.nodes[number]


def generate_nodes(section, content, entry, set_of):
    entries = set_of(content.node_sets, section.get("NSET")).entries if section.get("NSET") else None
    make = fill_between if section.name == "NFILL" else fill_line
    for line in section.lines:
        for number, point in make(section, content, line, fields_of(line.text)):
            content.nodes.setdefault(number, point)
            if entries is not None:
                entries.append(entry.of_number(line, number))


def between(begin, end, share):
    return [a + share * (b - a) for a, b in zip(begin, end)]


def fill_line(section, content, line, fields):
    """*NGEN: nodes on a line or an arc from the first to the last, in steps of their numbers, ends included."""
    first, last, step = (integers(line, fields[:3], "a number of *NGEN") + [0, 0, 0])[:3]
    step = step or 1
    if step < 1 or last <= first or (last - first) % step or (last - first) // step > MOST_MADE:
        line.fail("A line of *NGEN is a first and a last node and a step of their numbers that leads from one to the other.")
    begin, end = node_of(content, first, line), node_of(content, last, line)
    n = (last - first) // step
    kind = key(section.get("LINE")) or "S"
    if kind not in ("S", "C"):
        section.line.fail(f"*NGEN with LINE={kind} is not allowed. Allowed are a line (LINE=S) and an arc (LINE=C).")
    turn = arc(line, content, begin, end, fields[3:]) if kind == "C" else None
    for k in range(n + 1):
        yield first + k * step, turn(k / n) if turn and 0 < k < n else between(begin, end, k / n)


def arc(line, content, begin, end, fields):
    """Points by their share of the way about the centre, a node or coordinates, and the normal if it is given."""
    texts = fields + [""] * 7
    centre = node_of(content, line.integer(texts[0], "the number of a node"), line) if texts[0] else \
        [line.real(text) if text else 0.0 for text in texts[1:4]]
    normal = [line.real(text) if text else 0.0 for text in texts[4:7]]
    one, other = ([x - c for x, c in zip(point, centre)] for point in (begin, end))
    if not any(normal):
        normal = [one[d - 2] * other[d - 1] - one[d - 1] * other[d - 2] for d in range(3)]
    lengths = [sqrt(sum(x * x for x in v)) for v in (one, other)]
    if not any(normal) or min(lengths) == 0:
        line.fail("The arc of *NGEN has no plane: write the normal.")
    angle = degrees(acos(max(-1, min(1, sum(a * b for a, b in zip(one, other)) / (lengths[0] * lengths[1])))))

    def point(share):
        arm = [x - c for x, c in zip(turned(begin, centre, normal, share * angle), centre)]
        factor = 1 + share * (lengths[1] / lengths[0] - 1)
        return [c + factor * x for c, x in zip(centre, arm)]
    return point


def fill_between(section, content, line, fields):
    """*NFILL: nodes between those of two sets, in their order."""
    bias = section.number("BIAS", 1.0)
    if len(fields) < 4:
        line.fail("A line of *NFILL is two sets of nodes, the number of intervals and a step of the numbers.")
    ends = [numbers_of(content, name, line) for name in fields[:2]]
    n, step = integers(line, fields[2:4], "a number of *NFILL")
    if n < 1 or step < 1 or len(ends[0]) != len(ends[1]) or n * len(ends[0]) > MOST_MADE:
        line.fail("The two sets of *NFILL have as many nodes, with at least one interval and a step of at least 1.")
    weights = [bias ** -k for k in range(n)]
    for first, last in zip(*ends):
        begin, end = node_of(content, first, line), node_of(content, last, line)
        for k in range(n + 1):
            yield (first + k * step if k < n else last), between(begin, end, sum(weights[:k]) / sum(weights))


def numbers_of(content, name, line):
    if name.isdigit():
        return [int(name)]
    one = content.node_sets.get(key(name))
    if one is None:
        line.fail(f'There is no set of nodes "{name}".')
    numbers = []
    for entry in one.entries:
        numbers += numbers_of(content, entry.name, entry.line) if entry.name and entry.name != name else \
            range(entry.first, entry.last + 1, entry.step)
    return [number for number in dict.fromkeys(numbers) if number in content.nodes]


def generate_elements(section, content, entry, set_of):
    """*ELGEN: rows, layers of elements like a first one, by steps of the numbers of nodes and of elements."""
    entries = set_of(content.element_sets, section.get("ELSET")).entries if section.get("ELSET") else None
    for line in section.lines:
        numbers = integers(line, fields_of(line.text), "a number of *ELGEN")
        master, numbers = numbers[0], numbers[1:] + [0] * 9
        found = [(block, element) for block in content.blocks for element in block.elements if element[0] == master]
        if not found:
            line.fail(f"There is no element of number {master}.")
        block, (_, nodes, _) = found[0]
        steps = [((numbers[k] or 1), numbers[k + 1] or 1, numbers[k + 2] or 1) for k in (0, 3, 6)]
        if min(step[0] for step in steps) < 1 or steps[0][0] * steps[1][0] * steps[2][0] > MOST_MADE:
            line.fail("The numbers of elements in rows and layers of *ELGEN are at least 1.")
        for i in range(steps[0][0]):
            for j in range(steps[1][0]):
                for k in range(steps[2][0]):
                    of_nodes, of_elements = (sum(c * step[s] for c, step in zip((i, j, k), steps)) for s in (1, 2))
                    number = master + of_elements
                    if number != master:
                        block.elements.append((number, tuple(node + of_nodes for node in nodes), line))
                    if entries is not None:
                        entries.append(entry.of_number(line, number))

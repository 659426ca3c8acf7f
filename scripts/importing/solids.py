# SPDX-License-Identifier: LGPL-2.1-or-later
"""What the reader of the mesh makes of a keyword file: its parts, sets and nodes that are held."""

from .deck import value_of
from .layouts import SETS_OF_THE_MESH

# These need no words.
OF_THE_MESH = ("KEYWORD", "TITLE", "NODE", "INCLUDE", "PARAMETER", "PARAMETER_LOCAL", "ELEMENT_SOLID",
               "ELEMENT_SOLID_H20", "ELEMENT_SOLID_H27", "ELEMENT_SHELL")
NODES_OF_SOLID = {"ELEMENT_SOLID": 8, "ELEMENT_SOLID_H20": 20, "ELEMENT_SOLID_H27": 27}
# Directions that TC holds.
HELD = {1: "x", 2: "y", 3: "z", 4: "xy", 5: "yz", 6: "zx", 7: "xyz"}


def is_of_the_mesh(section):
    return section.name in OF_THE_MESH or section.name in SETS_OF_THE_MESH


def parts_of(section):
    """The parts of solid elements, on one card each or on several."""
    n_nodes, width = NODES_OF_SOLID[section.name], section.integer_width
    n_given = 0
    for line in section.lines:
        if "," in line.text[:10 * width] or "\t" in line.text:
            fields = section.raw_fields(line, width, 10)
            while fields and not fields[-1]:
                fields.pop()
            n_fields, second = len(fields), fields[1] if len(fields) > 1 else ""
        else:
            n_fields = -(-len(line.text[:10 * width].rstrip()) // width)
            second = line.text[width:2 * width].strip()
        if not n_fields:
            continue
        if n_given == 0 and second.isdigit():
            yield int(second)
        is_head = n_given == 0 and n_fields <= 2
        n_given += n_fields
        if not is_head and n_given >= 2 + n_nodes:
            n_given = 0


def elements_and_nodes(sections, report):
    """Numbers of the parts of solids, and how many nodes TC holds along each axis."""
    parts, held = set(), {axis: 0 for axis in "xyz"}
    for section in sections:
        if section.name in NODES_OF_SOLID:
            parts.update(parts_of(section))
        elif section.name == "ELEMENT_SHELL":
            report.note(section.line.place, f"*{section.keyword} (cards: {len(section.lines)}): shells are no cells; "
                        "those on the surface of solids make a boundary of their part.")
        elif section.name == "NODE":
            count_held(section, held, report)
    return parts, held


def count_held(section, held, report):
    begin = 80 if section.is_long else section.integer_width + 48
    width = section.integer_width
    for line in section.lines:
        text = line.text.expandtabs(8)
        if "," in text:
            tc, rc = (text.split(",") + [""] * 6)[4:6]
        elif len(text) > begin:
            tc, rc = text[begin:begin + width], text[begin + width:begin + 2 * width]
        else:
            continue
        for axis in HELD.get(value_of(tc.strip() or "0"), ""):
            held[axis] += 1
        if value_of(rc.strip() or "0") != 0:
            report.count(line.place, "RC of *NODE is not used: nodes of solids do not turn.")


def names_of_sets(sections, held, report):
    """The names that the reader of the mesh gives to boundaries, by kind and number; the line of sets that it
    does not read."""
    names, taken = {}, set()

    def name(kind, number, title):
        default = f"{kind} {number}" if number else kind
        result = " ".join("".join(" " if c in ",#\\" else c for c in title).split()) or default
        if result in taken:
            result += f" ({default})"
        taken.add(result)
        return result

    for section in sections:
        for keyword, kind in (("SET_NODE", "node set"), ("SET_SEGMENT", "segment set"), ("SET_", "")):
            if section.name.startswith(keyword):
                break
        else:
            continue
        record, lines = section.head()
        number = record.integer("SID")
        if section.name not in SETS_OF_THE_MESH:
            names.setdefault((kind, number), section)
            continue
        report.unused_fields(section.keyword, record.unused())
        if kind:
            names[kind, number] = name(kind, number, record.title)
        n_fields = 4 if kind == "segment set" else 1 if section.name == "SET_NODE_COLUMN" else 8
        for line in lines:
            if any(section.values(line)[n_fields:]):
                report.count(line.place, f"attributes of *{section.keyword} are not used.")
    for axis in "xyz":
        if held[axis]:
            names["held", axis] = name(f"held along {axis}", 0, "")
    return names

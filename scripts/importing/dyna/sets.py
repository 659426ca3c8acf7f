# SPDX-License-Identifier: LGPL-2.1-or-later
"""Sets of nodes, segments, elements and parts of a keyword file, and sets of sets."""

import re
from collections import Counter

WORDS = {"NODE": "node set", "SEGMENT": "segment set", "SOLID": "solid set", "SHELL": "shell set", "PART": "part set"}
FORMS = re.compile(r"SET_(NODE|SEGMENT|SOLID|SHELL|PART)((?:_LIST)?(?:_GENERATE)?|_ADD|_COLUMN|_LIST_COLUMN|_GENERAL)")
OPTIONS_OF_GENERAL = {"NODE": ("ALL", "NODE", "DNODE", "PART", "DPART"), "SEGMENT": ("SEG", "DSEG", "PART", "DPART")}


class Set:
    def __init__(self, section, kind, form, number, title, lines):
        self.section, self.kind, self.form, self.number = section, kind, form, number
        self.title, self.lines = title, lines


class Sets:
    """Reads all sets of a mesh into its groups, surfaces and sets of nodes."""

    def __init__(self, mesh):
        self.mesh, self.report = mesh, mesh.report
        self.known, self.not_read = {}, {}
        self.parts_of_set = {}  # numbers of parts, by the number of a set of parts
        self.cells_of_part = {}
        self.n_cells_of_face = None
        for c, part in enumerate(mesh.part_of_cell):
            self.cells_of_part.setdefault(part, []).append(c)
        for section in mesh.deck.sections:
            if section.name.startswith("SET_"):
                self.read(section)
        for one in self.known.values():
            self.resolve(one)

    def read(self, section):
        record, lines = section.head()
        number = record.integer("SID")
        match = FORMS.fullmatch(section.name)
        if not match or (match[1] == "SHELL" and self.mesh.dimension == 3) or \
                (match[2] == "_GENERAL" and not self.is_readable(section, lines, match[1])):
            words = section.name.split("_")
            self.not_read.setdefault((WORDS.get(words[1] if len(words) > 1 else ""), number), section)
            self.report.leave_out(section, section.lines)
            return
        section.is_read = True
        for field in record.unused():
            self.report.unused(field.line.place, section.keyword, f"{field.name} = {field.text}")
        one = Set(section, match[1], match[2].removeprefix("_LIST"), number, record.title, lines)
        if (WORDS[match[1]], number) in self.known:
            section.line.fail(f"There are two {WORDS[match[1]]}s of number {number}.")
        self.known[WORDS[match[1]], number] = one

    @staticmethod
    def is_readable(section, lines, kind):
        return all(section.fields(line)[0].upper() in OPTIONS_OF_GENERAL.get(kind, ())
                   for line in lines if line.text.strip())

    def resolve(self, one):
        mesh, word = self.mesh, WORDS[one.kind]
        is_boundary = one.kind in ("NODE", "SEGMENT")
        name = (mesh.boundary_names if is_boundary else mesh.group_names).give(one.title, f"{word} {one.number}")
        mesh.names[word, one.number] = name
        members = self.members_of(one, name, [])
        if one.kind == "NODE":
            mesh.add_node_set(name, dict.fromkeys(members))
        elif one.kind == "SEGMENT":
            mesh.add_surface(name, members)
        elif one.kind == "PART":
            self.parts_of_set[one.number] = list(dict.fromkeys(members))
            mesh.add_group(name, [c for part in self.parts_of_set[one.number] for c in self.cells_of_part.get(part, ())])
        else:
            mesh.add_group(name, members)

    def members_of(self, one, name, outer):
        """Indices of nodes or cells, faces, or numbers of parts."""
        members = []
        for line in one.lines:
            if not line.text.strip():
                continue
            if one.form == "_GENERAL":
                members = (self.nodes_of_option if one.kind == "NODE" else self.faces_of_option)(one, line, members)
                continue
            if one.kind == "SEGMENT" and one.form != "_ADD":
                members.append(self.segment(one, line))
                continue
            fields = one.section.fields(line)[:1 if one.form == "_COLUMN" else None]
            numbers = [line.integer(text, "a number of a set") if text else 0 for text in fields]
            if len(numbers) > 8:
                line.fail(f"A card of *{one.section.keyword} has {len(numbers)} numbers. Allowed are eight on a card.")
            if one.form == "_COLUMN" and any(one.section.values(line)[1:]):
                self.report.count(line.place, f"attributes of *{one.section.keyword} are not used.")
            if one.form == "_ADD":
                for number in filter(None, numbers):
                    members += self.of_set(one, number, line, name, outer)
            elif one.form == "_GENERATE":
                if len(numbers) % 2:
                    line.fail(f"A card of *{one.section.keyword} has pairs of a first and a last number.")
                for first, last in zip(numbers[::2], numbers[1::2]):
                    members += self.of_range(one, first, last)
            else:
                members += [self.member(one, number, line, name) for number in numbers if number != 0]
        return members

    def of_set(self, one, number, line, name, outer):
        number = one.section.transform.number("S", number)
        other = self.known.get((WORDS[one.kind], number))
        if other is None:
            line.fail(f"There is no set of {one.kind.lower()}s of number {number}, which the set \"{name}\" names.")
        return [] if other in outer or other is one else self.members_of(other, name, outer + [one])

    def of_range(self, one, first, last):
        """Of a range LS-DYNA takes what exists."""
        kind = {"NODE": "N", "PART": "P"}.get(one.kind, "E")
        first, last = (one.section.transform.number(kind, number) for number in (first, last))
        known = self.mesh.index_of_node if one.kind == "NODE" else \
            {part: part for part in self.mesh.titles} if one.kind == "PART" else self.mesh.cell_of_element
        return [index for number, index in known.items() if first <= number <= last]

    def member(self, one, number, line, name):
        transform = one.section.transform
        if one.kind == "NODE":
            return self.mesh.node(number, line, transform)
        if one.kind == "PART":
            return transform.number("P", number)
        number = transform.number("E", number)
        if number not in self.mesh.cell_of_element:
            line.fail(f"There is no element of number {number}, which the set \"{name}\" names.")
        return self.mesh.cell_of_element[number]

    def segment(self, one, line, first=0):
        """The nodes of a face, which stand from a field on, and its line."""
        n_nodes = 4 if self.mesh.dimension == 3 else 2
        fields = one.section.fields(line)[first:]
        texts = (fields + [""] * 4)[:n_nodes]
        numbers = [line.integer(text, "the number of a node of a segment") for text in texts]
        if len(set(numbers)) < n_nodes:
            line.fail("A segment is a triangle. Allowed are faces of hexahedra only." if n_nodes == 4 else
                      "A segment has the same node twice.")
        if any(line.real(text) for text in fields[4:] if text):
            self.report.count(line.place, f"attributes of *{one.section.keyword} are not used.")
        return tuple(self.mesh.node(number, line, one.section.transform) for number in numbers), line

    def nodes_of_option(self, one, line, members):
        """*SET_NODE_GENERAL: the members so far with those of one more card, or without them."""
        fields = one.section.fields(line)
        option, mesh = fields[0].upper(), self.mesh
        if option == "ALL":
            return members + list(range(len(mesh.points)))
        numbers = [line.integer(text) for text in fields[1:] if text]
        if option.endswith("NODE"):
            named = [mesh.node(number, line, one.section.transform) for number in numbers]
        else:
            named = [node for c in self.cells_of_parts(one, numbers) for node in mesh.cells[c].nodes]
        return [node for node in members if node not in set(named)] if option.startswith("D") else members + named

    def faces_of_option(self, one, line, members):
        """*SET_SEGMENT_GENERAL: faces so far with one more, or with the outer faces of parts, or without them."""
        fields = one.section.fields(line)
        option = fields[0].upper()
        if option.endswith("SEG"):
            named = [self.segment(one, line, 1)]
        else:
            # Behind three parts are attributes.
            numbers = [line.integer(text, "the number of a part") for text in fields[1:4] if text]
            named = [(nodes, line) for nodes in self.outer_faces(self.cells_of_parts(one, numbers))]
        taken = {tuple(sorted(nodes)) for nodes, _ in named}
        return [face for face in members if tuple(sorted(face[0])) not in taken] if option.startswith("D") else \
            members + named

    def cells_of_parts(self, one, numbers):
        parts = [one.section.transform.number("P", number) for number in numbers]
        return [c for part in parts for c in self.cells_of_part.get(part, ())]

    def outer_faces(self, cells):
        """Faces of cells that no other cell of the mesh has, round against the clock as seen from outside."""
        if self.n_cells_of_face is None:
            self.n_cells_of_face = Counter(tuple(sorted(face)) for c in range(len(self.mesh.cells))
                                           for face in self.mesh.faces(c))
        return [face[::-1] for c in cells for face in self.mesh.faces(c) if self.n_cells_of_face[tuple(sorted(face))] == 1]

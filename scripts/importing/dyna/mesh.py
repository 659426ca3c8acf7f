# SPDX-License-Identifier: LGPL-2.1-or-later
"""The mesh of a keyword file: nodes, solid elements (shell elements in the plane), parts, and nodes that are held."""

from ..mesh import ADVICE, Cell, Mesh, Names, SHAPE
from ..text import DeckError, value_of
from .sets import Sets
from .transform import transformations_of

NODES_OF_SOLID = {"ELEMENT_SOLID": 8, "ELEMENT_SOLID_H20": 20, "ELEMENT_SOLID_H27": 27}
# Directions that TC holds.
HELD = {0: "", 1: "x", 2: "y", 3: "z", 4: "xy", 5: "yz", 6: "zx", 7: "xyz"}
LARGEST_PART = 2000000000


class DynaMesh(Mesh):
    """Names of sets by kind and number are in names; groups of parts by number in part_names."""

    def __init__(self, deck, dimension, report):
        super().__init__(dimension)
        self.deck, self.report = deck, report
        self.index_of_node = {}
        self.cell_of_element = {}
        self.part_of_cell = []
        self.titles = {}          # of parts
        self.shells = {}          # faces, by part
        self.n_triangles, self.first_triangle = 0, None
        self.held = {axis: [] for axis in "xyz"[:dimension]}
        self.first_held = None
        self.names, self.part_names = {}, {}
        self.read_nodes()
        self.read_elements()
        self.read_parts()
        self.group_names, self.boundary_names = Names(self.remarks), Names(self.remarks)
        self.sets = Sets(self)
        self.name_held_nodes()
        self.name_parts()
        self.name_shells()
        if dimension == 3 and not self.cells:
            raise DeckError("there are no hexahedra (*ELEMENT_SOLID): cells of other shapes, shells among them, are no "
                            "cells here (--dimension 2 reads a plane of shells).")
        self.finish()

    def node(self, number, line, transform=None):
        number = transform.number("N", number) if transform else number
        index = self.index_of_node.get(number)
        if index is None:
            line.fail(f"There is no node of number {number}.")
        return index

    def read_nodes(self):
        transformations = transformations_of(self.deck.named("DEFINE_TRANSFORMATION"))
        for section in self.deck.named("NODE"):
            width = section.integer_width
            real = 20 if section.is_long else 16
            widths = [width, real, real, real, width]
            moves = section.transform.outer is not None
            for line in section.lines:
                fields = section.columns(line, widths, 6)
                if not fields:
                    continue
                number = line.integer(fields[0], "the number of a node")
                number = section.transform.number("N", number) if moves else number
                if number in self.index_of_node:
                    line.fail(f"There are two nodes of number {number}.")
                point = [line.real(text, "a coordinate of a node") if text else 0.0 for text in fields[1:4]]
                point += [0.0] * (3 - len(point))
                if moves:
                    point = section.transform.point(point, transformations)
                self.index_of_node[number] = len(self.points)
                self.points.append(tuple(point))
                self.numbers.append(number)
                if len(fields) > 4:
                    self.hold(fields[4:], len(self.points) - 1, line)

    def hold(self, codes, node, line):
        tc = line.real(codes[0], "the constraint (TC) of a node") if codes[0] else 0
        if tc not in HELD:
            line.fail("TC of a node is a number from 0 to 7.")
        for axis in HELD[tc]:
            if axis in self.held:
                self.held[axis].append(node)
                self.first_held = self.first_held or line.place
        if len(codes) > 1 and (value_of(codes[1] or "0") or 0) != 0:
            self.report.count(line.place, "RC of *NODE is not used: nodes of solids do not turn.")

    def read_elements(self):
        for section in self.deck.sections:
            options = section.name.removeprefix("ELEMENT_SOLID")
            if section.name == "ELEMENT_SHELL":
                self.read_section(section, 4)
            elif section.name in NODES_OF_SOLID:
                if self.dimension == 2:
                    section.line.fail("There are solid elements, and the scene has two dimensions. Allowed are "
                                      "quadrilaterals (*ELEMENT_SHELL); or leave --dimension 2 out.")
                self.read_section(section, NODES_OF_SOLID[section.name])
            elif options != section.name:
                allowed = "Allowed are *ELEMENT_SOLID, *ELEMENT_SOLID_H20 and *ELEMENT_SOLID_H27."
                if options.startswith(("_T", "_P")):
                    section.line.fail(f"*ELEMENT_SOLID{options} has elements that are no hexahedra. {allowed}{ADVICE[3]}")
                section.line.fail(f"*ELEMENT_SOLID{options} is not allowed. {allowed}")

    def read_section(self, section, n_nodes):
        """Elements on one card each or on several."""
        element, first = [], None
        for line in section.lines:
            if not line.text:
                continue
            numbers = section.integers(line, section.integer_width, 10, "a number of an element")
            first = first if element else line
            # In the form of two cards the first one has the element and its part only.
            is_head = not element and len(numbers) <= 2
            element += numbers
            if not is_head and (len(element) >= 2 + n_nodes or (n_nodes <= 8 and len(element) >= 6)):
                self.add_element(section, element, n_nodes, first)
                element = []
        if element:
            self.add_element(section, element, n_nodes, first)

    def add_element(self, section, element, n_nodes, line):
        n_corners = 4 if n_nodes == 4 else 8
        given = [number for number in element[2:] if number != 0]
        if n_nodes == 4 and len(given) == 3:
            element, given = element[:5] + element[4:5], given + given[-1:]
        if n_corners == 8 and len(given) == 4:
            line.fail("An element is a tetrahedron of 4 nodes. Allowed are hexahedra only." + ADVICE[3])
        if len(element) < 2 + n_nodes or len(given) < n_nodes:
            line.fail(f"An element of this kind has {n_nodes} nodes, and this one has {len(given)}.")
        if n_nodes == 8 and len(given) > 8:
            line.fail("An element is a tetrahedron of 10 nodes. Allowed are hexahedra only." + ADVICE[3])
        if not 1 <= element[1] <= LARGEST_PART:
            line.fail(f"The number {element[1]} of a part is outside 1 to {LARGEST_PART}.")
        transform = section.transform
        number, part = transform.number("E", element[0]), transform.number("P", element[1])
        nodes = [self.node(node, line, transform) for node in element[2:2 + n_nodes]]
        corners = tuple(nodes[:n_corners])
        if n_corners == 4 and self.dimension == 3:
            if len(set(corners)) < 4:
                self.n_triangles, self.first_triangle = self.n_triangles + 1, self.first_triangle or line.place
            else:
                self.shells.setdefault(part, []).append((corners, line))
            return
        self.check_shape(corners, line)
        if number in self.cell_of_element:
            line.fail(f"There are two elements of number {number}.")
        self.cell_of_element[number] = len(self.cells)
        self.cells.append(Cell(corners, line, number))
        self.part_of_cell.append(part)
        if n_nodes > 8:
            self.add_midside_nodes(nodes, line)

    def check_shape(self, corners, line):
        n_distinct = len(set(corners))
        if len(corners) == 4 and n_distinct == 3:
            line.fail("An element is a triangle (two of its nodes are equal). Allowed are quadrilaterals only." + ADVICE[2])
        shape = {4: "tetrahedron", 5: "pyramid", 6: "wedge"}.get(n_distinct)
        if len(corners) == 8 and shape:
            line.fail(f"An element is a {shape} (it has {n_distinct} different nodes). Allowed are {SHAPE[3]} only." +
                      ADVICE[3])

    def read_parts(self):
        for section in self.deck.named("PART", "PART_CONTACT", "PART_INERTIA"):
            for record in section.records():
                if record.lines:
                    record.line.integer(record.text("PID"), "the number of a part")
                    if record.integer("PID") in self.titles:
                        record.line.fail(f"There are two parts of number {record.integer('PID')}.")
                    self.titles[record.integer("PID")] = record.title
        for part in sorted(set(self.part_of_cell)):
            self.titles.setdefault(part, "")

    def name_held_nodes(self):
        said, in_cells = [], {node for cell in self.cells for node in cell.nodes}
        for axis, nodes in self.held.items():
            if not in_cells.isdisjoint(nodes):
                name = self.boundary_names.give("", f"held along {axis}")
                said.append(f'"{name}" ({len(nodes)} nodes)')
                self.names["held", axis] = name
                self.add_node_set(name, nodes)
        if said:
            self.remarks.append(f"TC of *NODE (first on {self.first_held}) holds nodes. They are the boundaries " +
                                ", ".join(said) + ".")

    def name_parts(self):
        cells = {}
        for c, part in enumerate(self.part_of_cell):
            cells.setdefault(part, []).append(c)
        for part, title in sorted(self.titles.items()):
            if part not in cells:
                if part not in self.shells and part not in self.parts_of_links():
                    self.remarks.append(f'The part {part} "{title}" has no cells: it is left out.')
                continue
            number = f"part {part}"
            name = self.group_names.give(title, number)
            self.part_names[part] = name
            for group in (name, number):
                if group not in self.groups:
                    self.add_group(group, cells[part])

    def parts_of_links(self):
        """Numbers of the parts of *ELEMENT_DISCRETE."""
        return {section.transform.number("P", (section.integers(line, section.integer_width, 2, "a number") + [0, 0])[1])
                for section in self.deck.named("ELEMENT_DISCRETE") for line in section.lines if line.text.strip()}

    def name_shells(self):
        for part, faces in self.shells.items():
            name = self.boundary_names.give(self.titles.get(part, ""), f"part {part}")
            self.names["shells of part", part] = name
            self.add_surface(name, faces)
        if self.n_triangles:
            self.remarks.append(f"*ELEMENT_SHELL of three nodes ({self.n_triangles} times, first on "
                                f"{self.first_triangle}) are left out.")
        for section in self.deck.named("ELEMENT_SHELL") if self.dimension == 3 else ():
            self.report.note(section.line.place, f"*{section.keyword} (cards: {len(section.lines)}): shells are no cells; "
                             "those on the surface of solids make a boundary of their part.")

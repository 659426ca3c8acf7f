# SPDX-License-Identifier: LGPL-2.1-or-later
"""The mesh of a file of Abaqus: bodies of parts and instances, with their sets and surfaces."""

from ..dyna.transform import turned
from ..mesh import ADVICE, Cell, Mesh, usable
from ..text import DeckError
from .deck import fields_of, key, without_quotes
from .element_types import ElementType
from .generators import GENERATORS, cartesian, generate_elements, generate_nodes

HIDDEN = ("NCOPY", "NMAP", "ELCOPY", "SYSTEM")
COMBINING = ("COMBINE", "CROP")  # options of surfaces
LARGEST = 10 ** 12


class Entry:
    """A number, a range of numbers, or the name of a set, of an instance perhaps."""

    __slots__ = ("line", "instance", "name", "first", "last", "step", "is_range")

    def __init__(self, line, text="", instance=""):
        self.line, self.instance, self.name = line, instance, ""
        self.first = self.last = 0
        self.step, self.is_range = 1, False
        name = without_quotes(text)
        if "." in name:
            self.instance, _, name = name.rpartition(".")
        if name.isdigit() and name.isascii():
            self.first = self.last = int(name)
        else:
            self.name = name

    @classmethod
    def of_number(cls, line, number):
        entry = cls(line)
        entry.first = entry.last = number
        return entry

    @classmethod
    def of_range(cls, line, fields, instance):
        if not 2 <= len(fields) <= 3:
            line.fail("A line of GENERATE is a first and a last number and a step.")
        entry = cls(line, "", instance)
        entry.first = line.integer(fields[0], "the first number")
        entry.last = line.integer(fields[1], "the last number")
        entry.step = line.integer(fields[2], "the step") if len(fields) > 2 else 1
        entry.is_range = True
        if entry.step < 1 or not 0 <= entry.first <= entry.last <= LARGEST or entry.step > LARGEST:
            line.fail("A range of GENERATE goes up, with a step of at least 1.")
        return entry


class SetOf:
    def __init__(self, name):
        self.name, self.entries, self.with_nodes, self.is_internal = name, [], [], False


class Surface:
    def __init__(self, name, is_of_nodes):
        self.name, self.is_of_nodes, self.entries, self.faces, self.is_internal = name, is_of_nodes, [], [], False


class Block:
    """Elements of one type: number, nodes and line of each."""

    def __init__(self, kind):
        self.type, self.elements = kind, []


class LinkElement:
    """A spring or a dashpot: its nodes by their names, then by their indices."""

    def __init__(self, kind, number, names, line):
        self.type, self.number, self.names, self.line = kind, number, names, line
        self.nodes, self.prefix = (), ""


class Content:
    """What a scope says of the mesh."""

    def __init__(self):
        self.nodes, self.blocks, self.links = {}, [], []
        self.node_sets, self.element_sets, self.surfaces = {}, {}, {}


def set_of(sets, name):
    return sets.setdefault(key(name), SetOf(name))


class Body:
    """A part that an instance places, or what stands outside of the parts (no name)."""

    def __init__(self, name, content, scope):
        self.name, self.content, self.scope = name, content, scope
        self.nodes = {}     # indices by number
        self.elements = {}  # kind ("cell", "face", "link" or None) and index by number


class AbaqusMesh(Mesh):
    """Names of sets by keys are those that conditions use: groups, surfaces and node_sets of the mesh."""

    def __init__(self, deck, dimension, report):
        super().__init__(dimension)
        self.deck, self.report = deck, report
        self.contents = {}
        self.faces, self.faces_in_sets = [], set()
        self.links = []
        self.gaps = {}
        self.all_elements = []  # kind and index of all elements of all bodies
        for section in deck.sections:
            self.read(section)
        self.bodies = []
        self.make_bodies()
        self.find_nodes_of_links()
        if not self.points:
            raise DeckError("There is no section *NODE.")
        self.name_sets()
        self.remark_what_is_left_out()
        self.finish()

    def content_of(self, scope):
        return self.contents.setdefault(id(scope), Content())

    # Sections.

    def read(self, section):
        content = self.content_of(section.scope)
        if section.name in HIDDEN:
            section.line.fail(f"*{section.name} is not allowed: it makes or moves nodes or elements. Write the mesh with "
                              "*NODE and *ELEMENT alone, as Abaqus/CAE does.")
        readers = {"NODE": self.read_nodes, "ELEMENT": self.read_elements, "NSET": self.read_set,
                   "ELSET": self.read_set, "SURFACE": self.read_surface}
        if section.name in readers:
            section.is_read = True
            readers[section.name](section, content)
        elif section.name in GENERATORS:
            section.is_read = True
            if section.name == "ELGEN":
                generate_elements(section, content, Entry, set_of)
            else:
                generate_nodes(section, content, Entry, set_of)

    def read_nodes(self, section, content):
        system = key(section.get("SYSTEM"))
        if system not in ("", "R", "C", "S"):
            section.line.fail(f"*NODE with SYSTEM={system} is not allowed. Allowed are R, C and S.")
        section.get("NSET"), section.get("INPUT")
        entries = set_of(content.node_sets, section.get("NSET")).entries if section.get("NSET") else None
        for line in section.lines:
            fields = fields_of(line.text)
            if len(fields) < 3:
                line.fail("A node is a number and two or three coordinates, separated by commas.")
            number = line.integer(fields[0], "the number of a node")
            if number in content.nodes:
                line.fail(f"There are two nodes of number {number}.")
            if any(fields[4:]):
                self.report.count(line.place, "Fields of *NODE behind the coordinates are not used.")
            point = [line.real(text, "a coordinate of a node") if text else 0.0 for text in fields[1:4]]
            point += [0.0] * (3 - len(point))
            content.nodes[number] = cartesian(point, system) if system in ("C", "S") else point
            if entries is not None:
                entries.append(Entry.of_number(line, number))

    def read_elements(self, section, content):
        section.get("INPUT")
        if not section.has("TYPE"):
            section.line.fail("*ELEMENT has no TYPE.")
        kind = ElementType(key(section.get("TYPE")))
        self.check_type(section, kind)
        block = Block(kind)
        content.blocks.append(block)
        entries = set_of(content.element_sets, section.get("ELSET")).entries if section.get("ELSET") else None
        if kind.is_link:
            links = [self.link_of(line, kind) for line in section.lines]
            content.links += links
            block.elements = []
            if entries is not None:
                entries.extend(Entry.of_number(link.line, link.number) for link in links)
            return
        if self.is_left_out(kind):
            # One line each; sets may name them.
            self.report.count(section.line.place, f"*ELEMENT, TYPE={kind.name} is left out: such elements are neither "
                              "cells nor faces of cells.")
            block.elements = [(line.integer((fields_of(line.text) or [""])[0], "the number of an element"), (), line)
                              for line in section.lines]
        else:
            self.read_block(section, block)
        if entries is not None:
            entries.extend(Entry.of_number(line, number) for number, _, line in block.elements)

    @staticmethod
    def link_of(line, kind):
        fields = fields_of(line.text)
        if len(fields) != 3:
            line.fail(f"An element of type {kind.name} is a number and two nodes.")
        return LinkElement(kind.name, line.integer(fields[0], "the number of an element"), fields[1:], line)

    @staticmethod
    def read_block(section, block):
        n_nodes = block.type.n_nodes
        element, first = [], None
        for line in section.lines:
            first = first if element else line
            for field in fields_of(line.text):
                element.append(line.integer(field, "the number of a node" if element else "the number of an element"))
            if len(element) > n_nodes:
                if len(element) > n_nodes + 1:
                    break
                block.elements.append((element[0], tuple(element[1:]), first))
                element = []
        if element:
            first.fail(f"An element of this type has {n_nodes} nodes, and this one has {len(element) - 1}.")

    def is_left_out(self, kind):
        return kind.dimension + 1 < self.dimension or (kind.is_rigid and not kind.is_cube)

    def check_type(self, section, kind):
        begin = f"Elements of type {kind.name} are not allowed"
        allowed = " Allowed are hexahedra (C3D8, C3D8R, C3D20, ...) and faces of them (S4, ...)." \
            if self.dimension == 3 else \
            " Allowed are quadrilaterals (CPS4, CPE4, S4, ...) and edges of them (T2D2, B21)."
        if kind.n_nodes == 0:
            section.line.fail(begin + "." + allowed)
        if kind.dimension > self.dimension:
            section.line.fail(f"There are hexahedra ({kind.name}), and the scene has two dimensions. Allowed are "
                              "quadrilaterals; or leave --dimension 2 out.")
        if kind.dimension + 1 >= self.dimension and not kind.is_cube and not kind.is_rigid and kind.dimension > 0:
            section.line.fail(f"{begin}: they are {kind.shape()}.{allowed}{ADVICE[self.dimension]}")

    @staticmethod
    def read_set(section, content):
        is_of_nodes = section.name == "NSET"
        one = set_of(content.node_sets if is_of_nodes else content.element_sets, section.name_in(section.name))
        one.is_internal = section.has("INTERNAL") or one.is_internal
        instance = section.get("INSTANCE")
        section.get("INPUT")
        if is_of_nodes and section.get("ELSET"):
            one.with_nodes.append(Entry(section.line, section.get("ELSET")))
        generates = section.has("GENERATE")
        for line in section.lines:
            fields = fields_of(line.text)
            if generates:
                one.entries.append(Entry.of_range(line, fields, instance))
                continue
            for field in filter(None, fields):
                entry = Entry(line, field)
                entry.instance = entry.instance or instance
                one.entries.append(entry)

    def read_surface(self, section, content):
        kind = key(section.get("TYPE"))
        if kind not in ("", "ELEMENT", "NODE") or any(option in section.options for option in COMBINING):
            section.is_read = False
            return
        name = section.name_in("NAME")
        surface = content.surfaces.setdefault(key(name), Surface(name, kind == "NODE"))
        surface.is_internal = section.has("INTERNAL")
        for line in section.lines:
            fields = fields_of(line.text)
            if not 1 <= len(fields) <= 2:
                line.fail("A line of *SURFACE is an element or a set of elements and the name of a face.")
            surface.entries.append(Entry(line, fields[0]))
            surface.faces.append(key(fields[1]) if len(fields) > 1 and kind != "NODE" else "")

    # Bodies.

    def make_bodies(self):
        deck = self.deck
        self.add_body("", deck.outside, deck.outside)
        placed = set()
        for instance in deck.instances.values():
            scope = instance
            if not self.content_of(instance).nodes:
                scope = deck.parts.get(key(instance.part))
                if scope is None:
                    instance.line.fail(f'The instance "{instance.name}" is of the part "{instance.part}", and there is '
                                       "no such part.")
                placed.add(key(instance.part))
            self.add_body(instance.name, scope, instance)
        for part in deck.parts.values():
            if not deck.instances:
                self.add_body(part.name, part, part)
            elif key(part.name) not in placed:
                self.remarks.append(f'The part "{part.name}" has no instance: it is left out.')
        if deck.parts and not deck.instances:
            self.remarks.append("There is no *INSTANCE: the parts stay where they are.")

    def add_body(self, name, scope, instance):
        content = self.content_of(scope)
        body = Body(name, content, scope)
        self.bodies.append(body)
        place = self.placement_of(instance) if instance.placement else lambda point: point
        for number, point in content.nodes.items():
            body.nodes[number] = len(self.points)
            self.points.append(tuple(place(point)))
            self.numbers.append(number)
        for block in content.blocks:
            self.add_block(body, block)
        for link in content.links:
            self.add_link(body, link)

    def placement_of(self, instance):
        """Moved, then turned about an axis by two points and an angle in degrees."""
        wrong = ("Below *INSTANCE stand a line of three numbers (a translation) and perhaps a line of seven (two points of "
                 "an axis and an angle in degrees).")
        section = instance.placement
        rows = [[line.real(text, "a number of *INSTANCE") if text else 0.0 for text in fields_of(line.text)]
                for line in section.lines]
        for k, row in enumerate(rows):
            if k > 1 or (k == 0 and len(row) > 3) or (k == 1 and len(row) != 7):
                section.lines[k].fail(wrong)
        shift = (rows[0] if rows else []) + [0.0] * 3
        if len(rows) < 2 or rows[1][6] == 0:
            return lambda point: [x + s for x, s in zip(point, shift)]
        begin, end, angle = rows[1][:3], rows[1][3:6], rows[1][6]
        if begin == end:
            section.lines[1].fail(f'The two points of the axis that the instance "{instance.name}" is turned about are '
                                  "one point.")
        axis = [e - b for b, e in zip(begin, end)]
        written = ["(" + ", ".join(f"{x:g}" for x in v) + ")" for v in (shift[:3], begin, end)]
        self.remarks.append(f'The instance "{instance.name}" is moved by {written[0]} and then turned by {angle:g} degrees '
                            f"about the axis from {written[1]} to {written[2]}, as {section.line.place} and those after "
                            "it say.")
        return lambda point: turned([x + s for x, s in zip(point, shift)], begin, axis, angle)

    def add_block(self, body, block):
        n_corners = 2 ** block.type.dimension
        is_cell = block.type.dimension == self.dimension
        for number, named, line in block.elements:
            if number in body.elements:
                line.fail(f"There are two elements of number {number}.")
            if not named:
                body.elements[number] = (None, 0)
                continue
            nodes = []
            for node in named:
                if node not in body.nodes:
                    line.fail(f"There is no node of number {node}.")
                nodes.append(body.nodes[node])
            corners = tuple(nodes[:n_corners])
            if is_cell:
                body.elements[number] = ("cell", len(self.cells))
                self.cells.append(Cell(corners, line, number))
                if len(nodes) > n_corners:
                    self.add_midside_nodes(nodes, line)
            else:
                body.elements[number] = ("face", len(self.faces))
                self.faces.append((corners, line))

    def add_link(self, body, link):
        if link.number in body.elements:
            link.line.fail(f"There are two elements of number {link.number}.")
        body.elements[link.number] = ("link", len(self.links))
        of_body = LinkElement(link.type, link.number, link.names, link.line)
        of_body.prefix, of_body.body = body.name + "." if body.name else "", body
        self.links.append(of_body)

    def find_nodes_of_links(self):
        """When all bodies are there: a link of the assembly may name nodes of instances."""
        for link in self.links:
            nodes = [self.members(link.body, Entry(link.line, name), f"the element {link.number}", True)
                     for name in link.names]
            if any(len(one) != 1 for one in nodes):
                link.line.fail(f"The element {link.number} has two nodes, and each is a number or a set of one node.")
            link.nodes = tuple(node for one in nodes for node in one)

    def remark_links(self):
        """Of a mesh alone."""
        for link in self.links:
            self.report.count(link.line.place, f"*ELEMENT, TYPE={link.type} is left out: such elements are neither cells nor "
                              "faces of cells.")

    # Sets.

    def body_of(self, name, line):
        for body in self.bodies[1:]:
            if key(body.name) == key(name):
                return body
        names = ", ".join(f'"{body.name}"' for body in self.bodies[1:])
        return line.fail(f'There is no instance "{name}".' + (f" Instances are {names}." if names else ""))

    def members_of(self, body, one, is_of_nodes, outer=()):
        """Indices of nodes, or elements as kind and index, of a set."""
        members = {}
        of_what = f'the set "{one.name}"'
        names = set()
        for entry in one.entries:
            # A set that is named twice is looked up once, or nested sets would take exponential time.
            name = key(entry.instance + "." + entry.name)
            if entry.name and name in names:
                continue
            names.add(name)
            members.update(dict.fromkeys(self.members(body, entry, of_what, is_of_nodes, outer + (one,))))
        for entry in one.with_nodes:
            for kind, index in self.members(body, entry, of_what, False, ()):
                if kind:
                    nodes = self.cells[index].nodes if kind == "cell" else \
                        self.links[index].nodes if kind == "link" else self.faces[index][0]
                    members.update(dict.fromkeys(nodes))
        return list(members)

    def members(self, body, entry, of_what, is_of_nodes, outer=()):
        """Those of one entry. of_what is for messages."""
        what = "node" if is_of_nodes else "element"
        place = self.body_of(entry.instance, entry.line) if entry.instance else body
        if entry.name:
            sets = place.content.node_sets if is_of_nodes else place.content.element_sets
            found = sets.get(key(entry.name))
            if found is None:
                entry.line.fail(f'There is no set of {what}s "{entry.name}", which {of_what} names.')
            if found in outer:
                entry.line.fail(f'The set "{entry.name}" contains itself.')
            return self.members_of(place, found, is_of_nodes, outer)
        known = place.nodes if is_of_nodes else place.elements
        n_named = (entry.last - entry.first) // entry.step + 1
        # Of a range what exists is taken.
        if n_named > len(known):
            found = [index for number, index in known.items()
                     if entry.first <= number <= entry.last and (number - entry.first) % entry.step == 0]
        else:
            found = [known[number] for number in range(entry.first, entry.last + 1, entry.step) if number in known]
        if len(found) < n_named and not entry.is_range:
            entry.line.fail(f"There is no {what} of number {entry.first}, which {of_what} names.")
        if len(found) < n_named:
            self.gaps[entry.line.number, entry.line.file, of_what] = (f"{n_named - len(found)} of {n_named} {what}s of {of_what} "
                                                    f"({entry.line.place})")
        return found

    def add_element_set(self, name, members):
        cells = [index for kind, index in members if kind == "cell"]
        faces = [index for kind, index in members if kind == "face"]
        if faces:
            self.faces_in_sets.update(faces)
            self.add_surface(name, [self.faces[index] for index in faces])
        if cells:
            self.add_group(name, cells)

    def faces_of_cell(self, cell, face, line):
        n_faces = 6 if self.dimension == 3 else 4
        if face and not (len(face) == 2 and face[0] in "SE" and face[1] in "123456"[:n_faces]):
            line.fail(f'The face of an element is called "{face}". Allowed are S1 to S{n_faces}.')
        return [(self.face(cell, f), line) for f in range(n_faces) if not face or face[1] == str(f + 1)]

    def add_surface_of(self, name, body, surface):
        of_what = f'the surface "{surface.name}"'
        if surface.is_of_nodes:
            self.add_node_set(name, [node for entry in surface.entries
                                     for node in self.members(body, entry, of_what, True)])
            return
        faces = []
        for entry, face in zip(surface.entries, surface.faces):
            for kind, index in self.members(body, entry, of_what, False):
                if kind == "cell":
                    faces += self.faces_of_cell(index, face, entry.line)
                elif kind == "face":
                    self.faces_in_sets.add(index)
                    faces.append(self.faces[index])
        # Faces that are named by their elements alone are those on the boundary.
        self.add_surface(name, faces)

    def name_sets_of(self, body, prefix, is_wanted=lambda name: True):
        content = body.content
        for one in content.element_sets.values():
            if not one.is_internal and is_wanted(one.name):
                self.add_element_set(usable(prefix + one.name), self.members_of(body, one, False))
        for surface in content.surfaces.values():
            if is_wanted(surface.name):
                self.add_surface_of(usable(prefix + surface.name), body, surface)
        for one in content.node_sets.values():
            if not one.is_internal and is_wanted(one.name):
                self.add_node_set(usable(prefix + one.name), self.members_of(body, one, True))

    def name_sets(self):
        """Names of parts stand for the sets of all instances, where they mean one thing."""
        scopes = {}
        written = {}
        for body in self.bodies:
            content = body.content
            for name in [one.name for sets in (content.element_sets, content.node_sets) for one in sets.values()
                         if not one.is_internal] + [surface.name for surface in content.surfaces.values()]:
                scopes.setdefault(key(name), set()).add(id(content))
                if body is not self.bodies[0]:
                    written.setdefault(key(name), name)
        for body in self.bodies[1:]:
            self.name_sets_of(body, "", lambda name: len(scopes[key(name)]) == 1)
        ambiguous = [f'"{name}"' for k, name in written.items() if len(scopes[k]) > 1]
        if ambiguous:
            self.remarks.append("Several parts, or a part and the assembly, have sets called " + ", ".join(ambiguous) +
                                ". The sets of parts are called with their instances, as in "
                                f'"{self.bodies[1].name}.NAME".')
        self.name_sets_of(self.bodies[0], "")
        for body in self.bodies[1:]:
            self.name_sets_of(body, body.name + ".")
        known = set(self.groups)
        for body in self.bodies[1:]:
            cells = [index for kind, index in body.elements.values() if kind == "cell"]
            for name in dict.fromkeys((usable(body.scope.name), usable(body.name))):
                if name not in known and cells:
                    self.add_group(name, cells)

    def remark_what_is_left_out(self):
        in_sets = {cell for cells in self.groups.values() for cell in cells}
        if self.groups and len(in_sets) < len(self.cells):
            self.remarks.append("Some cells are in no ELSET.")
        if len(self.faces_in_sets) < len(self.faces):
            self.remarks.append(f"{len(self.faces) - len(self.faces_in_sets)} face elements (S4, CPS4, ...) are in no set: "
                                "they name no boundary.")
        if self.gaps:
            self.remarks.append("Ranges (GENERATE) name what does not exist, and what exists is taken. Missing are " +
                                ", ".join(self.gaps[place] for place in sorted(self.gaps)) + ".")

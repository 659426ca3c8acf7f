# SPDX-License-Identifier: LGPL-2.1-or-later
"""*SOLID SECTION and *RIGID BODY as parts."""

from ..mesh import usable
from ..scene import Part, integral, number
from .deck import key

NEED_DEGREE_1 = ("CONTACT PAIR", "CONTACT", "TIE", "RIGID BODY")


class Parts:
    """Makes the parts of a scene. rigid has the names of rigid parts by the indices of their reference nodes."""

    def __init__(self, converter):
        self.converter, self.scene, self.mesh = converter, converter.scene, converter.mesh
        self.rigid, self.used_materials = {}, {}
        self.free = {}  # entries of rigid parts that nothing holds, by name
        self.type_of_cell, self.thickness = {}, {}
        for body in self.mesh.bodies:
            for block in body.content.blocks:
                for element, _, _ in block.elements:
                    kind, index = body.elements.get(element, (None, 0))
                    if kind == "cell":
                        self.type_of_cell[index] = block.type.name
        for section in converter.deck.named("SOLID SECTION", "MEMBRANE SECTION", "SHELL SECTION"):
            if section.name == "SOLID SECTION" or self.mesh.dimension == 2:
                self.read_section(section)
        for section in converter.deck.named("RIGID BODY"):
            self.read_rigid(section)
        self.take_second_order()

    def take_second_order(self):
        """Cells of second order are elements of degree 2 where all of them are and nothing needs degree 1; where something
        does, each is divided into eight (four) of degree 1."""
        if not self.mesh.n_second_order:
            return
        if self.mesh.n_second_order < len(self.mesh.cells):
            self.converter.report.remark("Cells of second order are elements of degree 1 here, since other cells have it: they "
                                         "are stiffer in bending.")
            return
        self.scene.has_midsides = True
        needs_one = [name for name in NEED_DEGREE_1 if self.converter.deck.has(name)]
        if needs_one:
            self.scene.mesh_entries = {"Refine where": "abs(x) >= 0", "Refinement levels": "1"}
            self.converter.report.remark(f"Each cell of second order is {2 ** self.mesh.dimension} elements of degree 1 here, "
                                         f"since *{needs_one[0]} needs these.")
            return
        for part in self.scene.parts:
            part.formulation = "lagrange hexahedron"
            part.entries = {"Degree": "2", **part.entries}
        self.converter.report.remark("Cells of second order are elements of degree 2 here, whose nodes between the corners lie on "
                                     "straight edges.")

    def read_section(self, section):
        section.is_read = True
        name, material = section.name_in("ELSET"), section.name_in("MATERIAL")
        thickness = 0.0  # of solids there is none
        for row in section.rows():
            thickness = row.number(0)
        if key(material) not in self.converter.materials:
            section.line.fail(f'There is no *MATERIAL "{material}".')
        of_instances = self.converter.cells_of_instances(section.scope, section.line, name)
        if not of_instances:
            self.converter.report.note(section.line.place, f'*{section.name}: the set "{name}" has no cells.')
        for body, cells in of_instances:
            self.thickness.update(dict.fromkeys(cells, thickness or 1.0))
            self.add_part(section, f"{body.name}.{name}" if len(of_instances) > 1 else name, material, cells)

    def add_part(self, section, name, material, cells):
        """A part for each instance: they can touch."""
        group = self.converter.name_of_cells(cells, name)
        part_name = usable(group, ",/=#\\\"")
        types = {self.type_of_cell[cell] for cell in cells}
        kind = sorted(types)[0]
        if kind.startswith("CPS"):
            self.converter.report.note(section.line.place, f"elements {kind} are of plane stress; two dimensions are plane "
                                       "strain here.")
        formulation = "hexahedron" if self.is_one_point(kind) else "fully integrated hexahedron"
        self.used_materials.setdefault(key(material), self.converter.materials[key(material)])
        self.scene.parts.append(Part(part_name, group, formulation, usable(material, ",/=#\\\""),
                                     dict(self.converter.viscosity)))

    @staticmethod
    def is_one_point(kind):
        return kind.rstrip("THM").endswith("R")

    def read_rigid(self, section):
        """A body of cells that moves with a reference node."""
        section.is_read = True
        name = section.get("ELSET")
        cells = self.converter.cells_of(section.scope, section.line, name) if name else []
        nodes = self.mesh.nodes_of_groups([self.converter.name_of_cells(cells, name)]) if cells else set()
        parts = [part for part in self.scene.parts if part.group and self.scene.nodes_of_part(part) == nodes]
        if not parts:
            section.is_read = False
            self.converter.report.note(section.line.place, f'*RIGID BODY: the set "{name}" is not the cells of a '
                                       "*SOLID SECTION, and is left out.")
            return
        part = parts[0]
        part.formulation = "rigid"
        part.entries = {"Displacement": "; ".join(["free"] * self.mesh.dimension),
                        "Rotation": "free"}
        reference = section.name_in("REF NODE")
        nodes = self.converter.all_nodes_of(section.line, reference, section.scope)
        if len(nodes) != 1:
            section.line.fail(f'REF NODE="{reference}" of *RIGID BODY has {len(nodes)} nodes. Allowed is one.')
        node = nodes[0]
        part.entries["Origin"] = ", ".join(map(number, self.mesh.points[node][:self.mesh.dimension]))
        self.rigid[node] = part.name
        self.free[part.name] = dict(part.entries)

    def release(self):
        """Rigid parts as they are where a step prescribes nothing."""
        for name, entries in self.free.items():
            self.scene.part(name).entries = dict(entries)

    def drive(self, name, values, at_begin):
        """What a step prescribes of the reference node of a rigid part, and its displacements at the begin of the step."""
        part = self.scene.part(name)
        terms = ["free"] * self.mesh.dimension
        turns = {}
        for dof, (kind, text, last) in ((dof, value) for dof, value in values.items() if dof != "line"):
            if kind == "displacement" and at_begin[dof]:
                text = number(last - at_begin[dof]) if text == number(last) else f"{text} + {number(-at_begin[dof])}"
            if dof <= 3:
                if kind == "velocity" and text != "0":
                    text = self.integrated(values["line"], text)
                terms[dof - 1] = text
            elif dof <= 6:
                turns[dof - 4] = (kind, text)
        part.entries["Displacement"] = "; ".join(terms)
        part.entries.pop("Rotation", None)
        part.entries.pop("Angle", None)
        free = [axis for axis in ((0, 1, 2) if self.mesh.dimension == 3 else (2,)) if axis not in turns]
        moving = [axis for axis, (_, text) in turns.items() if text != "0"]
        if len(moving) > 1 or (moving and free) or len(free) == 2:
            values["line"].fail(f'the rotations of the rigid body "{name}" are prescribed in a way that is not possible '
                                "here: all are held or free, one is free, or one is prescribed.")
        if moving:
            kind, text = turns[moving[0]]
            part.entries["Angle"] = self.integrated(values["line"], text) if kind == "velocity" else text
        if moving or len(free) == 1:
            axis = moving[0] if moving else free[0]
            if self.mesh.dimension == 3:
                part.entries["Axis"] = ", ".join("1" if d == axis else "0" for d in range(3))
        if len(free) == 1 and self.mesh.dimension == 3:
            part.entries["Rotation"] = "about the axis"
        elif free:
            part.entries["Rotation"] = "free"

    def integrated(self, line, text):
        """A velocity as a displacement."""
        step, table = self.converter.step, self.converter.conditions.tables.get(text)
        if "t" not in text:
            return f"{text}*t"
        if not table or step.begin:
            line.fail("a velocity of a rigid body that changes in time is an amplitude in the first step here: prescribe its "
                      "displacement.")
        name, factor, points = table
        # An amplitude has its first value before, and its last value after its points.
        before = [(0.0, points[0][1])] if points[0][0] > 0 else []
        points = [*before, *points, (points[-1][0] + step.time, points[-1][1])]
        return f"{number(factor)}*table({self.scene.table(name + '_integrated', integral(points))}, t)"

    def push(self, name, dof, text):
        part = self.scene.part(name)
        terms = part.entries.get("Force", "; ".join(["0"] * self.mesh.dimension)).split("; ")
        terms[dof - 1] = text if terms[dof - 1] == "0" else f"{terms[dof - 1]} + {text}"
        part.entries["Force"] = "; ".join(terms)

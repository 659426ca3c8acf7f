# SPDX-License-Identifier: LGPL-2.1-or-later
"""The scene of a file of Abaqus."""

from ..mesh import usable
from ..scene import NotUnderstood, Scene, number, refuse_mixed_units
from ..text import DeckError
from .conditions import Conditions
from .contacts import Contacts
from .deck import key
from .histories import HistoryReader
from .initial import InitialConditions
from .links import LinkReader
from .materials import read_materials
from .mesh import COMBINING, Entry
from .parts import Parts
from .steps import Step, read_mass_scaling, read_output, steps_of



def scene_of(deck, mesh, target, report):
    return Converter(deck, mesh, target, report).scene


class Converter:
    def __init__(self, deck, mesh, target, report):
        self.deck, self.mesh, self.report = deck, mesh, report
        self.scene = Scene(deck.path, target, report, mesh)
        self.last_loads = {}
        for section in deck.named("HEADING"):
            if section.lines:
                self.scene.title = usable(section.lines[0].text) or self.scene.title
        self.materials = read_materials(deck)
        refuse_mixed_units((material.density, f'"{material.name}"', material.line.place)
                           for material in self.materials.values() if material.density)
        self.model, self.steps = steps_of(deck, report)
        self.has_mechanics = not self.steps or not all(step.is_heat_alone for step in self.steps)
        self.initial = InitialConditions(self)
        self.initial_temperature = self.initial.temperature
        self.viscosity = self.read_viscosity()
        self.parts = Parts(self)
        if not self.scene.parts:
            raise DeckError("there is no *SOLID SECTION with cells: nothing says of which material the cells are.")
        self.complete_materials()
        self.links, self.histories = LinkReader(self), HistoryReader(self)
        self.conditions, self.contacts = Conditions(self), Contacts(self)
        self.is_model, self.step = True, self.steps[0] if self.steps else Step(None, 1, 0.0)
        self.read_sections(self.model)
        self.is_model = False
        self.make_steps()
        self.initial.write()
        self.links.write()
        self.report_what_is_left_out()

    def complete_materials(self):
        has_heat = any(step.has_heat for step in self.steps)
        is_adiabatic = any(step.is_adiabatic for step in self.steps)
        is_at_rest = all(step.is_static for step in self.steps) and not has_heat
        steady = [step for step in self.steps if step.is_steady]
        steady_time = min((step.time for step in steady), default=0.0) if len(steady) == len(self.steps) else 0.0
        for step in steady if not steady_time else ():
            step.procedure.known.discard("STEADY STATE")
        for k, material in self.parts.used_materials.items():
            if material.density is None:
                self.scene.without_density.add(usable(material.name, ",/=#\\\""))
            if steady_time > 0:
                material.take_steady_heat(steady_time, self.mesh.largest_extent())
            if not self.has_mechanics:
                material.conduct_alone()
            self.scene.materials[usable(material.name, ",/=#\\\"")] = material.complete(
                has_heat, is_adiabatic, self.initial_temperature, is_at_rest)
            for remark in material.remarks:
                self.report.note(material.line.place, remark)
        for k, material in self.materials.items():
            if k not in self.parts.used_materials:
                self.report.note(material.line.place, f'*MATERIAL "{material.name}" is used by nothing.')

    def read_viscosity(self):
        for section in self.deck.named("BULK VISCOSITY"):
            rows = section.rows()
            if rows:
                return {"Linear bulk viscosity": number(rows[0].number(0, 0.06)),
                        "Quadratic bulk viscosity": number(rows[0].number(1, 1.2))}
        return {}

    def readers(self):
        return {**self.conditions.readers(), **self.contacts.readers(), "INITIAL CONDITIONS": self.initial.read,
                "AMPLITUDE": lambda section: section.rows()}

    def read_sections(self, sections):
        readers = self.readers()
        for section in sections:
            if section.name in readers:
                section.is_read = True
                try:
                    readers[section.name](section)
                except NotUnderstood as reason:
                    section.rows_so_far = None
                    section.options = {}
                    self.report.leave_out(section, section.lines, f"{reason}, so that this is left out "
                                          f"({section.line.place})")

    def make_steps(self):
        for step in self.steps:
            self.step = step
            self.conditions.begin_step()
            self.links.begin_step()
            for section in step.sections:
                if section.name == "OUTPUT":
                    read_output(section, step, self.scene)
                elif section.name in ("FIXED MASS SCALING", "VARIABLE MASS SCALING"):
                    self.read_mass_scaling(section, step)
            self.histories.read(step)
            self.read_sections(step.sections)
            names = self.conditions.conditions_of_step()
            self.links.end_step()
            entries = {**step.own_entries(), **step.entries}
            if len(self.steps) == 1:
                self.scene.end_time = step.time
                entries.pop("End time")
                for name, value in entries.items():
                    (self.scene.sections if isinstance(value, dict) else self.scene.head)[name] = value
            else:
                entries["Conditions"] = ", ".join(names)
                self.scene.stages[step.name] = entries
                self.scene.end_time = self.scene.end_time or step.time
            if len(self.steps) > 1 and self.parts.rigid:
                for part in self.scene.parts:
                    if part.formulation == "rigid":
                        self.scene.stages[step.name][f"Part: {part.name}"] = {"rigid": dict(part.entries)}

    def read_mass_scaling(self, section, step):
        """That of a set of elements is understood where it has all cells."""
        name = section.get("ELSET")
        if not name or len(self.cells_of(None, section.line, name)) == len(self.mesh.cells):
            read_mass_scaling(section, step)

    def report_what_is_left_out(self):
        for k, amplitude in self.conditions.amplitudes.items():
            if k not in self.conditions.used_amplitudes:
                self.report.note(amplitude.section.line.place, f'*AMPLITUDE "{amplitude.name}" is used by nothing.')
        for section in self.deck.sections:
            if section.is_read:
                section.report_unused(self.report)
            else:
                self.report.leave_out(section, section.lines)

    # Names of the deck.

    def bodies_of(self, scope):
        content = self.mesh.content_of(scope)
        return [body for body in self.mesh.bodies if body.content is content] or self.mesh.bodies[:1]

    def elements_of(self, line, text, scope=None):
        """Kind and index of the elements of a set or a number."""
        entry = Entry(line, text)
        bodies = self.bodies_of(scope or self.deck.outside)
        if entry.name and not entry.instance and not any(key(entry.name) in body.content.element_sets for body in bodies):
            bodies = [body for body in self.mesh.bodies if key(entry.name) in body.content.element_sets] or bodies
        return list(dict.fromkeys(member for body in bodies
                                  for member in self.mesh.members(body, entry, "a keyword", False)))

    def cells_of(self, scope, line, text):
        return sorted(index for kind, index in self.elements_of(line, text, scope) if kind == "cell")

    def cells_of_instances(self, scope, line, text):
        """Each body of a scope that has cells of a set, and these."""
        bodies = self.bodies_of(scope)
        if len(bodies) < 2:
            bodies = bodies[:1]
            result = [(bodies[0], self.cells_of(scope, line, text))]
        else:
            result = [(body, sorted(index for kind, index in self.mesh.members(body, Entry(line, text), "*SOLID SECTION",
                                                                               False) if kind == "cell"))
                      for body in bodies]
        return [(body, cells) for body, cells in result if cells]

    def name_of_cells(self, cells, name):
        """The group of these cells, a new one where there is none."""
        for group, members in self.mesh.groups.items():
            if members == cells:
                return group
        name = usable(name)
        while name in self.mesh.groups:
            name += " (cells)"
        self.mesh.groups[name] = cells
        return name

    def all_nodes_of(self, line, text, scope=None):
        entry = Entry(line, text)
        bodies = self.bodies_of(scope or self.deck.outside)
        if entry.name and not entry.instance and not any(key(entry.name) in body.content.node_sets for body in bodies):
            bodies = [body for body in self.mesh.bodies if key(entry.name) in body.content.node_sets] or bodies
        return list(dict.fromkeys(node for body in bodies
                                  for node in self.mesh.members(body, entry, "a keyword", True)))

    def nodes_of(self, line, text):
        """The nodes of a set or a number, those of cells."""
        return [node for node in self.all_nodes_of(line, text) if node in self.scene.nodes_of_cells()]

    def rigid_of(self, line, text):
        """The name of the rigid part whose reference node this is."""
        if not self.parts.rigid:
            return None
        nodes = self.all_nodes_of(line, text)
        return self.parts.rigid.get(nodes[0]) if len(nodes) == 1 else None

    def nodes_of_elements(self, line, text):
        return {node for cell in self.cells_of(None, line, text) for node in self.mesh.cells[cell].nodes}

    def faces_of_elements(self, line, text, face):
        faces = [one for cell in self.cells_of(None, line, text) for one, _ in self.mesh.faces_of_cell(cell, face, line)]
        return [one for one in faces if tuple(sorted(one)) in self.mesh.boundary_faces]

    def name_of_faces(self, faces, name):
        if not faces:
            raise NotUnderstood(f'the faces of "{name}" are not on the boundary')
        wanted = {tuple(sorted(face)) for face in faces}
        for known, members in self.mesh.surfaces.items():
            if {tuple(sorted(face)) for face in members} == wanted:
                return known
        return self.scene.new_surface(faces, usable(name))

    def surface_of(self, line, text):
        """The name of a surface in the mesh."""
        entry = Entry(line, text)
        bodies = [self.mesh.body_of(entry.instance, line)] if entry.instance else self.mesh.bodies
        name = entry.name or text
        if not name:
            raise NotUnderstood("one of its surfaces is not named, and a surface does not meet itself here")
        found = [(body, body.content.surfaces[key(name)]) for body in bodies if key(name) in body.content.surfaces]
        if not found:
            for section in self.deck.named("SURFACE"):
                if key(section.options.get("NAME", "")) == key(name):
                    option = next((one for one in COMBINING if one in section.options), "TYPE")
                    raise NotUnderstood(f'the *SURFACE "{text}" ({section.line.place}) is of {option}={section.get(option)}, which is '
                                        "not read")
            line.fail(f'There is no *SURFACE "{text}".')
        body, surface = found[0]
        prefix = body.name + "." if body.name else ""
        for candidate in (usable(prefix + surface.name), usable(surface.name)):
            if candidate in self.mesh.surfaces or candidate in self.mesh.node_sets:
                return candidate
        raise NotUnderstood(f'the surface "{text}" has no faces on the boundary')

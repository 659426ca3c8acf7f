# SPDX-License-Identifier: LGPL-2.1-or-later
"""The scene of a keyword file."""

from ..histories import Histories
from ..mesh import usable
from ..scene import NotUnderstood, Scene, number, refuse_mixed_units
from . import conditions, contacts, control, initial
from .cards import form_of
from .curves import Curves, Used
from .links import LinkReader
from .materials import EOS, MODELS, Material
from .parts import PartReader

OF_THE_MESH = ("KEYWORD", "TITLE", "INCLUDE", "INCLUDE_PATH", "INCLUDE_PATH_RELATIVE", "INCLUDE_TRANSFORM", "PARAMETER", "PARAMETER_LOCAL",
               "PARAMETER_EXPRESSION", "PARAMETER_EXPRESSION_LOCAL", "DEFINE_TRANSFORMATION", "NODE", "ELEMENT_SOLID", "ELEMENT_SOLID_H20", "ELEMENT_SOLID_H27", "ELEMENT_SHELL")
# Of these a field that is not understood leaves the thing out: it would act elsewhere, or at another time.
STRICT = {**conditions.RECORDS, **initial.RECORDS, **contacts.RECORDS}
OF_PLACES = ("RIGIDWALL_", "INITIAL_VELOCITY_GENERATION", "DEFINE_COORDINATE", "DEFINE_VECTOR", "DEFINE_BOX")
# They depend on others, or count where others do as well.
LAST = ("CONTACT_", "INITIAL_VELOCITY_NODE")


def scene_of(deck, mesh, target, report):
    return Converter(deck, mesh, target, report).scene


def refuse_moved(section):
    """What has places or units and stands in a file that *INCLUDE_TRANSFORM moves or scales: nodes alone are."""
    has_units = section.name not in OF_THE_MESH and not section.name.startswith(("SET_", "PART", "SECTION_SOLID", "DATABASE_HISTORY"))
    if section.name.startswith(OF_PLACES) and section.transform.moves() or has_units and section.transform.lengths() != 1:
        section.line.fail(f"*{section.keyword} is in a file of *INCLUDE_TRANSFORM, which moves or scales the nodes alone here. Write "
                          "it into a file that is as it is.")


class Converter:
    def __init__(self, deck, mesh, target, report):
        deck.report = report
        self.deck, self.mesh, self.report = deck, mesh, report
        self.scene = Scene(deck.path, target, report, mesh)
        self.records, self.integrated, self.intervals = [], {}, []
        self.histories = Histories(self.scene, self.scene.output())
        for section in deck.sections:
            section.is_read = getattr(section, "is_read", False) or section.name in OF_THE_MESH
            refuse_moved(section)
            if section.name == "TITLE" and section.lines:
                self.scene.title = usable(section.lines[0].text) or self.scene.title
        self.curves = Curves(deck, report)
        self.systems, self.vectors = conditions.local_systems(deck), conditions.vectors(deck)
        self.records += [curve.record for curve in self.curves.values()]
        self.read_materials()
        self.forms = self.by_number("SECID", *deck.named(
            "SECTION_SOLID", "SECTION_SOLID_SPG", *(("SECTION_SHELL",) if mesh.dimension == 2 else ())))
        self.viscosity = {}
        for section in deck.named("CONTROL_BULK_VISCOSITY"):
            for record in section.records():
                self.viscosity = {"Linear bulk viscosity": number(record.number("Q2") or 0.06),
                                  "Quadratic bulk viscosity": number(record.number("Q1") or 1.5)}
        self.links = LinkReader(self)
        self.parts = PartReader(self)
        self.links.connect()
        for material in self.materials.values():
            self.scene.materials[f"material {material.number}"] = material.entries()
            for remark in material.remarks:
                report.note(material.line.place, remark)
        for record in self.records_of(*deck.named("CONTROL_TERMINATION")):
            control.termination(self, record)
        conditions.hold_nodes(self)
        for section in sorted(deck.sections, key=lambda section: section.name.startswith(LAST)):
            self.read(section)
        self.links.write()
        control.intervals_of_histories(self)
        self.curves.remark_early_ends(self.scene.end_time)
        self.report_what_is_left_out()

    def read_materials(self):
        self.materials = Used()
        for section in self.deck.sections:
            if form_of(section.name) in MODELS:
                for record in self.records_of(section):
                    material = Material(record, self.curves)
                    self.materials.define(material.number, material, section)
        refuse_mixed_units((material.density, material.number, material.line.place)
                           for material in self.materials.values())
        self.equations = self.by_number("EOSID", *(
            section for section in self.deck.sections if form_of(section.name) in EOS))
        self.thermal = self.by_number("TMID", *(
            section for section in self.deck.sections if form_of(section.name) == "MAT_THERMAL_ISOTROPIC"))

    def by_number(self, field, *sections):
        """Records by the number that a field of them has."""
        result = Used()
        for record in self.records_of(*sections):
            result.define(record.integer(field), record, record.section)
        return result

    def unread_material(self, number_of_material):
        """Words for a material of a kind that is not read, or that is not there."""
        for section in self.deck.sections:
            if section.name.startswith("MAT_") and not section.name.startswith("MAT_ADD") and not section.is_read:
                _, lines = section.titled(section.lines) if section.lines else ("", [])
                if lines and section.fields(lines[0])[:1] == [str(number_of_material)]:
                    return f"*{section.keyword} ({section.line.place}), which is not read"
        return "not there"

    def heat_of(self, record, density):
        """*MAT_THERMAL_ISOTROPIC, whose capacity is that of a density of its own (TRO) where it has one."""
        share = (record.number("TRO") or density) / density
        temperature = 0.0
        for section in self.deck.named("INITIAL_TEMPERATURE_SET"):
            for one in section.records():
                if one.peek("NSID") == 0:
                    temperature = one.peek("TEMP")
        return {"Specific heat capacity": number(share * record.number("HC")), "Conductivity": number(record.number("TC")),
                "Initial temperature": number(temperature)}

    def records_of(self, *sections):
        """The records of sections that are used."""
        records = []
        for section in sections:
            section.is_read = True
            records += section.records()
        self.records += records
        return records

    def forget(self, record):
        self.records.remove(record)

    def read(self, section):
        name = section.name
        if name in control.RECORDS and name != "CONTROL_TERMINATION":
            for record in self.records_of(section):
                control.RECORDS[name](self, record)
        for table in (conditions.SECTIONS, control.SECTIONS):
            if name in table:
                section.is_read = True
                try:
                    table[name](self, section)
                except NotUnderstood as reason:
                    self.leave_out(section, section.lines, section.line.place, reason)
        reader = STRICT.get(name) or (contacts.contact if name.startswith("CONTACT_") else None)
        if reader:
            section.is_read = True
            for record in section.records():
                self.read_record(section, record, reader)

    def read_record(self, section, record, reader):
        try:
            things = list(reader(self, record))
            self.refuse_unused(record)
        except NotUnderstood as reason:
            self.leave_out(section, record.lines, record.line.place, reason)
            return
        for kind, word, entries in things:
            if entries:
                self.scene.add(kind, word, entries, record.line.place + (f": {record.title}" if record.title else ""))

    @staticmethod
    def refuse_unused(record):
        unused = record.unused()
        if unused:
            raise NotUnderstood(", ".join(f"{field.name} = {field.text}" for field in unused) + " is not understood")

    def attempt(self, section, lines, action, *arguments):
        """Does something with lines of a section, or leaves them out."""
        try:
            action(*arguments)
        except NotUnderstood as reason:
            self.leave_out(section, lines, lines[0].place, reason)

    def each_record(self, section, read):
        """Reads the records of a section, and leaves those out that are not understood."""
        left_out = {}
        for record in section.records():
            try:
                read(record)
            except NotUnderstood as reason:
                left_out.setdefault(str(reason), []).extend(record.lines)
        for reason, lines in left_out.items():
            self.leave_out(section, lines, lines[0].place, reason)

    def leave_out(self, section, lines, place, reason):
        self.report.leave_out(section, lines, f"{reason}, so that this is left out ({place})")

    def report_what_is_left_out(self):
        for things in (self.curves, self.equations, self.forms, self.thermal, self.links.forms, self.links.materials):
            for thing_number, thing in things.unused():
                record = getattr(thing, "record", thing)
                if record in self.records:
                    self.records.remove(record)
                self.report.note(record.line.place, f"*{record.section.keyword} {thing_number} is used by nothing.")
        for record in self.records:
            for field in record.unused():
                self.report.unused(field.line.place, record.section.keyword, f"{field.name} = {field.text}")
        for section in self.deck.sections:
            if not section.is_read and not section.name.startswith("SET_"):
                self.report.leave_out(section, section.lines)

    # What readers of cards ask.

    def boundary(self, kind, number_of_set, record):
        """The name of a set of nodes or segments."""
        return self.name_of_set(kind, number_of_set, record.section.line)

    def name_of_set(self, kind, number_of_set, line):
        """The name of a set that a line names."""
        name = self.mesh.names.get((kind, number_of_set))
        if name is None:
            of_set = self.mesh.sets.not_read.get((kind, number_of_set))
            if of_set:
                raise NotUnderstood(f"the {kind} {number_of_set} is a *{of_set.keyword} ({of_set.line.place}), which is not "
                                    "read")
            line.fail(f"there is no {kind} {number_of_set}.")
        return name

    def members(self, record, field="NSID"):
        """The nodes of the set that a field names."""
        number_of_set = record.integer_of(field, "S")
        if number_of_set == 0:
            return sorted(self.scene.nodes_of_cells())
        name = self.boundary("node set", number_of_set, record)
        if name not in self.mesh.node_sets:
            raise NotUnderstood(f"the node set {number_of_set} has no nodes of cells")
        return self.mesh.node_sets[name]

    def nodes_named_by(self, record):
        """All nodes that NSID or NID names, also those of no cell."""
        if "NSID" not in record.fields:
            return [self.mesh.node(record.integer("NID"), record.line)]
        number_of_set = record.integer("NSID")
        if number_of_set == 0:
            return self.members(record)
        return self.mesh.all_node_sets[self.boundary("node set", number_of_set, record)]

    def node_set(self, record, field="NSID"):
        """Entries that select the nodes of a set."""
        nodes = self.members(record, field)
        return self.scene.selection(nodes, self.mesh.names.get(("node set", record.integer_of(field, "S")), ""))

    def nodes_as_parts(self, nodes):
        """Entries of an initial condition."""
        entries = self.scene.at_start(nodes)
        if entries is None:
            raise NotUnderstood("its nodes are neither those of parts nor those of a box")
        return entries

    def part_names(self, numbers):
        names = [self.parts.names[part] for part in numbers if part in self.parts.names]
        if len(names) < len(numbers):
            missing = [str(part) for part in numbers if part not in self.parts.names]
            raise NotUnderstood(f"the part {', '.join(missing)} has no solid elements")
        return ", ".join(names)

    def until_the_end(self, record, field):
        """Reads a time of death that is none before the end."""
        end = self.scene.end_time
        if end and field in record.fields and record.fields[field].says_something() and record.peek(field) >= end:
            record.number(field)

    def numerical(self, record, field):
        """A field that is not used, and without which the thing is nearly the same."""
        found = record.fields.get(field)
        if found and found.says_something():
            found.is_read = True
            self.report.unused(found.line.place, record.section.keyword, f"{field} = {found.text}")

    def table(self, curve):
        """The file of a curve of time."""
        if curve in self.integrated:
            return self.scene.table(f"curve_{curve}", self.integrated[curve])
        return self.scene.table(f"curve_{curve}", self.curves[curve].points)

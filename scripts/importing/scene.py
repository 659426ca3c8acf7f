# SPDX-License-Identifier: LGPL-2.1-or-later
"""The parameter file of a keyword file."""

import os

from .conditions import Conditions
from .deck import KeywordError
from .layouts import PARTS
from .materials import Material, kind_of, refuse_mixed_units, unit_labels
from .report import Report
from .solids import elements_and_nodes, is_of_the_mesh, names_of_sets

ELEMENTS_OF_ELFORM = {0: "hexahedron", 1: "hexahedron"}  # others: fully integrated hexahedron
PARTICLES = "momentum consistent particle"


def usable(name):
    """A name without what separates names in a list or sections in a path."""
    return " ".join("".join(" " if c in ",/=#\\" else c for c in name).split())


class Curve:
    """*DEFINE_CURVE."""

    def __init__(self, section, report):
        record, lines = section.head()
        self.record, self.line = record, section.line
        self.number = record.integer("LCID")
        scale_x, scale_y = record.number("SFA") or 1, record.number("SFO") or 1
        offset_x, offset_y = record.number("OFFA"), record.number("OFFO")
        self.points = []
        for line in lines:
            if line.text.strip():
                point = section.values(line, 20)
                self.points.append((scale_x * (point[0] + offset_x), scale_y * (point[1] + offset_y)))
                if any(point[2:]):
                    report.count(line.place, f"a card of *{section.keyword} has more than two numbers.")


class Used(dict):
    """Things by their numbers, which count as used once they were looked up."""

    def __init__(self, things=()):
        super().__init__(things)
        self.used = set()

    def __getitem__(self, number):
        self.used.add(number)
        return super().__getitem__(number)

    def unused(self):
        return [(number, thing) for number, thing in self.items() if number not in self.used]


class Scene:
    def __init__(self, deck, target):
        self.source, self.target = deck.path, target
        self.sections = deck.sections
        self.report = Report()
        self.understood = set()
        self.records = []
        self.title = usable(self.source.stem)
        self.with_cells, self.held = elements_and_nodes(self.sections, self.report)
        if not self.with_cells:
            raise KeywordError("there are no hexahedra (*ELEMENT_SOLID): cells of other shapes, shells among them, "
                               "are no cells here.")
        self.curves = Used()
        for section in self.named("DEFINE_CURVE"):
            curve = Curve(section, self.report)
            self.curves[curve.number] = curve
            self.records.append(curve.record)
        self.materials = {}
        for section in self.sections:
            if kind_of(section.name):
                for record in self.records_of(section):
                    material = Material(record, self.curves)
                    self.materials[material.number] = material
        refuse_mixed_units(self.materials.values())
        self.equations = Used((record.integer("EOSID"), record)
                              for record in self.records_of(*self.named("EOS_GRUNEISEN")))
        self.forms = Used((record.integer("SECID"), record)
                          for record in self.records_of(*self.named("SECTION_SOLID", "SECTION_SOLID_SPG")))
        self.has_contact_of_all = any(section.name.startswith("CONTACT_") and "SINGLE_SURFACE" in section.name
                                      for section in self.sections)
        self.parts = list(self.read_parts())
        self.end_time = None
        for record in self.records_of(*self.named("CONTROL_TERMINATION")):
            self.end_time = record.number("ENDTIM")
        self.conditions = Conditions(self, names_of_sets(self.sections, self.held, self.report))
        for section in self.sections:
            if section.name == "TITLE" and section.lines:
                self.title = usable(section.lines[0].text) or self.title
            if self.conditions.read(section):
                self.understood.add(section)
        self.report_what_is_left_out()
        self.text = "\n".join(self.lines()) + "\n"

    def named(self, *names):
        return [section for section in self.sections if section.name in names]

    def records_of(self, *sections):
        """The records of sections that are understood."""
        records = []
        for section in sections:
            self.understood.add(section)
            records += section.records()
        self.records += records
        return records

    def report_what_is_left_out(self):
        for things in (self.curves, self.equations, self.forms):
            for number, thing in things.unused():
                record = getattr(thing, "record", thing)
                self.records.remove(record)
                self.report.note(record.line.place, f"*{record.section.keyword} {number} is used by nothing.")
        for record in self.records:
            self.report.unused_fields(record.section.keyword, record.unused())
        for section in self.sections:
            if section not in self.understood and not is_of_the_mesh(section) and section.name != "DEFINE_CURVE":
                self.report.leave_out(section, section.lines)

    def files(self):
        directory = self.target.parent
        files = {self.target: self.text}
        for number in self.conditions.tables:
            rows = "".join(f"{x:.10g}, {y:.10g}\n" for x, y in self.curves[number].points)
            files[directory / self.table_name(number)] = f"# curve {number} of {self.source.name}\n{rows}"
        return files

    def table_name(self, number):
        return f"{self.target.stem}_curve_{number}.csv"

    def read_parts(self):
        """Names of parts, their numbers and the lines of their sections."""
        taken = set()
        for record in self.records_of(*self.named(*PARTS)):
            number = record.integer("PID")
            if number not in self.with_cells:
                self.report.note(record.line.place, f'the part {number} "{record.title}" has no solid elements.')
                self.records.remove(record)
                continue
            form, material, equation = (record.integer(field) for field in ("SECID", "MID", "EOSID"))
            if equation in self.equations and material in self.materials:
                if not self.materials[material].equation:
                    self.materials[material].give_equation(self.equations[equation])
            elif equation:
                self.report.note(record.line.place, f"the equation of state {equation} of part {number} is not "
                                 "understood.")
            if material not in self.materials:
                self.report.note(record.line.place, f"the material {material} of part {number} is not understood: "
                                 "write its section.")
            if form not in self.forms:
                self.report.note(record.line.place, f"there is no *SECTION_SOLID {form}: part {number} is of "
                                 "one-point hexahedra.")
            name = usable(record.title) or f"part {number}"
            if name in taken:
                name += f" ({number})"
            taken.add(name)
            yield name, number, list(self.lines_of_part(
                name, number, self.forms[form] if form in self.forms else None, material))

    def lines_of_part(self, name, number, form, material):
        elform = form.integer("ELFORM") if form is not None else 1
        is_spg = form is not None and form.name == "SECTION_SOLID_SPG"
        formulation = PARTICLES if is_spg else ELEMENTS_OF_ELFORM.get(elform, "fully integrated hexahedron")
        of_material = self.materials.get(material)
        viscosity = ["set Linear bulk viscosity    = 0.06", "set Quadratic bulk viscosity = 1.5"] \
            if of_material and of_material.equation else []
        limits = []
        if of_material and of_material.failure_strain:
            limits.append(f"set Erosion strain = {of_material.failure_strain:.10g}")
        if of_material and of_material.has_damage:
            limits.append("set Erosion damage = 1")
        yield f"subsection Part: {name}"
        yield f"  set Cells       = group part {number}"
        yield f"  set Formulation = {formulation}"
        yield f"  set Material    = {self.name_of_material(material)}"
        if is_spg:
            yield f"  subsection {formulation}"
            yield from ("    " + line for line in self.lines_of_spg(form, self.has_contact_of_all))
            yield from ("    " + line for line in viscosity)
            yield "  end"
        elif limits or viscosity:
            yield f"  subsection {formulation}"
            yield from ("    " + line for line in limits + viscosity)
            yield "  end"
        yield "end"

    @staticmethod
    def lines_of_spg(form, touches_itself):
        """*SECTION_SOLID_SPG. Fragments touch each other where bonds break and the file has a contact of
        everything with itself."""
        sizes = [form.number(field) for field in ("DX", "DY", "DZ")]
        if any(sizes):
            yield f"set Dilation = {max(sizes):.10g}   # DX, DY, DZ = " + ", ".join(f"{s:g}" for s in sizes)
        kernel = form.integer("KERNEL")
        if kernel == 0:
            yield "set Configuration = updated Lagrangian"
            yield f"set Rebuild interval = {form.integer('SMSTEP') or 15}"
        elif kernel == 1:
            yield "set Configuration = current"
        if form.integer("IDAM") == 1 and form.number("FS") > 0:
            if touches_itself:
                yield "set Self-contact = true"
            yield "set Bond failure = effective plastic strain"
            yield "subsection effective plastic strain"
            yield f"  set Limit   = {form.number('FS'):.10g}"
            yield f"  set Stretch = {max(1, form.number('STRETCH')):.10g}"
            yield "end"

    def name_of_material(self, number):
        return f"material {number}"

    def lines(self):
        mesh = os.path.relpath(self.source, self.target.parent)
        yield f"# Written by scripts/import_keyword from {self.source.name}. Read it before it is run."
        units = unit_labels(self.materials.values())
        yield f"# The densities are those of metals in {units}." if units else \
            "# The densities do not tell the units; those of the file must be consistent."
        yield f"set Title              = {self.title}"
        yield "set Dimension          = 3"
        if self.end_time:
            yield f"set End time           = {self.end_time:.10g}"
        else:
            yield "# set End time = ...  There is no *CONTROL_TERMINATION."
        yield f"set Output directory   = output/{usable(self.source.stem)}"
        yield "set Parts              = " + ", ".join(name for name, _, _ in self.parts)
        yield "set Materials          = " + ", ".join(map(self.name_of_material, self.materials))
        yield from self.conditions.entries()
        yield from ("", "subsection Mesh", "  set Type = file", "  subsection file", f"    set File = {mesh}",
                    "  end", "end")
        for _, _, lines in self.parts:
            yield ""
            yield from lines
        for number, material in self.materials.items():
            yield ""
            yield from material.lines(self.name_of_material(number))
        yield from self.conditions.sections()
        yield from self.report.comments()

# SPDX-License-Identifier: LGPL-2.1-or-later
"""The parameter file of a keyword file."""

import os

from .deck import KeywordError
from .materials import Material, kind_of, refuse_mixed_units, unit_labels

# What the reader of the mesh takes, and what needs no words.
OF_THE_MESH = ("KEYWORD", "TITLE", "NODE", "ELEMENT_SOLID", "SET_", "PART", "DEFINE_CURVE", "SECTION_SOLID")
AXES = "xyz"
ELEMENTS_OF_ELFORM = {0: "hexahedron", 1: "hexahedron"}  # others: fully integrated hexahedron


def usable(name):
    """A name without what separates names in a list or sections in a path."""
    return " ".join("".join(" " if c in ",/=#" else c for c in name).split())


class Scene:
    def __init__(self, sections, source, target):
        self.sections = sections
        self.source, self.target = source, target
        self.understood = set()
        self.tables = {}       # curves that the parameter file names, by number
        self.notes = []
        self.curves = {}
        self.set_names = {}    # of boundaries, by kind and number
        self.conditions, self.initial_conditions, self.contacts = {}, {}, {}
        self.end_time = None
        for section in sections:
            if section.name in ("DEFINE_CURVE", "DEFINE_CURVE_TITLE"):
                self.read_curve(section)
        self.read_names_of_sets()
        self.materials = {material.number: material for material in self.read_materials()}
        refuse_mixed_units(self.materials.values())
        self.equations = {}    # of state, by number
        for section in sections:
            if section.name in ("EOS_GRUNEISEN", "EOS_GRUNEISEN_TITLE"):
                _, rest = section.title_and_rest()
                self.equations[rest.integer(0, 0)] = rest
        self.has_contact_of_all = any(section.name.startswith("CONTACT_") and "SINGLE_SURFACE" in section.name
                                      for section in sections)
        self.parts = list(self.read_parts())
        for section in sections:
            self.read_condition(section)
        self.left_out = [section for section in sections
                         if section not in self.understood and not section.name.startswith(OF_THE_MESH)]
        self.n_left_out = len(self.left_out)
        self.text = "\n".join(self.lines()) + "\n"

    def files(self):
        directory = self.target.parent
        files = {self.target: self.text}
        for number in self.tables:
            rows = "".join(f"{x:.10g}, {y:.10g}\n" for x, y in self.curves[number])
            files[directory / self.table_name(number)] = f"# curve {number} of {self.source.name}\n{rows}"
        return files

    def table_name(self, number):
        return f"{self.target.stem}_curve_{number}.csv"

    def read_curve(self, section):
        _, section = section.title_and_rest()
        scale_x, scale_y = section.number(0, 2) or 1, section.number(0, 3) or 1
        offset_x, offset_y = section.number(0, 4), section.number(0, 5)
        points = [(scale_x * (section.number(card, 0, widths=(20,)) + offset_x),
                   scale_y * (section.number(card, 1, widths=(20,)) + offset_y))
                  for card in range(1, len(section.cards)) if section.cards[card][1].strip()]
        self.curves[section.integer(0, 0)] = points

    def read_names_of_sets(self):
        """The names that the reader of the mesh gives to sets of nodes and segments."""
        taken = set()
        for section in self.sections:
            for keyword, kind in (("SET_NODE", "node set"), ("SET_SEGMENT", "segment set")):
                if not section.name.startswith(keyword):
                    continue
                title, rest = section.title_and_rest()
                default = f"{kind} {rest.integer(0, 0)}"
                name = title.replace(",", " ") or default
                if name in taken:
                    name += f" ({default})"
                taken.add(name)
                self.set_names[kind, rest.integer(0, 0)] = name

    def read_materials(self):
        for section in self.sections:
            name = section.name[:-len("_TITLE")] if section.name.endswith("_TITLE") else section.name
            if kind_of(name):
                self.understood.add(section)
                yield Material(section, self.curves)

    def read_parts(self):
        """Pairs of the name of a part and the lines of its section."""
        forms = {}
        for section in self.sections:
            if section.name.startswith("SECTION_SOLID"):
                _, rest = section.title_and_rest()
                forms[rest.integer(0, 0)] = rest
        with_cells = {int(fields[1]) for section in self.sections
                      if section.name.startswith("ELEMENT_SOLID")
                      for fields in [section.fields(card, (8,)) for card in range(len(section.cards))]
                      if len(fields) > 1 and fields[1].isdigit()
                      and (len(fields) == 2 or len(fields) >= 10 or not any(fields[2:]))}
        taken = set()
        for section in self.sections:
            if section.name not in ("PART", "PART_CONTACT", "PART_INERTIA"):
                continue
            step = 2 if section.name == "PART" else len(section.cards) or 2
            for card in range(0, len(section.cards) - 1, step):
                number, form, material, equation = (section.integer(card + 1, k) for k in range(4))
                if number not in with_cells:
                    continue
                if equation in self.equations and material in self.materials:
                    self.understood.update(s for s in self.sections if s.name.startswith("EOS_GRUNEISEN")
                                           and s.line == self.equations[equation].line)
                    if not self.materials[material].equation:
                        self.materials[material].give_equation(self.equations[equation])
                name = usable(section.cards[card][1]) or f"part {number}"
                if name in taken:
                    name += f" ({number})"
                taken.add(name)
                yield name, number, list(self.lines_of_part(name, number, forms.get(form), material))

    def lines_of_part(self, name, number, form, material):
        elform = form.integer(0, 1) if form is not None else 1
        is_spg = form is not None and (form.name == "SECTION_SOLID_SPG" or elform == 47)
        formulation = ("momentum consistent particle" if is_spg
                       else ELEMENTS_OF_ELFORM.get(elform, "fully integrated hexahedron"))
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
        """*SECTION_SOLID_SPG: DX DY DZ ISPLINE KERNEL - SMSTEP, then IDAM FS STRETCH. Fragments touch each
        other where bonds break and the file has a contact of everything with itself."""
        sizes = [form.number(1, k) for k in range(3)]
        if any(sizes):
            yield f"set Dilation = {max(sizes):.10g}   # DX, DY, DZ = " + ", ".join(f"{s:g}" for s in sizes)
        kernel = form.integer(1, 4)
        if kernel == 0:
            yield "set Configuration = updated Lagrangian"
            yield f"set Rebuild interval = {form.integer(1, 6) or 15}"
        elif kernel == 1:
            yield "set Configuration = current"
        if form.integer(2, 0) == 1 and form.number(2, 1) > 0:
            if touches_itself:
                yield "set Self-contact = true"
            yield "set Bond failure = effective plastic strain"
            yield "subsection effective plastic strain"
            yield f"  set Limit   = {form.number(2, 1):.10g}"
            yield f"  set Stretch = {max(1, form.number(2, 2)):.10g}"
            yield "end"

    def name_of_material(self, number):
        return f"material {number}"

    def read_condition(self, section):
        name = section.name
        if name == "CONTROL_TERMINATION":
            self.end_time = section.number(0, 0)
        elif name == "BOUNDARY_SPC_SET":
            for card in range(len(section.cards)):
                fixed = [section.integer(card, 2 + d) != 0 for d in range(3)]
                function = "; ".join("0" if is_fixed else "free" for is_fixed in fixed)
                self.add_condition("support", ("node set", section.integer(card, 0)), section,
                                   ["set Type     = clamp"] if all(fixed) else
                                   ["set Type     = displacement", f"set Function = {function}"])
        elif name == "BOUNDARY_PRESCRIBED_MOTION_SET" and self.is_simple_motion(section):
            for card in range(0, len(section.cards)):
                self.add_motion(section, card)
        elif name == "INITIAL_VELOCITY" and section.integer(0, 0) == 0:
            self.add_velocity(section, [section.number(1, d) for d in range(3)])
        elif name == "INITIAL_VELOCITY_GENERATION" and section.integer(0, 0) == 0 and not section.number(0, 2):
            self.add_velocity(section, [section.number(0, 3 + d) for d in range(3)])
        elif name == "RIGIDWALL_PLANAR" and len(section.cards) > 1:
            self.add_wall(section)
        else:
            return
        self.understood.add(section)

    def is_simple_motion(self, section):
        return all(section.integer(card, 1) in (1, 2, 3) and section.integer(card, 2) in (0, 2)
                   and section.integer(card, 3) in self.curves for card in range(len(section.cards)))

    def add_condition(self, word, boundary, section, lines):
        if boundary not in self.set_names:
            raise KeywordError(f"line {section.line}: there is no {boundary[0]} {boundary[1]}.")
        self.conditions[f"{word} {len(self.conditions) + 1}"] = (
            section.line, [f"set Boundary = {self.set_names[boundary]}"] + lines)

    def add_motion(self, section, card):
        axis = section.integer(card, 1) - 1
        kind = "velocity" if section.integer(card, 2) == 0 else "displacement"
        curve, factor = section.integer(card, 3), section.number(card, 4) or 1
        self.tables[curve] = True
        components = ["free"] * 3
        components[axis] = f"{factor:.10g}*table({self.table_name(curve)}, t)"
        self.add_condition("drive", ("node set", section.integer(card, 0)), section,
                           [f"set Type     = {kind}", "set Function = " + "; ".join(components)])

    def add_velocity(self, section, velocity):
        self.initial_conditions[f"flight {len(self.initial_conditions) + 1}"] = (
            section.line, ["set Velocity = " + "; ".join(f"{v:.10g}" for v in velocity)])

    def add_wall(self, section):
        tail = [section.number(1, d) for d in range(3)]
        head = [section.number(1, 3 + d) for d in range(3)]
        self.contacts[f"wall {len(self.contacts) + 1}"] = (
            section.line, ["set Surface  = plane", f"set Friction = {min(section.number(1, 6), 10):.10g}",
                           "subsection plane",
                           "  set Point  = " + ", ".join(f"{x:.10g}" for x in tail),
                           "  set Normal = " + ", ".join(f"{h - t:.10g}" for h, t in zip(head, tail)),
                           "end"])

    def lines(self):
        mesh = os.path.relpath(self.source, self.target.parent)
        yield f"# Written by scripts/import_keyword from {self.source.name}. Read it before it is run."
        units = unit_labels(self.materials.values())
        yield f"# The densities are those of metals in {units}." if units else \
            "# The densities do not tell the units; those of the file must be consistent."
        yield f"set Title              = {usable(self.source.stem)}"
        yield "set Dimension          = 3"
        if self.end_time:
            yield f"set End time           = {self.end_time:.10g}"
        else:
            yield "# set End time = ...  There is no *CONTROL_TERMINATION."
        yield f"set Output directory   = output/{usable(self.source.stem)}"
        yield "set Parts              = " + ", ".join(name for name, _, _ in self.parts)
        yield "set Materials          = " + ", ".join(map(self.name_of_material, self.materials))
        for entry, named in (("Conditions        ", self.conditions),
                             ("Initial conditions", self.initial_conditions),
                             ("Contacts          ", self.contacts)):
            if named:
                yield f"set {entry} = " + ", ".join(named)
        yield from ("", "subsection Mesh", "  set Type = file", "  subsection file", f"    set File = {mesh}",
                    "  end", "end")
        for _, _, lines in self.parts:
            yield ""
            yield from lines
        for number, material in self.materials.items():
            yield ""
            yield from material.lines(self.name_of_material(number))
        for word, named in (("Condition", self.conditions), ("Initial condition", self.initial_conditions),
                            ("Contact", self.contacts)):
            for name, (line, lines) in named.items():
                yield ""
                yield f"# line {line}"
                yield f"subsection {word}: {name}"
                yield from ("  " + line for line in lines)
                yield "end"
        if self.left_out:
            yield from ("", "# Not understood, with the line in the keyword file:")
        for section in self.left_out:
            if section.name.startswith("CONTACT"):
                yield ("# Contact here is with rigid surfaces (section \"Contact: NAME\") and between fragments of "
                       "a part of particles (Self-contact, without friction).")
            yield f"#   line {section.line}: *{section.name}"
            yield from (f"#     {text}" for _, text in section.cards)

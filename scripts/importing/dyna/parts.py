# SPDX-License-Identifier: LGPL-2.1-or-later
"""*PART and *SECTION_... as parts and their formulations."""

from ..mesh import usable
from ..scene import PARTICLES, Part, number
from .cards import PARTS
from .materials import Material

PLANE_STRESS, AXISYMMETRIC = 12, (14, 15)  # of *SECTION_SHELL
LAGRANGIAN = (-2, -1, 0, 1, 2, 3)  # those of solids that move with it, of one and of eight points
ELEMENTS_OF_ELFORM = {0: "hexahedron", 1: "hexahedron"}  # others: fully integrated hexahedron
# What CON1 of a rigid material holds, along the axes; CON2 about them.
HELD = {0: "", 1: "x", 2: "y", 3: "z", 4: "xy", 5: "yz", 6: "zx", 7: "xyz"}


class PartReader:
    """Makes the parts of a scene; their names by number are in names."""

    def __init__(self, converter):
        self.converter, self.scene, self.report = converter, converter.scene, converter.report
        self.names = {}
        self.rigid = set()  # numbers of rigid parts
        self.uses = {}      # equations of state with thermal materials, by numbers of materials
        self.touches_itself = any(section.name.startswith("CONTACT_") and
                                  ("SINGLE_SURFACE" in section.name or "AUTOMATIC_GENERAL" in section.name)
                                  for section in converter.deck.sections)
        taken = set()
        for record in converter.records_of(*converter.deck.named(*PARTS)):
            self.read(record, taken)

    def read(self, record, taken):
        converter, report = self.converter, self.report
        number_of_part = record.integer("PID")
        mesh = converter.mesh
        if number_of_part in converter.links.part_numbers:
            converter.links.parts[number_of_part] = record
            return
        if number_of_part not in mesh.part_names:
            report.note(record.line.place, f'the part {number_of_part} "{record.title}" has no solid elements.')
            converter.forget(record)
            return
        form, material, equation, thermal = (record.integer(field) for field in ("SECID", "MID", "EOSID", "TMID"))
        if equation and equation not in converter.equations:
            report.note(record.line.place, f"the equation of state {equation} of part {number_of_part} is not "
                        "understood.")
        if material not in converter.materials:
            report.note(record.line.place, f"the material {material} of part {number_of_part} is "
                        f"{converter.unread_material(material)}: write its section.")
        else:
            material = self.material_with(material, equation, thermal)
            if thermal and thermal not in converter.thermal:
                report.note(record.line.place, f"the thermal material {thermal} of part {number_of_part} is not understood.")
        if form not in converter.forms:
            report.note(record.line.place, f"there is no *SECTION_SOLID {form}: part {number_of_part} is of one-point "
                        "hexahedra.")
        name = usable(record.title, ",/=#\\\"") or f"part {number_of_part}"
        if name in taken:
            name += f" ({number_of_part})"
        taken.add(name)
        self.names[number_of_part] = name
        section = converter.forms[form] if form in converter.forms else None
        self.scene.parts.append(self.part(name, number_of_part, section, material))

    def material_with(self, number_of_material, equation, thermal):
        """The number of a material with these two; a further one where parts before have it with others."""
        converter = self.converter
        uses = self.uses.setdefault(number_of_material, [])
        is_new = (equation, thermal) not in uses
        if is_new:
            uses.append((equation, thermal))
        k = uses.index((equation, thermal)) + 1
        result = number_of_material if k == 1 else f"{number_of_material} ({k})"
        if is_new:
            if k > 1:
                record = converter.materials[number_of_material].record
                converter.materials.define(result, Material(record, converter.curves), record.section)
                converter.materials[result].number = result
            material = converter.materials[result]
            if equation in converter.equations:
                material.give_equation(converter.equations[equation])
            if thermal in converter.thermal:
                material.heat = converter.heat_of(converter.thermal[thermal], material.density)
        return result

    def part(self, name, number_of_part, section, material):
        name_of_material = f"material {material}"
        of_material = self.converter.materials.get(material)
        group = f"part {number_of_part}"
        if of_material and of_material.kind == "MAT_020":
            self.rigid.add(number_of_part)
            return Part(name, group, "rigid", name_of_material, self.rigid_motion(of_material.record))
        viscosity = dict(self.converter.viscosity)
        if of_material and of_material.equation:
            viscosity = viscosity or {"Linear bulk viscosity": 0.06, "Quadratic bulk viscosity": 1.5}
        if section is not None and section.name == "SECTION_SOLID_SPG":
            if of_material and (of_material.failure_strain or of_material.has_damage):
                self.report.note(of_material.line.place, f"part {number_of_part} is of particles: what breaks them is FS of its "
                                 "*SECTION, and not the failure of the material.")
            return Part(name, group, PARTICLES, name_of_material, {**self.entries_of_spg(section), **viscosity})
        elform = section.integer("ELFORM") if section is not None else 1
        limits = {}
        if of_material and of_material.failure_strain:
            limits["Erosion strain"] = number(of_material.failure_strain)
        if of_material and of_material.has_damage:
            limits["Erosion damage"] = 1
        formulation = ELEMENTS_OF_ELFORM.get(elform, "fully integrated hexahedron")
        if section is not None and section.name == "SECTION_SOLID" and elform not in LAGRANGIAN:
            self.report.note(section.line.place, f"*{section.section.keyword}: ELFORM = {elform} is no hexahedron of one or of "
                             "eight points; it is taken as fully integrated.")
        if self.scene.mesh.dimension == 2:
            formulation = "fully integrated hexahedron"
            self.check_plane(section, elform)
        return Part(name, group, formulation, name_of_material, {**limits, **viscosity})

    def check_plane(self, section, elform):
        if elform in AXISYMMETRIC:
            section.line.fail(f"ELFORM = {elform} is axisymmetric. Allowed is plane strain (ELFORM = 13).")
        if elform == PLANE_STRESS:
            self.report.note(section.line.place, "ELFORM = 12 is plane stress; two dimensions are plane strain here.")

    def entries_of_spg(self, form):
        """Fragments touch each other where bonds break and the file has a contact of everything with itself."""
        entries = {}
        form.integer("ELFORM")
        sizes = [form.number(field) for field in ("DX", "DY", "DZ")]
        if any(sizes):
            entries["#sizes"] = "DX, DY, DZ = " + ", ".join(f"{size:g}" for size in sizes)
            entries["Dilation"] = number(max(sizes))
        kernel = form.integer("KERNEL")
        if kernel == 0:
            entries["Configuration"] = "updated Lagrangian"
            entries["Rebuild interval"] = form.integer("SMSTEP") or 15
        elif kernel == 1:
            entries["Configuration"] = "current"
        if form.integer("IDAM") == 1 and form.number("FS") > 0:
            if self.touches_itself:
                entries["Self-contact"] = "true"
            entries["Bond failure"] = "effective plastic strain"
            entries["effective plastic strain"] = {"Limit": number(form.number("FS")),
                                                   "Stretch": number(max(1, form.number("STRETCH")))}
        return entries

    def rigid_motion(self, record):
        """What *MAT_020 leaves free, in global directions."""
        cmo = record.number("CMO")
        held, turns = ("", "") if cmo == 0 else \
            (HELD.get(record.integer("CON1"), ""), HELD.get(record.integer("CON2"), ""))
        if cmo not in (0, 1):
            self.report.note(record.line.place, "*MAT_RIGID: CMO is neither 0 nor 1, local constraints are not used: the "
                             "part is free.")
        entries = {"Displacement": "; ".join("0" if axis in held else "free"
                                             for axis in "xyz"[:self.scene.mesh.dimension])}
        if self.scene.mesh.dimension == 2:
            return entries if "z" in turns else {**entries, "Rotation": "free"}
        if turns == "xyz":
            return entries
        if len(turns) == 2:
            axis = (set("xyz") - set(turns)).pop()
            return {**entries, "Axis": ", ".join("1" if a == axis else "0" for a in "xyz"), "Rotation": "about the axis"}
        if len(turns) == 1:
            self.report.note(record.line.place, f"*MAT_RIGID: CON2 holds the rotation about {turns} alone, which is not "
                             "possible here: the part turns freely.")
        return {**entries, "Rotation": "free"}

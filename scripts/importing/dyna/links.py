# SPDX-License-Identifier: LGPL-2.1-or-later
"""*ELEMENT_DISCRETE with *SECTION_DISCRETE, *MAT_SPRING_ELASTIC and *MAT_DAMPER_VISCOUS as links."""

from ..links import Link, Links
from ..scene import NotUnderstood
from .cards import form_of

MODELS = ("MAT_S01", "MAT_S02")


class Element:
    """A card: numbers of the element and of its part, indices of its nodes, factor of the force, extension at the
    start; or the reason why it is left out."""

    def __init__(self, section, line, mesh):
        width, real = (20, 20) if section.is_long else (section.integer_width, 16)
        fields = section.columns(line, [width] * 5 + [real, width, real], 8)
        fields += [""] * (8 - len(fields))
        self.section, self.line, self.reason = section, line, ""
        numbers = [line.integer(text, "a number of an element") if text else 0 for text in fields[:5]]
        self.number, self.part = (section.transform.number(kind, n) for kind, n in zip("EP", numbers))
        self.factor = (line.real(fields[5]) if fields[5] else 0.0) or 1.0
        self.extension = line.real(fields[7]) if fields[7] else 0.0
        if numbers[3] == 0:
            self.reason = "N2 = 0, a spring to the ground, has no direction here"
        elif numbers[4] != 0:
            self.reason = f"VID = {numbers[4]} is not understood: links act along the line between their ends"
        self.nodes = () if self.reason else tuple(mesh.node(n, line, section.transform) for n in numbers[2:4])


class LinkReader:
    """Makes the links of a scene. parts has the *PART of elements, which PartReader gives."""

    def __init__(self, converter):
        self.converter, self.links = converter, Links(converter.scene)
        self.elements = [Element(section, line, converter.mesh) for section in converter.deck.named("ELEMENT_DISCRETE")
                         for line in section.lines if line.text.strip()]
        self.part_numbers = {element.part for element in self.elements}
        self.parts = {}
        sections = converter.deck.sections
        self.materials = converter.by_number("MID", *(section for section in sections if form_of(section.name) in MODELS))
        self.forms = converter.by_number("SECID", *converter.deck.named("SECTION_DISCRETE"))

    def connect(self):
        """Before the conditions: their ends are known."""
        for element in self.elements:
            element.section.is_read = True
            try:
                self.links.add(self.link(element))
            except NotUnderstood as reason:
                self.leave_out(element.section, element.line, element.number, reason)

    def link(self, element):
        if element.reason:
            raise NotUnderstood(element.reason)
        part = self.parts.get(element.part)
        if part is None:
            raise NotUnderstood(f"there is no *PART {element.part}")
        self.check_form(part.integer("SECID"))
        number_of_material = part.integer("MID")
        if number_of_material not in self.materials:
            raise NotUnderstood(f"its material {number_of_material} is "
                                f"{self.converter.unread_material(number_of_material)}")
        material = self.materials[number_of_material]
        is_spring = form_of(material.name) == "MAT_S01"
        constant = element.factor * material.number("K" if is_spring else "DC")
        return Link(f"{'spring' if is_spring else 'damper'} {element.number}", element.nodes, element.line.place,
                    stiffness=constant if is_spring else 0.0, damping=0.0 if is_spring else constant,
                    extension=element.extension if is_spring else 0.0)

    def check_form(self, number_of_form):
        """A link has nothing of what a section can say."""
        if number_of_form not in self.forms:
            raise NotUnderstood(f"there is no *SECTION_DISCRETE {number_of_form}")
        said = [f"{field.name} = {field.text}" for field in self.forms[number_of_form].unused()]
        if said:
            raise NotUnderstood(f"{', '.join(said)} of *SECTION_DISCRETE {number_of_form} is not understood")

    def leave_out(self, section, line, number, reason):
        self.converter.report.note(line.place, f"*{section.keyword} {number}: {reason}, so that this is left out.")

    def write(self):
        by_place = {element.line.place: element for element in self.elements}

        def leave_out(link, reason):
            element = by_place[link.place]
            self.leave_out(element.section, element.line, element.number, reason)
        self.links.write(leave_out)

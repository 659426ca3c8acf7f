# SPDX-License-Identifier: LGPL-2.1-or-later
"""*SPRING and *DASHPOT of elements SPRINGA, SPRING2, DASHPOTA and DASHPOT2 as links."""

from ..links import Link, Links
from ..scene import NotUnderstood, number

TYPES = {"SPRING": ("SPRINGA", "SPRING2"), "DASHPOT": ("DASHPOTA", "DASHPOT2")}


class LinkReader:
    """Makes the links of a scene."""

    def __init__(self, converter):
        self.converter, self.mesh, self.links = converter, converter.mesh, Links(converter.scene)
        self.left = dict(enumerate(self.mesh.links))  # elements without a section so far
        self.elements = {}  # by the names of links
        self.texts = []     # of the displacements of ends, by steps
        for section in converter.deck.named(*TYPES):
            self.read(section)
        for element in self.left.values():
            self.leave_out(element, "no *SPRING or *DASHPOT names it")

    def read(self, section):
        section.is_read = True
        elements = [index for kind, index in self.converter.elements_of(section.line, section.name_in("ELSET"), section.scope)
                    if kind == "link"]
        try:
            types = {self.mesh.links[index].type for index in elements}
            if not types.intersection(TYPES[section.name]):
                raise NotUnderstood(f"it is of no elements {' or '.join(TYPES[section.name])}")
            directions, constant = self.constant(section, any(one.endswith("2") for one in types))
        except NotUnderstood as reason:
            section.options, section.rows_so_far = {}, None
            self.converter.report.leave_out(section, section.lines, f"{reason}, so that this is left out "
                                            f"({section.line.place})")
            for index in elements:
                self.left.pop(index, None)
            return
        for index in elements:
            if self.mesh.links[index].type in TYPES[section.name] and index in self.left:
                self.add(section.name, self.left.pop(index), directions, constant)

    @staticmethod
    def constant(section, has_directions):
        """Degrees of freedom of the two nodes, where the first line has them, and the stiffness or the damping."""
        for option in ("NONLINEAR", "ORIENTATION", "COMPLEX STIFFNESS"):
            if option in section.options:
                raise NotUnderstood(f"{option} is not understood")
        rows = section.rows()
        directions = ()
        # Lines without any text are not among the rows.
        if rows and not any(rows[0].fields):
            rows = rows[1:]
        elif rows and has_directions:
            directions = tuple(rows[0].line.integer(rows[0].text(k), "a degree of freedom") if rows[0].text(k) else 0
                               for k in (0, 1))
            rows = rows[1:]
        if len(rows) != 1:
            raise NotUnderstood(f"it has {len(rows)} lines of constants, and one is understood")
        return directions, rows[0].number(0)

    def add(self, keyword, element, directions, constant):
        is_spring = keyword == "SPRING"
        try:
            if any(node in self.converter.parts.rigid for node in element.nodes):
                raise NotUnderstood("an end is the reference node of a rigid body, at which nothing can pull here")
            if element.type.endswith("2"):
                self.check_direction(element, directions)
            name = f"{'spring' if is_spring else 'damper'} {element.prefix}{element.number}"
            self.elements[name] = element
            self.links.add(Link(name, element.nodes, element.line.place, stiffness=constant if is_spring else 0.0,
                                damping=0.0 if is_spring else constant))
        except NotUnderstood as reason:
            self.leave_out(element, reason)

    def check_direction(self, element, directions):
        """Whether both degrees of freedom are those along the line between the nodes."""
        d = directions[0] - 1 if directions else -1
        points = [self.mesh.points[node] for node in element.nodes]
        across = [abs(b - a) for axis, (a, b) in enumerate(zip(*points)) if axis != d]
        if not 0 <= d < self.mesh.dimension or directions[0] != directions[1] or \
                max(across) > self.converter.scene.tolerance():
            raise NotUnderstood("its degrees of freedom are not those along the line between its nodes, along which links "
                                "act here")
        self.converter.report.count(element.line.place, f"elements {element.type} keep their direction; here it turns with "
                                    "the line between the nodes.")

    def leave_out(self, element, reason):
        self.converter.report.note(element.line.place, f"*ELEMENT, TYPE={element.type}, {element.prefix}{element.number}: "
                                   f"{reason}, so that this is left out.")

    # Ends in no cell, which a step holds or moves.

    def prescribe(self, nodes, values):
        """Values by degree of freedom as those of Conditions.held. Whether they are all those of ends in no cell."""
        texts = {dof - 1: text for dof, (kind, text, _) in values.items() if dof <= 3 and kind == "displacement"}
        return self.links.prescribe(nodes, texts)

    def begin_step(self):
        for texts in self.links.prescribed.values():
            texts.clear()

    def end_step(self):
        self.texts.append({node: dict(texts) for node, texts in self.links.prescribed.items()})

    def write(self):
        """The processes, with ends that move in other ways in further steps."""
        steps = list(zip(self.converter.steps, self.texts))
        for link in list(self.links.links):
            self.check(link, steps)
        if not steps:
            return
        self.links.prescribed = self.texts[0]
        self.links.write(lambda link, reason: self.leave_out(self.elements[link.name], reason))
        for link in self.links.links if len(steps) > 1 else ():
            _, entries = self.converter.scene.named["Processes"][link.name]
            # The length of a link is that of the start of the first step.
            entries["link"].setdefault("Length", number(self.links.length(link)))
            for step, texts in steps[1:]:
                self.links.prescribed = texts
                of_step = self.links.entries(link)
                if of_step.get("End") != entries["link"].get("End"):
                    self.converter.scene.stages[step.name][f"Process: {link.name}"] = {"link": {"End": of_step["End"]}}

    def check(self, link, steps):
        """Leaves out a link that is not possible in all steps."""
        try:
            if not steps:
                raise NotUnderstood("there is no step")
            for step, texts in steps:
                self.links.prescribed, where = texts, f'in the step "{step.name}" ' if step is not steps[0][0] else ""
                self.links.entries(link)
        except NotUnderstood as reason:
            self.links.links.remove(link)
            self.leave_out(self.elements[link.name], (where if steps else "") + str(reason))

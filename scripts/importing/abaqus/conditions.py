# SPDX-License-Identifier: LGPL-2.1-or-later
"""*BOUNDARY, *CLOAD, *DLOAD, *DSLOAD, films and fluxes."""

from ..node_forces import NodeForces
from ..scene import NotUnderstood, interpolated, number
from .deck import key
from .transforms import Transforms

SYMMETRIES = {"XSYMM": (1, 5, 6), "YSYMM": (2, 4, 6), "ZSYMM": (3, 4, 5), "ENCASTRE": (1, 2, 3, 4, 5, 6),
              "PINNED": (1, 2, 3), "XASYMM": (2, 3, 4), "YASYMM": (1, 3, 5), "ZASYMM": (1, 2, 6)}
# Options by which the numbers of a condition are others.
OTHER_MEANINGS = ("SUBMODEL", "USER", "IMAGINARY", "LOAD CASE", "TIME DELAY", "SECTOR", "FILM AMPLITUDE", "GEOSTATIC",
                  "SECTION POINTS", "REBAR", "FILE")
TEMPERATURE = 11
HEAT_ALONE = "all steps are *HEAT TRANSFER"
SMOOTH_STEPS = 20


def refuse_other_meanings(section):
    for option in OTHER_MEANINGS:
        if option in section.options:
            raise NotUnderstood(f"{option} is not understood")


class Amplitude:
    def __init__(self, section):
        self.section, self.name = section, section.name_in("NAME")
        self.is_total = key(section.get("TIME", "STEP TIME")).startswith("TOTAL")
        self.definition = key(section.get("DEFINITION", "TABULAR"))
        self.is_absolute = key(section.get("VALUE", "RELATIVE")) == "ABSOLUTE"
        numbers = [value for row in section.rows() for value in row.numbers()]
        self.points = list(zip(numbers[::2], numbers[1::2]))

    def points_at(self, begin):
        """Points over the time of a step that begins at a total time."""
        if self.definition not in ("TABULAR", "SMOOTH STEP"):
            raise NotUnderstood(f"the amplitude \"{self.name}\" has DEFINITION={self.definition} (TABULAR and SMOOTH STEP "
                                "are understood)")
        if self.is_absolute:
            raise NotUnderstood(f'the amplitude "{self.name}" has VALUE=ABSOLUTE (RELATIVE is understood)')
        times = [time for time, _ in self.points]
        if len(times) < 2 or any(b <= a for a, b in zip(times, times[1:])):
            self.section.line.fail(f'the times of the amplitude "{self.name}" must increase, of two points at least.')
        points = self.points
        if self.definition == "SMOOTH STEP":
            points = []
            for (t, a), (next_t, b) in zip(self.points, self.points[1:]):
                for k in range(SMOOTH_STEPS):
                    x = k / SMOOTH_STEPS
                    points.append((t + x * (next_t - t), a + (b - a) * x ** 3 * (10 - 15 * x + 6 * x * x)))
            points.append(self.points[-1])
        return [(time - (begin if self.is_total else 0), value) for time, value in points]


class Conditions:
    """Reads the conditions of steps. What is prescribed at nodes stays in further steps."""

    def __init__(self, converter):
        self.converter, self.mesh, self.scene, self.report = \
            converter, converter.mesh, converter.scene, converter.report
        self.amplitudes, self.used_amplitudes = {}, set()
        for section in converter.deck.named("AMPLITUDE"):
            one = Amplitude(section)
            if key(one.name) in self.amplitudes:
                section.line.fail(f'There are two of *AMPLITUDE called "{one.name}".')
            self.amplitudes[key(one.name)] = one
        self.transforms = Transforms(converter)
        self.held = {}     # by target: values by degree of freedom, as text, with the kind
        self.loads = {}    # entries of loads by what they act on, and by their number in the step where it is not the first
        self.of_step = set()  # those that the present step has said
        self.at_begin = {}   # displacements at the begin of the step, by target and degree of freedom
        self.begun = set()    # keywords whose OP=NEW a step has seen
        self.tables = {}      # name, factor and points of tables, by the texts of their functions
        self.last_texts = {}  # of their functions, and their last values
        self.of_total_time = {}  # amplitudes and their factors, by the texts of their functions

    # Functions of time.

    def function(self, section, value, before=0.0, is_load=True):
        """The text of a value in the time of the present step, and its last value."""
        step = self.converter.step
        name = section.get("AMPLITUDE")
        if name:
            amplitude = self.amplitudes.get(key(name))
            if amplitude is None:
                section.line.fail(f'There is no *AMPLITUDE "{name}".')
            self.used_amplitudes.add(key(name))
            return self.of_amplitude(amplitude, value)
        if step.ramps and step.time and value != before:
            time = "t" if step.time == 1 else f"t/{number(step.time)}"
            return f"{number(before)} + {number(value - before)}*{time}" if before else f"{number(value)}*{time}", value
        return number(value), value

    def of_amplitude(self, amplitude, value):
        """The same of a value times an amplitude."""
        step = self.converter.step
        points = amplitude.points_at(step.begin)
        suffix = f"_{step.name}" if amplitude.is_total and step.begin else ""
        name = "amplitude_" + "".join(c if c.isalnum() else "_" for c in amplitude.name + suffix)
        text = f"{number(value)}*table({self.scene.table(name, points)}, t)"
        self.tables[text] = name, value, points
        if amplitude.is_total:
            self.of_total_time[text] = amplitude, value
        return text, value * interpolated(points, step.time)

    def in_next_step(self, text, last):
        """A function that no further step gives anew stays as it is at the end, but for those of the total time."""
        return self.of_amplitude(*self.of_total_time[text]) if text in self.of_total_time else (number(last), last)

    # At nodes.

    def boundary(self, section):
        kind = {"": "displacement", "DISPLACEMENT": "displacement", "VELOCITY": "velocity"}.get(key(section.get("TYPE")))
        if kind is None:
            raise NotUnderstood(f"TYPE={section.get('TYPE')} is not understood (DISPLACEMENT and VELOCITY are)")
        fixed = section.has("FIXED")

        def read(row):
            target = row.text(0)
            words = key(row.text(1))
            if words in SYMMETRIES:
                for dof in SYMMETRIES[words]:
                    self.hold(section, row, target, dof, 0.0, kind)
                return
            if fixed:
                raise NotUnderstood("FIXED is not understood")
            first = row.line.integer(row.text(1), "a degree of freedom")
            last = row.line.integer(row.text(2), "a degree of freedom") if row.text(2) else first
            if last < first:
                row.line.fail(f"the last degree of freedom is {last}, and the first one is {first}.")
            for dof in range(first, last + 1):
                self.hold(section, row, target, dof, row.number(3), kind)
        self.each_row(section, read)

    def each_row(self, section, read):
        """Reads the rows of a keyword. Those that are not understood are left out, and others are used."""
        left_out = {}
        for row in section.rows():
            try:
                read(row)
            except NotUnderstood as reason:
                left_out.setdefault(str(reason), []).append(row)
        for reason, rows in left_out.items():
            self.report.leave_out(section, [row.line for row in rows], f"{reason}, so that this is left out "
                                  f"({rows[0].line.place})")
            for row in rows:
                row.is_read = [True] * len(row)

    def hold(self, section, row, target, dof, value, kind):
        if not (1 <= dof <= 6 or dof == TEMPERATURE):
            raise NotUnderstood(f"the degree of freedom {dof} is not understood (1 to 3 and {TEMPERATURE} are)")
        rigid = self.converter.rigid_of(row.line, target)
        if dof != TEMPERATURE and not self.converter.has_mechanics:
            self.report.count(row.line.place, f"*BOUNDARY: {HEAT_ALONE}, and displacements are not used.")
            return
        if 4 <= dof <= 6 and rigid is None:
            self.report.count(row.line.place, "Degrees of freedom 4 to 6 are not used: nodes of solids do not turn.")
            return
        if dof > self.mesh.dimension and dof <= 3:
            return
        name = key(target) if rigid is None else ("rigid", rigid)
        values = self.held.setdefault(name, {"line": row.line})
        at_start = 0.0
        if dof == TEMPERATURE:
            at_start = self.converter.initial.temperature_of(next(iter(self.converter.all_nodes_of(row.line, target)), None))
        before = values[dof][2] if dof in values and values[dof][0] == kind else self.at_begin.get((name, dof), at_start)
        step = self.converter.step
        if rigid is not None and value != 0 and kind == "displacement" and dof in values and values[dof][0] != kind:
            raise NotUnderstood("a rigid body with a velocity in the step before has no displacement here")
        if kind == "displacement" and dof != TEMPERATURE and not step.ramps and not step.is_static and value != 0 and \
                not section.get("AMPLITUDE") and not self.converter.is_model:
            raise NotUnderstood("a displacement without AMPLITUDE is a jump, which an explicit step does not have")
        text, last = self.function(section, value, before)
        values[dof] = (kind, text, last)

    def begin_step(self):
        """What was prescribed before goes on, and what has ended begins anew. Displacements of rigid parts count from the begin
        of a step."""
        if self.converter.step is not self.converter.steps[0]:
            self.at_begin = {(target, dof): last for target, values in self.held.items()
                             for dof, (kind, _, last) in self.items(values) if kind == "displacement"}
        self.of_step = set()
        last_loads = self.converter.last_loads
        self.converter.last_loads = {target: last_loads[target] for target in last_loads if target in self.loads}
        for values in self.held.values():
            for dof, (kind, text, last) in self.items(values):
                values[dof] = (kind, *self.in_next_step(text, last))
        for target, (word, entries, place) in list(self.loads.items()):
            if target in self.last_texts:
                text, last = self.last_texts[target]
                next_text, last = self.in_next_step(text, last)
                entries = {name: value.replace(text, next_text) if isinstance(value, str) else value
                           for name, value in entries.items()}
                self.loads[target] = (word, entries, place)
                self.last_texts[target] = (next_text, last)

    def conditions_of_step(self):
        """Names of conditions of what is held now."""
        names = []
        self.converter.parts.release()
        for targets, values in self.alike():
            line = values["line"]
            nodes = [node for target in targets for node in self.converter.all_nodes_of(line, target)]
            if self.converter.links.prescribe(nodes, dict(self.items(values))):
                continue
            try:
                groups = [(axes, self.selection(members)) for axes, members in self.transforms.groups(nodes)]
            except NotUnderstood as reason:
                self.report.note(line.place, f"*BOUNDARY of {', '.join(targets)}: {reason}, so that this is left out.")
                for target in targets:
                    del self.held[target]
                continue
            for axes, where in groups:
                names += self.conditions_at(where, axes, values)
        for word, entries, place in self.loads.values():
            if isinstance(word, tuple):
                self.converter.parts.push(*word, entries["Force"])
            else:
                names.append(self.add(word, entries, place, names))
        return names

    def conditions_at(self, where, axes, values):
        """Of nodes with these axes."""
        for kind in ("displacement", "velocity"):
            dofs = {dof: text for dof, (of_kind, text, _) in self.items(values) if of_kind == kind and dof <= 3}
            if not dofs:
                continue
            texts = [dofs.get(dof, "free") for dof in range(1, self.mesh.dimension + 1)]
            if set(texts) == {"0"}:
                entries = {**where, "Type": "clamp"}
            else:
                entries = {**where, "Type": kind, **axes, "Function": "; ".join(texts)}
            yield self.add("support" if set(texts) <= {"0", "free"} else "drive", entries, values["line"].place)
        if TEMPERATURE in values:
            yield self.add("temperature", {**where, "Type": "temperature", "Function": values[TEMPERATURE][1]},
                           values["line"].place)

    def alike(self):
        """What is held now, but for rigid parts: targets with the values of the first one. Single nodes with equal values
        stand together, apart from those of no cell."""
        result = {}
        for target, values in self.held.items():
            if target[:1] == ("rigid",):
                self.converter.parts.drive(target[1], values, {dof: self.at_begin.get((target, dof), 0.0) for dof in values})
                continue
            key_of_target = target
            if target.isdigit():
                node = self.converter.all_nodes_of(values["line"], target)[0]
                key_of_target = (node in self.scene.nodes_of_elements(),
                                 tuple((dof, *value[:2]) for dof, value in sorted(self.items(values))))
            result.setdefault(key_of_target, ([], values))[0].append(target)
        return list(result.values())

    @staticmethod
    def items(values):
        return [(dof, value) for dof, value in values.items() if dof != "line"]

    def add(self, word, entries, comment, of_step=()):
        """A condition; one that is there already is named again, unless it is one of this step."""
        for name, (_, known) in self.scene.named["Conditions"].items():
            if known == entries and name not in of_step:
                return name
        return self.scene.add("Conditions", word, entries, comment)

    def selection(self, nodes):
        nodes = [node for node in nodes if node in self.scene.nodes_of_elements()]
        name = next((name for name, members in self.mesh.node_sets.items() if set(members) == set(nodes)), "")
        return self.scene.selection(nodes, name)

    # Loads. Each is a word, or a rigid part with a degree of freedom, entries and a place, by what it acts on.

    def load_of(self, section, target, what):
        """A load of a step takes the place of those of steps before, and a further one acts beside it."""
        load = first = section.name, key(target), what
        while load in self.of_step:
            load = *first, load[3] + 1 if len(load) > 3 else 2
        return load

    def keep(self, section, target, what, word, entries, place):
        load = self.load_of(section, target, what)
        if len(load) == 3:
            self.loads = {one: value for one, value in self.loads.items() if one[:3] != load}
        self.loads[load] = (word, entries, place)
        self.of_step.add(load)

    def value(self, section, target, what, value):
        load = self.load_of(section, target, what)
        text, last = self.function(section, value, self.converter.last_loads.get(load, 0.0))
        self.converter.last_loads[load] = last
        self.last_texts[load] = (text, last)
        return text

    def concentrated(self, section):
        together = {}  # by degree of freedom
        for row in section.rows():
            target, dof, value = row.text(0), row.line.integer(row.text(1), "a degree of freedom"), row.number(2)
            if not 1 <= dof <= self.mesh.dimension:
                raise NotUnderstood(f"the degree of freedom {dof} is not understood (1 to {self.mesh.dimension} are)")
            rigid = self.converter.rigid_of(row.line, target)
            if rigid is not None:
                self.keep(section, target, dof, (rigid, dof), {"Force": self.value(section, target, dof, value)}, row.line.place)
                continue
            forces = NodeForces(self.mesh, self.scene.nodes_of_cells())
            # Those at the middle of edges carry as well.
            forces.add(row, target, self.converter.all_nodes_of(row.line, target), value)
            if self.mesh.faces_of_nodes(forces.forces):
                self.spread(section, dof, forces)
            else:
                others = together.setdefault(dof, NodeForces(self.mesh, self.scene.nodes_of_cells()))
                others.add(row, target, forces.forces, value)
        for dof, forces in together.items():
            self.spread(section, dof, forces)

    def spread(self, section, dof, forces):
        faces = forces.faces()
        area = self.mesh.area(faces)
        if self.mesh.dimension == 2:
            thicknesses = {self.converter.parts.thickness.get(self.mesh.boundary_faces[face], 1.0) for face in faces}
            if len(thicknesses) > 1:
                raise NotUnderstood("its nodes are on cells of several thicknesses")
            area *= thicknesses.pop()
        n = len(forces.forces)
        self.report.note(forces.place, f"*CLOAD: the force at each of {n} nodes is a traction over their faces, whose area is "
                         f"{area:g} at the start: the sum is the same, its distribution is not.")
        text = self.value(section, forces.name, dof, forces.total() / area)
        texts = [text if d == dof else "0" for d in range(1, self.mesh.dimension + 1)]
        nodes = list(forces.forces)
        self.keep(section, forces.name, dof, "load", {
            **self.selection(nodes), "Type": "traction", "Area": "initial", **self.transforms.of_all(nodes),
            "Function": "; ".join(texts)}, forces.place)

    def distributed(self, section):
        """*DLOAD: P1 to P6 on faces of elements, GRAV, BX, BY, BZ."""
        def read(row):
            target, word, value = row.text(0), key(row.text(1)), row.number(2)
            if word == "GRAV":
                direction = [row.number(k) for k in range(3, 6)]
                length = sum(x * x for x in direction) ** 0.5
                if not length:
                    raise NotUnderstood("GRAV has no direction")
                if abs(length - 1) > 1e-4:
                    self.report.note(row.line.place, "*DLOAD: the direction of GRAV is no unit vector: its length is not used, as in "
                                     "CalculiX.")
                    direction = [x / length for x in direction]
                direction = direction[:self.mesh.dimension]
                text = self.value(section, target, word, value)
                self.keep(section, target, word, "gravity", {
                    "Type": "gravity", **self.where_of_elements(row.line, target),
                    "Function": "; ".join(f"({text})*{number(x)}" if x else "0" for x in direction)}, row.line.place)
            elif word[:1] == "P" and word[1:].isdigit():
                faces = self.converter.faces_of_elements(row.line, target, "S" + word[1:])
                name = self.converter.name_of_faces(faces, f"{target} {word}")
                self.keep(section, target, word, "pressure", {
                    "Boundary": name, "Type": "pressure", "Function": self.value(section, target, word, value)},
                    row.line.place)
            else:
                raise NotUnderstood(f"{word} is not understood (P1 to P6 and GRAV are)")
        self.each_row(section, read)

    def where_of_elements(self, line, target):
        """Entries of a body force, which acts on nodes."""
        if not target:
            return {}
        nodes = self.converter.nodes_of_elements(line, target)
        names = self.scene.parts_of_nodes(nodes)
        if names and len(names) == len(self.scene.parts):
            return {}
        predicate = self.scene.box_of(set(nodes))
        if predicate is None:
            raise NotUnderstood(f'the elements of "{target}" are neither all nor those of a box')
        return {"Where": predicate}

    def on_surfaces(self, section):
        """*DSLOAD: P, and TRVEC with a direction."""
        def read(row):
            target, word, value = row.text(0), key(row.text(1)), row.number(2)
            name = self.converter.surface_of(row.line, target)
            text = self.value(section, target, word, value)
            if word == "P":
                entries = {"Boundary": name, "Type": "pressure", "Function": text}
            elif word == "TRVEC":
                direction = [row.number(k) for k in range(3, 6)]
                length = sum(x * x for x in direction) ** 0.5 or 1
                entries = {"Boundary": name, "Type": "traction", "Function": "; ".join(
                    f"({text})*{number(x / length)}" if x else "0" for x in direction[:self.mesh.dimension])}
            else:
                raise NotUnderstood(f"{word} is not understood (P and TRVEC are)")
            self.keep(section, target, word, "load", entries, row.line.place)
        self.each_row(section, read)

    def flux(self, section):
        """*DSFLUX (a surface, S) and *DFLUX (elements, S1 to S6)."""
        def read(row):
            target, word, value = row.text(0), key(row.text(1)), row.number(2)
            name = self.thermal_surface(section, row, target, word, "S")
            self.keep(section, target, word, "flux", {"Boundary": name, "Type": "heat flux", "Function": self.value(
                section, target, word, value)}, row.line.place)
        self.each_row(section, read)

    def film(self, section):
        """*SFILM (a surface, F) and *FILM (elements, F1 to F6): sink temperature and coefficient."""
        def read(row):
            target, word = row.text(0), key(row.text(1))
            name = self.thermal_surface(section, row, target, word, "F")
            self.keep(section, target, word, "film", {
                "Boundary": name, "Type": "convection", "Ambient temperature": self.value(section, target, word,
                                                                                         row.number(2)),
                "Film coefficient": number(row.number(3))}, row.line.place)
        self.each_row(section, read)

    def thermal_surface(self, section, row, target, word, letter):
        if word == letter:
            return self.converter.surface_of(row.line, target)
        if word[:1] == letter and word[1:].isdigit():
            faces = self.converter.faces_of_elements(row.line, target, "S" + word[1:])
            return self.converter.name_of_faces(faces, f"{target} {word}")
        raise NotUnderstood(f"{word} is not understood ({letter} and {letter}1 to {letter}6 are)")

    def refuse_forces(self, section):
        if section.name in ("CLOAD", "DLOAD", "DSLOAD") and not self.converter.has_mechanics:
            raise NotUnderstood(HEAT_ALONE)

    def begin_anew(self, section):
        """OP=NEW ends what was prescribed by the keyword before this step."""
        if key(section.get("OP", "MOD")) != "NEW" or (section.name, self.converter.step) in self.begun:
            return
        self.begun.add((section.name, self.converter.step))
        if section.name == "BOUNDARY":
            self.held = {}
        self.loads = {loaded: load for loaded, load in self.loads.items() if loaded[0] != section.name}

    def readers(self):
        """By keyword; each says first what ends."""
        def after(read):
            return lambda section: (refuse_other_meanings(section), self.refuse_forces(section), self.begin_anew(section),
                                    read(section))
        return {keyword: after(read) for keyword, read in self.all_readers().items()}

    def all_readers(self):
        return {"BOUNDARY": self.boundary, "CLOAD": self.concentrated, "DLOAD": self.distributed,
                "DSLOAD": self.on_surfaces, "DSFLUX": self.flux, "DFLUX": self.flux, "SFILM": self.film,
                "FILM": self.film}

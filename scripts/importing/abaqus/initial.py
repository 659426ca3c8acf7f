# SPDX-License-Identifier: LGPL-2.1-or-later
"""*INITIAL CONDITIONS. Where lines name the same node, each of its values is that of the last one."""

from collections import Counter

from ..scene import NotUnderstood, number
from .conditions import HEAT_ALONE, refuse_other_meanings
from .deck import key


class InitialConditions:
    """Velocities and temperatures of nodes, which write() makes to conditions, and stresses. A node without a line has
    the temperature zero; the one that most nodes have is that of the materials."""

    def __init__(self, converter):
        self.converter, self.mesh, self.scene = converter, converter.mesh, converter.scene
        self.velocities = {}    # by node or by the name of a rigid part: components, and a row
        self.temperatures = {}  # by node: a value, and a row
        for section in converter.deck.named("INITIAL CONDITIONS"):
            if key(section.get("TYPE")) == "TEMPERATURE":
                for row in section.rows():
                    value = row.number(1)
                    for node in converter.nodes_of(row.line, row.text(0)):
                        self.temperatures[node] = value, row
        counts = Counter(map(self.temperature_of, self.scene.nodes_of_cells()))
        self.temperature = counts.most_common(1)[0][0] if counts else 0.0

    def temperature_of(self, node):
        return self.temperatures.get(node, (0.0, None))[0]

    def read(self, section):
        refuse_other_meanings(section)
        kind = key(section.get("TYPE"))
        if kind in ("VELOCITY", "STRESS") and not self.converter.has_mechanics:
            raise NotUnderstood(HEAT_ALONE)
        if kind == "VELOCITY":
            for row in section.rows():
                self.read_velocity(row)
        elif kind == "STRESS":
            self.read_stresses(section)
        elif kind != "TEMPERATURE":
            raise NotUnderstood(f"TYPE={kind} is not understood (VELOCITY, TEMPERATURE and STRESS are)")

    def read_velocity(self, row):
        dof = row.line.integer(row.text(1), "a degree of freedom")
        if not 1 <= dof <= self.mesh.dimension:
            return
        rigid = self.converter.rigid_of(row.line, row.text(0))
        for target in self.converter.nodes_of(row.line, row.text(0)) if rigid is None else [rigid]:
            components = self.velocities.get(target, ((0.0,) * self.mesh.dimension, None))[0]
            self.velocities[target] = (*components[:dof - 1], row.number(2), *components[dof:]), row

    def read_stresses(self, section):
        """Rows of Abaqus are elements and six components, and those of CalculiX an element, an integration point and
        these: it has their mean. Elements of equal stresses are one condition."""
        stresses = {}  # of the integration points of a target, with a row
        for row in section.rows():
            first = 2 if len(row) > 7 else 1
            key_of_target = key(row.text(0)) if first == 2 else row
            row.text(first - 1)
            stresses.setdefault(key_of_target, ([], row))[0].append([row.number(k) for k in range(first, first + 6)])
        alike = {}
        for of_points, row in stresses.values():
            mean = tuple(sum(values) / len(of_points) for values in zip(*of_points))
            if any(tuple(one) != mean for one in of_points):
                self.converter.report.count(row.line.place, "*INITIAL CONDITIONS: an element has the mean stress of its points.")
            alike.setdefault(mean if len(row) > 7 else row, (mean, []))[1].append(row)
        for (xx, yy, zz, xy, xz, yz), rows in alike.values():
            nodes = {node for row in rows for node in self.converter.nodes_of_elements(row.line, row.text(0))}
            self.scene.add("Initial conditions", "stress", {
                **self.parts_or_box(nodes, rows[0].text(0)), "Stress": "; ".join(map(number, (xx, yy, zz, yz, xz, xy)))},
                rows[0].line.place)

    def write(self):
        rigid = {target: value for target, value in self.velocities.items() if isinstance(target, str)}
        for part, (components, row) in rigid.items():
            self.add("flight", {"Part": part, "Velocity": "; ".join(map(number, components))}, row)
        self.add_alike({node: value for node, value in self.velocities.items() if node not in rigid}, "flight",
                       lambda components: {"Velocity": "; ".join(map(number, components))})
        others = {node: value for node, value in self.temperatures.items() if value[0] != self.temperature}
        if others and not any(step.has_heat for step in self.converter.steps):
            _, row = next(iter(others.values()))
            self.converter.report.note(row.line.place, "*INITIAL CONDITIONS: no step has heat, and the temperature of all nodes "
                                       f"is that of most, {self.temperature:g}.")
            return
        self.add_alike(others, "heat", lambda value: {"Temperature": number(value)})

    def add_alike(self, values, word, entries_of):
        """One condition for the nodes of each value. Later ones count where they overlap."""
        groups = {}
        for node, (value, row) in values.items():
            groups.setdefault(value, ([], row))[0].append(node)
        groups = sorted(groups.items(), key=lambda group: -len(group[1][0]))
        for k, (value, (nodes, row)) in enumerate(groups):
            with_later = [node for _, (members, _) in groups[k:] for node in members]
            try:
                where = self.parts_or_box(nodes, row.text(0), with_later)
            except NotUnderstood as reason:
                self.converter.report.note(row.line.place, f"*INITIAL CONDITIONS: {reason}, so that this is left out.")
                continue
            self.add(word, {**where, **entries_of(value)}, row)

    def add(self, word, entries, row):
        self.scene.add("Initial conditions", word, entries, row.line.place)

    def parts_or_box(self, nodes, target, instead=()):
        """Entries that select nodes, or where there are none, those that are given instead."""
        for members in filter(None, (nodes, instead)):
            entries = self.scene.at_start(members)
            if entries is not None:
                return entries
        raise NotUnderstood(f'the nodes of "{target}" are neither those of parts nor those of a box')

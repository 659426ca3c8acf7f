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
            for row in section.rows():
                self.add_stress(row)
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

    def add_stress(self, row):
        target = row.text(0)
        xx, yy, zz, xy, xz, yz = (row.number(k) for k in range(1, 7))
        nodes = self.converter.nodes_of_elements(row.line, target)
        self.scene.add("Initial conditions", "stress", {
            **self.parts_or_box(nodes, target), "Stress": "; ".join(map(number, (xx, yy, zz, yz, xz, xy)))}, row.line.place)

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

# SPDX-License-Identifier: LGPL-2.1-or-later
"""*TRANSFORM: axes of nodes, along which supports, drives and forces at them are."""

from ..scene import NotUnderstood, number
from .deck import key


def cross(a, b):
    return [a[d - 2] * b[d - 1] - a[d - 1] * b[d - 2] for d in range(3)]


class Transforms:
    """The entries of conditions by nodes; a later *TRANSFORM of a node counts."""

    def __init__(self, converter):
        self.dimension = converter.mesh.dimension
        self.of_node, self.entries = {}, []
        for section in converter.deck.named("TRANSFORM"):
            if any(instance.placement and (instance is section.scope or key(instance.part) == key(section.scope.name))
                   for instance in converter.deck.instances.values()):
                continue  # an instance may turn it
            section.is_read = True
            try:
                entries = self.read(section)
            except NotUnderstood as reason:
                converter.report.leave_out(section, section.lines, f"{reason}, so that this is left out ({section.line.place})")
                continue
            self.entries.append(entries)
            for node in converter.all_nodes_of(section.line, section.name_in("NSET"), section.scope):
                self.of_node[node] = len(self.entries) - 1

    def read(self, section):
        system = key(section.get("TYPE", "R"))
        values = [value for row in section.rows() for value in row.numbers()]
        values += [0.0] * (6 - len(values))
        a, b = values[:3], values[3:6]
        if system == "C":
            axis = [q - p for p, q in zip(a, b)]
            if not any(axis):
                raise NotUnderstood("its axis has no length")
            entries = {"Axes": "cylindrical"}
            if self.dimension == 3:
                entries["Axis"] = ", ".join(map(number, axis))
            elif axis[0] or axis[1] or axis[2] < 0:
                raise NotUnderstood("its axis is not z")
            return {**entries, "Centre": ", ".join(map(number, a[:self.dimension]))}
        if system != "R":
            raise NotUnderstood(f"TYPE={system} is not understood (R and C are)")
        normal = cross(a, b)
        if not any(normal):
            raise NotUnderstood("its two points span no plane with the origin")
        if self.dimension == 3:
            return {"Axes": "; ".join(", ".join(map(number, point)) for point in (a, b))}
        if normal[0] or normal[1] or normal[2] < 0:
            raise NotUnderstood("its third axis is not z")
        return {"Axes": ", ".join(map(number, a[:2]))}

    def groups(self, nodes):
        """The nodes by their axes, with the entries of these."""
        result = {}
        for node in nodes:
            result.setdefault(self.of_node.get(node, -1), []).append(node)
        return [(self.entries[k] if k >= 0 else {}, members) for k, members in result.items()] or [({}, [])]

    def of_all(self, nodes):
        """The entries where all nodes have the same axes."""
        groups = self.groups(nodes)
        if len(groups) > 1:
            raise NotUnderstood("its nodes have different axes (*TRANSFORM)")
        return groups[0][0]

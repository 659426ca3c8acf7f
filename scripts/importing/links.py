# SPDX-License-Identifier: LGPL-2.1-or-later
"""Springs and dashpots between nodes, as processes."""

from dataclasses import dataclass
from math import dist

from .scene import NotUnderstood, number


@dataclass
class Link:
    """A spring or a dashpot: its name, the indices of two nodes, and the place in the deck."""

    name: str
    nodes: tuple
    place: str
    stiffness: float = 0.0
    damping: float = 0.0
    extension: float = 0.0  # at the start, by which it pulls


class Links:
    """The links of a scene. A node of no cell is an end that is a place, where all its displacements are prescribed."""

    def __init__(self, scene):
        self.scene, self.mesh = scene, scene.mesh
        self.links = []
        self.prescribed = {}  # of ends in no cell: texts of displacements by axis

    def add(self, link):
        self.links.append(link)
        for node in link.nodes:
            if node not in self.scene.nodes_of_cells():
                self.prescribed.setdefault(node, {})

    def prescribe(self, nodes, texts):
        """Texts of displacements by axis (0 to 2). Whether none of the nodes is one of a cell, and some are ends."""
        ends = [node for node in nodes if node in self.prescribed]
        for node in ends:
            self.prescribed[node].update(texts)
        return bool(ends) and not any(node in self.scene.nodes_of_cells() for node in nodes)

    def write(self, leave_out):
        """Adds the processes; leave_out(link, reason) is told of those that are not possible."""
        for link in self.links:
            try:
                entries = self.entries(link)
            except NotUnderstood as reason:
                leave_out(link, reason)
                continue
            self.scene.add("Processes", "", {"Type": "link", "link": entries}, link.place, link.name)
        if self.scene.named["Processes"]:
            self.scene.ask_for("link history")

    def entries(self, link):
        inside = [node in self.scene.nodes_of_cells() for node in link.nodes]
        first, second = link.nodes if inside[0] else link.nodes[::-1]
        if not any(inside):
            raise NotUnderstood("none of its ends is a node of a cell")
        if not (link.stiffness > 0 or link.damping > 0):
            raise NotUnderstood("its stiffness and its damping are not larger than zero")
        length = self.length(link)
        if length <= self.scene.tolerance():
            raise NotUnderstood("its ends are at one place, so that it has no direction")
        entries = {"Point": self.place(first)}
        if all(inside):
            entries["Other point"] = self.place(second)
        else:
            entries["End"] = self.end(second)
        for entry, value in (("Stiffness", link.stiffness), ("Damping", link.damping)):
            if value:
                entries[entry] = number(value)
        if link.extension:
            if not link.extension < length:
                raise NotUnderstood("its length without force is not larger than zero")
            entries["Length"] = number(length - link.extension)
        return entries

    def length(self, link):
        return dist(*(self.mesh.points[node] for node in link.nodes))

    def place(self, node):
        """The place of a node, by which it is found."""
        if node in self.coincident():
            raise NotUnderstood(f"at the node {self.mesh.numbers[node]} lies another one, and nodes are found by their places "
                                "here")
        return ", ".join(map(number, self.mesh.points[node][:self.mesh.dimension]))

    def end(self, node):
        """The place of a node of no cell over time."""
        texts = self.prescribed.get(node, {})
        dimension = self.mesh.dimension
        if any(axis not in texts for axis in range(dimension)):
            raise NotUnderstood(f"its node {self.mesh.numbers[node]} is in no cell, and is not held")
        return "; ".join(number(x) if texts[axis] == "0" else f"{number(x)} + ({texts[axis]})"
                         for axis, x in enumerate(self.mesh.points[node][:dimension]))

    def coincident(self):
        """Nodes of cells at whose places others lie."""
        if not hasattr(self, "at_one_place"):
            places = {}
            for node in self.scene.nodes_of_cells():
                key = tuple(round(x / self.scene.tolerance()) for x in self.mesh.points[node])
                places.setdefault(key, []).append(node)
            self.at_one_place = {node for nodes in places.values() if len(nodes) > 1 for node in nodes}
        return self.at_one_place

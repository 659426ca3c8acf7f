# SPDX-License-Identifier: LGPL-2.1-or-later
"""Histories of single nodes and of single elements, as probes and as material points."""

from .mesh import usable
from .scene import NotUnderstood, number

MOST_NODES, MOST_CELLS = 1000, 50
MOST_NAMES = 20  # in a note


class Histories:
    """Adds what a deck watches to the sections "probes" and "point history" of an output, which is given as its
    entries. A place is that of the card, for what is said."""

    def __init__(self, scene, output):
        self.scene, self.mesh, self.report, self.output = scene, scene.mesh, scene.report, output

    def add_nodes(self, nodes, place, labels=()):
        """Nodes by indices, and what the deck calls them. Corners of cells are named by their numbers. Midside nodes
        have none in the mesh: without corners among them they are places, to which the nearest node is taken. Throws
        NotUnderstood where there are too many."""
        self.refuse_many(nodes, MOST_NODES, "nodes")
        corners = self.mesh.numbers_in_file()
        has_corners = any(node in corners for node in nodes)
        listed, places = self.list_of("probes", "Mesh nodes", ", "), self.list_of("probes", "Locations", "; ")
        labels = dict(zip(nodes, labels))
        others, middles, nowhere = [], [], []
        for node in dict.fromkeys(nodes):
            of_deck, label = self.mesh.numbers[node], self.name(labels.get(node, ""))
            of_file = corners.get(node)
            if of_file is not None:
                listed.append(str(of_file))
                if of_file != of_deck or label:
                    called = f', "{label}",' if label else ""
                    others.append(f'{of_deck}{called} is "mesh node {of_file}"')
            elif node in self.mesh.midsides and not has_corners:
                places.append(self.place(label or f"node {of_deck}", self.mesh.points[node], places))
                middles.append(str(of_deck))
            else:
                nowhere.append(str(of_deck))
        for words, text in ((others, "columns of nodes have names of their own: the node "),
                            (middles, "the history of a node in the middle of an edge is that of the nearest corner: "),
                            (nowhere, "nodes that are no corners of cells have no history here: ")):
            if words:
                self.report.note(place, text + ", ".join(words[:MOST_NAMES]) + (
                    f" and {len(words) - MOST_NAMES} more." if len(words) > MOST_NAMES else "."))
        self.keep("probes", "Mesh nodes", list(dict.fromkeys(listed)), ", ")
        self.keep("probes", "Locations", list(filter(None, places)), "; ")

    def add_cells(self, cells, place, word, labels=()):
        """Cells by indices; a material point is the one next to the middle. Throws NotUnderstood where there are too
        many in all."""
        places, labels = self.list_of("point history", "Locations", "; "), dict(zip(cells, labels))
        rigid = self.cells_of_rigid_parts().intersection(cells)
        cells = [cell for cell in dict.fromkeys(cells) if cell not in rigid]
        self.refuse_many(cells, MOST_CELLS, "elements")
        for cell in cells:
            one = self.mesh.cells[cell]
            middle = [sum(self.mesh.points[node][d] for node in one.nodes) / len(one.nodes) for d in range(3)]
            text = self.place(self.name(labels.get(cell, "")) or f"{word} {one.number}", middle, places)
            if text:
                places.append(text)
        self.refuse_many(places, MOST_CELLS, "elements")
        for cell in sorted(rigid):
            self.report.note(place, f"the element {self.mesh.cells[cell].number} is one of a rigid part: it has no history.")
        self.keep("point history", "Locations", places, "; ")

    def every(self, section, entries):
        """Sets how often there are rows, where the section has been made; an entry of an empty text is none."""
        if section not in self.output:
            return False
        for entry, text in entries.items():
            self.output[section].pop(entry, None)
            if text:
                self.output[section][entry] = text
        return True

    @staticmethod
    def refuse_many(members, most, what):
        if len(set(members)) > most:
            raise NotUnderstood(f"there are {len(set(members))} {what} with histories, more than {most}")

    @staticmethod
    def name(label):
        return usable(label, ",;:=#\\\"")

    def list_of(self, section, entry, separator):
        text = self.output.get(section, {}).get(entry, "")
        return text.split(separator) if text else []

    def keep(self, section, entry, items, separator):
        if items:
            self.output.setdefault(section, {})[entry] = separator.join(items)

    def place(self, name, point, places):
        """A named place that is not there yet; nothing where it is there. A name that another place has gets a number."""
        text = ", ".join(map(number, point[:self.mesh.dimension]))
        names = [place.rpartition(":")[0] for place in places]
        if f"{name}: {text}" in places:
            return ""
        count, unique = 1, name
        while unique in names:
            count += 1
            unique = f"{name} ({count})"
        return f"{unique}: {text}"

    def cells_of_rigid_parts(self):
        groups = [part.group for part in self.scene.parts if part.formulation == "rigid"]
        return {cell for group in groups
                for cell in (range(len(self.mesh.cells)) if group is None else self.mesh.groups[group])}

# SPDX-License-Identifier: LGPL-2.1-or-later
"""A mesh as a file of gmsh, version 4.1 in text: each combination of groups is an entity."""

from .mesh import doubled

TYPES = {3: 5, 2: 3, 1: 1, 0: 15}  # of elements, by their dimension


class Writer:
    def __init__(self, mesh, name):
        self.mesh = mesh
        self.lines = ["$MeshFormat", "4.1 0 8", "$EndMeshFormat", "$Comments", f"made of {name}", "$EndComments"]
        self.tags = {}       # of physical groups, by dimension and name
        self.entities = {}   # by dimension: pairs of physical tags and of lists of nodes and numbers
        dimension = mesh.dimension
        numbers = [cell.number for cell in mesh.cells]
        has_numbers = None not in numbers and not doubled(numbers)
        self.next_number = max(numbers) + 1 if has_numbers else 1
        cells = mesh.combinations(mesh.groups, len(mesh.cells))
        self.add(dimension, mesh.groups, {
            names: [(mesh.cells[c].nodes, mesh.cells[c].number if has_numbers else None) for c in members]
            for names, members in cells.items()})
        faces = mesh.combinations({name: [tuple(face) for face in faces] for name, faces in mesh.surfaces.items()})
        self.add(dimension - 1, mesh.surfaces,
                 {names: [(face, None) for face in members] for names, members in faces.items()})
        nodes = mesh.combinations(mesh.node_sets)
        self.add(0, mesh.node_sets,
                 {names: [((node,), None) for node in members] for names, members in nodes.items()})
        self.write()

    def add(self, dimension, names, elements):
        for tag, name in enumerate(names, 1):
            self.tags[dimension, name] = tag
        self.entities[dimension] = [([self.tags[dimension, name] for name in combination], members)
                                    for combination, members in elements.items()]

    def write(self):
        lines, mesh = self.lines, self.mesh
        lines += ["$PhysicalNames", str(len(self.tags))]
        lines += [f'{dimension} {tag} "{name}"' for (dimension, name), tag in sorted(
            self.tags.items(), key=lambda item: (item[0][0], item[1]))]
        lines += ["$EndPhysicalNames", "$Entities"]
        lines.append(" ".join(str(len(self.entities.get(dimension, ()))) for dimension in range(4)))
        for dimension in sorted(self.entities):
            for tag, (physicals, members) in enumerate(self.entities[dimension], 1):
                points = [mesh.points[node] for nodes, _ in members for node in nodes]
                box = [f"{x:.16g}" for end in (min, max) for x in (end(p[d] for p in points) for d in range(3))]
                lines.append(" ".join([str(tag)] + box[:3 if dimension == 0 else 6] + [str(len(physicals))] +
                                      [str(physical) for physical in physicals] + ([] if dimension == 0 else ["0"])))
        lines.append("$EndEntities")
        self.write_nodes()
        self.write_elements()

    def write_nodes(self):
        mesh = self.mesh
        self.number_of = mesh.numbers_in_file()
        used, numbers = list(self.number_of), list(self.number_of.values())
        self.lines += ["$Nodes", f"1 {len(used)} {min(numbers)} {max(numbers)}", f"{mesh.dimension} 1 0 {len(used)}"]
        self.lines += [str(number) for number in numbers]
        self.lines += [" ".join(f"{x:.16g}" for x in mesh.points[node]) for node in used]
        self.lines.append("$EndNodes")

    def write_elements(self):
        blocks = [(dimension, tag, members) for dimension in sorted(self.entities, reverse=True)
                  for tag, (_, members) in enumerate(self.entities[dimension], 1)]
        rows, smallest = [], None
        for dimension, tag, members in blocks:
            rows.append(f"{dimension} {tag} {TYPES[dimension]} {len(members)}")
            for nodes, number in members:
                if number is None:
                    number, self.next_number = self.next_number, self.next_number + 1
                smallest = min(number, smallest if smallest is not None else number)
                rows.append(" ".join([str(number)] + [str(self.number_of[node]) for node in nodes]))
        n_elements = sum(len(members) for _, _, members in blocks)
        largest = max(self.next_number - 1, smallest)
        self.lines += ["$Elements", f"{len(blocks)} {n_elements} {smallest} {largest}", *rows, "$EndElements"]

    def text(self):
        return "\n".join(self.lines) + "\n"

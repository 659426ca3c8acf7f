# SPDX-License-Identifier: LGPL-2.1-or-later
"""Forces at nodes that are tractions over the faces of these nodes."""

from .scene import NotUnderstood

# Of the largest arm: beyond it, what forces turn is not what an even traction turns.
LARGEST_ARM = 0.05


class NodeForces:
    """Forces of one direction at nodes: those of a card, or of those cards together whose nodes make no face alone. A card
    has its line."""

    def __init__(self, mesh, nodes_of_cells):
        self.mesh, self.nodes_of_cells = mesh, nodes_of_cells
        self.targets, self.forces, self.place = [], {}, None

    def add(self, card, target, nodes, value):
        self.place = self.place or card.line.place
        self.targets.append(target)
        for node in nodes:
            self.forces[node] = self.forces.get(node, 0.0) + value

    @property
    def name(self):
        return ",".join(self.targets)

    def total(self):
        return sum(self.forces.values())

    def faces(self):
        """The faces of their nodes; NotUnderstood where these have none, or where an even traction turns the body otherwise."""
        faces = self.mesh.faces_of_nodes(self.forces)
        shown = '", "'.join(self.targets[:4]) + ('", ...' if len(self.targets) > 4 else '"')
        if not faces:
            raise NotUnderstood(f'the nodes of "{shown} make no face of the boundary: forces on single nodes are not '
                                "possible here")
        corners = {node for face in faces for node in face}
        alone = [node for node in self.forces if node in self.nodes_of_cells and node not in corners]
        if alone and len(self.targets) > 1:
            raise NotUnderstood(f'a node of "{shown} is on no face of the boundary that has all its nodes among them: forces '
                                "on single nodes are not possible here")
        if len(self.targets) > 1 and self.turns(faces):
            raise NotUnderstood(f'the forces on "{shown} turn the body, which an even traction over their faces does not')
        return faces

    def turns(self, faces):
        areas = [self.mesh.area([face]) for face in faces]
        points = [self.mesh.points[node] for node in self.forces]
        for d in range(3):
            middle = sum(area * sum(self.mesh.points[node][d] for node in face) / len(face)
                         for face, area in zip(faces, areas)) / sum(areas)
            extent = max(point[d] for point in points) - min(point[d] for point in points)
            arm = sum(force * (self.mesh.points[node][d] - middle) for node, force in self.forces.items())
            if abs(arm) > LARGEST_ARM * max(abs(self.total()) * extent, 1e-9 * sum(map(abs, self.forces.values()))):
                return True
        return False

# SPDX-License-Identifier: LGPL-2.1-or-later
"""A mesh of hexahedra (quadrilaterals in the plane) with its sets, and what is refused or said of it."""

from collections import Counter
from math import dist

from .text import DeckError

# Corners of faces, counted as the corners of cells stand in decks: round the bottom, then round the top.
FACES = {3: ((0, 1, 2, 3), (4, 7, 6, 5), (0, 4, 5, 1), (1, 5, 6, 2), (2, 6, 7, 3), (3, 7, 4, 0)),
         2: ((0, 1), (1, 2), (2, 3), (3, 0))}
# Of each corner the neighbours along three axes (two in the plane), in the order of a right-handed system.
NEIGHBOURS = {3: ((1, 3, 4), (2, 0, 5), (3, 1, 6), (0, 2, 7), (7, 5, 0), (4, 6, 1), (5, 7, 2), (6, 4, 3)),
              2: ((1, 3), (2, 0), (3, 1), (0, 2))}
MIDSIDES = {2: ((0, 1), (1, 2), (2, 3), (3, 0)),
            3: ((0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4), (0, 4), (1, 5), (2, 6), (3, 7))}
SMALLEST_CORNER = 1e-6
SHAPE = {3: "hexahedra", 2: "quadrilaterals"}
ADVICE = {
    2: " In gmsh, set Mesh.RecombineAll = 1 and Mesh.SubdivisionAlgorithm = 1 and mesh anew: the triangles that are "
       "left are divided into quadrilaterals.",
    3: " In gmsh, set Mesh.SubdivisionAlgorithm = 2 and mesh anew: tetrahedra, prisms and pyramids are divided into "
       "hexahedra. A mesh that is there is divided by a file x.geo with \"Merge 'OLD.msh'; "
       "Mesh.SubdivisionAlgorithm = 2; RefineMesh; Save 'NEW.msh';\" and \"gmsh - x.geo\"."}


class Cell:
    __slots__ = ("nodes", "line", "number")

    def __init__(self, nodes, line, number):
        self.nodes, self.line, self.number = nodes, line, number


def usable(name, separators=",#\\\""):
    """A name without what separates names in lists or begins comments."""
    return " ".join("".join(" " if c in separators else c for c in name).split())


class Names:
    """Names that are told apart: each is given once."""

    def __init__(self, remarks):
        self.taken, self.remarks = set(), remarks

    def give(self, title, default):
        name = usable(title)
        if name != title and name:
            self.remarks.append(f'The name "{title}" cannot stand in a parameter file: it is called "{name}".')
        name = name or default
        if name in self.taken:
            name += f" ({default})"
        self.taken.add(name)
        return name


class Mesh:
    """Points, cells by the indices of their corners, and names of what they are in. finish() checks all of it."""

    def __init__(self, dimension):
        self.dimension = dimension
        self.points = []
        self.numbers = []      # of the nodes in the deck
        self.cells = []
        self.groups = {}       # indices of cells
        self.surfaces = {}     # pairs of the nodes of a face and its line
        self.node_sets = {}    # indices of nodes
        self.remarks = []
        self.faces_at_node = {}   # by their places among boundary_faces
        self.of_file = {}         # numbers of nodes in the file that is written
        self.boundary_faces = {}  # the cell of each face that one cell has
        self.all_node_sets = {}   # node_sets with nodes of no cell
        self.midsides = set()     # midside nodes, which are left out
        self.n_second_order = 0
        self.largest_bend, self.place_of_largest = 0, None

    def add_midside_nodes(self, nodes, line):
        """Looks how far nodes of second order are off the middle of their edges."""
        self.n_second_order += 1
        n_corners = 2 ** self.dimension
        self.midsides.update(nodes[n_corners:])
        for (a, b), middle in zip(MIDSIDES[self.dimension], nodes[n_corners:]):
            begin, end = self.points[nodes[a]], self.points[nodes[b]]
            length = dist(begin, end)
            bend = dist(self.points[middle], [(x + y) / 2 for x, y in zip(begin, end)]) / length if length else 0
            if bend > self.largest_bend:
                self.largest_bend, self.place_of_largest = bend, line.place

    def add_group(self, name, cells):
        self.groups.setdefault(name, []).extend(cells)

    def add_surface(self, name, faces):
        self.surfaces.setdefault(name, []).extend(faces)

    def add_node_set(self, name, nodes):
        self.node_sets.setdefault(name, []).extend(nodes)

    def face(self, cell, f):
        nodes = self.cells[cell].nodes
        return tuple(nodes[k] for k in FACES[self.dimension][f])

    def faces(self, cell):
        return [self.face(cell, f) for f in range(len(FACES[self.dimension]))]

    def finish(self):
        if not self.cells:
            raise DeckError(f"there are no {SHAPE[self.dimension]}.")
        if self.n_second_order:
            self.remark_second_order()
        if self.dimension == 2:
            self.refuse_what_is_not_plane()
        self.check_cells()
        self.collect_faces()
        for name in list(self.surfaces):
            self.check_surface(name)
        in_cells = {node for cell in self.cells for node in cell.nodes}
        self.all_node_sets = dict(self.node_sets)
        for name, nodes in list(self.node_sets.items()):
            self.node_sets[name] = sorted(in_cells.intersection(nodes))
            if not self.node_sets[name]:
                del self.node_sets[name]
                self.remarks.append(f'The set "{name}" has no nodes of cells, and is no boundary.')
        self.groups = {name: sorted(set(cells)) for name, cells in self.groups.items() if cells}

    def remark_second_order(self):
        text = (f"{self.n_second_order} cells are of second order. Their midside nodes are left out: cells have "
                "straight edges between their corners. ")
        # Round-off of written coordinates is no bend.
        if self.largest_bend > 1e-6:
            text += (f"A midside node lies off the middle of its edge by up to {self.largest_bend:.3g} of the length "
                     f"of the edge ({self.place_of_largest}); smaller cells follow curved surfaces better.")
        else:
            text += "All of them are in the middle of their edges, so that the shape is the same."
        self.remarks.append(text)

    def refuse_what_is_not_plane(self):
        used = {node for cell in self.cells for node in cell.nodes}
        points = [self.points[node] for node in used]
        low, high = min(p[2] for p in points), max(p[2] for p in points)
        if high - low > 1e-9 * max(max(abs(p[0]), abs(p[1])) for p in points):
            raise DeckError(f"the mesh does not lie in the x-y plane: its z go from {low:g} to {high:g}. Allowed in two "
                            "dimensions is a plane mesh of equal z.")

    def check_cells(self):
        n_turned, first = 0, None
        for cell in self.cells:
            if len(set(cell.nodes)) < len(cell.nodes):
                cell.line.fail("A cell has the same node twice: it is no whole cell. Allowed are "
                               f"{SHAPE[self.dimension]} only.")
            mean, smallest = self.corners_of(cell)
            if mean < 0:
                half = len(cell.nodes) // 2
                cell.nodes = cell.nodes[half:] + cell.nodes[:half] if self.dimension == 3 else \
                    cell.nodes[:1] + cell.nodes[:0:-1]
                smallest = self.corners_of(cell)[1]
                n_turned, first = n_turned + 1, first or cell.line.place
            if not smallest > SMALLEST_CORNER:
                cell.line.fail(f"A cell is {'twisted' if smallest < 0 else 'flat'}: the determinant of the unit edges "
                               f"at one of its corners is {smallest:.6f}, and must be larger than "
                               f"{SMALLEST_CORNER:.6f}.")
        if n_turned:
            self.remarks.append(f"{n_turned} of {len(self.cells)} cells are numbered the wrong way round (the first on "
                                f"{first}) and were turned round.")

    def corners_of(self, cell):
        """The mean determinant of the edges at the corners, and the smallest one of unit edges."""
        points = [self.points[node] for node in cell.nodes]
        longest = max(dist(point, points[0]) for point in points)
        total, smallest = 0, 1
        for corner, others in enumerate(NEIGHBOURS[self.dimension]):
            o = points[corner]
            a, b, *rest = ([q - p for p, q in zip(o, points[k])] for k in others)
            if rest:
                c = rest[0]
                value = (a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) +
                         a[2] * (b[0] * c[1] - b[1] * c[0]))
            else:
                value = a[0] * b[1] - a[1] * b[0]
            total += value
            for k in others:
                length = dist(o, points[k])
                value = value / length if length > 1e-12 * longest else 0
            smallest = min(smallest, value)
        return total, smallest

    def collect_faces(self):
        owners = {}
        for c, cell in enumerate(self.cells):
            for corners in FACES[self.dimension]:
                owners.setdefault(tuple(sorted(cell.nodes[k] for k in corners)), []).append(c)
        for cells in owners.values():
            if len(cells) == 1:
                continue
            first, second = self.cells[cells[0]], self.cells[cells[1]]
            if set(first.nodes) == set(second.nodes):
                second.line.fail(f"The cell stands on {first.line.place} already.")
            if len(cells) > 2:
                self.cells[cells[-1]].line.fail("More than two cells have a face in common.")
        self.boundary_faces = {face: cells[0] for face, cells in owners.items() if len(cells) == 1}
        self.inner_faces = {face for face, cells in owners.items() if len(cells) == 2}

    def check_surface(self, name):
        """Keeps the faces on the boundary, and says what the others are."""
        kept, inner, elsewhere = {}, 0, 0
        for nodes, _ in self.surfaces[name]:
            key = tuple(sorted(nodes))
            if key in self.boundary_faces:
                kept[key] = nodes
            elif key in self.inner_faces:
                inner += 1
            else:
                elsewhere += 1
        if elsewhere:
            self.remarks.append(
                f'The surface "{name}" has {elsewhere} faces that are no faces of cells; they are left out. A rigid '
                'surface that the body shall touch belongs into a section "Contact: NAME", as a file .stl or .obj.')
        if inner:
            self.remarks.append(f'The surface "{name}" lies inside the body with {inner} ' + (
                "of its faces; only the others are a boundary." if kept else
                "faces: it is no boundary. Parts that meet there share its nodes without more ado."))
        elif not kept and not elsewhere:
            self.remarks.append(f'The surface "{name}" has no faces.')
        self.surfaces[name] = list(kept.values())
        if not kept:
            del self.surfaces[name]

    # What conditions ask.

    def numbers_in_file(self):
        """Of the corners of cells: those of the deck, where these tell the nodes apart."""
        if not self.of_file:
            used = sorted({node for cell in self.cells for node in cell.nodes})
            numbers = [self.numbers[node] for node in used]
            if doubled(numbers) or min(numbers) < 1:
                numbers = range(1, len(used) + 1)
            self.of_file = dict(zip(used, numbers))
        return self.of_file

    def faces_of_nodes(self, nodes):
        """Faces of the boundary of which a set has all nodes."""
        nodes = set(nodes)
        if not self.faces_at_node:
            for k, face in enumerate(self.boundary_faces):
                for node in face:
                    self.faces_at_node.setdefault(node, []).append((k, face))
        found = {one for node in nodes for one in self.faces_at_node.get(node, ())}
        return [face for _, face in sorted(found) if nodes.issuperset(face)]

    def area(self, faces):
        """The total area of faces, or the length of lines, by their nodes in any order round or across."""
        total = 0
        for face in faces:
            points = [self.points[node] for node in face]
            if len(points) == 2:
                total += dist(*points)
            else:
                # By the diagonals, of which there are three pairs; those of the convex order enclose most.
                total += max(cross_area(points, order) for order in ((0, 2, 1, 3), (0, 1, 2, 3), (0, 3, 1, 2)))
        return total

    def is_outward(self, face):
        """Whether the nodes of a face of the boundary go round against the clock as seen from outside; in the plane it is not
        asked."""
        if len(face) == 2:
            return True
        a, b, c, d = (self.points[node] for node in face)
        cell = self.cells[self.boundary_faces[tuple(sorted(face))]].nodes
        one, other = ([y - x for x, y in zip(*ends)] for ends in ((a, c), (b, d)))
        out = [sum(self.points[node][k] for node in face) / 4 - sum(self.points[node][k] for node in cell) / 8 for k in range(3)]
        return sum(out[k] * (one[k - 2] * other[k - 1] - one[k - 1] * other[k - 2]) for k in range(3)) > 0

    def nodes_of_groups(self, names):
        return {node for name in names for c in self.groups.get(name, ()) for node in self.cells[c].nodes}

    def faces_of_group(self, name):
        """Faces of its cells on the boundary of the mesh."""
        cells = set(self.groups.get(name, ()))
        return [face for face, cell in self.boundary_faces.items() if cell in cells]

    def bodies_share_nodes(self, one, other):
        return bool(self.nodes_of_groups([one]) & self.nodes_of_groups([other]))

    def largest_extent(self):
        ranges = [[point[d] for point in self.points] for d in range(3)]
        return max(max(values) - min(values) for values in ranges)

    def combinations(self, sets, n_items=None):
        """Members by the names of all sets that they are in."""
        names = {}
        for name, members in sets.items():
            for member in members:
                names.setdefault(member, []).append(name)
        for member in range(n_items or 0):
            names.setdefault(member, [])
        result = {}
        for member in sorted(names) if n_items is not None else names:
            result.setdefault(tuple(names[member]), []).append(member)
        return result


def cross_area(points, order):
    a, b, c, d = (points[k] for k in order)
    u, v = [y - x for x, y in zip(a, b)], [y - x for x, y in zip(c, d)]
    return 0.5 * sum((u[k - 2] * v[k - 1] - u[k - 1] * v[k - 2]) ** 2 for k in range(3)) ** 0.5


def doubled(values):
    """Those that occur more than once."""
    return {value for value, n in Counter(values).items() if n > 1}

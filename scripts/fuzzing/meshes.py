# SPDX-License-Identifier: LGPL-2.1-or-later
"""Small meshes of blocks, moved, mirrored, doubled and listed in another order, written for gmsh.

A mesh has points, cells and faces with a name. The nodes of a cell and of a face are in the order of gmsh:
around the bottom, then around the top.
"""

import collections
import itertools
import math
import random

Mesh = collections.namedtuple("Mesh", "dimension points cells faces")

CORNERS = {2: [(0, 0), (1, 0), (1, 1), (0, 1)],
           3: [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)]}


def parity(order):
    """The sign of a permutation."""
    return (-1) ** sum(a > b for a, b in itertools.combinations(order, 2))


def rotations(dimension):
    """The orders of a cell's nodes that are the same cell, turned."""
    corners = CORNERS[dimension]
    result = []
    for order in itertools.permutations(range(dimension)):
        for signs in itertools.product((1, -1), repeat=dimension):
            if parity(order) * math.prod(signs) > 0:
                result.append([corners.index(tuple(
                    corner[axis] if sign > 0 else 1 - corner[axis] for axis, sign in zip(order, signs)))
                    for corner in corners])
    return result


def block(cells, lower, upper, names=None):
    """A block of cells. Its faces are "x min", "x max", ..., or the names that replace these."""
    dimension = len(cells)
    counts = [n + 1 for n in cells]

    def number(index):
        return sum(i * math.prod(counts[:axis]) for axis, i in enumerate(index))
    points = [tuple(low + (high - low) * i / n for low, high, i, n in zip(lower, upper, reversed(index), cells))
              for index in itertools.product(*(range(n) for n in reversed(counts)))]
    elements, faces = [], []
    for reverse in itertools.product(*(range(n) for n in reversed(cells))):
        index = reverse[::-1]
        elements.append([number([i + c for i, c in zip(index, corner)]) for corner in CORNERS[dimension]])
        for axis, end in itertools.product(range(dimension), (0, 1)):
            if index[axis] == end * (cells[axis] - 1):
                name = "%s %s" % ("xyz"[axis], ("min", "max")[end])
                others = [i for i in range(dimension) if i != axis]
                corners = [[0], [1]] if dimension == 2 else CORNERS[2]
                face = []
                for corner in corners:
                    node = [index[i] + (end if i == axis else 0) for i in range(dimension)]
                    for other, c in zip(others, corner):
                        node[other] += c
                    face.append(number(node))
                faces.append(((names or {}).get(name, name), face))
    return Mesh(dimension, points, elements, faces)


def disordered(mesh, share, seed, spacings):
    """Nodes inside of the mesh are moved at random by a share of the spacing."""
    generator = random.Random(seed)
    on_surface = {node for _, face in mesh.faces for node in face}
    points = []
    for i, point in enumerate(mesh.points):
        moves = [generator.uniform(-share, share) * spacing for spacing in spacings]
        points.append(point if i in on_surface else tuple(x + move for x, move in zip(point, moves)))
    return mesh._replace(points=points)


def turned(mesh, degrees):
    """About the axis z through the origin."""
    cosine, sine = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
    return mesh._replace(points=[(cosine * x - sine * y, sine * x + cosine * y, *rest) for x, y, *rest in mesh.points])


def together(first, second):
    """Two bodies that share no node."""
    n = len(first.points)
    return first._replace(points=first.points + second.points,
                          cells=first.cells + [[i + n for i in cell] for cell in second.cells],
                          faces=first.faces + [(name, [i + n for i in face]) for name, face in second.faces])


def mapped(mesh, function, is_mirrored):
    """The mesh with other points. Nodes of mirrored cells are listed such that their volume stays positive."""
    cells = mesh.cells
    if is_mirrored:
        order = [0, 3, 2, 1, 4, 7, 6, 5][:len(cells[0])]
        cells = [[cell[i] for i in order] for cell in cells]
    return mesh._replace(points=[tuple(function(point)) for point in mesh.points], cells=cells)


def doubled(mesh, axis, plane):
    """The mesh and its image behind a plane, whose nodes are shared; the faces on it are inside then."""
    def reflected(point):
        return tuple(2. * plane - x if i == axis else x for i, x in enumerate(point))
    image = mapped(mesh, reflected, True)
    tolerance = 1e-9 * max(abs(point[axis] - plane) for point in mesh.points)
    on_plane = [abs(point[axis] - plane) < tolerance for point in mesh.points]
    numbers, points = [], list(mesh.points)
    for i, point in enumerate(image.points):
        numbers.append(i if on_plane[i] else len(points))
        if not on_plane[i]:
            points.append(point)
    faces = [(name, face) for name, face in mesh.faces if not all(on_plane[i] for i in face)]
    return Mesh(mesh.dimension, points, mesh.cells + [[numbers[i] for i in cell] for cell in image.cells],
                faces + [(name, [numbers[i] for i in face]) for name, face in faces])


def renumbered(mesh, seed):
    """The same mesh with points, cells and faces in another order, and each cell turned."""
    generator = random.Random(seed)
    order = list(range(len(mesh.points)))
    generator.shuffle(order)
    new_number = {old: new for new, old in enumerate(order)}
    turns = rotations(mesh.dimension)
    cells = [[new_number[cell[i]] for i in generator.choice(turns)] for cell in mesh.cells]
    faces = [(name, [new_number[i] for i in face]) for name, face in mesh.faces]
    generator.shuffle(cells)
    generator.shuffle(faces)
    return Mesh(mesh.dimension, [mesh.points[i] for i in order], cells, faces)


def text(mesh, number):
    """As a file of gmsh, version 2.2; number writes a coordinate."""
    names = sorted({name for name, _ in mesh.faces})
    groups = ['%d %d "%s"' % (mesh.dimension - 1, i + 1, name) for i, name in enumerate(names)]
    groups.append('%d %d "body"' % (mesh.dimension, len(names) + 1))
    nodes = ["%d %s" % (i + 1, " ".join([number(x) for x in point] + ["0"] * (3 - mesh.dimension)))
             for i, point in enumerate(mesh.points)]
    kinds = {2: (1, 3), 3: (3, 5)}[mesh.dimension]
    rows = [(kinds[0], names.index(name) + 1, face) for name, face in mesh.faces]
    rows += [(kinds[1], len(names) + 1, cell) for cell in mesh.cells]
    elements = ["%d %d 2 %d %d %s" % (i + 1, kind, tag, tag, " ".join(str(node + 1) for node in nodes_of))
                for i, (kind, tag, nodes_of) in enumerate(rows)]
    lines = ["$MeshFormat", "2.2 0 8", "$EndMeshFormat"]
    for name, content in (("PhysicalNames", groups), ("Nodes", nodes), ("Elements", elements)):
        lines += ["$" + name, str(len(content))] + content + ["$End" + name]
    return "\n".join(lines) + "\n"

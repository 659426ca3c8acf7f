#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Writes the meshes of the cases of contact between bodies and the surfaces of their tools.

usage: body_meshes.py

They are written beside the parameter files that read them: those of TEST_MESHES in tests/regression,
where git ignores them since run_case.py makes its own, and those of SHIPPED below parameter_files.
A mesh is a file of gmsh, format 2.2, of blocks that share no node; a surface is an .obj of
polygons.
"""

import itertools
import math
from pathlib import Path


class Mesh:
    """Quadrilaterals or hexahedra of lattices, with names of blocks and of their boundaries."""

    def __init__(self, dim, digits=17):
        self.dim, self.digits = dim, digits
        self.nodes, self.elements, self.names = [], [], []

    def group(self, dim, name):
        if (dim, name) not in self.names:
            self.names.append((dim, name))
        return self.names.index((dim, name)) + 1

    def add_block(self, name, coordinates, boundaries, position=lambda *point: point, by_rows=False):
        """A lattice of these coordinates by axis. `boundaries` maps (axis, end) to the name of a boundary;
        `position` moves a node. The cells are numbered along the last axis first, or `by_rows` along the
        first one like the nodes. Returns the mesh."""
        counts = [len(axis) for axis in coordinates]
        numbers = {}
        for index in itertools.product(*(range(n) for n in reversed(counts))):
            index = index[::-1]
            point = position(*(coordinates[d][index[d]] for d in range(self.dim)))
            self.nodes.append(tuple(point) + (0.,) * (3 - self.dim))
            numbers[index] = len(self.nodes)
        group = self.group(self.dim, name)
        square = [(0, 0), (1, 0), (1, 1), (0, 1)]
        corners = square if self.dim == 2 else [(i, j, k) for k in (0, 1) for i, j in square]
        cells = itertools.product(*(range(n - 1) for n in counts))
        for index in sorted(cells, key=lambda index: index[::-1]) if by_rows else cells:
            self.elements.append((3 if self.dim == 2 else 5, group,
                                  [numbers[tuple(i + c for i, c in zip(index, corner))]
                                   for corner in corners]))
        for (axis, end), boundary in boundaries.items():
            group = self.group(self.dim - 1, boundary)
            others = [d for d in range(self.dim) if d != axis]
            fixed = 0 if end == 0 else counts[axis] - 1
            for index in itertools.product(*(range(counts[d] - 1) for d in others)):
                face = []
                for corner in ([(0,), (1,)] if self.dim == 2 else square):
                    node_index = [fixed] * self.dim
                    for d, i, c in zip(others, index, corner):
                        node_index[d] = i + c
                    face.append(numbers[tuple(node_index)])
                self.elements.append((1 if self.dim == 2 else 3, group, face))
        return self

    def add_ring(self, name, centre, inner, outer, spacing):
        """The cells of a lattice whose middles are between two circles about a node of it."""
        reach = math.ceil(outer / spacing)
        numbers = {}
        group = self.group(2, name)
        for i, j in itertools.product(range(-reach, reach), repeat=2):
            if not inner <= spacing * math.hypot(i + 0.5, j + 0.5) <= outer:
                continue
            corners = [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)]
            for corner in corners:
                if corner not in numbers:
                    self.nodes.append((centre[0] + spacing * corner[0],
                                       centre[1] + spacing * corner[1], 0.))
                    numbers[corner] = len(self.nodes)
            self.elements.append((3, group, [numbers[corner] for corner in corners]))

    def add_cylinder(self, name, radius, core, rings, heights, boundaries):
        """A cylinder about the axis z: a core of `core` by `core` cells and rings around it. Its section
        is a polygon on the circle. `boundaries` are the names of the lower end, of the upper one, and of
        the side."""
        half = 0.6 * radius

        def on_circle(u, v):
            if abs(u) >= abs(v):
                angle = 0.25 * math.pi * v / u
                return math.copysign(math.cos(angle), u), math.copysign(1., u) * math.sin(angle)
            angle = 0.25 * math.pi * u / v
            return math.copysign(1., v) * math.sin(angle), math.copysign(math.cos(angle), v)

        def in_core(u, v):
            # Between a square and a circle, so that the four corners of the core are not sharp.
            size = max(abs(u), abs(v))
            if size == 0.:
                return 0., 0.
            share = 0.5 * size
            return tuple(half * ((1. - share) * 0.85 * square + share * size * circle)
                         for square, circle in zip((u, v), on_circle(u, v)))

        steps = even(-1., 1., core)
        around = ([(s, -1.) for s in steps[:-1]] + [(1., s) for s in steps[:-1]] +
                  [(-s, 1.) for s in steps[:-1]] + [(-1., -s) for s in steps[:-1]])
        lattice = [(u, v) for v in steps for u in steps]
        section = [in_core(*point) for point in lattice]
        rim = [min(range(len(lattice)), key=lambda k, point=point: math.dist(lattice[k], point))
               for point in around]
        edge = [section[k] for k in rim]
        width = core + 1
        quads = [[i + j * width, i + 1 + j * width, i + 1 + (j + 1) * width, i + (j + 1) * width]
                 for j in range(core) for i in range(core)]
        for ring in range(1, rings + 1):
            outer = [len(section) + k for k in range(len(around))]
            section += [tuple(a + (radius * b - a) * ring / rings
                              for a, b in zip(inner, on_circle(*point)))
                        for inner, point in zip(edge, around)]
            quads += [[rim[k - 1], outer[k - 1], outer[k], rim[k]] for k in range(len(around))]
            rim = outer
        base, n = len(self.nodes) + 1, len(section)
        self.nodes += [(round(x, 9), round(y, 9), z) for z in heights for x, y in section]
        group = self.group(3, name)
        lower, upper, side = (self.group(2, boundary) for boundary in boundaries)
        last = base + (len(heights) - 1) * n
        for foot in range(base, last, n):
            self.elements += [(5, group, [foot + k for k in quad] + [foot + n + k for k in quad])
                              for quad in quads]
            self.elements += [(3, side, [foot + rim[k - 1], foot + rim[k], foot + n + rim[k],
                                         foot + n + rim[k - 1]]) for k in range(len(rim))]
        for end, foot in ((lower, base), (upper, last)):
            self.elements += [(3, end, [foot + k for k in quad]) for quad in quads]

    def text(self):
        lines = ["$MeshFormat", "2.2 0 8", "$EndMeshFormat", "$PhysicalNames", str(len(self.names))]
        lines += [f'{dim} {k + 1} "{name}"' for k, (dim, name) in enumerate(self.names)]
        lines += ["$EndPhysicalNames", "$Nodes", str(len(self.nodes))]
        lines += [f"{k + 1} " + " ".join(f"{x:.{self.digits}g}" for x in node)
                  for k, node in enumerate(self.nodes)]
        lines += ["$EndNodes", "$Elements", str(len(self.elements))]
        lines += [f"{k + 1} {kind} 2 {group} {group} " + " ".join(map(str, nodes))
                  for k, (kind, group, nodes) in enumerate(self.elements)]
        return "\n".join(lines + ["$EndElements", ""])


class Surface:
    """Polygons of points, which are numbered from one, most of them in rings about the axis z."""

    def __init__(self, what, n_around):
        self.what, self.n_around = what, n_around
        self.points, self.facets = [], []

    def add_ring(self, radius, height):
        """The number of its first point."""
        self.points += [(radius * math.cos(angle), radius * math.sin(angle), height)
                        for angle in even(0., 2. * math.pi, self.n_around)[:-1]]
        return len(self.points) - self.n_around + 1

    def join(self, low, high):
        """Facets between two rings, or a ring and the first or last point, by first numbers."""
        is_end = {1, len(self.points)}
        for k in range(self.n_around):
            after = (k + 1) % self.n_around
            below = [low] if low in is_end else [low + k, low + after]
            self.facets.append(below + ([high] if high in is_end else [high + after, high + k]))

    def text(self):
        lines = [f"# {self.what}"]
        lines += ["v " + " ".join(f"{round(x, 12) + 0.:.9g}" for x in point)
                  for point in self.points]
        lines += ["f " + " ".join(map(str, facet)) for facet in self.facets]
        return "\n".join(lines + [""])


def even(low, high, n):
    return [low + (high - low) * i / n for i in range(n + 1)]


def graded(low, high, n, ratio):
    """Cells that grow by a factor `ratio` from the first to the last."""
    growth = ratio ** (1. / (n - 1))
    sizes = [growth ** i for i in range(n)]
    return [low] + [low + (high - low) * sum(sizes[:i + 1]) / sum(sizes) for i in range(n)]


def turned(x, y, *rest):
    c, s = math.cos(math.pi / 6), math.sin(math.pi / 6)
    return (c * x - s * y, s * x + c * y, *rest)


def bars(gap=0.5):
    mesh = Mesh(2).add_block("left", [even(-50., 0., 50), even(0., 3., 3)], {(0, 1): "left end"})
    return mesh.add_block("right", [even(gap, 50. + gap, 50), even(0., 3., 2)], {(0, 0): "right end"})


def patch_2d():
    mesh = Mesh(2).add_block("lower", [graded(0., 1., 5, 2.5), even(-0.5, 0., 2)],
                             {(1, 0): "bottom", (1, 1): "lower face"}, turned)
    return mesh.add_block("upper", [graded(0., 1., 7, 0.4), even(0., 0.6, 3)],
                          {(1, 0): "upper face", (1, 1): "top"}, turned)


def patch_3d():
    def turn(x, y, z):
        x, z = turned(x, z)
        return x, y, z

    mesh = Mesh(3).add_block("lower", [graded(0., 1., 5, 2.5), graded(0., 1., 3, 2.), even(-0.4, 0., 1)],
                             {(2, 0): "bottom", (2, 1): "lower face"}, turn)
    return mesh.add_block("upper", [graded(0., 1., 7, 0.4), graded(0., 1., 4, 1.5), even(0., 0.5, 2)],
                          {(2, 0): "upper face", (2, 1): "top"}, turn)


def half_spaces():
    width, gap = 1e-3, 8e-6
    near_to_far = graded(0., 0.06, 48, 40.)
    mesh = Mesh(2).add_block("work", [[-x for x in reversed(near_to_far)], even(0., width, 2)],
                             {(0, 1): "work face"})
    return mesh.add_block("tool", [[x + gap for x in near_to_far], even(0., width, 1)],
                          {(0, 0): "tool face"})


def rubbing():
    heights = graded(0., 1., 20, 3.)
    mesh = Mesh(2).add_block("lower", [even(-20., 20., 40), [-y for y in reversed(heights)]],
                             {(1, 1): "lower face"})
    return mesh.add_block("upper", [even(-20., 20., 31), [y + 2e-3 for y in heights]],
                          {(1, 0): "upper face"})


def slider():
    """A short block, two wide, on a long one with flat cells below its face."""
    depths = graded(0., 5., 14, 25.)
    mesh = Mesh(2).add_block("ground", [even(0., 13., 130), [-y for y in reversed(depths)]], {})
    return mesh.add_block("slider", [even(0.5, 2.5, 20), even(1e-3, 0.101, 1)], {})


def flush_blocks(dim=2, low=0.):
    mesh = Mesh(dim)
    across = [even(low, 2., round(2. - low))] * (dim - 1)
    for name, start in (("left", 0.), ("right", 6.)):
        mesh.add_block(name, [even(start, start + 6., 6)] + across, {})
    return mesh


def mirrored(is_whole):
    """A block that the plane y = 0 halves, and one beside it that stays off the plane."""
    low, n = (-2., 8) if is_whole else (0., 4)
    mesh = Mesh(2).add_block("middle", [even(0., 3., 6), even(low, 2., n)], {})
    for sign in (1., -1.) if is_whole else (1.,):
        ways = [sign * y for y in even(0.35, 2.35, 4)]
        mesh.add_block("side", [even(3.75, 6.75, 6), sorted(ways)], {})
    return mesh


def growing(first, length, n):
    """n cells from 0 to the length, the first one of this size, which grow by a factor."""
    low, high = 1., 10.
    for _ in range(200):
        ratio = 0.5 * (low + high)
        if first * sum(ratio ** i for i in range(n)) < length:
            low = ratio
        else:
            high = ratio
    coordinates = [first * sum(ratio ** j for j in range(i)) for i in range(n)]
    return coordinates + [length]


def cut():
    """The lattice of parameter_files/machining/geometry.prm and its tool, in mm: rake 10, clearance 7
    degrees. The edge of the tool is a corner in the middle of an arc of radius 0.02."""
    mesh = Mesh(2).add_block("work", [even(0., 5., 48), even(-2.052632, 1., 29)], {})
    rake, clearance, radius = math.radians(10.), math.radians(7.), 0.02
    face = (-math.sin(rake), math.cos(rake))
    flank = (-math.cos(clearance), math.sin(clearance))
    half = 0.5 * math.acos(face[0] * flank[0] + face[1] * flank[1])
    inwards = [face[d] + flank[d] for d in (0, 1)]
    depth = radius / math.sin(half) - radius

    def position(a, b):
        x, y = (face[d] * a + flank[d] * b for d in (0, 1))
        if a == 0. and b == 0.:
            x, y = (depth * c / math.hypot(*inwards) for c in inwards)
        return x - 1e-3, y

    first = radius / math.tan(half)
    return mesh.add_block("tool", [growing(first, 3., 24), growing(first, 1.7, 16)], {}, position)


def cylinders():
    """Right halves of two bodies with round faces of the radius 10, in mm; half a contact of Hertz is
    0.1287 wide."""
    mesh = Mesh(2)
    radius, size = 10., 1.6
    half = 0.12866

    def lines(fine, n_fine, n_coarse, reach):
        near = even(0., reach, n_fine)
        ratio = 1.
        while reach + sum(fine * ratio ** i for i in range(1, n_coarse + 1)) < size:
            ratio += 1e-3
        coarse = [near[-1] + sum(fine * ratio ** j for j in range(1, i + 1))
                  for i in range(1, n_coarse + 1)]
        return near + [near[-1] + (x - near[-1]) * (size - near[-1]) / (coarse[-1] - near[-1])
                       for x in coarse]

    for name, sign, fine in (("lower", -1., half / 4.), ("upper", 1., half / 4.6)):
        reach = 12 * fine
        columns = lines(fine, 12, 12, reach)
        rows = lines(fine / 2., 6, 16, 3. * fine)

        def position(x, y):
            rise = radius - math.sqrt(radius ** 2 - x ** 2)
            return x, sign * (rise * (1. - y / size) + y)

        heights = rows if sign > 0. else list(reversed(rows))
        face = 0 if sign > 0. else 1
        mesh.add_block(name, [columns, heights], {(1, face): f"{name} face", (1, 1 - face): f"{name} end",
                                                  (0, 0): f"{name} axis"}, position)
    return mesh


def spheres():
    """Quarters of two bodies with round faces of the radius 10; a contact of Hertz is about 0.5 wide.
    The faces are those of paraboloids, as Hertz has them."""
    mesh = Mesh(3)
    radius, size = 10., 4.
    for name, sign, n in (("lower", -1., 8), ("upper", 1., 9)):
        columns = growing(1. / n, size, n)
        heights = [sign * z for z in growing(0.5 / n, size, n - 2)][::int(sign)]

        def position(x, y, z):
            rise = 0.5 * (x ** 2 + y ** 2) / radius
            return tuple(round(c, 9) for c in (x, y, z + sign * rise * (1. - abs(z) / size)))

        face = 0 if sign > 0. else 1
        mesh.add_block(name, [columns, columns, heights],
                       {(2, face): f"{name} face", (2, 1 - face): f"{name} end",
                        (0, 0): "left", (1, 0): "front"}, position)
    return mesh


def punch():
    """A block of 6 by 6 by 3 cells on the middle of one of 8 by 8 by 4."""
    mesh = Mesh(3).add_block("upper", [even(0.25, 0.75, 6), even(0.25, 0.75, 6), even(1., 1.5, 3)],
                             {(2, 0): "upper face", (2, 1): "top"})
    return mesh.add_block("lower", [even(0., 1., 8), even(0., 1., 8), even(0., 1., 4)],
                          {(2, 0): "bottom", (2, 1): "lower face"})


def pressed_plate():
    mesh = Mesh(2)
    mesh.add_block("lower die", [even(-15., 15., 30), [-y for y in reversed(graded(0., 10., 10, 3.))]],
                   {(1, 0): "bottom", (1, 1): "lower face"})
    mesh.add_block("plate", [even(-20., 20., 80), even(0., 2., 4)],
                   {(1, 0): "plate bottom", (1, 1): "plate top"})
    return mesh.add_block("upper die", [even(-8., 8., 22), [2. + y for y in graded(0., 8., 10, 3.)]],
                          {(1, 0): "upper face", (1, 1): "top"})


def flat_shoulder():
    """Two plates of 76.2 by 31.75 by 3.18 with a joint in the plane x = 0 and a cylinder of the radius
    7.62 on their upper faces, in mm. Lines of the mesh are where the clamps begin, four fifths of the
    width from the joint. The joint is open by 1e-6, so that no two nodes are at one position."""
    mesh = Mesh(3)
    across = [5e-7] + even(0., 9., 9)[1:] + graded(9., 25.4, 7, 3.)[1:] + even(25.4, 31.75, 2)[1:]
    along, heights = even(-7.62, 68.58, 44), even(-3.18, 0., 2)
    for name, columns in (("left", [-x for x in reversed(across)]), ("right", across)):
        mesh.add_block(name, [columns, along, heights],
                       {(0, 0): "left side" if name == "left" else "right joint",
                        (0, 1): "left joint" if name == "left" else "right side",
                        (1, 0): "ends", (1, 1): "ends", (2, 0): "bottom", (2, 1): "top"},
                       lambda *point: [round(x, 9) for x in point])
    mesh.add_cylinder("tool", 7.62, 8, 3, [0., 1.5, 3.3, 5.5, 8.2, 11.5, 15.24],
                      ("shoulder", "tool top", "tool side"))
    return mesh


def rings(inner, outer):
    """Of the spacing one, with a gap of two."""
    mesh = Mesh(2)
    for side in (-1., 1.):
        mesh.add_ring("rings", (side * (outer + 1.), 0.), inner, outer, 1.)
    return mesh


def tube_sector():
    """60 degrees of a tube about (3, 1), of the radii 1 and 2."""
    return Mesh(2).add_block("tube", (even(1., 2., 16), even(math.radians(20), math.radians(80), 16)),
                             {(0, 0): "inner", (0, 1): "outer", (1, 0): "first end", (1, 1): "second end"},
                             lambda r, angle: (3 + r*math.cos(angle), 1 + r*math.sin(angle)))


def tube(n=8):
    """The quarter of a thick-walled tube of the radii 1 and 2."""
    def position(r, angle):
        x, y = r * math.cos(angle), r * math.sin(angle)
        return (0. if angle == math.pi / 2 else x), y

    return Mesh(2).add_block("tube", [even(1., 2., n), even(0., math.pi / 2, 2 * n)],
                             {(0, 0): "bore", (0, 1): "outside", (1, 0): "plane y", (1, 1): "plane x"},
                             position)


def two_blocks(dim):
    """Blocks in cells of a third that fly at each other, the right one a little higher."""
    mesh = Mesh(dim, 17 if dim == 2 else 12)
    n, lows = ((15, 6), (0.21,)) if dim == 2 else ((6, 3, 3), (0.11, 0.21))
    for left in ((0.,) * dim, (n[0] / 3. + 1., *lows)):
        lattice = [[low + i * (1. / 3.) for i in range(count + 1)] for low, count in zip(left, n)]
        mesh.add_block("blocks", lattice, {}, by_rows=True)
    return mesh


def static_drag():
    """A block on a longer one."""
    return stacked(([even(0., 6., 12), even(0., 1., 2)], [even(0.6, 2.6, 5), even(1., 1.5, 2)]))


def static_stack():
    """A quarter of three blocks on each other."""
    return stacked([[even(0., width, n)] * 2 + [even(low, low + 1., 2)]
                    for width, n, low in ((2., 4, 0.), (1.5, 3, 1.), (2., 4, 2.))])


def stacked(blocks):
    """Lattices with names of their lower and upper faces."""
    mesh = Mesh(len(blocks[0]), 12)
    axis = mesh.dim - 1
    for number, lattice in enumerate(blocks, 1):
        faces = {(axis, k): f"b{number} {'xyz'[axis]}{end}" for k, end in enumerate(("min", "max"))}
        mesh.add_block(f"b{number}", lattice, faces, by_rows=True)
    return mesh


def cup():
    """A thin wall of a cone of 36 degrees about the axis z, the radii from one to two inside."""
    mesh = Mesh(3, 16)
    half, n, rows = math.pi / 10., 32, 6
    for depth in (0., 0.2):
        for inside in even(1., 2., rows):
            radius = inside + depth * math.cos(half)
            height = inside / math.tan(half) - depth * math.sin(half)
            mesh.nodes += [(radius * math.cos(angle), radius * math.sin(angle), height)
                           for angle in even(0., 2. * math.pi, n)[:-1]]
    group = mesh.group(3, "cup")
    for first in range(1, n * rows + 1, n):
        for k in range(n):
            face = [first + k, first + (k + 1) % n, first + n + (k + 1) % n, first + n + k]
            mesh.elements.append((5, group, face + [node + n * (rows + 1) for node in face]))
    return mesh


def sphere():
    surface = Surface("A sphere of radius 10, of polygons, fine at its lowest point.", 48)
    surface.points.append((0., 0., -10.))
    angles = [0.015 * k for k in range(1, 13)]
    angles += [0.21, 0.26, 0.34, 0.46, 0.64, 0.9, 1.2, 1.6, 2., 2.4, 2.8]
    rings = [surface.add_ring(10. * math.sin(angle), -10. * math.cos(angle)) for angle in angles]
    surface.points.append((0., 0., 10.))
    for low, high in zip([1] + rings, rings + [len(surface.points)]):
        surface.join(low, high)
    return surface


def cone():
    surface = Surface("A cone of 36 degrees and a cylinder of radius 2.5, 360 facets around.", 360)
    surface.points.append((0., 0., 0.))
    edge, top = surface.add_ring(2.5, 2.5 / math.tan(math.pi / 10.)), surface.add_ring(2.5, 10.)
    surface.points.append((0., 0., 10.))
    surface.join(1, edge)
    surface.join(edge, top)
    surface.facets.append(range(top, top + surface.n_around))
    return surface


# What only the tests read, by the name of the file.
TEST_MESHES = {
    **{f"{make.__name__}.msh": make
       for make in (patch_2d, patch_3d, half_spaces, rubbing, slider, spheres, punch, static_drag,
                    static_stack, cup)},
    "flush_blocks.msh": flush_blocks,
    "flush_blocks_3d.msh": lambda: flush_blocks(3),
    "flush_wholes.msh": lambda: flush_blocks(2, -2.),
    "flush_wholes_3d.msh": lambda: flush_blocks(3, -2.),
    "tube_sector.msh": tube_sector,
    "mirrored_half.msh": lambda: mirrored(False),
    "mirrored_whole.msh": lambda: mirrored(True),
    "small_rings.msh": lambda: rings(15., 20.),
    "tube.msh": tube,
    "tube_16.msh": lambda: tube(16),
    "two_blocks.msh": lambda: two_blocks(2),
    "two_blocks_3d.msh": lambda: two_blocks(3),
    "sphere.obj": sphere,
    "cone.obj": cone,
}
# By the path below parameter_files.
SHIPPED = {
    "smoothed_particles/colliding_rings.msh": lambda: rings(30., 40.),
    "machining/cut.msh": cut,
    "friction_stir_welding/flat_shoulder.msh": flat_shoulder,
    **{f"contact/{make.__name__}.msh": make for make in (bars, cylinders, pressed_plate)},
}


def write(name, directory):
    """Writes a file of TEST_MESHES; its path."""
    path = Path(directory) / name
    path.write_text(TEST_MESHES[name]().text(), encoding="utf-8")
    return path


def main():
    here = Path(__file__).resolve().parent
    for name in TEST_MESHES:
        write(name, here)
    for name, make in SHIPPED.items():
        (here.parents[1] / "parameter_files" / name).write_text(make().text(), encoding="utf-8")


if __name__ == "__main__":
    main()

#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Relations between scenes: what is written in another frame is the same scene, what comes back is the same
table, and a difference is detected.

The program is a stand-in that moves a body as a whole, with the fault that its environment names.
"""

import itertools
import math
import os
import unittest

from stand_ins import judge_of
from fuzzing import frames, meshes, related_scenes, relations, scene_runs

STAND_IN = r'''#!/usr/bin/python3
import itertools, json, os, re, sys
from math import *
fault = os.environ["FAULT"]
ranks = int(os.environ.get("STAND_IN_RANKS", "1"))
text = open("case.prm").read()
resumed = any(argument.startswith("--resume") for argument in sys.argv)
sign = lambda x: (x > 0) - (x < 0)

def entry(name):
    return re.search(r"set %s = (.*)" % name, text).group(1)

# Volume, centre and momentum of the nodes, all of one mass.
dimension = int(entry("Dimension"))
lines = open("mesh.msh").read().split("\n")
start = lines.index("$Nodes") + 2
points = [[float(x) for x in line.split()[1:]] for line in lines[start:lines.index("$EndNodes")]]
ends = [(min(p[i] for p in points), max(p[i] for p in points)) for i in range(dimension)]
volume = 1.
for low, high in ends:
    volume *= high - low
mass = volume * float(entry("Density"))
x = y = z = 0.
velocity = [eval(v) for v in entry("Velocity").split(";")] + [0.] * (3 - dimension)
centre = [0.5 * (low + high) for low, high in ends] + [0.] * (3 - dimension)
momentum = [mass * v for v in velocity]
kinetic = 0.5 * sum(p * v for p, v in zip(momentum, velocity))
pressure = float(entry("Young's modulus"))
elastic = pressure * volume
if fault == "axes":
    momentum[0] = abs(momentum[0])
if fault == "units":
    elastic *= 1. + 1e-4 * log(volume * pressure)
if fault == "moved":
    elastic *= 1. + 1e-4 * points[0][0] / (ends[0][1] - ends[0][0])
if fault == "flight":
    elastic *= 1. + 1e-4 * (velocity[0] / max(1e-300, abs(velocity[dimension - 1])))
if fault == "numbering":
    elastic *= 1. + 1e-3 * sum((i + 1) ** 2 * (p[0] - ends[0][0]) for i, p in enumerate(points)) / (ends[0][1] - ends[0][0])
if fault == "whole":
    elastic *= 1. + 1e-4 * ("symmetry" in text)
if fault == "source" and "Type = box" in text or fault == "ranks" and ranks > 1 or fault == "resume" and resumed:
    elastic *= 1. + 1e-4
turn = [centre[1] * momentum[2] - centre[2] * momentum[1], centre[2] * momentum[0] - centre[0] * momentum[2],
        centre[0] * momentum[1] - centre[1] * momentum[0]]
end = float(entry("End time"))
os.makedirs("output/checkpoint", exist_ok=True)
for name in ("log.txt", "original.prm", "parameters.prm", "checkpoint/step_1.h5", "checkpoint/step_2.h5"):
    open("output/" + name, "w").close()
json.dump({"ended": "finished"}, open("output/summary.json", "w"))
row = {"time [T]": end, "time step [T]": float(entry("Fixed")) if "Fixed" in text else 0.01 * end,
       "kinetic energy [M L^2/T^2]": kinetic, "elastic energy [M L^2/T^2]": elastic,
       "largest speed [L/T]": sqrt(sum(v * v for v in velocity)), "largest stress component [M/(L T^2)]": pressure}
row.update({"momentum %s [M L/T]" % "xyz"[i]: momentum[i] for i in range(dimension)})
row.update({"angular momentum %s [M L^2/T]" % "xyz"[i]: turn[i] for i in range(3) if dimension == 3 or i == 2})
with open("output/statistics.csv", "w") as file:
    file.write(",".join(row) + "\n")
    file.write(",".join(map(repr, row.values())) + "\n")
'''

SIDES = {2: ["x min", "x max", "y min", "y max"],
         3: ["x min", "x max", "y min", "y max", "z min", "z max"]}


def volume_at(mesh, cell, corner):
    """The volume of the edges at a corner of a cell."""
    corners = meshes.CORNERS[mesh.dimension]
    edges = []
    for axis in range(mesh.dimension):
        ends = [tuple(value if i == axis else x for i, x in enumerate(corners[corner])) for value in (0, 1)]
        low, high = (mesh.points[cell[corners.index(end)]] for end in ends)
        edges.append([b - a for a, b in zip(low, high)])
    return sum(meshes.parity(order) * math.prod(edges[i][j] for i, j in enumerate(order))
               for order in itertools.permutations(range(mesh.dimension)))


def frame_of(order, signs, **changes):
    return frames.identity(len(order))._replace(order=order, signs=signs, **changes)


class MeshTest(unittest.TestCase):
    def assert_is_mesh(self, mesh, volume):
        volumes = [volume_at(mesh, cell, corner) for cell in mesh.cells for corner in range(2 ** mesh.dimension)]
        self.assertGreater(min(volumes), 0.)
        self.assertAlmostEqual(sum(volumes) / 2 ** mesh.dimension, volume)
        inner = [frozenset(face) for _, face in mesh.faces]
        self.assertEqual(len(set(inner)), len(inner))

    def test_cells_have_four_and_24_turns(self):
        for dimension, n in ((2, 4), (3, 24)):
            turns = meshes.rotations(dimension)
            self.assertEqual(len({tuple(turn) for turn in turns}), n)

    def test_cells_stay_positive(self):
        for cells, volume in (([3, 2], 24.), ([2, 3, 1], 48.)):
            n = len(cells)
            mesh = meshes.block(cells, [0.] * n, [6., 4., 2.][:n])
            self.assert_is_mesh(mesh, volume)
            self.assertEqual(sorted({name for name, _ in mesh.faces}), sorted(SIDES[n]))
            for order, signs in frames.all_axes(n):
                frame = frame_of(order, signs)
                other = meshes.mapped(mesh, lambda p: frames.point(frame, p), frames.determinant(frame) < 0)
                self.assert_is_mesh(other, volume)
            for seed in range(5):
                other = meshes.renumbered(mesh, seed)
                self.assert_is_mesh(other, volume)
                self.assertNotEqual(other.cells, mesh.cells)
                self.assertEqual(sorted(other.points), sorted(mesh.points))
            self.assert_is_mesh(meshes.doubled(mesh, 1, 0.), 2. * volume)

    def test_a_whole_has_no_faces_within(self):
        mesh = meshes.doubled(meshes.block([2, 2], [1., 0.], [3., 2.]), 0, 1.)
        self.assertEqual(len(mesh.points), 15)
        self.assertEqual(sum(name == "x min" for name, _ in mesh.faces), 0)
        self.assertEqual(sum(name == "x max" for name, _ in mesh.faces), 4)


class FrameTest(unittest.TestCase):
    def test_points_and_expressions_agree(self):
        """A coordinate of the scene, as an expression in the frame, is that of the point there."""
        for order, signs in frames.all_axes(3):
            frame = frame_of(order, signs, shift=("0.25", "-3", "7"))
            position = [1.5, -2.25, 4.]
            x, y, z = frames.point(frame, position)
            for name, value in zip("xyz", position):
                self.assertEqual(eval(frames.expression(frame, name), {"x": x, "y": y, "z": z}), value)

    def test_vectors_and_tensors_turn_alike(self):
        v, tension = [2., -3., 5.], [1., 2., 3., 4., 5., 6.]
        full = [[0.] * 3 for _ in range(3)]
        for (i, j), value in zip(frames.SYMMETRIC, tension):
            full[i][j] = full[j][i] = value
        energy = sum(v[i] * full[i][j] * v[j] for i in range(3) for j in range(3))
        for order, signs in frames.all_axes(3):
            frame = frame_of(order, signs)
            turned = [eval(text) for text in frames.vector(frame, list(map(str, v)))]
            self.assertEqual(turned, frames.point(frame, v))
            other = [eval(text) for text in frames.tensor(frame, list(map(str, tension)))]
            self.assertEqual(energy, sum((1 if i == j else 2) * turned[i] * turned[j] * value
                                         for (i, j), value in zip(frames.SYMMETRIC, other)))

    def test_tables_come_back(self):
        position, momentum = [1., -2., 3.], [0.5, 0.25, -4.]

        def columns(position, momentum):
            turn = [position[1] * momentum[2] - position[2] * momentum[1], position[2] * momentum[0] - position[0] * momentum[2],
                    position[0] * momentum[1] - position[1] * momentum[0]]
            return {"time": ("T", [0.])} | {"%s %s" % (name, axis): (unit, [value]) for name, unit, values in (
                ("momentum", "M L/T", momentum), ("p position", "L", position), ("angular momentum", "M L^2/T", turn))
                for axis, value in zip("xyz", values)}
        for order, signs in frames.all_axes(3):
            frame = frame_of(order, signs, shift=("10", "20", "40"))
            other = columns(frames.point(frame, position), frames.point(frame._replace(shift=None), momentum))
            self.assertEqual(frames.transformed_back(frame, other), columns(position, momentum))

    def test_units_are_read(self):
        for unit, dimension, powers in (
                ("M L^2/T^2", 3, [2, 1, -2, 0]), ("M L^2/T^2", 2, [1, 1, -2, 0]), ("M/(L T^2)", 2, [-1, 1, -2, 0]),
                ("1", 3, [0, 0, 0, 0]), ("1/T", 3, [0, 0, -1, 0]), ("temperature", 2, [0, 0, 0, 1]), ("L/T", 2, [1, 0, -1, 0])):
            self.assertEqual(frames.dimensions(unit, dimension), powers, unit)


class RelationsTest(unittest.TestCase):
    def setUp(self):
        self.judge = judge_of(self, relations.Judge, STAND_IN, 10.)

    def scene(self, symmetric):
        """A block in flight along its last axis."""
        for scene in map(related_scenes.drawn, range(5000)):
            if scene["motion"] and scene["motion"]["kind"] == "flight" and scene["scaling"] is None and not scene["section"] \
                    and scene["second body"] is None and scene["disorder"] == 0. and scene["rotation"] == 0. \
                    and not scene["static"] and not scene["rigid"] and not scene["damping"] and scene["bulk viscosity"] is None \
                    and not scene["smoothed cells"] and not scene["softening modulus"] and scene["erosion"] is None \
                    and bool(scene["symmetry"]) == symmetric:
                return scene

    def judged(self, kind, fault):
        scene = self.scene(kind == "whole")
        os.environ["FAULT"] = fault
        self.judge.kept.clear()
        relation = next(relation for relation in (relations.relation_of(scene, kind, seed) for seed in range(1, 50))
                        if kind != "axes" or relation.view.frame.signs[0] > 0
                        and relation.view.frame.order[0] == len(relation.view.frame.order) - 1)
        return self.judge.related(scene, relation)

    def test_relations_hold_without_a_fault(self):
        for kind in relations.KINDS:
            if kind != "source":  # the stand-in reads files alone
                result = self.judged(kind, "")
                self.assertIsNone(result.problem, result.problem)
                self.assertEqual(result.kind, "run")

    def test_a_wrong_relation_is_noticed(self):
        for kind, fault in (("axes", "axes"), ("units", "units"), ("decimal units", "units"), ("moved", "moved"),
                            ("flight", "flight"), ("numbering", "numbering"), ("whole", "whole"), ("ranks", "ranks"),
                            ("resume", "resume")):
            problem = self.judged(kind, fault).problem
            self.assertIsNotNone(problem, kind)
            self.assertEqual(problem.kind, kind)

    def test_a_scene_is_a_function_of_its_number(self):
        for number in (1, 20, 300):
            texts = [related_scenes.files_of(related_scenes.drawn(number)) for _ in range(2)]
            self.assertEqual(texts[0], texts[1])

    def test_scenes_have_all_features(self):
        texts = [related_scenes.files_of(related_scenes.drawn(i))["case.prm"].decode() for i in range(1, 301)]
        for piece in ("Method = surface", "Method = kinematic", "Body contacts", "Type = tied", "Sections", "part history",
                      "Formulation = rigid", "Rate =", "quasi-static", "dynamic relaxation", "Type = gravity", "Type = pressure",
                      "Type = symmetry", "Refine where", "Formulation = smoothed cells", "Formulation = smoothed particle",
                      "Formulation = momentum consistent particle", "Bond failure", "Time integration = explicit",
                      "= backward Euler", "Friction", "Strain measure = rate"):
            self.assertTrue(any(piece in text for text in texts), piece)

    def test_simpler_scenes_are_legal_and_others(self):
        for i in range(1, 100, 10):
            scene = related_scenes.drawn(i)
            for candidate in related_scenes.simpler(scene):
                self.assertNotEqual(candidate, scene)
                self.assertEqual(candidate, related_scenes.legal(candidate))


if __name__ == "__main__":
    unittest.main()

# SPDX-License-Identifier: LGPL-2.1-or-later
"""Scenes for relations: those of scenes.py on meshes from files, with further features, and how they are written
in another frame, with another numbering or as a whole instead of a half."""

import collections
import itertools
import random

from . import frames, meshes, scene_files, scenes

# frame: frames.Frame; numbering: a seed of the order of all that is listed, or None; is_whole: whether the body
# is on both sides of its planes of symmetry; source: "file" or "box", the origin of the mesh.
View = collections.namedtuple("View", "frame numbering is_whole source")

MOTION_TYPES = ("velocity", "displacement", "clamp")
LISTS = ("Parts", "Materials", "Conditions", "Contacts")


def plain(scene):
    return View(frames.identity(scene["dimension"]), None, False, "file")


def drawn(seed):
    """The scene of a seed."""
    generator = random.Random("related %d" % seed)
    choice, maybe = generator.choice, scenes.maybe
    scene = dict(scenes.drawn(seed), mesh="box", pictures=False, probe=False, ranks=1)
    scene["offset"] = min(scene["offset"], 0.)
    scene["steps"] = min(scene["steps"], 60)
    scene["outputs"] = min(scene["outputs"], 3)
    if scene["bonds"] is not None:  # round-off decides whether a bond is longer than at the start
        scene["bonds"] = dict(scene["bonds"], stretch=1.02)
    scene["strain measure"] = choice([None, "rate", "logarithmic"])
    scene["contacts"] = [dict(contact, method=choice(["penalty", "penalty", "surface", "kinematic"]))
                         for contact in scene["contacts"]]
    scene["second body"] = {"cells": [choice([1, 2, 3]) for _ in range(3)], "gap": choice([0., 0., 0.01]),
                            "type": choice(["touching", "touching", "tied"]), "friction": choice([0., 0.3]),
                            "conductance": choice([0., 0.01])} if maybe(generator, 0.2) else None
    scene["rigid"] = choice(["free", "free", "led"]) if maybe(generator, 0.12) else None
    scene["damping"] = {"rate": choice([0., 0.1]), "stiffness": choice([0., 0.05])} if maybe(generator, 0.12) else None
    scene["section"] = {"axis": generator.randrange(3)} if maybe(generator, 0.4) else None
    scene["static"] = choice(["quasi-static", "quasi-static", "dynamic relaxation"]) if maybe(generator, 0.12) else None
    scene["conditions"] = scene["conditions"] + [
        {"type": kind, "axis": generator.randrange(3), "end": choice(["min", "max"]),
         "size": scenes.power(generator, -5, -3), "in time": choice(["1", "t"]), "free": False,
         "direction": generator.randrange(3)} for kind in ("gravity", "pressure") if maybe(generator, 0.12)]
    return legal(scene)


def legal(scene):
    """As scenes.legal, of the further features too."""
    scene = dict(scene)
    dim = scene["dimension"]
    if scene["static"] is not None:
        make_static(scene)
    if scene["rigid"] is not None:
        make_rigid(scene)
    if scene["second body"] is not None:
        scene.update(layout="halves", refined=None, adaptive=None, rotation=0., bonds=None)
        if scene["conversion"] is not None:
            scene["conversion"] = None
        if scene["second body"]["type"] == "tied":
            scene["erosion"] = None
        if scene["refill"] is not None:
            scene["refill"] = None
    if scene["layout"] == "one":
        scene["rigid"] = None
    scene = scenes.legal(scene)
    scene["contacts"] = [dict(contact) for contact in scene["contacts"]]
    if scene["second body"] is not None and scene["layout"] == "one":
        scene["layout"] = "halves"
    up = "xyz"[dim - 1]
    if scene["symmetry"]:
        scene["contacts"] = [] if up in scene["symmetry"] else [
            contact if contact["surface"] in ("floor", "plate") else dict(contact, surface="floor")
            for contact in scene["contacts"]]
        scene["conditions"] = symmetric_conditions(scene)
        scene["stress"] = None
        if scene["rigid"] == "free":
            scene["rigid"] = "led"
    if scene["degree"] > 1:
        scene["contacts"] = [dict(contact, method="penalty") for contact in scene["contacts"]]
        scene["second body"] = None
    scene["conditions"] = [condition for i, condition in enumerate(scene["conditions"])
                           if condition["type"] not in MOTION_TYPES
                           or not any(other["type"] in MOTION_TYPES for other in scene["conditions"][:i])]
    if scene["rigid"] is not None:
        scene["contacts"] = [dict(contact, method="penalty") for contact in scene["contacts"]]
        scene["conditions"] = [condition for condition in scene["conditions"] if condition["type"] not in MOTION_TYPES]
    return scene


def make_static(scene):
    """A body that is held at one end, without what static steps refuse."""
    scene.update(motion=None, damping=None, scaling=None, erosion=None, conversion=None, filter=None, bonds=None,
                 rigid=None, refill=None, adaptive=None, stress=None,
                 symmetry=[axis for axis in scene["symmetry"] if axis != "x"])
    scene.update({"bulk viscosity": None, "self-contact": False, "smoothed particles": False,
                  "configuration": "total Lagrangian", "bridge": "paper", "second body": None,
                  "shape functions": "moving least squares"})
    has_particles = scenes.PARTICLES in scenes.formulations_of(scene)
    scene["contacts"] = [] if has_particles else [
        dict(contact, damping=0., surface="plate", gap=0., move="speed", speed=0.01 * contact["speed"],
             method="surface" if contact["method"] == "surface" else "penalty") for contact in scene["contacts"][:1]]
    load = {"type": "traction", "axis": 0, "end": "max", "size": 1e-4, "in time": "t", "free": False,
            "direction": 0 if "y" in scene["symmetry"] else 1}
    kept = [condition for condition in scene["conditions"] if condition["type"] not in MOTION_TYPES + ("traction",)]
    scene["conditions"] = kept + [{"type": "clamp", "axis": 0, "end": "min", "size": 0., "in time": "1", "free": False,
                                   "direction": 0}, load]


def make_rigid(scene):
    """The second part is rigid, beside elements."""
    scene.update(conversion=None, refined=None, adaptive=None, refill=None, degree=1)
    scene["smoothed cells"] = False
    scene["layout"] = "halves"
    first = scene["formulations"][0]
    scene["formulations"] = [first if first in scenes.ELEMENTS[:2] else scenes.ELEMENTS[0], "rigid"]


def symmetric_conditions(scene):
    """Without those on a plane of symmetry, and without motion prescribed across one."""
    axes = "xyz"[:scene["dimension"]]
    result = []
    for condition in scene["conditions"]:
        if axes[condition["axis"] % len(axes)] in scene["symmetry"]:
            condition = dict(condition, end="max")
        is_across = axes[condition["direction"] % len(axes)] in scene["symmetry"]
        if not (condition["type"] in ("velocity", "displacement") and (is_across or not condition["free"])):
            result.append(condition)
    return result


SIMPLER = {"second body": None, "rigid": None, "damping": None, "section": None, "static": None, "strain measure": None}


def simpler(scene):
    """Scenes with one feature less each."""
    candidates = [dict(scene, **{name: value}) for name, value in SIMPLER.items() if scene[name] != value]
    candidates += [dict(scene, contacts=scene["contacts"][:i] + [dict(contact, method="penalty")] + scene["contacts"][i + 1:])
                   for i, contact in enumerate(scene["contacts"]) if contact["method"] != "penalty"]
    seen = [scene]
    for candidate in itertools.chain(candidates, scenes.simpler(scene)):
        candidate = legal(candidate)
        if candidate not in seen:
            seen.append(candidate)
            yield candidate


class Writer(scene_files.Writer):
    """The text of a scene in a view. All else is written as the scene has it, and transformed entry by entry."""

    def __init__(self, scene, view, perturbation=None, fixed_step=None):
        self.view = view
        self.kinds = []
        scene = dict(scene, symmetry=[] if view.is_whole else scene["symmetry"])
        self.planes = []  # of symmetry, of a whole: axis and coordinate
        super().__init__(scene, perturbation, fixed_step)

    # Entries in the view.

    def number(self, value, length=0, mass=0, time=0, temperature=0):
        text = super().number(value, length, mass, time, temperature)
        length_unit, mass_unit, time_unit, temperature_unit = self.view.frame.units
        factor = length_unit ** length * mass_unit ** mass * time_unit ** time * temperature_unit ** temperature
        return text if factor == 1. else frames.number(float(text) * factor)

    def begin(self, name):
        super().begin(name)
        self.kinds.append("")

    def end(self):
        super().end()
        self.kinds.pop()

    def set(self, name, value):
        value = str(value)
        if name == "Type" and self.kinds:
            self.kinds[-1] = value
        kind = next((kind for kind in reversed(self.kinds) if kind), "")
        if self.view.numbering is not None and name in LISTS and not self.kinds:
            names = value.split(", ")
            random.Random("%s %d" % (name, self.view.numbering)).shuffle(names)
            value = ", ".join(names)
        if self.view.is_whole:
            value = self.in_whole(name, value)
        if self.view.source == "box" and self.scene["second body"] is not None and name.lower().endswith("boundary"):
            value = self.mesh_boundaries(value)
        super().set(name, frames.entry(self.view.frame, name, value, kind))

    def in_whole(self, name, value):
        """Even in each coordinate across a plane; vectors across it are odd."""
        def even(text):
            for axis, plane in self.planes:
                at = self.length(plane)
                text = frames.replaced(text, "xyz"[axis], "(abs(%s-(%s))+(%s))" % ("xyz"[axis], at, at))
            return text

        def odd(text, axes):
            for axis, plane in self.planes:
                if axes.count(axis) % 2 == 1 and text not in ("0", "free"):
                    text = "sign(%s-(%s))*(%s)" % ("xyz"[axis], self.length(plane), text)
            return text
        if name in ("Velocity", "Function"):
            components = [even(text) for text in value.split("; ")]
            if len(components) == self.dim:
                components = [odd(text, [i]) for i, text in enumerate(components)]
            return "; ".join(components)
        if name == "Stress":
            return "; ".join(odd(even(text), axes) for text, axes in zip(value.split("; "), frames.SYMMETRIC))
        if name in frames.EXPRESSIONS and not value.startswith("from "):
            return even(value)
        return value

    # Geometry.

    def extent(self):
        lower, upper = super().extent()
        if self.scene["second body"] is not None:
            upper = list(upper)
            upper[-1] += self.scene["second body"]["gap"] + self.second_height()
        return lower, upper

    def second_height(self):
        return self.scene["second body"]["cells"][self.dim - 1] * self.scene["spacing"][self.dim - 1]

    def joint(self):
        """The height of the joint between two bodies."""
        return self.upper[-1] - self.second_height() - 0.5 * self.scene["second body"]["gap"]

    def smallest_spacing(self):
        scene, smallest = self.scene, super().smallest_spacing()
        if scene["second body"] is not None:
            smallest = min([smallest] + [size / n for size, n in zip(self.sizes(), scene["second body"]["cells"])])
        return smallest

    def body(self):
        """The mesh in cells."""
        scene = self.scene
        lower = [scene["offset"] * max(self.sizes())] * self.dim
        upper = [x + size for x, size in zip(lower, self.sizes())]
        up = "xyz"[self.dim - 1]
        second = scene["second body"]
        mesh = meshes.block(scene["cells"][:self.dim], lower, upper, {up + " max": "slave"} if second else None)
        if scene["disorder"] > 0.:
            mesh = meshes.disordered(mesh, scene["disorder"], scene["seed"], scene["spacing"])
        if second is not None:
            lower = lower[:-1] + [upper[-1] + second["gap"]]
            upper = upper[:-1] + [self.upper[-1]]
            mesh = meshes.together(mesh, meshes.block(second["cells"][:self.dim], lower, upper, {up + " min": "master"}))
        if scene["rotation"] != 0.:
            mesh = meshes.turned(mesh, scene["rotation"])
        return mesh

    def mesh(self):
        if self.view.source == "box":
            if self.scene["second body"] is None:
                super().mesh()
            else:
                self.two_meshes()
            return
        frame = self.view.frame
        mesh = self.body()
        for axis, plane in self.planes:
            mesh = meshes.doubled(mesh, axis, plane)

        def placed(position):
            return frames.point(frame, [float(self.length(x)) for x in position])
        mesh = meshes.mapped(mesh, placed, frames.determinant(frame) < 0)
        if self.view.numbering is not None:
            mesh = meshes.renumbered(mesh, self.view.numbering)
        self.files["mesh.msh"] = meshes.text(mesh, frames.number)
        self.begin("Mesh")
        self.set("Type", "file")
        if self.scene["refined"] is not None:
            axis = self.scene["refined"]["axis"]
            self.set("Refine where", "%s < %s" % ("xyz"[axis], self.coordinate(axis, self.scene["refined"]["share"])))
        self.section("file", {"File": "mesh.msh"})
        self.adaptive()
        self.end()

    def two_meshes(self):
        """The bodies as boxes, each a mesh of its own."""
        scene, up = self.scene, self.dim - 1
        second = scene["second body"]
        top = self.lower[up] + self.sizes()[up]
        self.set("Meshes", "a, b")
        for name, cells, lower, upper in (
                ("a", scene["cells"], self.lower, list(self.upper[:up]) + [top]),
                ("b", second["cells"], list(self.lower[:up]) + [top + second["gap"]], self.upper)):
            self.begin("Mesh: " + name)
            self.set("Type", "box")
            self.section("box", {"Lower corner": ", ".join(map(self.length, lower)),
                                 "Upper corner": ", ".join(map(self.length, upper)),
                                 "Cells": ", ".join(map(str, cells[:self.dim]))})
            self.end()

    def mesh_boundaries(self, boundary):
        """The names that a boundary of both bodies has there."""
        up = "xyz"[self.dim - 1]
        known = {"slave": "a.%s max" % up, "master": "b.%s min" % up, up + " min": "a.%s min" % up,
                 up + " max": "b.%s max" % up}
        return known.get(boundary, "a.%s, b.%s" % (boundary, boundary))

    # Sections.

    def text(self):
        scene = self.scene
        super().text()
        if scene["second body"] is not None:
            self.set("Body contacts", "joint")
            self.body_contact(scene["second body"])
        if scene["section"] is not None:
            self.set("Sections", "middle")
            axis = scene["section"]["axis"] % self.dim
            middle = [0.5 * (low + high) for low, high in zip(self.lower, self.upper)]
            middle[axis] = float(self.lower[axis]) + 0.4871 * (self.upper[axis] - self.lower[axis])
            self.section("Section: middle", {"Point": ", ".join(map(self.length, middle)), "Normal": ", ".join(
                "1" if i == axis else "0" for i in range(self.dim))})
        if scene["damping"] is not None:
            self.section("Damping", {"Rate": self.number(scene["damping"]["rate"], time=-1),
                                     "Stiffness factor": self.time(scene["damping"]["stiffness"])})
        if scene["static"] is not None:
            self.set("Time integration", scene["static"])
            self.section("Statics", {"Largest step": self.time(0.25 * self.duration()), "Tolerance": "1e-11"})
            if scenes.uses_particles(scene):
                self.section("Surface damping", {"Coefficient": 0})
        tree = tree_of(self.lines)
        for i, contact in enumerate(scene["contacts"]):
            if contact["method"] == "kinematic":
                section = tree["subsection Contact: tool %d" % i]
                for name in [name for name in section if name.startswith(("set Stiffness", "set Damping"))]:
                    section.pop(name)
        if scene["static"] is not None:
            tree.pop("subsection Time step")
        return "\n".join(written(tree)) + "\n"

    def parts(self):
        scene = self.scene
        if scene["second body"] is None:
            return super().parts()
        first, second = scene["formulations"]
        other = "first" if scene["second material"] is None else "second"
        return {"a": ["%s < %s" % ("xyz"[self.dim - 1], self.length(self.joint())), first, "first"],
                "b": ["otherwise", second, other]}

    def part(self, name, cells, formulation, material):
        scene = self.scene
        if formulation == "rigid":
            self.begin("Part: " + name)
            self.section_of_rigid(cells, material)
            self.end()
            return
        super().part(name, cells, formulation, material)
        if scene["strain measure"] is not None and formulation in scenes.ELEMENTS:
            self.begin("Part: " + name)
            self.section(scenes.name_of(scene, formulation), {"Strain measure": scene["strain measure"]})
            self.end()

    def section_of_rigid(self, cells, material):
        self.set("Cells", cells)
        self.set("Formulation", "rigid")
        self.set("Material", material)
        self.begin("rigid")
        if self.scene["rigid"] == "free":
            self.set("Displacement", "; ".join(["free"] * self.dim))
            self.set("Rotation", "free")
        else:
            up = self.dim - 1
            self.set("Displacement", "; ".join(["0"] * up + ["-%s*t" % self.speed(1e-3)]))
        self.end()

    def body_contact(self, second):
        self.section("Body contact: joint", {
            "Slave boundary": "slave", "Master boundary": "master", "Type": second["type"],
            **({} if second["type"] == "tied" else {"Friction": second["friction"]}),
            **({"Conductance": self.number(second["conductance"] * self.scene["heat"]["capacity"], 0, 1, -3, -1)}
               if self.scene["heat"] is not None else {})})

    def contact(self, name, contact):
        if self.view.frame.boost is not None and contact["move"] == "rest":
            contact = dict(contact, move="speed", speed=0.)
        super().contact(name, contact)
        if contact["method"] != "penalty":
            self.section("Contact: " + name, {"Method": contact["method"]})

    def condition(self, name, condition):
        kind = condition["type"]
        if kind == "clamp" and self.view.frame.boost is not None:
            condition = dict(condition, type="velocity", size=0., free=False)
        super().condition(name, condition)
        value = {"1": "%s", "t": "%s*t/" + self.time(self.duration())}[condition["in time"]] \
            if kind in ("gravity", "pressure") else ""
        if kind == "gravity":
            components = ["0"] * self.dim
            components[condition["direction"] % self.dim] = value % self.number(condition["size"], 1, 0, -2)
            self.section("Condition: " + name, {"Function": "; ".join(components)})
        elif kind == "pressure":
            self.section("Condition: " + name, {"Function": value % self.pressure(condition["size"])})

    def tool_file(self, name, width):
        """A file has the axes of the scene: those of the frame turn it, and a mirrored facet is read backwards."""
        file_name = super().tool_file(name, width)
        frame = self.view.frame._replace(shift=None)

        def moved(numbers):
            return map(frames.number, frames.point(frame, list(map(float, numbers))))

        lines = []
        for line in self.files[file_name].splitlines():
            if self.dim == 2:
                lines.append(", ".join(moved(line.split(","))))
                continue
            kind, *words = line.split()
            if kind == "v":
                words = moved(words)
            elif frames.determinant(frame) < 0:
                words.reverse()
            lines.append(" ".join([kind, *words]))
        self.files[file_name] = "\n".join(lines) + "\n"
        return file_name

    def start(self):
        entries = super().start()
        if self.view.frame.boost is not None:
            entries.setdefault("Velocity", "; ".join(["0"] * self.dim))
        return entries

    def heat(self):
        super().heat()
        heat = self.scene["heat"]
        if heat["integration"] == "explicit" and heat["diffusivity"] > 0.:
            # Well below any estimate of the limit, which numbering changes.
            size = self.smallest_spacing()
            self.begin("Heat")
            self.section("explicit", {"Maximum": self.time(0.03 * size * size / heat["diffusivity"])})
            self.end()

    def output(self):
        super().output()
        # No point has the same distance to two nodes.
        points = [self.upper, self.lower, [low + share * (high - low) for low, high, share in zip(
            self.lower, self.upper, (0.4137, 0.5719, 0.4523))]]
        self.begin("Output")
        self.set("Further outputs", "part history")
        if self.scene["rotation"] == 0.:
            labels = ["p%d: %s" % (i, ", ".join(map(self.length, point))) for i, point in enumerate(points)]
            self.section("probes", {"Locations": "; ".join(labels)})
        if any(not scenes.is_thermal(condition) for condition in self.scene["conditions"]):
            self.section("condition history", {"Moments about": ", ".join(map(self.length, self.lower))})
        self.end()


def tree_of(lines):
    """Sections and entries by their lines; the contents of sections of one name are in one section."""
    tree = {}
    path = [tree]
    for line in lines:
        words = line.strip()
        if words.startswith("subsection "):
            path.append(path[-1].setdefault(words, {}))
        elif words == "end":
            path.pop()
        else:
            path[-1][words] = None
    return tree


def written(section, depth=0):
    """The lines of a tree."""
    for name, content in section.items():
        yield "  " * depth + name
        if content is not None:
            yield from written(content, depth + 1)
            yield "  " * depth + "end"


def files_of(scene, view=None, perturbation=None, fixed_step=None):
    """The files of a scene by name, of which case.prm is the main one."""
    writer = Writer(scene, view or plain(scene), perturbation, fixed_step)
    if writer.view.is_whole:
        writer.planes = [("xyz".index(axis), writer.lower["xyz".index(axis)]) for axis in scene["symmetry"]]
    text = writer.text()
    return {"case.prm": text.encode(), **{name: content.encode() for name, content in writer.files.items()}}

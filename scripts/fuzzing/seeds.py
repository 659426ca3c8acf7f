# SPDX-License-Identifier: LGPL-2.1-or-later
"""Valid inputs in a form that runs in a fraction of a second.

A seed is a set of files (name: text) with the one that the program is given, the program and its
options. Meshes get few cells and runs few steps: how many steps a file makes is requested from the
program (--dry-run), and its times are shortened accordingly.
"""

import os
import re
import struct

import body_meshes  # tests/regression

# A run of a seed makes about so many steps.
STEPS = 6
MOST_CELLS = {2: 8, 3: 5}

ENTRY = re.compile(rb"^\s*set\s+([^=\n]*?)\s*=[ \t]*([^\n]*?)[ \t]*$")
TIMES = {(b"", b"End time"), (b"Output", b"Times"), (b"Output", b"Interval"),
         (b"Output/specimen shape", b"Average from")}
# Files of tests that are no scenes by themselves: with mistakes, without their mesh, or of a run that fails.
NOT_VALID = ("twenty_mistakes.prm", "bodies.prm", "turned_particle.prm")
# Scenes whose supports of particles need more cells than a reduced scene has.
NOT_REDUCIBLE = ("cut_smoothed_slice.prm", "titanium_cost.prm",
                 os.path.join("elastic_wave", "smoothed_particles.prm"))
PARTS_ENTRY = re.compile(rb"^\s*set\s+Parts\s*=", re.M)
INCLUDE = re.compile(rb"^\s*include\s+(\S.*?)\s*$", re.M)
MESH_FILE = re.compile(rb"^\s*set\s+File\s*=\s*(\S.*?)\s*$", re.M)

# A scene around a mesh file.
SCENE = b"""set Title            = Mesh of a file
set Dimension        = %d
set End time         = 0.5
set Output directory = output
set Parts            = body
set Materials        = steel
set Initial conditions = motion

subsection Mesh
  set Type = file
  subsection file
    set File = %s
  end
end

subsection Part: body
  set Cells       = all
  set Formulation = %s
  set Material    = steel
end

subsection Material: steel
  set Model = elastic
  subsection elastic
    set Density         = 100
    set Young's modulus = 100
    set Poisson's ratio = 0.3
  end
end

subsection Initial condition: motion
  set Velocity = 0.01*x%s
end
"""

# Meshes of kinds that tests/meshes has in three dimensions only.
STRIP_VTK = b"""# vtk DataFile Version 3.0
strip
ASCII
DATASET UNSTRUCTURED_GRID
POINTS 6 double
0 0 0  1 0 0  2 0 0
0 1 0  1 1 0  2 1 0
CELLS 2 10
4 0 1 4 3
4 1 2 5 4
CELL_TYPES 2
9
9
CELL_DATA 2
SCALARS MaterialID int
LOOKUP_TABLE default
1 2
"""


class Seed:
    """Files by name, the main one and the names that are changed."""

    def __init__(self, name, files, main, mesh=None):
        self.name = name
        self.files = files
        self.main = main
        self.mesh = mesh  # the mesh file that is to be changed, if it is that and not the parameters

    def parameter_files(self):
        return [name for name in self.files if name.endswith(".prm")]


def read(path):
    with open(path, "rb") as file:
        return file.read()


def with_its_files(root, main):
    """The text of a parameter file, of what it includes and of its mesh, by name below root."""
    files = {}
    open_names = [main]
    while open_names:
        name = open_names.pop()
        if name in files:
            continue
        files[name] = read(os.path.join(root, name))
        directory = os.path.dirname(name)
        for other in INCLUDE.findall(files[name]):
            open_names.append(os.path.normpath(os.path.join(directory, other.decode())))
        for other in MESH_FILE.findall(files[name]):
            mesh = os.path.normpath(os.path.join(directory, other.decode()))
            if mesh in body_meshes.TEST_MESHES:
                files[mesh] = body_meshes.TEST_MESHES[mesh]().text().encode()
            elif os.path.isfile(os.path.join(root, mesh)):
                files[mesh] = read(os.path.join(root, mesh))
    return files


def dimension_of(files):
    for text in files.values():
        match = re.search(rb"^\s*set\s+Dimension\s*=\s*(\d)", text, re.M)
        if match:
            return int(match.group(1))
    return 3


def map_entries(text, change):
    """The text with values changed: change(section path, name, value) returns a value or None."""
    sections = []
    lines = []
    for line in text.split(b"\n"):
        words = line.strip()
        if words.startswith(b"subsection "):
            sections.append(words[11:].strip())
        elif words == b"end" and sections:
            sections.pop()
        match = ENTRY.match(line)
        value = change(b"/".join(sections), match.group(1), match.group(2)) if match else None
        lines.append(line if value is None else line[:match.start(2)] + value)
    return b"\n".join(lines)


def fewer_cells(most):
    def change(section, name, value):
        value = value.split(b"#")[0].strip()
        if section == b"Mesh/box" and name == b"Cells":
            return re.sub(rb"(?<![\w.])(?<![eE][-+])(?<!to )\d+(?=\s*($|[,;|]|to\b))", lambda n: b"%d" % min(int(n.group()), most),
                          value)
        if section == b"Mesh" and name == b"Refine where":
            # A region may have no centre of a larger cell.
            return b"; ".join([b"1 > 0"] * (value.count(b";") + 1))
        if section == b"Mesh" or not section.startswith(b"Mesh/"):
            return None
        few = {b"Core cells": b"2", b"Rings": None, b"Cells along axis": None, b"Cells along edge": b"4",
               b"Cells through thickness": b"2"}
        if name not in few:
            return None
        return few[name] or re.sub(rb"(?<![\w.])(?<![eE][-+])(?<!to )\d+(?=\s*($|[|]|to\b))",
                                   lambda n: b"%d" % min(int(n.group()), 2 if name == b"Rings" else 5), value)
    return change


def shorter(factor):
    def change(section, name, value):
        if (section, name) not in TIMES:
            return None
        return b", ".join(b"%.15g" % (factor * float(number)) for number in value.split(b"#")[0].split(b","))
    return change


def reduced(files, n_steps):
    """Files with few cells, and with few steps. n_steps(files) is the number of steps of the former."""
    files = {name: map_entries(text, fewer_cells(MOST_CELLS[dimension_of(files)])) if name.endswith(".prm")
             else text for name, text in files.items()}
    steps = n_steps(files)
    if steps is None or steps <= STEPS:
        return files
    return {name: map_entries(text, shorter(STEPS / steps)) if name.endswith(".prm") else text
            for name, text in files.items()}


def mesh_seeds(project):
    """Every shipped mesh file in elements and in particles."""
    directory = os.path.join(project, "tests", "meshes")
    meshes = {name: read(os.path.join(directory, name)) for name in sorted(os.listdir(directory))}
    cook = os.path.join(project, "parameter_files", "stability", "scenes")
    meshes["cook_4.msh"] = read(os.path.join(cook, "cook_4.msh"))
    meshes["strip.vtk"] = STRIP_VTK
    seeds = []
    for name, text in meshes.items():
        dimension = 2 if re.search("strip|square|cook", name) else 3
        for formulation in (b"hexahedron", b"momentum consistent particle"):
            scene = SCENE % (dimension, name.encode(), formulation, b"; 0" * (dimension - 1))
            seeds.append(Seed("mesh %s as %s" % (name, formulation.decode()),
                              {"case.prm": scene, name: text}, "case.prm", mesh=name))
    return seeds


def tool_seeds(project):
    """Every kind of file that the surface of a tool is read from, above a block."""
    directory = os.path.join(project, "tests", "program")
    surface = read(os.path.join(directory, "tool.obj"))
    vertices = [line.split()[1:] for line in surface.splitlines() if line.startswith(b"v ")]
    triangles = []
    for line in surface.splitlines():
        corners = [vertices[int(number) - 1] for number in line.split()[1:]] if line.startswith(b"f ") else []
        triangles += [(corners[0], corners[k], corners[k + 1]) for k in range(1, len(corners) - 1)]
    text = b"solid tool\n" + b"".join(
        b"facet normal 0 0 0\nouter loop\n" + b"".join(b"vertex %s\n" % b" ".join(corner) for corner in corners)
        + b"endloop\nendfacet\n" for corners in triangles) + b"endsolid tool\n"
    binary = b"tool".ljust(80) + struct.pack("<I", len(triangles)) + b"".join(
        struct.pack("<12fH", 0, 0, 0, *(float(x) for corner in corners for x in corner), 0)
        for corners in triangles)
    solid = read(os.path.join(directory, "block.prm")).replace(b"@OUTPUT@", b"output")
    plane = solid
    for old, new in ((b"Dimension        = 3", b"Dimension        = 2"), (b"-1, -1, -1", b"-1, -1"),
                     (b"1, 1, 0", b"1, 0"), (b"4, 4, 2", b"4, 2"), (b"-0.2, -0.2, 0", b"-0.2, 0"),
                     (b"triangles", b"polyline")):
        plane = plane.replace(old, new)
    motion = b"\n    set Edge radius = 0.01\n    set Angle = t\n    set Displacement = 0; %s-t"
    seeds = []
    for name, scene, content in (("tool.obj", solid, surface), ("tool.stl", solid, text), ("binary.stl", solid, binary),
                                 ("outline.csv", plane, b"0, 0 # the tip\n1, 1\n\n-1, 1\n")):
        entries = name.encode() + motion % (b"" if scene is plane else b"0; ")
        seeds.append(Seed("tool " + name, {"case.prm": scene.replace(b"tool.obj", entries), name: content},
                          "case.prm", mesh=name))
    return seeds


def collect(project):
    """All seeds, not reduced yet, in a fixed order."""
    seeds = []
    for root in ("parameter_files", os.path.join("tests", "program"), os.path.join("tests", "regression")):
        root = os.path.join(project, root)
        for directory, _, names in sorted(os.walk(root)):
            for name in sorted(names):
                path = os.path.relpath(os.path.join(directory, name), root)
                if not name.endswith(".prm") or name in NOT_VALID or path.endswith(NOT_REDUCIBLE):
                    continue
                files = with_its_files(root, path)
                texts = b"\n".join(files.values())
                files = {other: text.replace(b"@OUTPUT@", b"output") for other, text in files.items()}
                label = os.path.relpath(os.path.join(directory, name), project)
                if PARTS_ENTRY.search(texts) and re.search(rb"^\s*set\s+End time", texts, re.M) and \
                        re.search(rb"^\s*set\s+Output directory", texts, re.M) and \
                        not re.search(rb"^\s*set\s+Stages", texts, re.M):  # a directory each
                    seeds.append(Seed(label, files, path))
    return seeds + mesh_seeds(project) + tool_seeds(project)

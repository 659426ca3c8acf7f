# SPDX-License-Identifier: LGPL-2.1-or-later
"""The same scene in another frame: entries of a parameter file, and the numbers of its tables transformed back.

A frame has axes that are permuted and mirrored, x' = M x + d + V t, and other units. What is written
is transformed entry by entry, by name; the results of the run are transformed back column by column, by name and unit.
"""

import collections
import itertools
import math
import re

from . import meshes

# order and signs: x'_i = signs[i] x_order[i]. shift and boost are texts of numbers in the units of the scene, along
# the axes x'. units: factors of length, mass, time and temperature.
Frame = collections.namedtuple("Frame", "order signs shift boost units")

POINTS = ("Point", "Origin", "Moments about", "Centre of spin")
VECTORS = ("Normal", "Axis")
EXPRESSIONS = ("Cells", "Where", "Refine where", "Temperature")
SYMMETRIC = ((0, 0), (1, 1), (2, 2), (1, 2), (0, 2), (0, 1))  # xx; yy; zz; yz; xz; xy
TURNS = re.compile("(angular momentum|moment|torque|spin|rotation|angular impulse)$")


def identity(dimension):
    return Frame(tuple(range(dimension)), (1,) * dimension, None, None, (1., 1., 1., 1.))


def all_axes(dimension):
    """All ways to permute and mirror the axes."""
    return [(order, signs) for order in itertools.permutations(range(dimension))
            for signs in itertools.product((1, -1), repeat=dimension)]


def determinant(frame):
    return meshes.parity(frame.order) * math.prod(frame.signs)


def has_axes(frame):
    return frame.order != tuple(range(len(frame.order))) or min(frame.signs) < 0


def number(value):
    return "%.17g" % value


def point(frame, values):
    """Coordinates in the units of the scene."""
    moved = [sign * values[axis] for axis, sign in zip(frame.order, frame.signs)]
    if frame.shift is not None:
        moved = [x + float(d) for x, d in zip(moved, frame.shift)]
    return moved


def with_sign(text, sign):
    if sign > 0 or text in ("0", "free"):
        return text
    return "-(%s)" % text


def vector(frame, components):
    """Texts of components along the new axes."""
    return [with_sign(components[axis], sign) for axis, sign in zip(frame.order, frame.signs)]


def moving(frame, components, factor=""):
    """With the velocity of the frame, times t for a displacement."""
    if frame.boost is None:
        return components
    return [text if text == "free" else "%s + %s%s" % (text, boost, factor) for text, boost in zip(components, frame.boost)]


def replaced(text, coordinate, by):
    """An expression with a coordinate replaced by something else."""
    return re.sub(r"\b%s\b" % coordinate, by, text)


def expression(frame, text):
    """An expression of the initial position."""
    if not has_axes(frame) and frame.shift is None:
        return text

    def coordinate(match):
        i = frame.order.index("xyz".index(match.group(0)))
        name = "xyz"[i]
        if frame.shift is not None:
            name = "(%s - (%s))" % (name, frame.shift[i])
        return name if frame.signs[i] > 0 else "(-%s)" % name
    return re.sub(r"\b[xyz]\b", coordinate, text)


def expressions(frame, texts):
    return [expression(frame, text) for text in texts]


def tensor(frame, components):
    """Six components of a symmetric tensor."""
    dimension = len(frame.order)
    order = list(frame.order) + list(range(dimension, 3))
    signs = list(frame.signs) + [1] * (3 - dimension)
    result = []
    for i, j in SYMMETRIC:
        index = SYMMETRIC.index(tuple(sorted((order[i], order[j]))) if order[i] != order[j] else (order[i],) * 2)
        result.append(with_sign(components[index], signs[i] * signs[j]))
    return result


def entry(frame, name, value, kind_of_section=""):
    """The value of an entry, in the frame. The kind of a section is the value of its entry `Type`."""
    n = len(frame.order)
    if not has_axes(frame) and frame.shift is None and frame.boost is None:
        return value
    if name in POINTS:
        return ", ".join(number(x) for x in point(frame, [float(x) for x in value.split(",")]))
    if name in VECTORS:
        return ", ".join(number(float(x)) for x in point(frame._replace(shift=None), [float(x) for x in value.split(",")]))
    if name == "Locations":
        locations = [coordinates.split(":") for coordinates in value.split(";")]
        return "; ".join("%s: %s" % (label, entry(frame, "Point", coordinates)) for label, coordinates in locations)
    if name == "Stress":
        return "; ".join(tensor(frame, expressions(frame, value.split("; "))))
    if name == "Angle":
        return with_sign(value, determinant(frame))
    if name == "Initial velocity":
        components = [float(x) for x in vector_of_numbers(frame, value)]
        if frame.boost is not None:
            components = [x + float(v) for x, v in zip(components, frame.boost)]
        return ", ".join(map(number, components))
    if name in ("Velocity", "Displacement", "Function", "Force"):
        components = expressions(frame, value.split("; "))
        if len(components) != n:
            return components[0]
        components = vector(frame, components)
        kind = kind_of_section if name == "Function" else name
        factor = {"Velocity": "", "velocity": "", "Displacement": "*t", "displacement": "*t"}.get(kind)
        return "; ".join(components if factor is None else moving(frame, components, factor))
    if name in EXPRESSIONS and value not in ("all", "otherwise") and not value.startswith("from "):
        return expression(frame, value)
    return value


def vector_of_numbers(frame, value):
    values = [float(x) for x in value.split(",")]
    return [number(sign * values[axis]) for axis, sign in zip(frame.order, frame.signs)]


# Tables.

def dimensions(unit, dimension):
    """The powers of length, mass, time and temperature in a unit. In the plane what has a mass is per thickness."""
    powers = collections.Counter()
    above, _, below = unit.partition("/")
    for side, sign in ((above, 1), (below.strip("()"), -1)):
        for factor in side.split():
            base, _, power = factor.partition("^")
            powers[{"K": "temperature"}.get(base, base)] += sign * int(power or 1)
    if dimension == 2 and above.split()[:1] == ["M"] and powers["L"] >= 0:
        powers["L"] -= 1
    return [powers[base] for base in ("L", "M", "T", "temperature")]


def without_units(frame, columns):
    """Columns in the units of the scene."""
    result = {}
    for name, (unit, values) in columns.items():
        factor = math.prod(f ** p for f, p in zip(frame.units, dimensions(unit, len(frame.order))))
        result[name] = unit, [value / factor for value in values]
    return result


def vectors_of(columns):
    """The names of vectors and turning vectors, each with its components by axis."""
    result = collections.defaultdict(dict)
    for name in columns:
        found = re.fullmatch("(.*) ([xyz])", name)
        if found:
            result[found.group(1)]["xyz".index(found.group(2))] = name
    return result


def transformed_back(frame, columns):
    """Columns of a run in the frame as those of the scene itself, without those that have no counterpart there."""
    columns = without_units(frame, columns)
    result = dict(columns)
    n = len(frame.order)
    sign_of_turns = determinant(frame)
    for name, components in vectors_of(columns).items():
        is_turn = TURNS.search(name) is not None
        if is_turn and n == 2:
            axes = [(2, 2, sign_of_turns)] if 2 in components else []
        else:
            axes = [(axis, i, sign * (sign_of_turns if is_turn else 1))
                    for i, (axis, sign) in enumerate(zip(frame.order, frame.signs)) if i in components]
        for component in components.values():
            result.pop(component)
        for axis, i, sign in axes:
            unit, values = columns[components[i]]
            if name.endswith("position") and frame.shift is not None:
                values = [x - float(frame.shift[i]) for x in values]
            if frame.boost is not None:
                values = at_rest(name, values, columns["time"][1], float(frame.boost[i]) if i < n else 0.)
            if values is not None:
                result["%s %s" % (name, "xyz"[axis])] = unit, [sign * value for value in values]
    if frame.shift is not None:
        about_origin(frame, columns, result)
    return result


def at_rest(name, values, times, velocity):
    """Components of a vector without the velocity of the frame, or None where it is another kind of vector."""
    if name.endswith("velocity"):
        return [value - velocity for value in values]
    if re.search("(position|displacement)$", name):
        return [value - velocity * time for value, time in zip(values, times)]
    return None if "momentum" in name else values


def about_origin(frame, columns, result):
    """Angular momentum about the origin of the scene instead of that about the origin of the frame: L - d x p."""
    n = len(frame.order)
    shift = [float(d) for d in frame.shift] + [0.] * (3 - n)
    momenta = [columns["momentum " + axis][1] for axis in "xyz"[:n]] if "momentum x" in columns else []
    if not momenta:
        return
    momenta += [[0.] * len(momenta[0])] * (3 - n)
    order, signs = list(frame.order) + list(range(n, 3)), list(frame.signs) + [1] * (3 - n)
    for i in range(3):
        name = "angular momentum " + "xyz"[order[i]]
        if name in result:
            j, k = (i + 1) % 3, (i + 2) % 3
            arm = [shift[j] * pk - shift[k] * pj for pj, pk in zip(momenta[j], momenta[k])]
            sign = signs[i] * determinant(frame)
            unit, values = result[name]
            result[name] = unit, [value - sign * a for value, a in zip(values, arm)]

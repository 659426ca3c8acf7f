# SPDX-License-Identifier: LGPL-2.1-or-later
"""A parameter file with its mesh and tables, filled by the readers of decks."""

from pathlib import Path

from .mesh import usable
from .msh import Writer
from .text import DeckError

PARTICLES = "momentum consistent particle"
MOST_NODES_OF_A_PREDICATE = 100
LARGEST_RATIO_OF_DENSITIES = 1000
STEPS_OF_INTEGRAL = 20
# Of the flow stress of Johnson and Cook: no temperature is above the reference.
WITHOUT_SOFTENING = {"Thermal exponent": "1", "Melting temperature": "2e+09", "Reference temperature": "1e+09"}
KINDS = (("Conditions", "Condition"), ("Initial conditions", "Initial condition"), ("Contacts", "Contact"),
         ("Body contacts", "Body contact"), ("Processes", "Process"))


class NotUnderstood(Exception):
    """Why a condition is left out."""


def number(value):
    return f"{value:.10g}"


def vector(values, separator="; "):
    return separator.join(number(value) + "" for value in values)


def lines_of_entries(entries, indent=""):
    """Entries and subsections; names that begin with # are comments."""
    width = max((len(name) for name, value in entries.items() if not isinstance(value, dict) and name[0] != "#"),
                default=0)
    for name, value in entries.items():
        if name.startswith("#"):
            yield f"{indent}# {value}"
        elif not isinstance(value, dict):
            yield f"{indent}set {name:{width}} = {value}".rstrip()
    for name, value in entries.items():
        if isinstance(value, dict):
            yield from lines_of_section(name, value, indent)


def lines_of_section(head, entries, indent=""):
    yield f"{indent}subsection {head}"
    yield from lines_of_entries(entries, indent + "  ")
    yield f"{indent}end"


class Part:
    def __init__(self, name, group, formulation, material, entries=None):
        self.name, self.group, self.formulation, self.material = name, group, formulation, material
        self.entries = entries or {}  # of the section of its formulation

    def lines(self):
        head = {"Cells": "all" if self.group is None else f"group {self.group}", "Formulation": self.formulation,
                "Material": self.material}
        if self.entries:
            head[self.formulation] = self.entries
        return lines_of_section(f"Part: {self.name}", head)


class Scene:
    def __init__(self, source, target, report, mesh):
        self.source, self.target, self.report, self.mesh = Path(source), Path(target), report, mesh
        self.title = usable(self.source.stem)
        self.end_time = None
        self.has_midsides = False  # whether there are nodes in the middle of edges
        self.mesh_entries = {}
        self.without_density = set()  # materials of which the deck says none
        self.head = {}        # further entries outside of all sections
        self.parts = []
        self.materials = {}   # entries by name, with comments
        self.named = {kind: {} for kind, _ in KINDS}  # a comment and entries by name
        self.sections = {}    # further ones
        self.stages = {}      # entries by name
        self.tables = {}      # rows by file name

    def add(self, kind, word, entries, comment="", name=""):
        """Gives a condition or contact a name: a word and a number, or one that it has."""
        named = self.named[kind]
        name = f"{name} ({len(named) + 1})" if name in named else name or f"{word} {len(named) + 1}"
        named[name] = comment, entries
        return name

    def output(self):
        return self.sections.setdefault("Output", {})

    def ask_for(self, table):
        """A table that is written on request."""
        output = self.output()
        known = [word for word in output.get("Further outputs", "").split(", ") if word]
        output["Further outputs"] = ", ".join(dict.fromkeys(known + [table]))

    def table(self, name, points):
        """The name of the file of a function of time."""
        file = f"{self.target.stem}_{name}.csv"
        self.tables[file] = f"# {name} of {self.source.name}\n" + "".join(f"{x:.10g}, {y:.10g}\n" for x, y in points)
        return file

    # Nodes and faces.

    def selection(self, nodes, name=""):
        """Entries that select nodes: a boundary whose faces have them, or a predicate. name is that of their set in the
        mesh, if there is one."""
        mesh = self.mesh
        nodes = {node for node in nodes if node in self.nodes_of_elements()}
        if not nodes:
            raise NotUnderstood("none of its nodes is one of a cell")
        on_faces = {node for face in mesh.faces_of_nodes(nodes) for node in face}
        corners = nodes & self.nodes_of_cells()
        if on_faces and on_faces == corners:
            return {"Boundary": name or self.new_set(corners)}
        predicate = self.predicate_of(nodes)
        if predicate is not None:
            return {"Where": predicate}
        if not on_faces:
            raise NotUnderstood(f"its {len(nodes)} nodes make no face of the boundary" + (
                ", and others lie where they do" if self.has_others_at(nodes) else ""))
        self.report.remark(f'{len(corners) - len(on_faces)} of {len(corners)} nodes of "{name}" are on none of its faces: '
                           "conditions leave them out.")
        return {"Boundary": name or self.new_set(corners)}

    def nodes_of_cells(self):
        if not hasattr(self, "in_cells"):
            self.in_cells = {node for cell in self.mesh.cells for node in cell.nodes}
        return self.in_cells

    def nodes_of_elements(self):
        """With those between the corners where elements have them."""
        return self.nodes_of_cells() | self.mesh.midsides if self.has_midsides else self.nodes_of_cells()

    def places_of_elements(self):
        if not hasattr(self, "places"):
            self.places = [self.mesh.points[node] for node in self.nodes_of_elements()]
        return self.places

    def new_set(self, nodes):
        sets = self.mesh.node_sets
        for name, members in sets.items():
            if set(members) == nodes:
                return name
        name = f"nodes {len(sets) + 1}"
        sets[name] = sorted(nodes)
        return name

    def new_surface(self, faces, name):
        if name not in self.mesh.surfaces:
            self.mesh.surfaces[name] = [tuple(face) for face in faces]
        return name

    def at_start(self, nodes):
        """Entries of an initial condition that select nodes: parts, a predicate, or a predicate in a part. Nothing where
        there are none."""
        names = self.parts_of_nodes(nodes)
        if names:
            return {} if len(names) == len(self.parts) else {"Part": ", ".join(names)}
        nodes = set(nodes) & self.nodes_of_cells()
        for part in (None, *self.parts):
            among = self.nodes_of_part(part) if part else None
            predicate = self.predicate_of(nodes, among) if part is None or nodes <= among else None
            if predicate is not None:
                return {**({"Part": part.name} if part else {}), "Where": predicate}
        return None

    def predicate_of(self, nodes, among=None):
        """A predicate of a box, or of the places of few nodes, that these nodes alone fulfil, if there is one: of all nodes
        or among some."""
        predicate, points = self.box_of(nodes, among), self.mesh.points
        if predicate is not None or len(nodes) > MOST_NODES_OF_A_PREDICATE or self.has_others_at(nodes, among):
            return predicate
        return " || ".join("(" + self.near(range(self.mesh.dimension), points[node], points[node]) + ")"
                           for node in sorted(nodes))

    def has_others_at(self, nodes, among=None):
        """Whether other nodes lie where these do, as where bodies touch."""
        def at(node):
            return tuple(round(x / self.tolerance()) for x in self.mesh.points[node])
        places = {at(node) for node in nodes}
        return any(at(node) in places for node in (self.nodes_of_elements() if among is None else among) - set(nodes))

    def box_of(self, nodes, among=None):
        """A predicate of a box that has these nodes alone, if there is one."""
        if not nodes:
            raise NotUnderstood("none of its nodes is one of a cell")
        mesh, dimension = self.mesh, self.mesh.dimension
        points = [mesh.points[node] for node in nodes]
        low, high = ([end(point[d] for point in points) for d in range(dimension)] for end in (min, max))
        eps = self.tolerance()
        everything = self.places_of_elements() if among is None else [mesh.points[node] for node in among]
        inside = sum(all(a - eps <= x <= b + eps for x, a, b in zip(point, low, high)) for point in everything)
        if inside != len(nodes):
            return None
        axes = [d for d in range(dimension)
                if any(not low[d] - eps <= point[d] <= high[d] + eps for point in everything)]
        return self.near(axes, low, high) if axes else "1"

    def tolerance(self):
        if not hasattr(self, "eps"):
            self.eps = float(f"{1e-6 * self.mesh.largest_extent():.0e}")
        return self.eps

    def near(self, axes, low, high):
        eps, terms = self.tolerance(), []
        for d in axes:
            name = "xyz"[d]
            if high[d] - low[d] <= eps:
                terms.append(f"abs({name} - {number(low[d])}) < {eps:g}".replace("- -", "+ "))
            else:
                terms.append(f"{name} > {number(low[d] - eps)} && {name} < {number(high[d] + eps)}")
        return " && ".join(terms)

    def parts_of_nodes(self, nodes):
        """Names of the parts whose nodes these are; None where they are others."""
        nodes = set(nodes) & self.nodes_of_cells()
        names, found = [], set()
        for part in self.parts:
            own = self.nodes_of_part(part)
            if own <= nodes:
                names.append(part.name)
                found |= own
        return names if found == nodes and names else None

    def nodes_of_part(self, part):
        return self.nodes_of_cells() if part.group is None else self.mesh.nodes_of_groups([part.group])

    def part(self, name):
        return next(part for part in self.parts if part.name == name)

    def share_nodes(self, one, other):
        return bool(self.nodes_of_part(self.part(one)) & self.nodes_of_part(self.part(other)))

    # The file.

    def files(self):
        directory = self.target.parent
        result = {self.target: self.text(), self.mesh_file(): Writer(self.mesh, self.source.name).text()}
        result.update((directory / name, text) for name, text in self.tables.items())
        return result

    def mesh_file(self):
        return self.target.with_suffix(".msh")

    def text(self):
        return "\n".join(self.lines()) + "\n"

    def lines(self):
        yield f"# Written by scripts/import from {self.source.name}. Read it before it is run."
        units = unit_labels(self.densities())
        if units:
            yield "# The densities are those of metals in these units. Without the first sign tables and reports have them:"
            yield f"# set Unit labels = {units}"
        else:
            yield "# The densities do not tell the units; those of the file must be consistent."
        entries = {"Title": self.title, "Dimension": self.mesh.dimension}
        if self.end_time:
            entries["End time"] = number(self.end_time)
        else:
            entries["#end"] = "set End time = ...  The deck does not say when the run ends."
        entries["Output directory"] = f"output/{usable(self.source.stem)}"
        entries.update(self.head)
        if self.stages:
            entries["Stages"] = ", ".join(self.stages)
        entries["Parts"] = ", ".join(part.name for part in self.parts)
        entries["Materials"] = ", ".join(self.materials)
        for kind, _ in KINDS:
            if self.named[kind] and kind not in entries:
                # Stages but the first one begin as the one before ends.
                of_first = kind == "Initial conditions" and self.stages
                (next(iter(self.stages.values())) if of_first else entries)[kind] = ", ".join(self.named[kind])
        yield from lines_of_entries(entries)
        yield ""
        yield from lines_of_section("Mesh", {"Type": "file", **self.mesh_entries, "file": {"File": self.mesh_file().name}})
        for name, stage in self.stages.items():
            yield ""
            yield from lines_of_section(f"Stage: {name}", stage)
        for part in self.parts:
            yield ""
            yield from part.lines()
        for name, (comments, entries) in self.materials.items():
            yield ""
            yield from (f"# {comment}" for comment in comments)
            yield from lines_of_section(f"Material: {name}", entries)
        for kind, word in KINDS:
            for name, (comment, entries) in self.named[kind].items():
                yield ""
                if comment:
                    yield f"# {comment}"
                yield from lines_of_section(f"{word}: {name}", entries)
        for name, entries in ((name, entries) for name, entries in self.sections.items() if entries):
            yield ""
            yield from lines_of_section(name, entries)
        yield from self.report.comments()

    def densities(self):
        for name, (_, entries) in self.materials.items():
            for section in () if name in self.without_density else entries.values():
                if isinstance(section, dict) and "Density" in section:
                    yield float(section["Density"])


def unit_labels(densities):
    """The likely units by the density of metals, as a comment; None where it tells nothing."""
    densities = list(densities)
    systems = (("mass: kg, length: m, time: s", 1), ("mass: t, length: mm, time: s", 1e-12),
               ("mass: kg, length: mm, time: ms", 1e-9), ("mass: g, length: mm, time: ms", 1e-6),
               ("mass: g, length: cm, time: us", 1e-3))
    for labels, factor in systems:
        if densities and all(500 <= density / factor <= 23000 for density in densities):
            return labels
    return None


def refuse_mixed_units(densities):
    """Densities of solids in one system of units are of the same magnitude. Each is a value, a name and a place."""
    ordered = sorted(densities)
    if len(ordered) > 1 and ordered[-1][0] > LARGEST_RATIO_OF_DENSITIES * ordered[0][0]:
        (low, low_name, low_place), (high, high_name, high_place) = ordered[0], ordered[-1]
        raise DeckError(
            f"{high_place}: the density of material {high_name} is {high:g}, and that of material {low_name} "
            f"({low_place}) is {low:g}: these are not in the same units. Allowed is a factor of up to "
            f"{LARGEST_RATIO_OF_DENSITIES}; write all materials in the units of the mesh.")


def plastic_curve(points, fail):
    """Flow stresses over plastic strains from zero on; constant before the first point."""
    before = [point for point in points if point[0] < 0]
    points = [point for point in points if point[0] >= 0]
    if before and points and points[0][0] > 0:
        (e, s), (next_e, next_s) = before[-1], points[0]
        points.insert(0, (0, s - e * (next_s - s) / (next_e - e)))
    elif points and points[0][0] > 0:
        points.insert(0, (0, points[0][1]))
    if not points or min(stress for _, stress in points) <= 0:
        fail("a curve of hardening needs flow stresses larger than zero over plastic strains from zero on.")
    strains = [strain for strain, _ in points]
    if any(b <= a for a, b in zip(strains, strains[1:])):
        fail("the strains of a curve of hardening must increase.")
    return points


def integral(points):
    """Of a table over time, with points between where it bends."""
    way, result = 0.0, []
    for (t, v), (next_t, next_v) in zip(points, points[1:]):
        steps = 1 if v == next_v else STEPS_OF_INTEGRAL
        for k in range(steps):
            share = k / steps
            result.append((t + share * (next_t - t), way + share * (next_t - t) * (v + share * (next_v - v) / 2)))
        way += (next_t - t) * (v + next_v) / 2
    return [*result, (points[-1][0], way)]


def interpolated(points, x):
    """The value of a table, constant beyond its ends."""
    if x <= points[0][0]:
        return points[0][1]
    for (a, f), (b, g) in zip(points, points[1:]):
        if x <= b:
            return f + (g - f) * (x - a) / (b - a)
    return points[-1][1]


def at_one_temperature(constants, temperature, remarks):
    """Constants of a scene without heat: those over the temperature are those of the start."""
    result = {}
    for name, text in constants.items():
        if name == "Thermal expansion":
            remarks.append("No step has heat: the thermal expansion is left out.")
            continue
        if ":" in text:
            points = [tuple(float(word) for word in pair.split(":")) for pair in text.split(",")]
            text = number(interpolated(points, temperature))
            remarks.append(f"No step has heat: {name} is that of the temperature {temperature:g}.")
        result[name] = text
    return result


def over_temperature(points):
    """The text of pairs of temperature and value."""
    return ", ".join(f"{number(temperature)}: {number(value)}" for temperature, value in points)


def expansion_increments(points, zero, fail):
    """Of coefficients that give the whole expansion since a temperature, those of its increments: the derivative of
    α(T) (T - zero) for α that is linear between temperatures and constant beyond them."""
    if any(b <= a for (a, _), (b, _) in zip(points, points[1:])):
        fail("the temperatures of an expansion must increase.")
    if len(points) < 2:
        return points
    gap = 1e-6 * (points[-1][0] - points[0][0])
    result = [(points[0][0] - gap, points[0][1])]
    for (t, a), (next_t, b) in zip(points, points[1:]):
        slope = (b - a) / (next_t - t)
        result += [(t + gap, a + slope * (t - zero)), (next_t - gap, b + slope * (next_t - zero))]
    return [*result, (points[-1][0] + gap, points[-1][1])]


def tabular_over(entry, rows):
    """Of (strain rate or temperature, points of a curve): a table over all their strains, constant beyond a curve's end."""
    strains = sorted({strain for _, points in rows for strain, _ in points})
    return {"Flow stress": "tabular", "tabular": {
        "Plastic strains": ", ".join(map(number, strains)),
        entry: ", ".join(number(value) for value, _ in rows),
        "Flow stresses": "; ".join(", ".join(number(interpolated(points, strain)) for strain in strains) for _, points in rows)}}


def tabular(points):
    return {"Flow stress": "tabular", "tabular": {
        "Plastic strains": ", ".join(number(strain) for strain, _ in points),
        "Flow stresses": ", ".join(number(stress) for _, stress in points)}}


def linear_hardening(stress, slope):
    return {"Flow stress": "linear hardening",
            "linear hardening": {"Yield stress": number(stress), "Hardening modulus": number(slope)}}

# SPDX-License-Identifier: LGPL-2.1-or-later
"""Supports, drives and loads: *BOUNDARY_..., *LOAD_..., TC of *NODE."""

from ..node_forces import NodeForces
from ..scene import NotUnderstood, integral, number

AXES = "xyz"
NEVER = 1e19


def components(converter, axes, text="0", other="free"):
    """Functions along axes. Supports along z alone are none in two dimensions."""
    if text != "0" and not set(axes) & set(AXES[:converter.mesh.dimension]):
        raise NotUnderstood("in two dimensions there is nothing along z")
    return "; ".join(text if axis in axes else other for axis in AXES[:converter.mesh.dimension])


def hold_nodes(converter):
    """TC of *NODE: a support for each set of nodes."""
    supports = {}  # a boundary and axes by nodes
    for axis, nodes in converter.mesh.held.items():
        name = converter.mesh.names.get(("held", axis))
        converter.links.links.prescribe(nodes, {AXES.index(axis): "0"})
        if name:
            supports.setdefault(frozenset(nodes), (name, []))[1].append(axis)
    for nodes, (name, axes) in supports.items():
        try:
            where = converter.scene.selection(nodes, name)
        except NotUnderstood as reason:
            converter.report.note(converter.mesh.first_held, f"TC of *NODE: {reason}, so that this is left out.")
            continue
        converter.scene.add("Conditions", "support", fixed(converter, where, axes, {}), "TC of *NODE")


def held_axes(record):
    if any([record.integer("DOFR" + axis) for axis in "XYZ"]):
        record.section.deck.report.count(record.line.place, f"DOFRX, DOFRY and DOFRZ of *{record.section.keyword} are not "
                                         "used: nodes of solids do not turn.")
    return [axis for axis in AXES if record.integer("DOF" + axis.upper()) != 0]


def fixed(converter, where, axes, entries):
    if len(axes) == 3:
        return {**where, "Type": "clamp", **{name: text for name, text in entries.items() if name != "Axes"}}
    return {**where, "Type": "displacement", **entries, "Function": components(converter, axes)}


def in_axes(converter, record, axes):
    """Directions in a local system (CID) as axes of the coordinates, or as they are with the entry `Axes`."""
    number_of_system = record.peek("CID")
    if not number_of_system or not axes:
        return axes, {}
    local = converter.systems.get(record.integer("CID"))
    if len(axes) == 3:
        return axes, {}
    if local is None:
        raise NotUnderstood(f"CID = {record.text('CID')} is no *DEFINE_COORDINATE_SYSTEM or _VECTOR of this file")
    along = [AXES[d] for axis in axes for d in range(3) if abs(local[AXES.index(axis)][d]) > 1 - 1e-9]
    if len(along) == len(axes):
        return sorted(set(along)), {}
    return axes, local_axes(converter, local, f"CID = {record.text('CID')}")


def local_axes(converter, directions, what):
    """The entry of unit vectors."""
    if converter.mesh.dimension == 3:
        return {"Axes": "; ".join(", ".join(map(number, direction)) for direction in directions[:2])}
    if abs(directions[2][2]) < 1 - 1e-9:
        raise NotUnderstood(f"{what} has no axis along z, about which those of two dimensions turn")
    if directions[2][2] < 0:
        raise NotUnderstood(f"{what} has its z axis against that of the coordinates, which two dimensions do not have")
    return {"Axes": ", ".join(map(number, directions[0][:2]))}


def is_at_rest(converter):
    def says(keyword, field):
        return any(record.peek(field) == 1 for section in converter.deck.named(keyword) for record in section.records())
    return says("CONTROL_IMPLICIT_GENERAL", "IMFLAG") and not says("CONTROL_IMPLICIT_DYNAMICS", "IMASS")


def times(converter, record):
    """`Start` and `End` of what has BIRTH and DEATH."""
    entries, end = {}, converter.scene.end_time
    birth, death = record.peek("BIRTH"), record.peek("DEATH")
    if is_at_rest(converter) and (birth > 0 or 0 < death < (end or death + 1)):
        return {}  # fields that are not read
    if record.number("BIRTH") > 0:
        entries["Start"] = number(birth)
    if record.number("DEATH") > 0 and not (end and death >= end) and death < NEVER:
        entries["End"] = number(death)
    return entries


def local_systems(deck):
    """*DEFINE_COORDINATE_SYSTEM and _VECTOR: unit vectors of their axes, by number."""
    systems = {}
    for section in deck.named("DEFINE_COORDINATE_SYSTEM", "DEFINE_COORDINATE_VECTOR"):
        section.is_read = True
        for record in section.records():
            origin = [record.number(axis + "O") for axis in "XYZ"]
            first, second = (("{}L", "{}P") if section.name.endswith("SYSTEM") else ("{}X", "{}V"))
            x = [record.number(first.format(axis)) - o for axis, o in zip("XYZ", origin)]
            in_plane = [record.number(second.format(axis)) - o for axis, o in zip("XYZ", origin)]
            z = cross(x, in_plane)
            y = cross(z, x)
            lengths = [sum(c * c for c in v) ** 0.5 for v in (x, y, z)]
            if min(lengths) > 0:
                systems[record.integer("CID")] = [[c / length for c in v] for v, length in zip((x, y, z), lengths)]
    return systems


def vectors(deck):
    """*DEFINE_VECTOR: unit vectors by number."""
    result = {}
    for section in deck.named("DEFINE_VECTOR"):
        section.is_read = True
        for record in section.records():
            way = [record.number(axis + "H") - record.number(axis + "T") for axis in "XYZ"]
            if any(way) and not record.peek("CID"):
                result[record.integer("VID")] = unit(way)
    return result


def unit(vector):
    length = sum(c * c for c in vector) ** 0.5
    return [c / length for c in vector]


def cross(a, b):
    return [a[d - 2] * b[d - 1] - a[d - 1] * b[d - 2] for d in range(3)]


def are_ends(converter, record, nodes, texts):
    """Prescribes texts by axis of ends of links that are in no cell; whether that is all that the card does."""
    return not record.unused() and converter.links.links.prescribe(nodes, texts)


def support(converter, record):
    nodes = converter.nodes_named_by(record)
    axes, entries = in_axes(converter, record, held_axes(record))
    if "BIRTH" in record.fields:
        entries.update(times(converter, record))
    if not entries and are_ends(converter, record, nodes, {AXES.index(axis): "0" for axis in axes}):
        return
    where = converter.node_set(record)
    yield "Conditions", "support", fixed(converter, where, axes, entries) if is_support(converter, axes) else None


def is_support(converter, axes):
    return bool(set(axes) & set(AXES[:converter.mesh.dimension]))


def support_of_nodes(converter, section):
    """*BOUNDARY_SPC_NODE: nodes with equal directions are one support."""
    groups = {}

    def read(record):
        axes, entries = in_axes(converter, record, held_axes(record))
        node = converter.mesh.node(record.integer("NID"), record.line)
        if "BIRTH" in record.fields:
            entries.update(times(converter, record))
        converter.refuse_unused(record)
        if is_support(converter, axes) and (entries or not are_ends(converter, record, [node], {AXES.index(axis): "0" for axis in axes})):
            groups.setdefault((tuple(axes), tuple(entries.items())), []).append((node, record.line))

    def hold(axes, entries, nodes, place):
        converter.scene.add("Conditions", "support", fixed(converter, converter.scene.selection(nodes), axes, dict(entries)), place)

    converter.each_record(section, read)
    for (axes, entries), members in groups.items():
        nodes, lines = zip(*members)
        converter.attempt(section, lines, hold, axes, entries, nodes, lines[0].place)


def function_of_time(converter, record, factor_field="SF"):
    """A factor times a curve."""
    curve = record.integer("LCID")
    if curve not in converter.curves:
        raise NotUnderstood(f"LCID = {curve} is no *DEFINE_CURVE of this file")
    factor = record.number(factor_field) or 1
    return factor, curve


def times_table(converter, factor, curve, start=""):
    """The time of the curve begins at the start."""
    converter.curves.along_time(curve)
    return f"{number(factor)}*table({converter.table(curve)}, t{' - ' + start if start else ''})"


def motion(converter, record):
    nodes = converter.nodes_named_by(record)
    axis, kind = record.integer("DOF"), record.integer("VAD")
    if axis in (5, 6, 7):
        raise NotUnderstood(f"DOF = {axis} is a rotation of nodes, and nodes of solids do not turn (9, 10 and 11 turn them "
                            "about an axis)")
    if axis not in (1, 2, 3, 4, -4, 9, 10, 11):
        raise NotUnderstood(f"DOF = {axis} is not understood (1, 2, 3, 4, -4 and 9, 10, 11 are)")
    if kind not in (0, 2):
        raise NotUnderstood(f"VAD = {kind} is not understood (0 and 2 are)")
    factor, curve = function_of_time(converter, record)
    if axis > 4:
        acting = times(converter, record)
        entries = turning(converter, record, AXES[axis - 9], kind, factor, curve, acting.get("Start", ""))
        yield "Conditions", "drive", {**entries, **acting}
        return
    entries = times(converter, record)
    start = entries.get("Start", "")
    if abs(axis) == 4:
        entries.update(along_vector(converter, record))
    if record.unused():
        return
    if abs(axis) == 4:
        yield "Conditions", "drive", {
            **where_of(converter, record, nodes), "Type": "velocity" if kind == 0 else "displacement", **entries,
            "Function": components(converter, "x", times_table(converter, factor, curve, start), "free" if axis == 4 else "0")}
        return
    if not entries and any(node in converter.links.links.prescribed for node in nodes):
        way = times_table(converter, factor, curve) if kind == 2 else way_of(converter, factor, curve)
        if are_ends(converter, record, nodes, {axis - 1: way}):
            return
    yield "Conditions", "drive", {
        **where_of(converter, record, nodes), "Type": "velocity" if kind == 0 else "displacement", **entries,
        "Function": components(converter, AXES[axis - 1], times_table(converter, factor, curve, start))}


def along_vector(converter, record):
    """The entry of axes, of which the first is along *DEFINE_VECTOR."""
    direction = converter.vectors.get(record.integer("VID"))
    if direction is None:
        raise NotUnderstood(f"VID = {record.text('VID')} is no *DEFINE_VECTOR of this file with a length")
    least = min(range(3), key=lambda d: abs(direction[d]))
    across = unit(cross(direction, [float(d == least) for d in range(3)]))
    if converter.mesh.dimension == 2:
        across = [-direction[1], direction[0], 0.0]
    return local_axes(converter, (direction, across, cross(direction, across)), f"VID = {record.text('VID')}")


def where_of(converter, record, nodes):
    return converter.node_set(record) if "NSID" in record.fields else converter.scene.selection(nodes)


def way_of(converter, factor, curve, start=""):
    """A factor times the integral of a curve, whose time begins at the start."""
    converter.curves.along_time(curve)
    time = f"t - {start}" if start else "t"
    return f"{number(factor)}*table({converter.table(integrated(converter, curve))}, {time})"


def turning(converter, record, axis, kind, factor, curve, start):
    """DOF 9, 10 and 11: nodes turn about an axis, along which they are free."""
    along = AXES.index(axis)
    if converter.mesh.dimension == 2 and axis != "z":
        raise NotUnderstood("in two dimensions nodes turn about z (DOF = 11)")
    where = where_of(converter, record, converter.nodes_named_by(record))
    centre = [0.0, 0.0, 0.0]
    # The coordinates of a point of the axis, in cyclic order.
    for field, d in (("OFFSET1", along - 2), ("OFFSET2", along - 1)):
        centre[d] = record.number(field)
    entries = {**where, "Type": "displacement"}
    if converter.mesh.dimension == 3:
        entries["Function"] = components(converter, axis, "free", "0")
        entries["Axis"] = ", ".join("1" if other == axis else "0" for other in AXES)
    entries["Angle"] = (times_table if kind == 2 else way_of)(converter, factor, curve, start)
    entries["Centre"] = ", ".join(map(number, centre[:converter.mesh.dimension]))
    return entries


def rigid_motion(converter, record):
    """*BOUNDARY_PRESCRIBED_MOTION_RIGID, of a part of *MAT_020."""
    part = record.integer("PID")
    if part not in converter.parts.rigid:
        raise NotUnderstood(f"the part {part} is no rigid one (*MAT_020)")
    axis, kind = record.integer("DOF"), record.integer("VAD")
    if axis not in (1, 2, 3, 5, 6, 7):
        raise NotUnderstood(f"DOF = {axis} is not understood (1 to 3 and 5 to 7 are)")
    if converter.mesh.dimension == 2 and axis in (3, 5, 6):
        raise NotUnderstood(f"DOF = {axis} is none of two dimensions (1, 2 and 7 are)")
    if kind not in (0, 2):
        raise NotUnderstood(f"VAD = {kind} is not understood (0 and 2 are)")
    factor, curve = function_of_time(converter, record)
    converter.until_the_end(record, "DEATH")
    if record.unused():
        return
    converter.curves.along_time(curve)
    if kind == 0:
        curve = integrated(converter, curve)
    text = f"{number(factor)}*table({converter.table(curve)}, t)"
    entries = converter.scene.part(converter.parts.names[part]).entries
    if axis <= 3:
        terms = entries["Displacement"].split("; ")
        terms[axis - 1] = text
        entries["Displacement"] = "; ".join(terms)
    else:
        if entries.get("Angle"):
            raise NotUnderstood("the part turns about another axis already")
        entries.pop("Rotation", None)
        if converter.mesh.dimension == 3:
            entries["Axis"] = ", ".join("1" if d == axis - 5 else "0" for d in range(3))
        entries["Angle"] = text
    record.is_used = True
    yield from ()


def integrated(converter, number_of_curve):
    """A curve of velocity as one of displacement, with points between where it bends."""
    key = f"{number_of_curve}_integrated"
    converter.integrated[key] = integral(converter.curves[number_of_curve].points)
    return key


def load_of_nodes(converter, record):
    """*LOAD_NODE_SET: the sum of the forces as a traction on the faces of the nodes."""
    nodes = converter.members(record)
    where = converter.node_set(record)
    if "Boundary" not in where:
        raise NotUnderstood("its nodes make no face of the boundary")
    factor, curve, axis, entries = force_of(converter, record)
    if record.unused():
        return
    forces = NodeForces(converter.mesh, converter.scene.nodes_of_cells())
    forces.add(record, "", nodes, factor)
    yield "Conditions", "load", traction(converter, record.section, where, forces, curve, axis, entries)


def force_of(converter, record):
    """Factor and curve of a force, its direction, and the entry of its axes."""
    axis = record.integer("DOF")
    if axis not in (1, 2, 3):
        raise NotUnderstood(f"DOF = {axis} is not understood (1, 2 and 3 are)")
    return *function_of_time(converter, record), *in_load_axes(converter, record, AXES[axis - 1])


def traction(converter, section, where, forces, curve, axis, entries):
    area, n = converter.mesh.area(forces.faces()), len(forces.forces)
    text = times_table(converter, forces.total() / area, curve)
    converter.report.note(forces.place, f"*{section.keyword}: the force at each of {n} nodes is a traction over their faces, whose "
                          f"area is {area:g} at the start: the sum is the same, its distribution is not.")
    return {**where, "Type": "traction", "Area": "initial", **entries, "Function": components(converter, axis, text, "0")}


def forces_on_nodes(converter, section):
    """*LOAD_NODE_POINT: forces of one direction and curve are one load, where the nodes make faces together."""
    groups = {}

    def read(record):
        factor, curve, axis, entries = force_of(converter, record)
        node = converter.mesh.node(record.integer("NID"), record.line)
        converter.refuse_unused(record)
        forces, lines = groups.setdefault((curve, axis, tuple(entries.items())), (NodeForces(
            converter.mesh, converter.scene.nodes_of_cells()), []))
        forces.add(record, record.text("NID"), [node], factor)
        lines.append(record.line)

    def load(forces, curve, axis, entries):
        entries = traction(converter, section, converter.scene.selection(forces.forces), forces, curve, axis, dict(entries))
        converter.scene.add("Conditions", "load", entries, forces.place)

    converter.each_record(section, read)
    for (curve, axis, entries), (forces, lines) in groups.items():
        converter.attempt(section, lines, load, forces, curve, axis, entries)


def in_load_axes(converter, record, axis):
    """A direction in a local system (CID), and the entry of its axes."""
    if not record.peek("CID"):
        return axis, {}
    local = converter.systems.get(record.integer("CID"))
    if local is None:
        raise NotUnderstood(f"CID = {record.text('CID')} is no *DEFINE_COORDINATE_SYSTEM or _VECTOR of this file")
    return axis, local_axes(converter, local, f"CID = {record.text('CID')}")


def pressure(converter, record):
    name = converter.boundary("segment set", record.integer("SSID"), record)
    factor, curve = function_of_time(converter, record)
    birth, death = record.number("AT"), record.number("DT")
    if record.unused():
        return
    factor *= way_of_segments(converter, converter.mesh.surfaces.get(name, ()), record.line)
    yield "Conditions", "pressure", {"Boundary": name, "Type": "pressure",
                                     "Function": pressure_of_time(converter, factor, curve, birth, death)}


def way_of_segments(converter, faces, line):
    """1 where segments of the boundary are numbered as seen from outside, -1 where a pressure on them pulls."""
    ways = {converter.mesh.is_outward(face) for face in faces}
    if len(ways) > 1:
        raise NotUnderstood("its segments go round both ways: it would press on some and pull on others")
    if ways == {False}:
        converter.report.note(line.place, "the segments go round as seen from inside: a pressure on them pulls.")
    return -1 if ways == {False} else 1


def pressure_of_time(converter, factor, curve, birth, death):
    """A factor times a curve whose time begins at its birth; before it, and from its death on, there is none."""
    converter.curves.along_time(curve)
    end = converter.scene.end_time
    time = f"t - {number(birth)}" if birth > 0 else "t"
    text = f"{number(factor)}*table({converter.table(curve)}, {time})"
    if birth > 0:
        text = f"if(t < {number(birth)}, 0, {text})"
    return f"if(t < {number(death)}, {text}, 0)" if death > 0 and not (end and death >= end) else text


def pressure_on_segments(converter, section):
    """*LOAD_SEGMENT: segments with equal curves are one pressure."""
    groups = {}

    def read(record):
        factor, curve = function_of_time(converter, record)
        birth = record.number("AT")
        n_corners = 4 if converter.mesh.dimension == 3 else 2
        nodes = [converter.mesh.node(record.integer(f"N{k}"), record.line) for k in range(1, n_corners + 1)]
        converter.refuse_unused(record)
        if tuple(sorted(nodes)) not in converter.mesh.boundary_faces:
            raise NotUnderstood("it is no face of the boundary")
        groups.setdefault((factor, curve, birth), []).append((tuple(nodes), record.line))

    def press(factor, curve, birth, faces, line):
        factor *= way_of_segments(converter, faces, line)
        name = converter.scene.new_surface(faces, f"segments of {line.place}".replace('"', ""))
        converter.scene.add("Conditions", "pressure", {
            "Boundary": name, "Type": "pressure",
            "Function": pressure_of_time(converter, factor, curve, birth, 0.0)}, line.place)

    converter.each_record(section, read)
    for key, members in groups.items():
        faces, lines = zip(*members)
        converter.attempt(section, lines, press, *key, faces, lines[0])


def body_load(converter, record):
    """*LOAD_BODY_X, _Y, _Z: the base accelerates, by which bodies feel the opposite."""
    axis = record.section.name[-1].lower()
    if axis not in AXES:
        raise NotUnderstood("only *LOAD_BODY_X, _Y and _Z are understood")
    factor, curve = function_of_time(converter, record)
    if record.unused():
        return
    yield "Conditions", "gravity", {"Type": "gravity", **where_of_body_loads(converter), "Function": components(
        converter, axis, times_table(converter, -factor, curve), "0")}


def where_of_body_loads(converter):
    """*LOAD_BODY_PARTS restricts all of them to a set of parts."""
    for section in converter.deck.named("LOAD_BODY_PARTS"):
        section.is_read = True
        for record in section.records():
            number_of_set = record.integer("PSID")
            if number_of_set not in converter.mesh.sets.parts_of_set:
                raise NotUnderstood(f"there is no part set {number_of_set}")
            nodes = converter.mesh.nodes_of_groups(
                f"part {part}" for part in converter.mesh.sets.parts_of_set[number_of_set])
            if converter.scene.at_start(nodes) == {}:
                return {}
            predicate = converter.scene.box_of(nodes)
            if predicate is None:
                raise NotUnderstood("the parts of *LOAD_BODY_PARTS are neither all nor those of a box")
            return {"Where": predicate}
    return {}


def temperature(converter, record):
    where = converter.node_set(record)
    factor, curve = record.number("CMULT") or 1, record.integer("LCID")
    if record.unused():
        return
    if curve and curve not in converter.curves:
        raise NotUnderstood(f"LCID = {curve} is no *DEFINE_CURVE of this file")
    yield "Conditions", "temperature", {
        **where, "Type": "temperature", "Function": times_table(converter, factor, curve) if curve else number(factor)}


RECORDS = {"BOUNDARY_SPC_SET": support, "BOUNDARY_SPC_SET_BIRTH_DEATH": support,
           "BOUNDARY_PRESCRIBED_MOTION_SET": motion,
           "BOUNDARY_PRESCRIBED_MOTION_NODE": motion, "BOUNDARY_PRESCRIBED_MOTION_RIGID": rigid_motion,
           "LOAD_NODE_SET": load_of_nodes,
           "LOAD_SEGMENT_SET": pressure, "LOAD_BODY_X": body_load, "LOAD_BODY_Y": body_load, "LOAD_BODY_Z": body_load,
           "BOUNDARY_TEMPERATURE_SET": temperature}
SECTIONS = {"BOUNDARY_SPC_NODE": support_of_nodes, "BOUNDARY_SPC_NODE_BIRTH_DEATH": support_of_nodes,
            "LOAD_SEGMENT": pressure_on_segments, "LOAD_NODE_POINT": forces_on_nodes, "LOAD_NODE": forces_on_nodes}

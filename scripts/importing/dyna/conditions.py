# SPDX-License-Identifier: LGPL-2.1-or-later
"""Supports, drives and loads: *BOUNDARY_..., *LOAD_..., TC of *NODE."""

from ..scene import NotUnderstood, number

AXES = "xyz"


def components(converter, axes, text="0", other="free"):
    return "; ".join(text if axis in axes else other for axis in AXES[:converter.mesh.dimension])


def hold_nodes(converter):
    """TC of *NODE."""
    for axis in AXES:
        name = converter.mesh.names.get(("held", axis))
        converter.links.links.prescribe(converter.mesh.held.get(axis, ()), {AXES.index(axis): "0"})
        if name:
            converter.scene.add("Conditions", "support", {
                "Boundary": name, "Type": "displacement", "Function": components(converter, axis)}, "TC of *NODE")


def held_axes(record):
    if any([record.integer("DOFR" + axis) for axis in "XYZ"]):
        record.section.deck.report.count(record.line.place, f"DOFRX, DOFRY and DOFRZ of *{record.section.keyword} are not "
                                         "used: nodes of solids do not turn.")
    return [axis for axis in AXES if record.integer("DOF" + axis.upper()) != 0]


def fixed(converter, where, axes):
    if len(axes) == 3:
        return {**where, "Type": "clamp"}
    return {**where, "Type": "displacement", "Function": components(converter, axes)}


def in_global_axes(converter, record, axes):
    """Directions in a local system (CID), which are understood where it holds all, or stands along the axes."""
    number_of_system = record.peek("CID")
    if not number_of_system or not axes:
        return axes
    local = converter.systems.get(record.integer("CID"))
    if len(axes) == 3:
        return axes
    result = set()
    for axis in axes:
        along = [AXES[d] for d in range(3) if local and abs(local[AXES.index(axis)][d]) > 1 - 1e-9]
        if not along:
            record.fields["CID"].is_read = False
            return axes
        result.add(along[0])
    return sorted(result)


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


def cross(a, b):
    return [a[d - 2] * b[d - 1] - a[d - 1] * b[d - 2] for d in range(3)]


def are_ends(converter, record, nodes, texts):
    """Prescribes texts by axis of ends of links that are in no cell; whether that is all that the card does."""
    return not record.unused() and converter.links.links.prescribe(nodes, texts)


def support(converter, record):
    nodes = converter.nodes_named_by(record)
    axes = in_global_axes(converter, record, held_axes(record))
    if are_ends(converter, record, nodes, {AXES.index(axis): "0" for axis in axes}):
        return
    where = converter.node_set(record)
    yield "Conditions", "support", fixed(converter, where, axes) if axes else None


def support_of_nodes(converter, section):
    """*BOUNDARY_SPC_NODE: nodes with equal directions are one support."""
    nodes, first = {}, {}
    for record in section.records():
        axes = tuple(in_global_axes(converter, record, held_axes(record)))
        node = converter.mesh.node(record.integer("NID"), record.line)
        converter.refuse_unused(record)
        if axes and not are_ends(converter, record, [node], {AXES.index(axis): "0" for axis in axes}):
            nodes.setdefault(axes, []).append(node)
            first.setdefault(axes, record)
    for axes, members in nodes.items():
        converter.scene.add("Conditions", "support", fixed(converter, converter.scene.selection(members), axes),
                            first[axes].line.place)


def function_of_time(converter, record, factor_field="SF"):
    """A factor times a curve."""
    curve = record.integer("LCID")
    if curve not in converter.curves:
        raise NotUnderstood(f"LCID = {curve} is no *DEFINE_CURVE of this file")
    factor = record.number(factor_field) or 1
    return factor, curve


def times_table(converter, factor, curve):
    converter.curves.along_time(curve)
    return f"{number(factor)}*table({converter.table(curve)}, t)"


def motion(converter, record):
    nodes = converter.nodes_named_by(record)
    axis, kind = record.integer("DOF"), record.integer("VAD")
    if axis in (5, 6, 7):
        raise NotUnderstood(f"DOF = {axis} is a rotation of nodes, and nodes of solids do not turn (9, 10 and 11 turn them "
                            "about an axis)")
    if axis not in (1, 2, 3, 9, 10, 11):
        raise NotUnderstood(f"DOF = {axis} is not understood (1, 2, 3 and 9, 10, 11 are)")
    if kind not in (0, 2):
        raise NotUnderstood(f"VAD = {kind} is not understood (0 and 2 are)")
    factor, curve = function_of_time(converter, record)
    converter.until_the_end(record, "DEATH")
    if axis > 3:
        yield "Conditions", "drive", turning(converter, record, AXES[axis - 9], kind, factor, curve)
        return
    if record.unused():
        return
    if any(node in converter.links.links.prescribed for node in nodes):
        way = times_table(converter, factor, curve) if kind == 2 else way_of(converter, factor, curve)
        if are_ends(converter, record, nodes, {axis - 1: way}):
            return
    yield "Conditions", "drive", {
        **where_of(converter, record, nodes), "Type": "velocity" if kind == 0 else "displacement",
        "Function": components(converter, AXES[axis - 1], times_table(converter, factor, curve))}


def where_of(converter, record, nodes):
    return converter.node_set(record) if "NSID" in record.fields else converter.scene.selection(nodes)


def way_of(converter, factor, curve):
    """A factor times the integral of a curve."""
    converter.curves.along_time(curve)
    return f"{number(factor)}*table({converter.table(integrated(converter, curve))}, t)"


def turning(converter, record, axis, kind, factor, curve):
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
    entries["Angle"] = times_table(converter, factor, curve) if kind == 2 else way_of(converter, factor, curve)
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
        entries["Axis"] = ", ".join("1" if d == axis - 5 else "0" for d in range(3))
        entries["Angle"] = text
    record.is_used = True
    yield from ()


def integrated(converter, number_of_curve):
    """A curve of velocity as one of displacement, with points between where it bends."""
    points, way, result = converter.curves[number_of_curve].points, 0.0, []
    for (t, v), (next_t, next_v) in zip(points, points[1:]):
        steps = 1 if v == next_v else 20
        for k in range(steps):
            share = k / steps
            result.append((t + share * (next_t - t), way + share * (next_t - t) * (v + share * (next_v - v) / 2)))
        way += (next_t - t) * (v + next_v) / 2
    result.append((points[-1][0], way))
    key = f"{number_of_curve}_integrated"
    converter.integrated[key] = result
    return key


def load_of_nodes(converter, record):
    """*LOAD_NODE_SET, *LOAD_NODE_POINT: the sum of the forces as a traction on the faces of the nodes."""
    if "NSID" not in record.fields:
        raise NotUnderstood("forces on single nodes are not possible here")
    nodes = converter.members(record)
    where = converter.node_set(record)
    if "Boundary" not in where:
        raise NotUnderstood("its nodes make no face of the boundary")
    axis = record.integer("DOF")
    if axis not in (1, 2, 3):
        raise NotUnderstood(f"DOF = {axis} is not understood (1, 2 and 3 are)")
    factor, curve = function_of_time(converter, record)
    if record.unused():
        return
    area = converter.mesh.area(converter.mesh.faces_of_nodes(nodes))
    converter.report.note(record.line.place, f"*{record.section.keyword}: the force at each of {len(set(nodes))} nodes is a "
                          f"traction over their faces, whose area is {area:g}: the sum is the same, its distribution "
                          "is not.")
    yield "Conditions", "load", {
        **where, "Type": "traction", "Function": components(converter, AXES[axis - 1], times_table(
            converter, factor * len(set(nodes)) / area, curve), "0")}


def pressure(converter, record):
    name = converter.boundary("segment set", record.integer("SSID"), record)
    factor, curve = function_of_time(converter, record)
    birth, death = record.number("AT"), record.number("DT")
    if record.unused():
        return
    yield "Conditions", "pressure", {"Boundary": name, "Type": "pressure",
                                     "Function": pressure_of_time(converter, factor, curve, birth, death)}


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
    for record in section.records():
        factor, curve = function_of_time(converter, record)
        birth = record.number("AT")
        n_corners = 4 if converter.mesh.dimension == 3 else 2
        nodes = [converter.mesh.node(record.integer(f"N{k}"), record.line) for k in range(1, n_corners + 1)]
        converter.refuse_unused(record)
        groups.setdefault((factor, curve, birth), []).append((tuple(nodes), record))
    for (factor, curve, birth), faces in groups.items():
        place = faces[0][1].line.place
        wanted = [face for face, _ in faces if tuple(sorted(face)) in converter.mesh.boundary_faces]
        if len(wanted) < len(faces):
            raise NotUnderstood(f"{len(faces) - len(wanted)} of its segments are no faces of the boundary")
        name = converter.scene.new_surface(wanted, f"segments of {place}".replace('"', ""))
        converter.scene.add("Conditions", "pressure", {
            "Boundary": name, "Type": "pressure",
            "Function": pressure_of_time(converter, factor, curve, birth, 0.0)}, place)


def body_load(converter, record):
    """*LOAD_BODY_X, _Y, _Z: the base accelerates, by which bodies feel the opposite."""
    axis = record.section.name[-1].lower()
    if axis not in AXES:
        raise NotUnderstood("only *LOAD_BODY_X, _Y and _Z are understood")
    factor, curve = function_of_time(converter, record)
    if record.unused():
        return
    yield "Conditions", "gravity", {"Type": "gravity", "Function": components(
        converter, axis, times_table(converter, -factor, curve), "0")}


def temperature(converter, record):
    where = converter.node_set(record)
    factor, curve = record.number("CMULT") or 1, record.integer("LCID")
    if record.unused():
        return
    if curve and curve not in converter.curves:
        raise NotUnderstood(f"LCID = {curve} is no *DEFINE_CURVE of this file")
    yield "Conditions", "temperature", {
        **where, "Type": "temperature", "Function": times_table(converter, factor, curve) if curve else number(factor)}


RECORDS = {"BOUNDARY_SPC_SET": support, "BOUNDARY_PRESCRIBED_MOTION_SET": motion,
           "BOUNDARY_PRESCRIBED_MOTION_NODE": motion, "BOUNDARY_PRESCRIBED_MOTION_RIGID": rigid_motion,
           "LOAD_NODE_SET": load_of_nodes, "LOAD_NODE_POINT": load_of_nodes, "LOAD_NODE": load_of_nodes,
           "LOAD_SEGMENT_SET": pressure, "LOAD_BODY_X": body_load, "LOAD_BODY_Y": body_load, "LOAD_BODY_Z": body_load,
           "BOUNDARY_TEMPERATURE_SET": temperature}
SECTIONS = {"BOUNDARY_SPC_NODE": support_of_nodes, "LOAD_SEGMENT": pressure_on_segments}

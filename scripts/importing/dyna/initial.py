# SPDX-License-Identifier: LGPL-2.1-or-later
"""*INITIAL_...: velocities and temperatures at the start."""

from ..scene import NotUnderstood, number


def velocity_of(converter, record):
    return [number(record.number("V" + axis)) for axis in "XYZ"[:converter.mesh.dimension]]


def velocity(converter, record):
    """Of all nodes but some, which have one of their own."""
    values, where = velocity_of(converter, record), {}
    if record.peek("NSID") != 0:
        where = converter.nodes_as_parts(converter.members(record))
    if record.peek("NSIDEX") > 0:
        others = converter.scene.selection(converter.members(record, "NSIDEX"))
        predicate = others.get("Where") or converter.scene.box_of(set(converter.members(record, "NSIDEX")))
        if predicate is None:
            raise NotUnderstood(f"NSIDEX = {record.integer('NSIDEX')} is not understood: its nodes are neither few nor "
                                "those of a box")
        exceptions = [number(record.number(f"V{axis}E")) for axis in "XYZ"]
        values = [f"if({predicate}, {other}, {value})" if other != value else value
                  for value, other in zip(values, exceptions)]
    yield "Initial conditions", "flight", {**where, "Velocity": "; ".join(values)}


def velocity_of_node(converter, record):
    where = converter.nodes_as_parts([converter.mesh.node(record.integer("NID"), record.line)])
    yield "Initial conditions", "flight", {**where, "Velocity": "; ".join(velocity_of(converter, record))}


def generated_velocity(converter, record):
    values, where = velocity_of(converter, record), {}
    if record.peek("ID") == 0:
        record.integer("ID"), record.integer("STYP")
    elif record.peek("STYP") == 2:
        record.integer("STYP")
        where["Part"] = converter.part_names([record.integer_of("ID", "P")])
    elif record.peek("STYP") == 1:
        record.integer("STYP")
        numbers = converter.mesh.sets.parts_of_set.get(record.integer_of("ID", "S"))
        if numbers is None:
            raise NotUnderstood(f"there is no part set {record.integer_of('ID', 'S')}")
        where["Part"] = converter.part_names(numbers)
    elif record.peek("STYP") == 3:
        record.integer("STYP")
        where = converter.nodes_as_parts(converter.members(record, "ID"))
    entries = {**where, "Velocity": "; ".join(values)}
    if record.number("OMEGA"):
        axis = [record.number("N" + axis) for axis in "XYZ"]
        if axis[0] == -999:
            raise NotUnderstood("NX = -999, by which nodes give the axis, is not understood")
        length = sum(x * x for x in axis) ** 0.5
        if not length:
            raise NotUnderstood("OMEGA has no axis")
        if converter.mesh.dimension == 2 and any(axis[:2]):
            raise NotUnderstood("in two dimensions nodes turn about z")
        spin = [record.number("OMEGA") * x / length for x in axis]
        centre = [record.number(axis + "C") for axis in "XYZ"]
        if converter.mesh.dimension == 2:
            spin, centre = spin[2:], centre[:2]
        entries["Spin"] = ", ".join(map(number, spin))
        entries["Centre of spin"] = ", ".join(map(number, centre))
    yield "Initial conditions", "flight", entries


def velocity_of_rigid_body(converter, record):
    part = record.integer("PID")
    yield "Initial conditions", "flight", {"Part": converter.part_names([part]),
                                           "Velocity": "; ".join(velocity_of(converter, record))}


def temperature(converter, record):
    value = record.number("TEMP")
    where = {}
    if record.peek("NSID") != 0:
        where = converter.nodes_as_parts(converter.members(record))
    else:
        record.integer("NSID")
    yield "Initial conditions", "heat", {**where, "Temperature": number(value)}


RECORDS = {"INITIAL_VELOCITY": velocity, "INITIAL_VELOCITY_NODE": velocity_of_node,
           "INITIAL_VELOCITY_GENERATION": generated_velocity, "INITIAL_VELOCITY_RIGID_BODY": velocity_of_rigid_body,
           "INITIAL_TEMPERATURE_SET": temperature}

# SPDX-License-Identifier: LGPL-2.1-or-later
"""*RIGIDWALL_... and *CONTACT_...: contacts with rigid surfaces and between bodies."""

import re
from itertools import combinations

from ..scene import PARTICLES, NotUnderstood, number

STICKING = 10  # the largest coefficient of friction here
MOST_PAIRS = 45
KINDS = re.compile("SURFACE_TO_SURFACE|NODES_TO_SURFACE|SINGLE_SURFACE|AUTOMATIC_GENERAL")
OFFSET = re.compile("(_CONSTRAINED|_BEAM)?_OFFSET")
# What is not read, by a part of its name, and what to take instead.
OTHER_KINDS = (
    ("TIEBREAK|FAILURE", "no contact here holds bodies until a stress (nearest are `Type = tied`, which does not break, or a layer of "
                 "particles that shares its nodes with both and has `Bond failure = principal stress`)"),
    ("TIED_WELD", "it is no tie from the start (take `Type = touching` with a `Bonding temperature`)"),
    ("DRAWBEAD", "beads are no contacts here (take a `traction` on the sheet, or make the bead a part of the tool)"),
    ("SPOTWELD", "beams are no cells (nearest is a `Body contact` with `Type = tied`)"),
    ("BEAM|SHELL_EDGE", "beams and edges of shells are no cells"),
    ("2D", "its sides are those of a plane (write a section \"Body contact: NAME\")"),
    ("SLIDING|ORTHO_FRICTION|LUBRICATION|COMPOSITE", "contact of this kind is not understood"))
# Fields of contacts that say how stiff or how often, not where or when.
NUMERICAL = ("SPR", "MPR", "PENCHK", "SFS", "SFM", "SST", "MST", "SFST", "SFMT", "FSF", "VSF", "SOFT", "SOFSCL", "MAXPAR",
             "SBOPT", "DEPTH", "BSORT", "FRCFRQ", "PENMAX", "THKOPT", "SHLTHK", "SNLOG", "ISYM", "I2D3D", "SLDTHK",
             "SLDSTF", "IGAP", "IGNORE", "DPRFAC", "DTSTIF", "EROSOP", "IADJ", "VDC", "VC",
             # Heat that passes, which the bodies do without.
             "K", "FRAD", "H0", "LMIN", "LMAX", "FTOSLV", "BC_FLG", "ALGO")


def friction_of(record, entries):
    friction = record.number("FRIC")
    if friction > 1:
        raise NotUnderstood(f"FRIC = {friction:g} is not understood (0 to 1 are)")
    if friction == 1:
        entries["#stick"] = "FRIC = 1: nothing slides in LS-DYNA."
        friction = STICKING
    entries["Friction"] = number(friction)


def nodes_of_wall(converter, record):
    """The nodes that can touch."""
    entries = {}
    if record.peek("NSID") != 0:
        entries = converter.node_set(record)
    if record.peek("NSIDEX") > 0:
        exempt = set(converter.members(record, "NSIDEX"))
        nodes = set(converter.members(record)) if entries else converter.scene.nodes_of_cells()
        entries = converter.scene.selection(nodes - exempt)
    converter.until_the_end(record, "DEATH")
    return entries


def plane(converter, record):
    entries = {"Surface": "plane", **nodes_of_wall(converter, record)}
    friction_of(record, entries)
    dimension = converter.mesh.dimension
    tail = [record.number(axis + "T") for axis in "XYZ"]
    head = [record.number(axis + "H") for axis in "XYZ"]
    normal = [h - t for h, t in zip(head, tail)]
    if not any(normal[:dimension]):
        raise NotUnderstood("its normal has no length" + (" in the plane" if any(normal) else ""))
    entries["plane"] = {"Point": ", ".join(map(number, tail[:dimension])),
                        "Normal": ", ".join(map(number, normal[:dimension]))}
    if record.name.endswith("_MOVING"):
        length = sum(x * x for x in normal) ** 0.5
        unit = [x / length for x in normal[:dimension]]
        mass = record.number("MASS")
        speed = record.number("V0")
        if mass > 0:
            entries["plane"]["Mass"] = number(mass)
            entries["plane"]["Initial velocity"] = ", ".join(number(speed * x) for x in unit)
            entries["plane"]["Directions"] = ", ".join(map(number, unit))
        else:
            entries["plane"]["Displacement"] = "; ".join(f"{number(speed * x)}*t" for x in unit)
    yield "Contacts", "wall", entries


def sphere(converter, record):
    if converter.mesh.dimension == 2:
        raise NotUnderstood("a sphere is not possible in two dimensions")
    entries = {"Surface": "sphere", **nodes_of_wall(converter, record)}
    friction_of(record, entries)
    tail = [number(record.number(axis + "T")) for axis in "XYZ"]
    for axis in "XYZ":
        record.number(axis + "H")
    entries["sphere"] = {"Radius": number(record.number("RADSPH")), "Origin": ", ".join(tail)}
    if record.name.endswith("_MOTION"):
        curve = record.integer("LCID")
        if record.integer("OPT") not in (0, 1) or curve not in converter.curves:
            raise NotUnderstood("OPT is 0 (velocity) or 1 (displacement), with a curve LCID")
        direction = [record.number("V" + axis) for axis in "XYZ"]
        length = sum(x * x for x in direction) ** 0.5 or 1
        converter.curves.along_time(curve)
        if record.integer("OPT") == 0:
            from .conditions import integrated
            curve = integrated(converter, curve)
        entries["sphere"]["Displacement"] = "; ".join(
            f"{number(x / length)}*table({converter.table(curve)}, t)" for x in direction)
    yield "Contacts", "wall", entries


def side_of(converter, record, letter):
    """Entries of one side and the names of its parts, by the kind of set (SSTYP, MSTYP)."""
    kind = record.integer(f"{letter}STYP")
    value = record.number(f"{letter}SID")
    if kind == 5 or (kind in (2, 3) and value == 0):
        return {}, [part.name for part in converter.scene.parts]
    if kind == 3:
        numbers = [record.integer_of(f"{letter}SID", "P")]
    elif kind == 2:
        number_of_set = record.integer_of(f"{letter}SID", "S")
        if number_of_set not in converter.mesh.sets.parts_of_set:
            raise NotUnderstood(f"there is no part set {number_of_set}")
        numbers = converter.mesh.sets.parts_of_set[number_of_set]
    elif kind in (0, 4):
        word = "segment set" if kind == 0 else "node set"
        if kind == 0 and value == 0:
            return {}, [part.name for part in converter.scene.parts]
        name = converter.boundary(word, record.integer_of(f"{letter}SID", "S"), record)
        if kind == 4 and not converter.mesh.faces_of_nodes(converter.mesh.node_sets.get(name, ())):
            raise NotUnderstood(f'the nodes of "{name}" make no face of the boundary')
        return {"boundary": name}, []
    else:
        raise NotUnderstood(f"{letter}STYP = {kind} is not understood (0, 2, 3, 4 and 5 are)")
    names = [converter.parts.names[number] for number in numbers if number in converter.parts.names]
    missing = [number for number in numbers if number not in converter.parts.names]
    if missing:
        converter.report.note(record.line.place, f"*{record.section.keyword}: parts {', '.join(map(str, missing))} have no "
                              "solid elements and take no part in the contact.")
    if not names:
        raise NotUnderstood("none of its parts has solid elements")
    return {"parts": names}, names


def contact(converter, record):
    name = record.section.name
    if "TIED" in name and OFFSET.search(name):
        name = OFFSET.sub("", name)
        converter.report.note(record.line.place, f"*{record.section.keyword}: nodes are tied where they are nearer than 10 % of "
                              "a cell's thickness, and keep their distance.")
    for part_of_name, instead in OTHER_KINDS:
        if re.search(part_of_name, name):
            raise NotUnderstood(instead)
    if not KINDS.search(name):
        raise NotUnderstood("contact of this kind is not understood")
    for field in NUMERICAL:
        converter.numerical(record, field)
    friction = record.number("FS")
    # Without DC friction is FS at all speeds.
    if record.number("DC") == 0 or record.peek("FD") == friction:
        record.number("FD")
    else:
        converter.numerical(record, "FD")
    if friction == 2 and record.peek("FD") > 0:
        raise NotUnderstood("FS = 2 names a table of friction by FD")
    if not 0 <= friction <= STICKING:
        raise NotUnderstood(f"FS = {friction:g} is not understood (0 to {STICKING} are)")
    converter.until_the_end(record, "DT")
    extra = {"Type": "tied"} if "TIED" in name else {}
    if friction and not extra:
        extra["Friction"] = number(friction)
    slave, slave_parts = side_of(converter, record, "S")
    if "SINGLE_SURFACE" in name or "GENERAL" in name:
        for field in ("MSID", "MSTYP"):
            record.number(field)
        yield from pairs(converter, record, slave_parts, extra)
        return
    master, master_parts = side_of(converter, record, "M")
    overlap = set(slave_parts) & set(master_parts)
    if overlap:
        if set(slave_parts) == set(master_parts):
            yield from pairs(converter, record, slave_parts, extra)
            return
        master_parts = [part for part in master_parts if part not in overlap]
        master = {"parts": master_parts}
        if not master_parts:
            raise NotUnderstood("both sides are of the same parts")
    # A rigid body must be the master.
    rigid = {converter.parts.names[part] for part in converter.parts.rigid}
    if slave_parts and set(slave_parts) <= rigid and not set(master_parts) & rigid and (master or master_parts):
        slave, slave_parts, master, master_parts = master, master_parts, slave, slave_parts
    for one in slave_parts:
        for other in master_parts:
            refuse_common_nodes(converter, one, other)
    entries = {}
    for word, side, parts in (("Slave", slave, slave_parts), ("Master", master, master_parts)):
        if "boundary" in side:
            entries[f"{word} boundary"] = side["boundary"]
        else:
            entries[f"{word} parts"] = ", ".join(parts)
    yield "Body contacts", "joint", {**entries, **extra}


def refuse_common_nodes(converter, one, other):
    if converter.scene.share_nodes(one, other):
        raise NotUnderstood(f'the parts "{one}" and "{other}" share nodes: they are welded and do not touch')


def pairs(converter, record, parts, extra):
    """Contact of everything with everything: of each two bodies, and of fragments of particles among themselves."""
    rigid = {converter.parts.names[part] for part in converter.parts.rigid}
    # These meet each other as their fragments do.
    with_itself = [part for part in parts if converter.scene.part(part).formulation == PARTICLES and
                   "Self-contact" in converter.scene.part(part).entries]
    touching = [(one, other) for one, other in combinations(parts, 2)
                if not converter.scene.share_nodes(one, other) and not {one, other} <= rigid and
                not {one, other} <= set(with_itself)]
    if len(touching) > MOST_PAIRS:
        raise NotUnderstood(f"it is among {len(parts)} parts: write a section \"Body contact: NAME\" for those that meet")
    if with_itself:
        converter.report.note(record.line.place, f"*{record.section.keyword}: fragments of "
                              f"{', '.join(with_itself)} touch each other by Self-contact.")
        if extra.get("Friction"):
            for part in with_itself:
                converter.scene.part(part).entries["Self-contact friction"] = extra["Friction"]
    others = [part for part in parts if part not in with_itself and part not in rigid]
    if others:
        converter.report.note(record.line.place, f"*{record.section.keyword}: folds of {', '.join(others)} that meet "
                              "themselves are not seen.")
    if not touching and not with_itself:
        raise NotUnderstood("there are no two bodies, and contact of one with itself is that of particles whose bonds break "
                            "(Self-contact)")
    for one, other in touching:
        slave, master = (other, one) if one in rigid else (one, other)
        yield "Body contacts", "joint", {"Slave parts": slave, "Master parts": master, **extra}


RECORDS = {"RIGIDWALL_PLANAR": plane, "RIGIDWALL_PLANAR_MOVING": plane, "RIGIDWALL_GEOMETRIC_SPHERE": sphere,
           "RIGIDWALL_GEOMETRIC_SPHERE_MOTION": sphere}

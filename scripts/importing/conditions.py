# SPDX-License-Identifier: LGPL-2.1-or-later
"""Supports, drives, initial velocities and walls of a keyword file."""

from .deck import KeywordError

AXES = "xyz"
STICKING = 10  # the largest coefficient of friction here


class NotUnderstood(Exception):
    """Why a condition is left out."""


class Conditions:
    def __init__(self, scene, set_names):
        self.scene, self.set_names = scene, set_names
        self.tables = {}       # curves that the parameter file names, by number
        self.conditions, self.initial_conditions, self.contacts = {}, {}, {}
        self.hold_nodes()

    def read(self, section):
        """Whether it is a keyword of conditions. A condition of which a field is not understood is left out:
        it would act elsewhere, or at another time."""
        kinds = {"BOUNDARY_SPC_SET": self.support, "BOUNDARY_PRESCRIBED_MOTION_SET": self.motion,
                 "INITIAL_VELOCITY": self.velocity, "INITIAL_VELOCITY_GENERATION": self.generated_velocity,
                 "RIGIDWALL_PLANAR": self.wall}
        if section.name not in kinds:
            return False
        for record in section.records():
            try:
                named, word, lines = kinds[section.name](record)
                unused = record.unused()
                if unused:
                    raise NotUnderstood(", ".join(f"{field.name} = {field.text}" for field in unused) +
                                        " is not understood")
            except NotUnderstood as reason:
                self.scene.report.leave_out(section, record.lines,
                                            f"{reason}, so that this is left out ({record.line.place})")
                continue
            if lines:
                named[f"{word} {len(named) + 1}"] = (record, lines)
        return True

    def boundary(self, kind, number, record):
        """The name of a set of nodes or segments."""
        name = self.set_names.get((kind, number))
        if name is None:
            raise KeywordError(f"{record.section.line.place}: there is no {kind} {number}.")
        if not isinstance(name, str):
            raise NotUnderstood(f"the {kind} {number} is a *{name.keyword} ({name.line.place}), which is not read")
        return name

    def until_the_end(self, record, field):
        """Reads a time of death that is none before the end."""
        if self.scene.end_time and record.fields.get(field) and \
                record.fields[field].says_something() and record.peek(field) >= self.scene.end_time:
            record.number(field)

    def support(self, record):
        boundary = self.boundary("node set", record.integer("NSID"), record)
        fixed = [record.integer("DOF" + axis) != 0 for axis in "XYZ"]
        if any([record.integer("DOFR" + axis) for axis in "XYZ"]):
            self.scene.report.count(record.line.place, f"DOFRX, DOFRY and DOFRZ of *{record.section.keyword} are not "
                                    "used: nodes of solids do not turn.")
        lines = ["set Type     = clamp"] if all(fixed) else \
            ["set Type     = displacement", "set Function = " + "; ".join("0" if f else "free" for f in fixed)]
        return self.conditions, "support", [f"set Boundary = {boundary}"] + lines if any(fixed) else []

    def hold_nodes(self):
        """TC of *NODE."""
        for axis in AXES:
            name = self.set_names.get(("held", axis))
            if name:
                function = "; ".join("0" if other == axis else "free" for other in AXES)
                self.conditions[f"support {len(self.conditions) + 1}"] = (None, [
                    f"set Boundary = {name}", "set Type     = displacement", f"set Function = {function}"])

    def motion(self, record):
        boundary = self.boundary("node set", record.integer("NSID"), record)
        axis, kind, number = record.integer("DOF"), record.integer("VAD"), record.integer("LCID")
        if axis not in (1, 2, 3):
            raise NotUnderstood(f"DOF = {axis} is not understood (1, 2 and 3 are)")
        if kind not in (0, 2):
            raise NotUnderstood(f"VAD = {kind} is not understood (0 and 2 are)")
        if number not in self.scene.curves:
            raise NotUnderstood(f"LCID = {number} is no *DEFINE_CURVE of this file")
        self.scene.curves.used.add(number)
        self.until_the_end(record, "DEATH")
        factor = record.number("SF") or 1
        components = ["free"] * 3
        components[axis - 1] = f"{factor:.10g}*table({self.scene.table_name(number)}, t)"
        if not record.unused():
            self.tables[number] = True
        return self.conditions, "drive", [
            f"set Boundary = {boundary}", f"set Type     = {'velocity' if kind == 0 else 'displacement'}",
            "set Function = " + "; ".join(components)]

    def velocity(self, record):
        return self.initial_conditions, "flight", [self.velocity_of(record)]

    def generated_velocity(self, record):
        lines = [self.velocity_of(record)]
        if record.peek("ID") != 0 and record.peek("STYP") == 2:
            number = record.integer("ID")
            record.integer("STYP")
            parts = [name for name, part, _ in self.scene.parts if part == number]
            if not parts:
                raise NotUnderstood(f"the part {number} has no solid elements")
            lines.insert(0, f"set Part     = {parts[0]}")
        elif record.peek("ID") == 0:
            record.integer("STYP")
        return self.initial_conditions, "flight", lines

    @staticmethod
    def velocity_of(record):
        return "set Velocity = " + "; ".join(f"{record.number('V' + axis):.10g}" for axis in "XYZ")

    def wall(self, record):
        lines = []
        if record.peek("NSID") != 0:
            lines.append(f"set Boundary = {self.boundary('node set', record.integer('NSID'), record)}")
        self.until_the_end(record, "DEATH")
        friction = record.number("FRIC")
        if friction > 1:
            raise NotUnderstood(f"FRIC = {friction:g} is not understood (0 to 1 are)")
        if friction == 1:
            lines.append("# FRIC = 1: nothing slides in LS-DYNA.")
            friction = STICKING
        tail = [record.number(axis + "T") for axis in "XYZ"]
        head = [record.number(axis + "H") for axis in "XYZ"]
        return self.contacts, "wall", [
            "set Surface  = plane", *lines, f"set Friction = {friction:.10g}", "subsection plane",
            "  set Point  = " + ", ".join(f"{x:.10g}" for x in tail),
            "  set Normal = " + ", ".join(f"{h - t:.10g}" for h, t in zip(head, tail)), "end"]

    def entries(self):
        """Lists of the conditions."""
        for entry, named in (("Conditions        ", self.conditions),
                             ("Initial conditions", self.initial_conditions),
                             ("Contacts          ", self.contacts)):
            if named:
                yield f"set {entry} = " + ", ".join(named)

    def sections(self):
        for word, named in (("Condition", self.conditions), ("Initial condition", self.initial_conditions),
                            ("Contact", self.contacts)):
            for name, (record, lines) in named.items():
                yield ""
                if record is None:
                    yield "# TC of *NODE"
                else:
                    yield f"# {record.line.place}" + (f": {record.title}" if record.title else "")
                yield f"subsection {word}: {name}"
                yield from ("  " + line for line in lines)
                yield "end"

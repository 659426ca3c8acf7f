# SPDX-License-Identifier: LGPL-2.1-or-later
"""*CONTROL_..., *DATABASE_..., *DAMPING_...: how long, in which steps, and what is written."""

from ..scene import number


def termination(converter, record):
    converter.scene.end_time = record.number("ENDTIM")


def time_step(converter, record):
    """TSSFAC is of a similar limit. DT2MS below zero adds mass where steps are smaller."""
    factor = record.number("TSSFAC") or 0.9
    if 0 < factor <= 1 and factor != 0.9:
        converter.scene.sections.setdefault("Time step", {})["Safety factor"] = number(factor)
    if record.number("DT2MS") < 0:
        converter.scene.sections["Scaling"] = {"Target time step": number(-record.number("DT2MS") * factor)}


def viscosity(converter, record):
    """Read before the parts."""
    for field in ("Q1", "Q2", "TYPE"):
        record.number(field)


def implicit(converter, record):
    if record.integer("IMFLAG") == 1:
        converter.scene.head["Time integration"] = "quasi-static"
        if record.number("DT0"):
            converter.scene.sections["Statics"] = {"Largest step": number(record.number("DT0"))}


def damping(converter, record):
    if record.integer("LCID") == 0 and record.number("VALDMP") > 0:
        converter.scene.sections["Damping"] = {"Rate": number(record.number("VALDMP"))}
        return
    record.fields["LCID"].is_read = False


def pictures(converter, record):
    interval = record.number("DT")
    if interval > 0:
        converter.scene.output()["Interval"] = number(interval)


def statistics(converter, record):
    interval = record.number("DT")
    if interval > 0:
        output = converter.scene.output()
        known = float(output.get("Statistics interval", interval))
        output["Statistics interval"] = number(min(interval, known))


def further(name):
    def add(converter, record):
        record.number("DT")
        output = converter.scene.output()
        known = [word for word in output.get("Further outputs", "").split(", ") if word]
        if name not in known:
            output["Further outputs"] = ", ".join(known + [name])
    return add


def probes(converter, section):
    """*DATABASE_HISTORY_NODE: places of nodes."""
    section.is_read = True
    places = []
    lines = section.lines
    for line in lines:
        fields = section.fields(line)
        numbers = [fields[0]] if section.has_id else fields
        for text in filter(None, numbers):
            node = converter.mesh.node(line.integer(text), line, section.transform)
            label = (fields[1] if section.has_id and len(fields) > 1 else "") or f"node {text}"
            point = converter.mesh.points[node][:converter.mesh.dimension]
            places.append(f"{label}: " + ", ".join(map(number, point)))
    if places:
        probes_section = converter.scene.output().setdefault("probes", {})
        known = probes_section.get("Locations")
        probes_section["Locations"] = "; ".join(([known] if known else []) + places)


RECORDS = {"CONTROL_TERMINATION": termination, "CONTROL_TIMESTEP": time_step, "CONTROL_BULK_VISCOSITY": viscosity,
           "CONTROL_IMPLICIT_GENERAL": implicit, "DAMPING_GLOBAL": damping, "DATABASE_BINARY_D3PLOT": pictures,
           "DATABASE_GLSTAT": statistics, "DATABASE_MATSUM": further("part history")}
SECTIONS = {"DATABASE_HISTORY_NODE": probes}

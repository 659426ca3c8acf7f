# SPDX-License-Identifier: LGPL-2.1-or-later
"""*CONTROL_..., *DATABASE_..., *DAMPING_...: how long, in which steps, and what is written."""

from ..scene import number
from .conditions import is_at_rest


def termination(converter, record):
    converter.scene.end_time = record.number("ENDTIM")


def time_step(converter, record):
    """TSSFAC is of a similar limit. DT2MS below zero adds mass where steps are smaller; above zero it changes all masses."""
    factor = record.peek("TSSFAC") or 0.9
    if 0 < factor <= 1:
        record.number("TSSFAC")
    else:
        factor = 0.9
    if factor != 0.9:
        converter.scene.sections.setdefault("Time step", {})["Safety factor"] = number(factor)
    if record.peek("DT2MS") < 0:
        converter.scene.sections["Scaling"] = {"Target time step": number(-record.number("DT2MS") * factor)}


def viscosity(converter, record):
    """Read before the parts."""
    for field in ("Q1", "Q2", "TYPE"):
        record.number(field)


def implicit(converter, record):
    if is_at_rest(converter):
        record.integer("IMFLAG")
        converter.scene.head["Time integration"] = "quasi-static"
        if record.number("DT0"):
            converter.scene.sections["Statics"] = {"Largest step": number(record.number("DT0"))}
    elif record.peek("IMFLAG") == 1:
        converter.report.note(record.line.place, f"*{record.section.keyword}: steps of motion (*CONTROL_IMPLICIT_DYNAMICS) are "
                              "explicit here.")


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
        converter.scene.ask_for(name)
    return add


def interval(section_of_output, entry):
    """*DATABASE_NODOUT, _ELOUT and _DEFORC: how often a history has rows, which a later card may ask for."""
    def read(converter, record):
        converter.intervals.append((record, section_of_output, entry))
    return read


def intervals_of_histories(converter):
    """When all histories are known."""
    if converter.scene.named["Processes"]:
        converter.scene.output().setdefault("link history", {})
    for record, section_of_output, entry in converter.intervals:
        if record.number("DT") > 0 and not converter.histories.every(section_of_output, {entry: number(record.number("DT"))}):
            converter.report.note(record.line.place, f"*{record.section.keyword} is used by nothing.")
    output = converter.scene.output()
    if not output.get("link history", True):
        del output["link history"]


def watched(converter, section, what):
    """Lines of a *DATABASE_HISTORY with their numbers, and the labels of these."""
    section.is_read = True
    for line in section.lines:
        fields, label = ([], "") if not section.has_id else section.number_and_title(line)
        for text in filter(None, fields or section.fields(line)):
            number_of_one = line.integer(text, f"the number of {what}")
            if number_of_one:
                yield line, number_of_one, label


def nodes(converter, section):
    """*DATABASE_HISTORY_NODE."""
    found = [(converter.mesh.node(one, line, section.transform), label, line)
             for line, one, label in watched(converter, section, "a node")]
    if found:
        members, labels, lines = zip(*found)
        converter.attempt(section, lines[:1], converter.histories.add_nodes, members, lines[0].place, labels)


def node_sets(converter, section):
    """*DATABASE_HISTORY_NODE_SET."""
    for line, one, _ in watched(converter, section, "a set of nodes"):
        name = converter.name_of_set("node set", section.transform.number("S", one), line)
        converter.attempt(section, [line], converter.histories.add_nodes, converter.mesh.all_node_sets[name], line.place)


def solids(converter, section):
    """*DATABASE_HISTORY_SOLID."""
    found = []
    for line, one, label in watched(converter, section, "an element"):
        cell = converter.mesh.cell_of_element.get(section.transform.number("E", one))
        if cell is None:
            line.fail(f"There is no element of number {one}.")
        found.append((cell, label, line))
    if found:
        cells, labels, lines = zip(*found)
        converter.attempt(section, lines[:1], converter.histories.add_cells, cells, lines[0].place, "solid", labels)


def solid_sets(converter, section):
    """*DATABASE_HISTORY_SOLID_SET."""
    for line, one, _ in watched(converter, section, "a set of elements"):
        name = converter.name_of_set("solid set", section.transform.number("S", one), line)
        converter.attempt(section, [line], converter.histories.add_cells, converter.mesh.groups.get(name, ()), line.place, "solid")


RECORDS = {"CONTROL_TERMINATION": termination, "CONTROL_TIMESTEP": time_step, "CONTROL_BULK_VISCOSITY": viscosity,
           "CONTROL_IMPLICIT_GENERAL": implicit, "CONTROL_IMPLICIT_DYNAMICS": lambda converter, record: record.integer("IMASS"),
            "DAMPING_GLOBAL": damping, "DATABASE_BINARY_D3PLOT": pictures,
           "DATABASE_GLSTAT": statistics, "DATABASE_MATSUM": further("part history"),
           "DATABASE_NODOUT": interval("probes", "Interval"),
           "DATABASE_ELOUT": interval("point history", "Time between rows"),
           "DATABASE_DEFORC": interval("link history", "Time between rows")}
SECTIONS = {"DATABASE_HISTORY_NODE": nodes, "DATABASE_HISTORY_NODE_SET": node_sets, "DATABASE_HISTORY_SOLID": solids,
            "DATABASE_HISTORY_SOLID_SET": solid_sets}

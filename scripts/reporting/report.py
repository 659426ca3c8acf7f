# SPDX-License-Identifier: LGPL-2.1-or-later
"""Makes the report of a run, section by section."""

import math
from html import escape

from . import asked, charts, frames, histories, page, pictures, units
from .bodies import Bodies
from .run_files import RunFiles


def make_report(directory, cut=None, fields=None, stage_line=""):
    """The text of the page and the notices in it. `stage_line`, HTML, states the stage that it shows."""
    run = RunFiles(directory)
    report = page.Page(run.title())
    bodies = Bodies(run, cut, fields)
    view, drawn = bodies_of(run, bodies)
    report.view = view
    if view:
        report.add("view", "3-D view", page.view_html(view, bodies.arrow_text()))
    if drawn:
        report.add("pictures", "Pictures", page.pictures_html(drawn, frames.colour_stops, bodies.arrow_text()))
    add_histories(report, run)
    report.add("asked", "What was asked", asked_html(run))
    report.add("audit", "Audit and costs", audit_html(run))
    # Last: reading the pictures may have found damage.
    report.head = head_html(run, stage_line)
    report.foot = foot_html(run)
    return report.text(), run.notices


def bodies_of(run, bodies):
    """The 3-D view and the pictures, None and [] where there are none."""
    if not bodies.times:
        if run.results.files:
            run.note("error", "No output of solution.pvd can be read: the report has no pictures.")
        return None, []
    view_times = bodies.readable_times(frames.view_times(bodies, run.note))
    drawn_times = bodies.readable_times(pictures.picture_times(bodies))
    if not drawn_times:
        return None, []
    bodies.set_ranges(sorted(set(view_times) | set(drawn_times)))
    if len(view_times) < len(bodies.times) - len(bodies.failed):
        run.note("note", f"The 3-D view shows {len(view_times)} of {len(bodies.times)} outputs, so that the file stays small.")
    if not bodies.fields:
        run.note("note", "No field changes in place or time: there is nothing to show in colour.")
    drawn = pictures.make_pictures(bodies, drawn_times)
    return frames.make_view(bodies, view_times, run.note), drawn


def add_histories(report, run):
    statistics = run.tables.get("statistics.csv")
    if statistics is not None:
        report.add("energies", "Energies", report.drawn(map(charts.draw, histories.energy_charts(statistics))))
        report.add("histories", "Histories", report.drawn(map(charts.draw, histories.motion_charts(statistics))))
    for name, anchor, title in (("contact.csv", "contacts", "Contact forces"),
                                ("conditions.csv", "conditions", "Condition forces"),
                                ("sections.csv", "sections", "Section forces")):
        if name in run.tables:
            report.add(anchor, title, surfaces_html(report, run, run.tables[name]))
    for name, anchor, title in (("specimen.csv", "specimen", "Specimen"), ("probes.csv", "probes", "Probes"),
                                ("points.csv", "points", "Material points"), ("links.csv", "links", "Links"),
                                ("parts.csv", "parts", "Parts")):
        table = run.tables.get(name)
        if table is not None:
            columns = [column for column in table.columns if column not in histories.NOT_DRAWN]
            report.add(anchor, title, report.drawn(map(charts.draw, histories.by_unit(table, columns))))


def surfaces_html(report, run, table):
    parts = []
    for name, drawn in histories.surface_charts(table):
        largest = histories.largest_force(table, name)
        remark = ""
        if largest is not None and largest[0] > 0:
            size, unit, time = largest
            remark = (f'<p class="hint">Largest mean force {escape(units.quantity(size, unit))} at t = '
                      f'{escape(units.quantity(time, table.units["time"]))}.</p>')
        parts.append(f"<h3>{escape(name)}</h3>{remark}{report.drawn(map(charts.draw, drawn))}")
    return "".join(parts)


def asked_html(run):
    if not run.parameters:
        return ""
    defaults = asked.read_defaults()
    entries = asked.entries(run.parameters, defaults)
    differing = [entry for entry in entries if entry.differs]
    half = len(differing) // 2
    # The second column begins with a section.
    while 0 < half < len(differing) and differing[half].section == differing[half - 1].section:
        half += 1
    columns = "".join(f'<div class="card">{page.entries_html(part)}</div>' for part in (differing[:half], differing[half:])
                      if part)
    source = ("Defaults are those of this version of doc/parameters.md." if defaults else
              "doc/parameters.md is missing, so that no defaults are known.")
    return (f'<p class="hint">{len(differing)} of {len(entries)} entries are mandatory or differ from their defaults. {source}</p>'
            f'<div class="columns">{columns}</div><details><summary>All entries that the run used</summary>'
            f'<div class="card">{page.entries_html(entries)}</div></details>')


def audit_html(run):
    parts = []
    lines = run.audit()
    if lines:
        items = "".join(f"<li>{escape(line.strip())}</li>" for line in lines if line.strip())
        parts.append(f'<div class="card"><h3 style="margin-top:0">Audit</h3><ul class="audit">{items}</ul></div>')
    phases = run.summary.get("seconds_per_phase")
    if isinstance(phases, dict) and phases:
        rows = [(name, f"{units.number(seconds, 3)} s") for name, seconds in
                sorted(phases.items(), key=lambda item: -item[1]) if isinstance(seconds, (int, float))]
        parts.append(f'<div class="card"><h3 style="margin-top:0">Time of the phases of a step</h3>'
                     f'{page.table_html(("Phase", "Time, summed over the run"), rows)}</div>')
    results = list(flattened(run.summary.get("results") or {}))
    if results:
        parts.append(f'<div class="card"><h3 style="margin-top:0">Results of the summary</h3>'
                     f'{page.table_html(("Result", "Value in units of the parameter file"), results)}</div>')
    versions = run.summary.get("versions")
    if isinstance(versions, dict):
        parts.append(f'<div class="card"><h3 style="margin-top:0">Versions</h3>'
                     f'{page.table_html(("What", "Version"), list(flattened(versions)))}</div>')
    log = f"<details><summary>The whole log</summary><pre>{escape(chr(10).join(run.log))}</pre></details>" if run.log else ""
    return f'<div class="columns">{"".join(parts)}</div>{log}' if parts or log else ""


def flattened(values, path=""):
    """Nested values as rows of a name and a text."""
    for name, value in values.items():
        title = f"{path}{str(name).replace('_', ' ')}"
        if isinstance(value, dict):
            yield from flattened(value, f"{title}: ")
        elif isinstance(value, list):
            yield title, ", ".join(value_text(one) for one in value)
        else:
            yield title, value_text(value)


def value_text(value):
    if isinstance(value, float):
        return units.number(value, 6)
    return "–" if value is None else str(value).lower() if isinstance(value, bool) else str(value)


def last_of(table, name):
    """The last number of a column, None where there is none."""
    if table is None or name not in table:
        return None
    finite = [float(value) for value in table[name] if math.isfinite(value)]
    return finite[-1] if finite else None


def tiles(run):
    """The numbers to see first."""
    statistics, summary = run.tables.get("statistics.csv"), run.summary
    result = []

    def add(name, value, unit="", remark="", digits=3):
        if isinstance(value, (int, float)) and not isinstance(value, bool):
            result.append((name, units.quantity(value, unit, name, digits), remark))

    time_unit = run.results.units.label("T")
    end_time = run.parameter("End time")
    remark = f"end time {units.quantity(float(end_time), time_unit)}" if is_number(end_time) else ""
    add("Simulated time", summary.get("simulated_time", last_of(statistics, "time")), time_unit, remark, 4)
    steps = summary.get("steps", last_of(statistics, "step"))
    if isinstance(steps, (int, float)):
        result.append(("Steps", f"{int(steps):,}".replace(",", " "), ""))
    add("Largest time step", summary.get("time_step_max"), time_unit, digits=3)
    add("Wall time", summary.get("wall_seconds"), "s")
    if isinstance(summary.get("energy_error_relative"), float):
        result.append(("Energy error", percent(summary["energy_error_relative"]), "at the end"))
    elif (error := last_of(statistics, "energy error")) is not None:
        result.append(("Energy error", percent(error), "last row"))
    add("Momentum drift", summary.get("momentum_drift_relative"), remark="relative", digits=2)
    temperature = "largest temperature" if statistics is not None and "largest temperature" in statistics else \
        "largest nodal temperature"
    for name in ("largest effective plastic strain", temperature, "largest speed"):
        if statistics is not None and name in statistics:
            finite = [float(value) for value in statistics[name] if math.isfinite(value)]
            if finite and max(finite) != min(finite):
                add(name[:1].upper() + name[1:], max(finite), statistics.units[name], "of all rows")
    contact = run.tables.get("contact.csv")
    if contact is not None:
        for name in list(histories.surfaces(contact))[:3]:
            largest = histories.largest_force(contact, name)
            if largest is not None and largest[0] > 0:
                add(f"Largest force of {name}", largest[0], largest[1],
                    f"at {units.quantity(largest[2], contact.units['time'], digits=3)}")
    return result


def percent(value):
    return f"{units.number(100 * value, 2)} %"


def is_number(text):
    try:
        return math.isfinite(float(text))
    except (TypeError, ValueError):
        return False


def head_html(run, stage_line):
    summary = run.summary
    versions = summary.get("versions") if isinstance(summary.get("versions"), dict) else {}
    facts = []
    if versions.get("tombolo"):
        git = f" ({versions['git']})" if versions.get("git") else ""
        facts.append(f"Tombolo {versions['tombolo']}{git}")
    for key, text in (("ranks", "{} rank" + ("" if summary.get("ranks") == 1 else "s")), ("dimension", "{} dimensions"),
                      ("nodes", "{} nodes"), ("fe_cells", "{} elements"), ("particles", "{} particles")):
        if summary.get(key):
            facts.append(text.format(summary[key]))
    kind = {"finished": "finished", "stopped": "stopped"}.get(run.state, "")
    spans = "".join(f"<span>{escape(fact)}</span>" for fact in facts)
    return (f'<header><div><h1>{escape(run.title())}</h1>{stage_line}<p class="facts"><span class="state {kind}">{escape(run.state)}</span>'
            f"{spans}</p>{page.notices_html(run.notices)}{page.tiles_html(tiles(run))}</div></header>\n")


def foot_html(run):
    return (f"<footer>Written by scripts/report from the output of one run. Numbers are in SI units with prefixes where the run "
            f"names its units (<code>Unit labels</code>). Charts draw at most some {charts.MAXIMUM_POINTS} points of a line, with "
            f"the extremes between them. Nothing is fetched from elsewhere.</footer>\n")

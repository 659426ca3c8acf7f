# SPDX-License-Identifier: LGPL-2.1-or-later
"""*STEP with its procedure, and what it writes."""

from ..scene import number
from .deck import key

PROCEDURES = ("STATIC", "DYNAMIC", "COUPLED TEMPERATURE-DISPLACEMENT", "DYNAMIC TEMPERATURE-DISPLACEMENT",
              "HEAT TRANSFER", "UNCOUPLED TEMPERATURE-DISPLACEMENT", "VISCO")
NOT_POSSIBLE = ("FREQUENCY", "BUCKLE", "MODAL DYNAMIC", "STEADY STATE DYNAMICS", "COMPLEX FREQUENCY")


class Step:
    """A step: its sections, how it goes through time, and its entries."""

    def __init__(self, section, number_of_step, begin):
        self.section, self.begin = section, begin
        self.name = "".join(c if c.isalnum() or c in " _.-" else " " for c in section.get("NAME")) if section else ""
        self.name = self.name.strip() or f"step {number_of_step}"
        self.sections, self.procedure = [], None
        self.time, self.increment = 0.0, 0.0
        self.is_explicit = self.has_heat = self.is_static = self.is_adiabatic = False
        self.is_heat_alone = self.is_steady = self.ramps = False
        self.entries = {}

    def read_procedure(self, section, report):
        section.is_read = True
        self.procedure = section
        rows = section.rows()
        self.time = rows[0].number(1, 1.0) if rows else 1.0
        self.increment = rows[0].number(0) if rows else 0.0
        self.is_explicit = section.has("EXPLICIT") or section.name == "DYNAMIC TEMPERATURE-DISPLACEMENT"
        self.is_adiabatic = section.has("ADIABATIC")
        self.is_static = section.name in ("STATIC", "VISCO", "COUPLED TEMPERATURE-DISPLACEMENT",
                                          "UNCOUPLED TEMPERATURE-DISPLACEMENT")
        self.has_heat = "TEMPERATURE" in section.name or section.name == "HEAT TRANSFER"
        self.is_heat_alone = section.name == "HEAT TRANSFER"
        self.is_steady = self.has_heat and section.has("STEADY STATE")
        if self.is_static and key(self.section.get("NLGEOM", "NO" if not self.section.has("NLGEOM") else "YES")) == "NO":
            report.note(self.section.line.place, "*STEP without NLGEOM: displacements can be large here.")
        if section.name == "DYNAMIC" and not self.is_explicit:
            report.note(section.line.place, "*DYNAMIC: steps are explicit here.")
        # Steady heat alone comes to rest behind a ramp, and has its last state exactly from the start.
        default = "RAMP" if section.name == "STATIC" or (self.is_steady and not self.is_heat_alone) else "STEP"
        self.ramps = not self.is_explicit and key(self.section.get("AMPLITUDE", default)) == "RAMP"
        if self.is_static or self.has_heat:
            for row in rows[:1]:
                for k in (2, 3):
                    if row.text(k):
                        row.is_read[k] = False

    def own_entries(self):
        entries = {"End time": number(self.time)}
        if self.is_static:
            entries["Time integration"] = "quasi-static"
            if self.increment and self.increment < self.time:
                entries["Statics"] = {"Largest step": number(self.increment)}
        elif not self.has_heat or self.is_explicit:
            entries["Time integration"] = "explicit"
        if self.has_heat and not self.is_explicit:
            step = self.increment if 0 < self.increment < self.time else self.time / 20
            entries["Heat"] = {"Time integration": "backward Euler", "backward Euler": {"Step": number(step)}}
        return entries


def steps_of(deck, report):
    """The steps with their sections; those that are not possible are left out."""
    steps, current, begin = [], None, 0.0
    model = []
    for section in deck.sections:
        if section.name == "STEP":
            current = Step(section, len(steps) + 1, begin)
            section.is_read = True
            for option in ("NLGEOM", "INC"):
                section.get(option)
            names = [step.name for step in steps]
            if current.name in names:
                current.name += f" ({len(steps) + 1})"
            steps.append(current)
        elif section.name == "END STEP":
            begin += current.time if current else 0
            current = None
        elif current is None:
            model.append(section)
        elif section.name in PROCEDURES:
            current.read_procedure(section, report)
        else:
            current.sections.append(section)
    for step in list(steps):
        if step.procedure is None:
            steps.remove(step)
            step.section.is_read = False
            report.note(step.section.line.place, f'*STEP "{step.name}" has no procedure that is possible here (*STATIC, '
                        "*DYNAMIC, *COUPLED TEMPERATURE-DISPLACEMENT, *HEAT TRANSFER), and is left out.")
    for step in steps:
        if step.is_heat_alone and not all(one.is_heat_alone for one in steps):
            step.is_static = True
            report.note(step.procedure.line.place, "*HEAT TRANSFER: other steps have mechanics, and here the body expands at rest.")
    return model, steps


def read_output(section, step, scene):
    """*OUTPUT: how often."""
    section.is_read = True
    output = step.entries.setdefault("Output", {})
    interval = section.get("TIME INTERVAL")
    count = section.get("NUMBER INTERVAL")
    if section.has("HISTORY"):
        if interval:
            output["Statistics interval"] = interval
    else:
        section.has("FIELD")
        if interval:
            output["Interval"] = interval
        elif count:
            output["Number"] = count
    section.get("VARIABLE"), section.get("OP"), section.get("NAME")


def read_mass_scaling(section, step):
    section.is_read = True
    factor, dt = section.get("FACTOR"), section.get("DT")
    if factor:
        step.entries["Scaling"] = {"Mass factor": factor}
    elif dt:
        if key(section.get("TYPE")) != "BELOW MIN":
            section.known.discard("TYPE")
        step.entries["Scaling"] = {"Target time step": dt}
    else:
        section.is_read = False

# SPDX-License-Identifier: LGPL-2.1-or-later
"""*NODE OUTPUT and *ELEMENT OUTPUT below *OUTPUT, HISTORY; *NODE PRINT and *EL PRINT."""

import re

from ..histories import Histories
from ..scene import NotUnderstood, number
from .conditions import HEAT_ALONE
from .deck import key

NODES, ELEMENTS = ("NODE OUTPUT", "NODE PRINT"), ("ELEMENT OUTPUT", "EL PRINT")
PRINTS = ("NODE PRINT", "EL PRINT")
# What the tables have.
OF_NODES = re.compile(r"[UV]([123]|T)?|NT(11)?|COORD")
OF_ELEMENTS = re.compile(r"S([123][123])?|MISES|PEEQ|ALPHA([1-9]?)|SINV")


class HistoryReader:
    """Adds what a step watches to its output. A step without *OUTPUT, HISTORY goes on with that of the step before."""

    def __init__(self, converter):
        self.converter, self.report = converter, converter.report
        self.of_step_before = {}

    def read(self, step):
        begins_anew = any(section.name == "OUTPUT" and "HISTORY" in section.options for section in step.sections)
        output = {} if begins_anew else {name: dict(entries) for name, entries in self.of_step_before.items()}
        self.histories = Histories(self.converter.scene, output)
        asks = None
        for section in step.sections:
            if section.name == "OUTPUT":
                asks = section if "HISTORY" in section.options else None
            elif section.name in PRINTS or (section.name in NODES + ELEMENTS and asks):
                self.add(section, section if section.name in PRINTS else asks, step)
        self.of_step_before = output
        if output:
            step.entries.setdefault("Output", {}).update(output)

    @staticmethod
    def frequency(section, step):
        """How often there are rows, every so many steps or at times: an option, and both as texts."""
        for option in ("FREQUENCY", "TIME INTERVAL", "NUMBER INTERVAL"):
            text = section.options.get(option, "")
            value = section.line.real(text) if text else 0
            if value > 0:
                by_time = text if option == "TIME INTERVAL" else number(step.time / value)
                return (option, text, "") if option == "FREQUENCY" else (option, "", by_time)
        return None

    def add(self, section, asks, step):
        """asks is the section that says how often."""
        is_of_nodes = section.name in NODES
        option = "NSET" if is_of_nodes else "ELSET"
        section.is_read = True
        try:
            target = section.get(option)
            if not target:
                raise NotUnderstood(f"without {option} it is of the whole model")
            wanted = self.wanted(section, OF_NODES if is_of_nodes else OF_ELEMENTS)
            if not wanted and not section.get("VARIABLE"):
                raise NotUnderstood("none of its variables is in a history here")
            if is_of_nodes:
                self.add_nodes(section, target)
                names = ("probes", "Steps", "Interval")
            else:
                names = (self.add_elements(section, target), "Steps between rows", "Time between rows")
        except NotUnderstood as reason:
            section.options, section.rows_so_far = {}, None
            self.report.leave_out(section, section.lines, f"{reason}, so that this is left out ({section.line.place})")
            return
        frequency = self.frequency(asks, step)
        if frequency and self.histories.every(names[0], dict(zip(names[1:], frequency[1:]))):
            asks.get(frequency[0])

    @staticmethod
    def wanted(section, pattern):
        """How many of the variables the tables have; the others are not used."""
        count = 0
        for row in section.rows():
            for k, text in enumerate(row.fields):
                if pattern.fullmatch(key(text)):
                    count += bool(row.text(k))
        return count

    def add_nodes(self, section, target):
        rigid = self.converter.rigid_of(section.line, target)
        if rigid is not None:
            raise NotUnderstood(f'it is the reference node of the rigid part "{rigid}", whose motion and forces are in '
                                "rigid_bodies.csv")
        self.histories.add_nodes(self.converter.all_nodes_of(section.line, target), section.line.place)

    def add_elements(self, section, target):
        """The name of the table that has them."""
        if not self.converter.has_mechanics:
            raise NotUnderstood(HEAT_ALONE)
        if key(section.get("POSITION", "INTEGRATION POINTS")) not in ("INTEGRATION POINTS", "CENTROIDAL"):
            raise NotUnderstood(f"POSITION={section.get('POSITION')} is not understood")
        elements = self.converter.elements_of(section.line, target)
        cells = sorted(index for kind, index in elements if kind == "cell")
        if not cells and any(kind == "link" for kind, _ in elements):
            self.histories.output.setdefault("link history", {})
            return "link history"
        if not cells:
            raise NotUnderstood(f'"{target}" has no cells')
        self.histories.add_cells(cells, section.line.place, "element",
                                 [f"element {self.prefix_of(cell)}{self.converter.mesh.cells[cell].number}" for cell in cells])
        return "point history"

    def prefix_of(self, cell):
        """The instance of a cell, where there are several."""
        named = [body for body in self.converter.mesh.bodies if body.name]
        if len(named) < 2:
            return ""
        for body in named:
            if body.elements.get(self.converter.mesh.cells[cell].number) == ("cell", cell):
                return body.name + "."
        return ""

# SPDX-License-Identifier: LGPL-2.1-or-later
"""Reads what a run left behind, whole or not, and notes what is missing or damaged."""

import json
import math
import re
from dataclasses import dataclass
from pathlib import Path

import numpy
from plotting.results import PlotError, Results, Table, Units
from tombolo import histories

from . import units

TABLES = ("statistics.csv", "contact.csv", "conditions.csv", "sections.csv", "parts.csv", "probes.csv", "points.csv", "links.csv",
          "specimen.csv")
# One of these makes a directory the output of a run.
TRACES = ("summary.json", "parameters.json", "log.txt", "solution.pvd", "cells.xdmf",
          "particles.xdmf", histories.FILE) + TABLES

PROGRESS = re.compile(r"\s*[\d.]+ %\s+t = (\S+)\s+step (\d+)")
ENERGY_ERROR_TO_MENTION = 0.01
DRIFT_TO_MENTION = 1e-9


@dataclass
class Notice:
    """A remark for the reader of the report: "error", "warning" or "note"."""
    level: str
    text: str


class RunFiles:
    """The output directory of a run. Reading goes on where a file is missing or damaged; `notices`
    contains what was found."""

    def __init__(self, directory):
        self.directory = Path(directory)
        if not self.directory.is_dir():
            raise PlotError(f"there is no directory {directory}")
        if not any((self.directory / name).exists() for name in TRACES):
            raise PlotError(f"{directory} is not the output of a run: it has none of {', '.join(TRACES)}")
        self.notices = []
        self.summary = self.read_json("summary.json")
        self.parameters = self.read_json("parameters.json")
        self.log = self.read_log()
        self.tables = {name: table for name in TABLES if (table := self.read_table(name)) is not None}
        self.results = self.read_results()
        self.tools = self.read_tools()
        self.judge_ending()
        self.note_what_is_missing()
        self.judge_numbers()

    def note(self, level, text):
        if all(notice.text != text for notice in self.notices):
            self.notices.append(Notice(level, text))

    def relative(self, text):
        """A message without the path of the output directory."""
        return str(text).replace(f"{self.directory}/", "")

    def read_json(self, name):
        """The content with numbers as they are written, {} where there is none."""
        path = self.directory / name
        if not path.exists():
            return {}
        try:
            read = json.loads(path.read_text("utf-8"), parse_float=str if name.startswith("param") else None,
                              parse_int=str if name.startswith("param") else None)
            if not isinstance(read, dict):
                raise ValueError("it is no object")
            return read
        except (ValueError, OSError, RecursionError) as error:
            self.note("error", f"{name} is damaged and was left out: {error}.")
            return {}

    def read_log(self):
        path = self.directory / "log.txt"
        if not path.exists():
            return []
        lines = path.read_text("utf-8", errors="replace").splitlines()
        for line in lines:
            if line.startswith("Warning: "):
                self.note("warning", line.removeprefix("Warning: "))
        return lines

    def has_table(self, name):
        """Whole or damaged."""
        try:
            return histories.has_table(self.directory / name)
        except PlotError:
            return True

    def read_table(self, name):
        path = self.directory / name
        try:
            if not histories.has_table(path):
                return None
            table = Table(path, leaves_out_damaged_rows=True)
        except (PlotError, OSError) as error:
            self.note("error", f"{self.relative(error)}: it is left out.")
            return None
        if table.damaged_rows:
            self.note("error", f"{name} is damaged: {len(table.damaged_rows)} rows are left out, the first of "
                      f"them row {table.damaged_rows[0]}.")
        if "time" not in table:
            self.note("error", f'{name} has no column "time": it is left out.')
            return None
        has_time = numpy.isfinite(table["time"])
        if not has_time.all():
            self.note("error", f"{name} has {numpy.count_nonzero(~has_time)} rows without a time: they are left out.")
            table.columns = {column: values[has_time] for column, values in table.columns.items()}
        if not len(table["time"]):
            self.note("error", f"{name} has a header and no whole row: it is left out.")
            return None
        if (table["time"][1:] < table["time"][:-1]).any():
            self.note("warning", f"The times of {name} do not grow from row to row.")
        return table

    def read_results(self):
        """The series of pictures, empty where it cannot be read."""
        results = Results.__new__(Results)
        results.directory, results.summary, results.grids = self.directory, self.summary, {}
        results.units = self.labels()
        try:
            results.files = results.read_series()
        except (PlotError, OSError, ValueError, TypeError) as error:
            self.note("error", f"solution.pvd is damaged, there are no pictures: {self.relative(error)}.")
            results.files = {}
        return results

    def read_tools(self):
        try:
            series = self.results.read_series("tools.pvd")
        except (PlotError, OSError, ValueError, TypeError) as error:
            self.note("warning", f"tools.pvd is damaged, tools are not drawn: {self.relative(error)}.")
            series = {}
        return {time: files["tools"] for time, files in series.items() if "tools" in files}

    def judge_ending(self):
        self.has_finished = self.summary.get("ended") == "finished"
        if "failure" in self.summary:
            self.state = "stopped"
            self.note("error", f"The run stopped: {self.summary['failure']}")
        elif self.has_finished:
            self.state = "finished"
        elif "ended" in self.summary:
            self.state = str(self.summary["ended"])
            self.note("warning", f"The run was {self.state} before its end time; the report shows what it wrote until then.")
        else:
            self.state = "not finished"
            progress = [match for match in map(PROGRESS.match, self.log) if match]
            where = f" Its log ends at t = {progress[-1].group(1)}, step {progress[-1].group(2)}." if progress else ""
            self.note("warning", "The run has not ended, or was killed: there is no readable summary.json. The "
                      f"report shows what was written until now.{where}")
        if "resumed_from_step" in self.summary:
            self.note("note", f"The run was resumed at step {self.summary['resumed_from_step']}. Its costs are those "
                      "of the part since then.")

    def note_what_is_missing(self):
        has_mechanics = "energy_error_relative" in self.summary
        if "statistics.csv" not in self.tables and not self.has_table("statistics.csv"):
            self.note("error", "statistics.csv is missing: the report has no energies.")
        if self.parameter("Contacts") and has_mechanics and not self.has_table("contact.csv"):
            self.note("error", "contact.csv is missing: the report has no contact forces.")
        if self.parameter("Conditions") and has_mechanics and not self.has_table("conditions.csv"):
            self.note("note", "There is no conditions.csv: no condition of the run has forces to show.")
        if not self.parameters:
            self.note("error", "parameters.json is missing or damaged: the report cannot say what was asked.")
        if not self.log:
            self.note("error", "log.txt is missing or empty: the report has no audit.")
        if not self.results.files and not (self.directory / "solution.pvd").exists():
            if self.parameter("Output", "Write solution") == "false" or self.parameter("Output", "Write solution") is False:
                self.note("note", "The run wrote no pictures (`Output/Write solution` is false).")
            else:
                self.note("error", "solution.pvd is missing: the report has no pictures.")

    def judge_numbers(self):
        statistics = self.tables.get("statistics.csv")
        if statistics is None:
            return
        for name, limit in (("energy error", ENERGY_ERROR_TO_MENTION), ("heat balance error", ENERGY_ERROR_TO_MENTION),
                            ("momentum drift", DRIFT_TO_MENTION)):
            if name in statistics:
                largest = max((abs(value) for value in statistics[name] if math.isfinite(value)), default=0)
                if largest > limit:
                    self.note("warning", f"The {name} reaches {units.number(largest, 3)}, more than "
                              f"{units.number(limit)}.")
        for name, values in statistics.columns.items():
            if not all(map(math.isfinite, values)) and any(map(math.isinf, values)):
                self.note("warning", f'The column "{name}" of statistics.csv has values that are not finite.')

    def parameter(self, *path, default=None):
        """An entry by its sections and name."""
        section = self.parameters
        for name in path:
            if not isinstance(section, dict) or name not in section:
                return default
            section = section[name]
        return section

    def labels(self):
        """The labels of units, from the summary, or from the entry `Unit labels` where it is missing."""
        given = self.summary.get("units")
        if not isinstance(given, dict):
            pairs = (item.partition(":") for item in str(self.parameter("Unit labels", default="")).split(","))
            given = {quantity.strip(): name.strip() for quantity, _, name in pairs if name.strip()}
        return Units(given)

    def audit(self):
        """The lines of the log before the first step."""
        lines = []
        for line in self.log:
            if PROGRESS.match(line):
                break
            lines.append(line)
        return lines

    def title(self):
        for title in (self.summary.get("title"), self.parameter("Title")):
            if title:
                return str(title)
        return self.directory.resolve().name

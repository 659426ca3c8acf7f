# SPDX-License-Identifier: LGPL-2.1-or-later
"""What a run left behind, by name."""

import json
from pathlib import Path

from .errors import TomboloError, nearest
from .histories import has_table
from .table import Table

TABLES = {"statistics": "statistics", "contacts": "contact", "conditions": "conditions", "sections": "sections",
          "parts": "parts", "probes": "probes", "specimen": "specimen"}


class Run:
    """The output directory of a run. Each table is an attribute: `statistics`, `contacts`,
    `conditions`, `sections`, `parts`, `probes`, `specimen`, and by the name of its file that of a process
    from outside, such as `springs`."""

    def __init__(self, directory):
        self.directory = Path(directory)
        if not self.directory.is_dir():
            beside = self.directory.parent
            names = [one.name for one in beside.iterdir() if one.is_dir()] if beside.is_dir() else []
            raise TomboloError(f"there is no directory {directory}." + nearest(self.directory.name, names))

    def __getattr__(self, name):
        """A table, which is read at its first use."""
        path = self.directory / f"{TABLES.get(name, name)}.csv"
        if name not in TABLES and (name.startswith("_") or not has_table(path)):
            raise AttributeError(f'a run has no "{name}".' + nearest(name, [*TABLES, "summary"]))
        table = Table(path)
        setattr(self, name, table)
        return table

    @property
    def summary(self):
        """The contents of summary.json, {} where the run has not ended."""
        path = self.directory / "summary.json"
        try:
            return json.loads(path.read_text("utf-8")) if path.exists() else {}
        except ValueError as error:
            raise TomboloError(f"{path} is damaged: {error}") from error

    def fields(self, time):
        """{"cells": grid, "particles": grid} of the output nearest to a time, pieces of all ranks joined.
        A grid has `points`, `cells`, `point_data`, `cell_data` and `units`; numpy and vtk are needed."""
        try:
            from .grid import Grid, read_series  # only where it is needed
        except ImportError as error:
            raise TomboloError(f"fields of a run need numpy and vtk for Python: {error}") from error
        if "series" not in vars(self):
            self.series = read_series(self.directory)
        if not self.series:
            raise TomboloError(f"{self.directory} has no solution.pvd and no cells.xdmf or particles.xdmf")
        files = self.series[min(self.series, key=lambda one: abs(one - time))]
        grids = {kind: Grid(path) for kind, path in files.items()}
        return {kind: grid for kind, grid in grids.items() if grid.n_points}

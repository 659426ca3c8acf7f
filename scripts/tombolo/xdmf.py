# SPDX-License-Identifier: LGPL-2.1-or-later
"""Grids of a run in HDF5, as NAME.xdmf lists them: those that `Format = xdmf` writes."""

import re
import xml.etree.ElementTree
from dataclasses import dataclass
from pathlib import Path

KINDS = ("cells", "particles", "tools")


class Damaged(Exception):
    """A file is missing or is not what it should be."""


@dataclass(frozen=True)
class GridEntry:
    """One grid of a series."""
    index: Path
    number: int

    def __str__(self):
        return f"{self.index} (grid {self.number})"


def grids_of(index):
    """The elements of XDMF of all grids."""
    try:
        series = xml.etree.ElementTree.parse(index).find("Domain/Grid")
    except xml.etree.ElementTree.ParseError as error:
        raise Damaged(f"{index} is damaged: {error}") from error
    if series is None or series.get("CollectionType") != "Temporal":
        raise Damaged(f"{index} is damaged: it has no grids over time")
    return series.findall("Grid")


def read_series(directory, kind):
    """{time: GridEntry} of a kind of grid; empty where the run has none."""
    index = Path(directory) / f"{kind}.xdmf"
    if not index.exists():
        return {}
    try:
        return {float(grid.find("Time").get("Value")): GridEntry(index, number)
                for number, grid in enumerate(grids_of(index))}
    except (AttributeError, TypeError, ValueError) as error:
        raise Damaged(f"{index} is damaged: a grid has no time") from error


class Reader:
    """The arrays of a grid: points, cells, point_data, cell_data, units."""

    def __init__(self, grid_entry):
        try:
            import h5py  # only where it is needed
        except ImportError as error:
            raise Damaged(f"to read {grid_entry.index.with_suffix('.h5')} python3-h5py is needed, which scripts/setup "
                          "installs") from error
        grid = grids_of(grid_entry.index)[grid_entry.number]
        self.point_data, self.cell_data, self.units = {}, {}, {}
        path = grid_entry.index.with_suffix(".h5")
        try:
            with h5py.File(path, "r") as file:
                self.points = self.array(file, grid.find("Geometry"))
                self.cells = self.array(file, grid.find("Topology"))
                self.cells = self.cells.reshape(len(self.cells), -1)
                for attribute in grid.findall("Attribute"):
                    name = attribute.get("Name")
                    data = self.cell_data if attribute.get("Center") == "Cell" else self.point_data
                    data[name] = self.array(file, attribute)
                    unit = attribute.find("Information[@Name='unit']")
                    match = re.fullmatch(r".* \[([^\[\]]*)\]", unit.get("Value")) if unit is not None else None
                    if match:
                        self.units[name] = match.group(1)
        except (OSError, KeyError, AttributeError, ValueError) as error:
            raise Damaged(f"{path} is damaged: {error}") from error
        if any(len(values) != len(self.points) for values in self.point_data.values()) or any(
                len(values) != len(self.cells) for values in self.cell_data.values()):
            raise Damaged(f"{path} is damaged: its arrays do not fit to its points and cells")

    @staticmethod
    def array(file, element):
        return file[element.find("DataItem").text.partition(":")[2]][...]

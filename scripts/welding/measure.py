# SPDX-License-Identifier: LGPL-2.1-or-later
"""What a weld is measured by, from the tables of a run."""

import json
import math
from pathlib import Path

from cutting.measure import CutError, Table, costs, interpolated, largest_of

WeldError = CutError


def torque_over_shear(shoulder, pin, length, angle):
    """The torque of Schmidt and Hattel over the traction along the surface: a length cubed."""
    return 2 / 3 * math.pi * ((shoulder**3 - pin**3) * (1 + math.tan(math.radians(angle)))
                              + pin**3 + 3 * pin**2 * length)


def surface_area(shoulder, pin, length, angle):
    """That of the shoulder, a cone, and of the side and the end of the pin."""
    return math.pi * ((shoulder**2 - pin**2) / math.cos(math.radians(angle))
                      + 2 * pin * length + pin**2)


def flow_stresses(directory, material):
    """Temperatures and flow stresses at no plastic strain, of the table of the run's material."""
    path = Path(directory) / "parameters.json"
    try:
        entries = json.loads(path.read_text("utf-8"))
        tabular = entries[f"Material: {material}"]["j2 plasticity"]["tabular"]
        temperatures = [float(one) for one in tabular["Temperatures"].split(",")]
        stresses = [float(row.split(",")[0]) for row in tabular["Flow stresses"].split(";")]
    except (OSError, ValueError, KeyError, TypeError, AttributeError) as error:
        raise WeldError(f"{path} has no table of flow stresses over the temperature of the material "
                        f'"{material}": {error}') from error
    return temperatures, stresses


class Weld:
    """The tables of a run, at a time or over an interval."""

    def __init__(self, directory, contact, material, tool):
        self.directory = Path(directory)
        self.contact = contact
        self.table = Table(self.directory / "contact.csv")
        self.times = self.table["time"]
        self.temperatures, self.stresses = flow_stresses(directory, material)
        self.factor = torque_over_shear(*tool)
        self.area = surface_area(*tool)

    def column(self, what):
        return self.table[f"{self.contact} {what}"]

    def torque(self):
        """The torque of the tool, a mean since the row before."""
        return [abs(value) for value in self.column("mean torque z")]

    def sticking_torque(self):
        """That of Schmidt and Hattel at the mean temperature of the contact, at each row."""
        return [self.factor / math.sqrt(3)
                * interpolated(self.temperatures, self.stresses, temperature)
                if n_nodes > 0 else math.nan
                for temperature, n_nodes in zip(self.column("contact mean temperature"),
                                                self.column("nodes"))]

    def mean(self, values, begin, end):
        """Of a column whose entries are means since the row before, weighted with their times."""
        total = weight = 0.0
        for k in range(1, len(self.times)):
            share = min(end, self.times[k]) - max(begin, self.times[k - 1])
            if share > 0 and not math.isnan(values[k]):
                total += share * values[k]
                weight += share
        if weight == 0:
            raise WeldError(f"nothing touches from {begin:g} to {end:g}")
        return total / weight


def measure(weld, window, plunge):
    """The numbers of a run, by name."""
    end = weld.times[-1]
    result = {"time": end}
    # A turn before the end of the plunge, and the traverse.
    intervals = [("end of the plunge", (0.8 * plunge, plunge)), ("traverse", window or (end / 3, end))]
    for name, (begin, stop) in intervals:
        if stop > end * (1 + 1e-6) or begin >= stop:
            continue
        torque, sticking = (weld.mean(values, begin, stop)
                            for values in (weld.torque(), weld.sticking_torque()))
        result[f"torque, {name}"] = torque
        result[f"torque of Schmidt and Hattel, {name}"] = sticking
        result[f"torque over that, {name}"] = torque / sticking
        if f"{weld.contact} area in contact" in weld.table:
            result[f"area in contact over that of the tool, {name}"] = weld.mean(
                weld.column("area in contact"), begin, stop) / weld.area
        for axis in "xyz":
            result[f"force {axis} on the tool, {name}"] = -weld.mean(
                weld.column(f"mean force {axis}"), begin, stop)
        for what in ("mean", "largest"):
            result[f"{what} temperature of the contact, {name}"] = weld.mean(
                weld.column(f"contact {what} temperature"), begin, stop)
    if f"{weld.contact} tool temperature" in weld.table:
        result["temperature of the tool at the end"] = weld.column("tool temperature")[-1]
    statistics = Table(weld.directory / "statistics.csv")
    times = statistics["time"]
    if "largest nodal temperature" in statistics:
        for name, time in (("end of the plunge", plunge), ("end", end)):
            if time <= end * (1 + 1e-6):
                result[f"largest temperature, {name}"] = interpolated(
                    times, statistics["largest nodal temperature"], time)
        result["largest temperature at any time"] = max(statistics["largest nodal temperature"])
    result.update(largest_of(statistics, ("energy error", "heat balance error", "momentum drift",
                                          "kinetic over internal energy")))
    for name in ("broken bonds", "debris particles"):
        if name in statistics:
            result[name] = statistics[name][-1]
    return {**result, **costs(weld.directory)}


def binned(times, values, width):
    """Middles and means of intervals of the time."""
    middles, means = [], []
    begin = 0
    for k in range(1, len(times) + 1):
        if k == len(times) or times[k] - times[begin] >= width:
            inside = [value for value in values[begin:k] if not math.isnan(value)]
            if inside:
                middles.append(0.5 * (times[begin] + times[k - 1]))
                means.append(sum(inside) / len(inside))
            begin = k
    return middles, means

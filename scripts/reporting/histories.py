# SPDX-License-Identifier: LGPL-2.1-or-later
"""Which columns of the tables of a run are drawn together, and under which titles."""

import re

import numpy
from plotting.histories import ENERGIES

from . import units
from .charts import N_COLOURS, Chart

ENERGY = (1, 2, -2, 0)
HEAT = re.compile(r"enthalpy|.*heat( |$).*|thermal work")
# Columns of a contact or a condition, after its name.
PER_SURFACE = re.compile(r"(.+?) ((?:mean )?(?:force|moment|torque|displacement|power)|impulse|position|work|"
                         r"friction heat|damping|stored energy|nodes|penetration|heat of \w+|temperature|"
                         r"angular impulse)(?: ([xyz]))?")
# What of a surface is drawn in one chart, in this order; a heading for each.
SURFACE_CHARTS = (("mean force", "Force"), ("force", "Force"), ("mean torque", "Torque"), ("mean moment", "Moment"),
                  ("impulse", "Impulse"), ("angular impulse", "Angular impulse"))
SMALL_SHARE = 0.05  # energies that are smaller beside the largest have a chart of their own
NOT_DRAWN = ("time", "step")


def energy_charts(table):
    """Every column that is an energy, those of the balance first, and the errors of the balance."""
    energies = [name for name, unit in table.units.items() if is_energy(name, unit)]
    balance = [name for name in ENERGIES if name in energies]
    heat = [name for name in energies if name not in balance and HEAT.fullmatch(name)]
    others = [name for name in energies if name not in balance and name not in heat]
    top = max((size_of(table, name) for name in balance + others), default=0)
    small = [name for name in balance + others if 0 < size_of(table, name) < SMALL_SHARE * top]
    large, further = ([name for name in names if name not in small] for names in (balance, others))
    charts = [Chart("Energy balance", table, large, "energy", dashed=("external work",)),
              Chart("Further energies", table, further, "energy"),
              Chart(f"Energies below {SMALL_SHARE:.0%} of the largest".replace("%", " %"), table, small, "energy"),
              Chart("Heat", table, heat, "heat", dashed=("enthalpy", "friction heat"))]
    charts += [Chart(title, table, [name], "relative")
               for title, name in (("Energy error", "energy error"), ("Heat balance error", "heat balance error"))
               if name in table]
    return [chart for chart in charts if chart.names]


def size_of(table, name):
    return float(numpy.max(numpy.abs(numpy.nan_to_num(table[name])), initial=0))


def is_energy(name, unit):
    """Energies have the unit of a moment, too; a unit of symbols without labels counts by its text."""
    return (units.dimension_of(unit) == ENERGY or unit == "M L^2/T^2") and "moment" not in name


def vectors(table, names, used):
    """Charts of the columns "NAME x", "NAME y", "NAME z" that are there."""
    charts = []
    for title, stems in names:
        columns = [f"{stem} {axis}" for stem in stems for axis in "xyz" if f"{stem} {axis}" in table]
        if columns:
            charts.append(Chart(title, table, columns, dashed=tuple(name for name in columns if "impulse" in name)))
            used.update(columns)
    return charts


def motion_charts(table):
    """The rest of statistics.csv: momenta, drifts, the step, and what is left by unit."""
    used = set(NOT_DRAWN) | {name for chart in energy_charts(table) for name in chart.names}
    charts = vectors(table, (("Momentum and impulse", ("momentum", "impulse")),
                             ("Angular momentum", ("angular momentum",))), used)
    for name in ("momentum drift", "angular momentum drift"):
        if name in table:
            charts.append(Chart(name.capitalize(), table, [name], "relative"))
            used.add(name)
    specimen = [name for name in table.columns if name.startswith("specimen ")]
    used.update(specimen)  # drawn from specimen.csv, which has more rows
    return charts + by_unit(table, [name for name in table.columns if name not in used])


def by_unit(table, names, short=None):
    """One chart for the columns of each unit; columns without a unit are drawn alone, but for those
    of one stem ("probe stress xx", "probe stress yy")."""
    groups = {}
    for name in names:
        unit = table.units[name]
        groups.setdefault((unit, name if not unit else ""), []).append(name)
    charts = []
    for (_, _), columns in groups.items():
        for start in range(0, len(columns), 2 * N_COLOURS):
            part = columns[start:start + 2 * N_COLOURS]
            charts.append(Chart(title_of(part, short or {}), table, part, "" if len(part) == 1 else "value",
                                short or {}))
    return charts


def title_of(columns, short):
    texts = [short.get(name, name) for name in columns]
    title = texts[0] if len(texts) == 1 else f"{texts[0]}, {texts[1]}" + (" ..." if len(texts) > 2 else "")
    return title[:1].upper() + title[1:]


def surfaces(table):
    """{name of a contact or condition: {column: what follows the name}}, in the order of the table."""
    # Names may contain anything; that of a surface is what all its columns begin with.
    names = list(dict.fromkeys(match.group(1) for column in table.columns
                               if (match := re.fullmatch(r"(.+) mean force [xyz]", column))))
    result = {name: {} for name in names}
    for column in table.columns:
        if column in NOT_DRAWN:
            continue
        own = max((name for name in names if column.startswith(name + " ")), key=len, default=None)
        if own is None:
            match = PER_SURFACE.fullmatch(column)
            own = match.group(1) if match else column
        result.setdefault(own, {})[column] = column.removeprefix(own).strip() or column
    return result


def surface_charts(table):
    """[(name, charts)] of contact.csv, conditions.csv or sections.csv."""
    result = []
    for name, columns in surfaces(table).items():
        charts, used = [], set()
        for stem, title in SURFACE_CHARTS:
            own = [column for column, text in columns.items() if re.fullmatch(re.escape(stem) + r"( [xyz])?", text)]
            if own:
                charts.append(Chart(title, table, own, stem, columns))
                used.update(own)
        rest = [column for column in columns if column not in used]
        vector_stems = dict.fromkeys(columns[column][:-2] for column in rest
                                     if re.fullmatch(r".+ [xyz]", columns[column]))
        for stem in vector_stems:
            own = [column for column in rest if columns[column][:-2] == stem]
            charts.append(Chart(stem[:1].upper() + stem[1:], table, own, stem, columns))
            used.update(own)
        charts += by_unit(table, [column for column in rest if column not in used], columns)
        result.append((name, charts))
    return result


def largest_force(table, name):
    """The largest magnitude of the mean force of a surface and its time, or None."""
    columns = [f"{name} mean force {axis}" for axis in "xyz" if f"{name} mean force {axis}" in table]
    if not columns:
        return None
    size = sum(table[column]**2 for column in columns)**0.5
    row = max(range(len(size)), key=lambda index: size[index] if size[index] == size[index] else -1)
    return float(size[row]), table.units[columns[0]], float(table["time"][row])

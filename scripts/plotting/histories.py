# SPDX-License-Identifier: LGPL-2.1-or-later
"""The tables of a run over time: energies, momenta, probes, dimensions."""

import numpy

from . import style

COLOURS = ("#1f5f99", "#d1602a", "#3a8f4d", "#8a4fa0", "#b8960c", "#4a4a4a", "#c0427a", "#1b9aaa")

ENERGIES = ("kinetic energy", "elastic energy", "plastic dissipation", "hourglass energy",
            "viscous dissipation", "filter dissipation", "failure dissipation", "kernel renewal",
            "mass damping", "external work", "total energy")


def draw_lines(plot, table, names, label, dashed=()):
    """Columns over time, those left out that are zero but for rounding beside the others."""
    time = table["time"]
    largest = {name: numpy.max(numpy.abs(numpy.nan_to_num(table[name])), initial=0)
               for name in names}
    threshold = 1e-9 * max(largest.values())
    # Points only where a line would hide how few there are.
    marker = "." if len(time) <= 60 else None
    colour = 0
    for name in names:
        values = table[name]
        if largest[name] <= threshold:
            continue
        plot.plot(time, values, marker=marker, markersize=4,
                  linestyle="--" if name in dashed else "-", color=COLOURS[colour % len(COLOURS)],
                  label=name)
        colour += 1
    plot.set_xlabel(table.heading("time"))
    plot.set_ylabel(label)
    if colour == 0:
        plot.text(0.5, 0.5, "zero throughout", transform=plot.transAxes, ha="center", va="center",
                  color="#777777")
    elif len(names) > 1:
        plot.legend(fontsize=7, loc="upper left", bbox_to_anchor=(1.0, 1.02), borderaxespad=0.3)


def label_of(table, text, name):
    unit = table.units[name]
    return table.heading(name).replace(name, text, 1) if unit else text


def draw_energies(table, path):
    """Energies with their error, momentum with the impulse, share of the lattice mode."""
    groups = []
    energies = [name for name in ENERGIES if name in table]
    if energies:
        groups.append((energies, label_of(table, "energy", energies[0]), ("external work",)))
    if "energy error" in table:
        groups.append((["energy error"], "relative energy error", ()))
    momenta = [f"momentum {axis}" for axis in "xyz" if f"momentum {axis}" in table]
    impulses = [f"impulse {axis}" for axis in "xyz" if f"impulse {axis}" in table]
    if momenta:
        groups.append((momenta + impulses, label_of(table, "momentum", momenta[0]), impulses))
    drifts = [name for name in ("momentum drift", "angular momentum drift") if name in table]
    if drifts:
        groups.append((drifts, "relative drift", ()))
    if "lattice mode share" in table:
        groups.append((["lattice mode share"], "lattice mode share", ()))
    if not groups:
        return None
    figure, plots = style.panels(len(groups), 2, 5.2, 2.6)
    for plot, (names, label, dashed) in zip(plots, groups):
        draw_lines(plot, table, names, label, dashed)
    return style.save(figure, path)


def draw_heat(table, path):
    """Enthalpy beside what entered, the error of the balance, extreme temperatures; None where the
    run has no heat."""
    if "enthalpy" not in table:
        return None
    entered = [name for name in table.columns if name.startswith("heat through ")
               or name in ("plastic heat", "friction heat of bodies", "conducted heat of bodies")]
    temperatures = [name for name in table.columns if name.endswith("est nodal temperature")]
    figure, plots = style.panels(3, 1, 7.5, 2.4, sharex=True)
    draw_lines(plots[0], table, ["enthalpy"] + entered, label_of(table, "heat", "enthalpy"),
               ("enthalpy",))
    draw_lines(plots[1], table, ["heat balance error"], "relative error of the balance")
    draw_lines(plots[2], table, temperatures, label_of(table, "temperature", temperatures[0]))
    for plot in plots[:-1]:
        plot.set_xlabel("")
    return style.save(figure, path)


def draw_conditions(table, path):
    """Mean forces and moments of supports, drives, loads or sections, and the works of those that do
    work."""
    groups = []
    for text in ("mean force", "mean moment", "work"):
        names = [name for name in table.columns if f" {text} " in name + " "]
        if names:
            groups.append((names, label_of(table, text, names[0])))
    if not groups:
        return None
    figure, plots = style.panels(len(groups), 1, 7.5, 2.6, sharex=True)
    for plot, (names, label) in zip(plots, groups):
        draw_lines(plot, table, names, label)
    for plot in plots[:-1]:
        plot.set_xlabel("")
    return style.save(figure, path)


def draw_probes(table, path):
    """One panel for each unit of the columns."""
    names = [name for name in table.columns if name not in ("time", "step")]
    units = list(dict.fromkeys(table.units[name] for name in names))
    if not names:
        return None
    figure, plots = style.panels(len(units), 1, 7.5, 2.6, sharex=True)
    for plot, unit in zip(plots, units):
        own = [name for name in names if table.units[name] == unit]
        text = own[0] if len(own) == 1 else "value"
        draw_lines(plot, table, own, label_of(table, text, own[0]))
    for plot in plots[:-1]:
        plot.set_xlabel("")
    return style.save(figure, path)

#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Draws the convergence histories of the heated plate (Fig. 7 of the paper).

usage: draw_histories.py PICTURE TEMPERATURES EXPANSION [EXPANSION ...]

TEMPERATURES is the output directory of temperature.json beside this file. EXPANSION is an output
directory of parameter_files/heated_plate/expansion_*.prm, or "label=directory".
"""

import math
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "scripts"))
from plotting import style  # noqa: E402  found only with the path above
from plotting.results import Table  # noqa: E402

DIFFUSIVITY, CONDUCTIVITY, FLUX, THICKNESS = 237 / (2700 * 900), 237, 20e6, 10e-3


def exact(depth, time):
    """The exact temperature, from the Fourier series of the slab."""
    fourier = DIFFUSIVITY * time / THICKNESS**2
    xi = depth / THICKNESS
    total = fourier + (3 * (1 - xi)**2 - 1) / 6
    for n in range(1, 200):
        total -= (2 / math.pi**2 / n**2 * math.exp(-(n * math.pi)**2 * fourier)
                  * math.cos(n * math.pi * xi))
    return total * FLUX * THICKNESS / CONDUCTIVITY


def main():
    if len(sys.argv) < 3:
        sys.exit(__doc__)
    picture, temperatures, expansions = Path(sys.argv[1]), Path(sys.argv[2]), sys.argv[3:]
    figure, plots = style.panels(4 if expansions else 2, 2, 4.6, 3.0)
    times = [0.001 * k for k in range(101)]
    for plot, (probe, depth) in zip(plots, (("P1", 0.), ("P2", THICKNESS))):
        plot.plot(times, [exact(depth, t) for t in times], color=style.EXACT_COLOUR, label="exact")
        for n, mark in (("1", "o"), ("2", "s"), ("3", "^")):
            for kind, colour in (("fe", style.ELEMENT_COLOUR),
                                 ("particles affine", style.PARTICLE_COLOUR)):
                table = Table(temperatures / f"{kind} {n}" / "probes.csv")
                plot.plot(table["time"][::5], table[f"{probe} temperature"][::5], linestyle="none",
                          marker=mark, markersize=3.5, markerfacecolor="none", color=colour,
                          label=f"{'elements' if kind == 'fe' else 'particles'}, {n}")
        plot.set_title(f"{probe}, discretizations 1 to 3")
        plot.set_xlabel("time [s]")
        plot.set_ylabel("temperature [C]")
    for expansion in expansions:
        label, _, directory = expansion.rpartition("=")
        table = Table(Path(directory) / "probes.csv")
        middle = table["middle displacement z"]
        plots[2].plot(table["time"], 1e6 * table["P4 displacement x"], linewidth=0.8,
                      label=label or directory)
        plots[3].plot(table["time"], 1e6 * (table["P4 displacement z"] - middle), linewidth=0.8)
    if expansions:
        for plot, text in ((plots[2], "P4 along x"), (plots[3], "P4 against the middle, along z")):
            plot.set_title(text)
            plot.set_xlabel("time [s]")
            plot.set_ylabel("displacement [µm]")
        plots[2].legend(fontsize=7)
    plots[1].legend(fontsize=7)
    print(style.save(figure, picture))


if __name__ == "__main__":
    main()

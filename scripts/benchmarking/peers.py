# SPDX-License-Identifier: LGPL-2.1-or-later
"""The same rod by open packages of Debian and by this program: processor time of a node and step."""

import re
import shutil
import tempfile
from dataclasses import dataclass, field
from pathlib import Path

from .runs import (AFFINE, ELASTIC, FULLY_INTEGRATED, JOHNSON_COOK, ONE_POINT, PAPER, PARTICLE,
                   PERFECTLY_PLASTIC, BenchmarkError, median, rod, run, spacing_of, user_seconds)
from .tables import number, print_table

FOLDER = Path("benchmarks/peers")
SCENE = "benchmarks/rod.prm"
# {package: (command, Debian's package)}
PEERS = {"LAMMPS": ("lmp", "lammps"), "CalculiX": ("ccx", "calculix-ccx")}
TOMBOLO = "Tombolo"
STEP = 0.3  # over the spacing and the time of a wave, as in rod.lmp: stable in all packages
FEW_STEPS = 10  # of the run that is subtracted
SECONDS_OF_STEPS = 1.5  # of what is left, about


@dataclass
class Case:
    package: str
    label: str
    group: str           # rows of a group do about the same work
    cost: float          # about, in nanoseconds a node and step: for the number of steps
    options: dict = field(default_factory=dict)  # of a peer
    settings: list = field(default_factory=list)  # of this program


def bonds(style, horizon, cost):
    """Particles of LAMMPS with a horizon in spacings."""
    kind = "plastic" if style == "peri/eps" else "elastic"
    return Case("LAMMPS", f"{style}, horizon of {horizon:g} spacings", f"{kind} particles", cost,
                {"style": style, "horizon": horizon})


# Cases of a round, in this order. Horizons: 26 bonds a particle, as many as neighbours of a particle here, and the 3
# spacings that are usual (122 bonds), a little more so that round-off decides nothing.
CASES = [
    bonds("peri/lps", 1.8, 260),
    bonds("peri/lps", 3.001, 1800),
    Case(TOMBOLO, "affine, elastic", "elastic particles", 300, settings=[*PARTICLE, *ELASTIC, AFFINE]),
    Case(TOMBOLO, "paper's smoothing, elastic", "elastic particles", 250, settings=[*PARTICLE, *ELASTIC, PAPER]),
    bonds("peri/eps", 1.8, 450),
    bonds("peri/eps", 3.001, 2800),
    Case(TOMBOLO, "affine, perfectly plastic", "plastic particles", 350,
         settings=[*PARTICLE, *PERFECTLY_PLASTIC, AFFINE]),
    Case(TOMBOLO, "affine, Johnson-Cook", "plastic particles", 350, settings=[*PARTICLE, *JOHNSON_COOK, AFFINE]),
    Case("CalculiX", "C3D8R", "hexahedra, one point", 2600, {"element": "C3D8R"}),
    Case(TOMBOLO, "one point, elastic", "hexahedra, one point", 80, settings=[*ONE_POINT, *ELASTIC]),
    Case("CalculiX", "C3D8", "hexahedra, eight points", 7500, {"element": "C3D8"}),
    Case(TOMBOLO, "fully integrated, elastic", "hexahedra, eight points", 250,
         settings=[*FULLY_INTEGRATED, *ELASTIC]),
]


@dataclass
class Finished:
    """What a run prints of itself."""
    nodes: int
    steps: int
    neighbours: float = None


def choose_cases(there=shutil.which):
    """Of packages that are installed; prints which are not. An error where none is."""
    missing = {name: package for name, (command, package) in PEERS.items() if not there(command)}
    how = f"`scripts/setup --peers`, or on Debian: apt-get install {' '.join(missing.values())}"
    if len(missing) == len(PEERS):
        raise BenchmarkError(f"neither {' nor '.join(missing)} is installed ({how}).")
    if missing:
        print(f"{', '.join(missing)} is not installed and left out ({how}).", flush=True)
    return [case for case in CASES if case.package not in missing]


def read_lammps(text):
    """Of its log."""
    loop = re.search(r"^Loop time of \S+ on \d+ procs for (\d+) steps with (\d+) atoms", text, re.MULTILINE)
    per_atom = re.search(r"^\s*bonds/atom = ([\d.]+)", text, re.MULTILINE)
    if not loop or not per_atom:
        raise BenchmarkError("the log of LAMMPS has no end of a run with bonds:\n" + text[-1000:])
    return Finished(int(loop[2]), int(loop[1]), float(per_atom[1]))


def read_calculix(log, results):
    """Of what it prints, and of its file .frd, which numbers the step of the output at the end."""
    nodes = re.search(r"^\s*nodes:\s+(\d+)", log, re.MULTILINE)
    steps = re.findall(r"^ +1PSTEP +\d+ +(\d+)", results, re.MULTILINE)
    if not nodes or not steps or "Job finished" not in log:
        raise BenchmarkError("CalculiX has not come to its end:\n" + log[-1000:])
    return Finished(int(nodes[1]), int(steps[-1]))


def mesh_of(cells):
    """Nodes, cells and velocities of the rod, as lines of a deck of CalculiX."""
    spacing = spacing_of(cells)
    along, across = cells[0] + 1, cells[1] + 1
    indices = [(i, j, k) for k in range(cells[2] + 1) for j in range(across) for i in range(along)]
    nodes = [f"{n}, " + ", ".join(f"{spacing * index:.9g}" for index in node_indices)
             for n, node_indices in enumerate(indices, 1)]
    velocities = [f"{n}, {axis}, {value:.9g}" for n, (i, j, k) in enumerate(indices, 1)
                  for axis, value in enumerate((0.01 * (spacing * i - 5), -0.005 * spacing * j, -0.005 * spacing * k), 1)]
    lower = [1 + i + along * (j + across * k) for i, j, k in indices
             if i < cells[0] and j < cells[1] and k < cells[2]]
    corners = [0, 1, along + 1, along]
    corners += [corner + along * across for corner in corners]
    cell_lines = [f"{n}, " + ", ".join(str(first + corner) for corner in corners) for n, first in enumerate(lower, 1)]
    return {"nodes": "\n".join(nodes), "cells": "\n".join(cell_lines), "velocities": "\n".join(velocities)}


def run_lammps(root, case, cells, n_steps, directory):
    values = {"along": cells[0], "across": cells[1], "steps": n_steps, **case.options}
    variables = [part for name, value in values.items() for part in ("-var", name, value)]
    run([PEERS["LAMMPS"][0], "-in", root / FOLDER / "rod.lmp", "-log", f"{directory}/log", "-screen", "none", *variables])
    return read_lammps(Path(directory, "log").read_text("utf-8"))


def run_calculix(root, case, cells, n_steps, directory):
    step = STEP * spacing_of(cells)
    deck = (root / FOLDER / "rod.inp").read_text("utf-8").format(
        **mesh_of(cells), **case.options, step=f"{step:.9g}", end=f"{n_steps * step:.9g}", n_steps=n_steps)
    Path(directory, "rod.inp").write_text(deck, "utf-8")
    log = run([PEERS["CalculiX"][0], "-i", f"{directory}/rod"]).stdout
    return read_calculix(log, Path(directory, "rod.frd").read_text("utf-8"))


def run_case(program, root, case, cells, n_steps):
    """What the run prints, and its user time in seconds."""
    if case.package == TOMBOLO:
        done, seconds = user_seconds(lambda: program.run(SCENE, rod(cells, n_steps, step=STEP) + case.settings))
        return Finished(done.summary["nodes"], done.steps(), done.mean_neighbours()), seconds
    start = run_lammps if case.package == "LAMMPS" else run_calculix
    with tempfile.TemporaryDirectory() as directory:
        return user_seconds(lambda: start(root, case, cells, n_steps, directory))


def measure_case(program, root, case, cells):
    """By a few steps and by more."""
    n_nodes = (cells[0] + 1) * (cells[1] + 1) * (cells[2] + 1)
    more = FEW_STEPS + max(FEW_STEPS, round(SECONDS_OF_STEPS / (1e-9 * case.cost * n_nodes)))
    few, seconds_of_few = run_case(program, root, case, cells, FEW_STEPS)
    many, seconds = run_case(program, root, case, cells, more)
    if many.nodes != n_nodes or many.steps <= few.steps:
        raise BenchmarkError(f"{case.package} has run {many.nodes} nodes and {few.steps} and {many.steps} steps, "
                             f"in place of {n_nodes} nodes and {FEW_STEPS} and {more} steps.")
    return many, 1e9 * (seconds - seconds_of_few) / (n_nodes * (many.steps - few.steps))


def measure_peers(program, root, cells, rounds):
    """All cases in turn, round after round."""
    cases = choose_cases()
    rows = [{"package": case.package, "case": case.label, "group": case.group, "rounds": []} for case in cases]
    for one in range(rounds):
        for case, row in zip(cases, rows):
            done, nanoseconds = measure_case(program, root, case, cells)
            row.update(nodes=done.nodes, steps=done.steps, neighbours=done.neighbours)
            row["rounds"].append(nanoseconds)
        print(f"round {one + 1} of {rounds}", flush=True)
    for row in rows:
        row["ns_per_node_step"] = median(row["rounds"])
    return rows


def print_peers(rows):
    table = []
    for row in sorted(rows, key=lambda row: [case.group for case in CASES].index(row["group"])):
        # The first of a group has the defaults of the program.
        own = next(other["ns_per_node_step"] for other in rows
                   if other["group"] == row["group"] and other["package"] == TOMBOLO)
        table.append([row["group"], row["package"], row["case"], f"{row['nodes']:,}", row["steps"],
                      number(row["neighbours"]), number(row["ns_per_node_step"]),
                      f"{number(min(row['rounds']))} to {number(max(row['rounds']))}",
                      "" if row["package"] == TOMBOLO else f"{row['ns_per_node_step'] / own:.2f}"])
    print_table("The rod by open packages and by Tombolo, user time, one core, start-up taken away",
                ["work", "package", "case", "nodes", "steps", "neighbours", "ns/node-step", "rounds",
                 "over Tombolo's first"], table)

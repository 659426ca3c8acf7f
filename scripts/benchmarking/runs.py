# SPDX-License-Identifier: LGPL-2.1-or-later
"""Starts programs and whole runs of them."""

import json
import math
import os
import re
import resource
import subprocess
import tempfile
from dataclasses import dataclass
from pathlib import Path


class BenchmarkError(Exception):
    pass


def run(command):
    finished = subprocess.run([str(part) for part in command], capture_output=True, text=True,
                              check=False)
    if finished.returncode != 0:
        raise BenchmarkError(f"{' '.join(map(str, command))} failed:\n"
                             + (finished.stderr or finished.stdout)[-2000:])
    return finished


def user_seconds(call):
    """What a call returns, and the user time of the processes that it starts and waits for."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
    returned = call()
    return returned, resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before


def launcher(ranks):
    return [] if ranks == 1 else ["mpirun", "-n", ranks]


def available_cores():
    return len(os.sched_getaffinity(0))


@dataclass
class Run:
    """What a whole run leaves behind."""
    summary: dict
    log: str

    def steps(self):
        return self.summary["steps"]

    def mean_neighbours(self):
        """Of the particles, by the audit; none in a run without particles."""
        match = re.search(r"neighbours \d+ / ([\d.]+) / \d+ \(min / mean / max\)", self.log)
        return float(match.group(1)) if match else None


class Program:
    """The program under test."""

    def __init__(self, root, path=None):
        self.root = root
        self.path = Path(path) if path else root / "build/bin/tombolo"

    def _command(self, file, overrides, directory):
        return [self.path, self.root / file,
                *(part for one in [*overrides, f"Output directory = {directory}/run"]
                  for part in ("--set", one))]

    def start(self, file, overrides, directory, ranks=1, prefix=()):
        """A process of the run, which writes below @p directory."""
        command = [*prefix, *launcher(ranks), *self._command(file, overrides, directory),
                   "--quiet"]
        return subprocess.Popen([str(part) for part in command], stdout=subprocess.DEVNULL,
                                stderr=subprocess.PIPE, text=True)

    @staticmethod
    def finish(process, directory):
        _, errors = process.communicate()
        if process.returncode != 0:
            raise BenchmarkError(f"{' '.join(map(str, process.args))} failed:\n{errors[-2000:]}")
        results = Path(directory) / "run"
        return Run(json.loads((results / "summary.json").read_text("utf-8")),
                   (results / "log.txt").read_text("utf-8"))

    def run(self, file, overrides, ranks=1, prefix=()):
        with tempfile.TemporaryDirectory() as directory:
            return self.finish(self.start(file, overrides, directory, ranks, prefix), directory)

    def run_copies(self, file, overrides, copies):
        """Independent runs of one rank each, at the same time."""
        directories = [tempfile.TemporaryDirectory() for _ in range(copies)]
        try:
            processes = [self.start(file, overrides, directory.name) for directory in directories]
            return [self.finish(process, directory.name)
                    for process, directory in zip(processes, directories)]
        finally:
            for directory in directories:
                directory.cleanup()


NO_OUTPUT = ["Output/Times =", "Output/Number = 1", "Output/Write solution = false"]

# The rod of the elastic wave, with cubic cells.
ROD_LENGTH = 10.


def spacing_of(cells, length=ROD_LENGTH):
    return length / cells[0]


def rod(cells, n_steps, length=ROD_LENGTH, step=0.8):
    """Settings of a rod of @p cells that makes @p n_steps steps of so many spacings and writes nothing."""
    spacing = spacing_of(cells, length)
    # A wave crosses 0.9 to 1.3 cells in the largest step of the formulations. The step is fixed, so
    # that no run spends time on estimating it.
    step *= spacing
    return [
        f"Mesh/box/Upper corner = {length}, {cells[1] * spacing}, {cells[2] * spacing}",
        f"Mesh/box/Cells = {', '.join(map(str, cells))}",
        f"Time step/Fixed = {step}",
        f"End time = {step * n_steps}",
        *NO_OUTPUT,
    ]


def rod_cells(n_nodes):
    """Cells of a rod of about so many nodes, twelve times as long as it is wide."""
    across = max(2, round((n_nodes / 12) ** (1 / 3)) - 1)
    along = max(2, round(n_nodes / (across + 1) ** 2) - 1)
    return [along, across, across]


# Of benchmarks/rod.prm.
ELASTIC = [
    "Material: rod/Model = elastic",
    *(f"Material: rod/elastic/{entry}" for entry in (
        "Density = 100", "Young's modulus = 100", "Poisson's ratio = 0"))]
JOHNSON_COOK = [
    "Material: rod/Model = j2 plasticity",
    *(f"Material: rod/j2 plasticity/{entry}" for entry in (
        "Density = 100", "Young's modulus = 100", "Poisson's ratio = 0",
        "Flow stress = johnson cook", "Specific heat capacity = 1e-3",
        "Taylor-Quinney coefficient = 0.9", "Initial temperature = 298",
        "johnson cook/Yield stress = 0.05", "johnson cook/Hardening coefficient = 0.3",
        "johnson cook/Hardening exponent = 0.37", "johnson cook/Rate coefficient = 0.013",
        "johnson cook/Reference rate = 1e-4", "johnson cook/Thermal exponent = 1.09",
        "johnson cook/Melting temperature = 1356", "johnson cook/Reference temperature = 298"))]

PERFECTLY_PLASTIC = [
    "Material: rod/Model = j2 plasticity",
    *(f"Material: rod/j2 plasticity/{entry}" for entry in (
        "Density = 100", "Young's modulus = 100", "Poisson's ratio = 0",
        "Flow stress = linear hardening", "linear hardening/Yield stress = 0.05"))]

ONE_POINT = ["Part: rod/Formulation = hexahedron"]
FULLY_INTEGRATED = ["Part: rod/Formulation = fully integrated hexahedron"]
PARTICLE = ["Part: rod/Formulation = momentum consistent particle"]


def particle(entry):
    return f"Part: rod/momentum consistent particle/{entry}"


CURRENT = particle("Configuration = current")
PAPER = particle("Smoothing = paper")
AFFINE = particle("Smoothing = affine")


def median(values):
    values = sorted(values)
    middle = len(values) // 2
    return values[middle] if len(values) % 2 else math.fsum(values[middle - 1:middle + 1]) / 2

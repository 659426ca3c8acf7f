#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Builds the heat source with an installed Tombolo, runs it and checks what it gave.

usage: check.py PREFIX SOURCE DIRECTORY MPIEXEC CMAKE
"""

import csv
import subprocess
import sys
from pathlib import Path


def last_row(directory):
    with open(Path(directory) / "statistics.csv", newline="", encoding="utf-8") as file:
        row = list(csv.DictReader(file))[-1]
    return {name.split(" [")[0]: float(value) for name, value in row.items() if value}


def main():
    prefix, source, directory, mpiexec, cmake = sys.argv[1:6]
    build = f"{directory}/build"
    for command in ([cmake, "-S", source, "-B", build, f"-DCMAKE_PREFIX_PATH={prefix}"],
                    [cmake, "--build", build]):
        subprocess.run(command, check=True, stdout=subprocess.DEVNULL)

    def run(name, *settings, ranks=1, file="plate.prm", succeeds=True):
        command = [f"{prefix}/bin/tombolo", "--quiet", "--set",
                   f"Plugin libraries = {build}/libmoving_heat_source.so", "--set",
                   f"Output directory = {directory}/{name}"]
        for setting in settings:
            command += ["--set", setting]
        launcher = [mpiexec, "-n", str(ranks)] if ranks > 1 else []
        result = subprocess.run(launcher + command + [f"{source}/{file}"], text=True, check=False,
                                stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
        if (result.returncode == 0) != succeeds:
            sys.exit(f"{name} ended with {result.returncode}:\n{result.stdout}")
        return result.stdout

    problems = []

    def expect(is_true, text):
        if not is_true:
            problems.append(text)

    given = 0.1**2  # the integral of 2 t
    rows = []
    for name, ranks in (("one", 1), ("two", 2)):
        run(name, ranks=ranks)
        rows.append(last_row(f"{directory}/{name}"))
        row = rows[-1]
        expect(abs(row["heat of torch"] - given) <= 1e-12 * given,
               f"{name}: {row['heat of torch']} was given, not {given}")
        expect(abs(row["enthalpy"] - given) <= 1e-10 * given,
               f"{name}: the nodes have {row['enthalpy']}, not {given}")
        expect(abs(row["heat balance error"]) <= 1e-12,
               f"{name}: heat balance error {row['heat balance error']}")
        expect(abs(row["torch x"] - 0.8) < 0.05, f"{name}: the torch is at {row['torch x']}")
        expect(row["largest nodal temperature"] > 0.1, f"{name}: nothing became hot")
    for column, value in rows[0].items():
        other = rows[1][column]
        expect(column.endswith("error") or abs(other - value) <= 1e-9 * max(abs(value), 1e-3),
               f"{column}: {value} on one rank, {other} on two")

    text = run("radius", "Process: torch/moving heat source/Radius = 0", succeeds=False)
    expect("Radius" in text and "terminate" not in text, f"a radius of zero: {text}")
    text = run("type", "Process: torch/Type = moving heat sauce", succeeds=False)
    expect('Did you mean "moving heat source"' in text or "moving heat source" in text,
           f"an unknown process: {text}")
    for problem in problems:
        print(problem)
    sys.exit(1 if problems else 0)


if __name__ == "__main__":
    main()

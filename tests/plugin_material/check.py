#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Builds the Maxwell material with an installed Tombolo, runs it and compares with the closed form.

usage: check.py PREFIX SOURCE DIRECTORY CMAKE
"""

import csv
import math
import subprocess
import sys
from pathlib import Path


def main():
    prefix, source, directory, cmake = sys.argv[1:5]
    build = f"{directory}/build"
    for command in ([cmake, "-S", source, "-B", build, f"-DCMAKE_PREFIX_PATH={prefix}"],
                    [cmake, "--build", build]):
        subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
    program = [f"{prefix}/bin/tombolo", "--quiet", "--set",
               f"Plugin libraries = {build}/libmaxwell.so"]

    problems = []

    def expect(is_true, text):
        if not is_true:
            problems.append(text)

    output = Path(directory) / "shear"
    subprocess.run(program + ["--set", f"Output directory = {output}", f"{source}/shear.prm"],
                   check=True)
    with open(output / "statistics.csv", newline="", encoding="utf-8") as file:
        rows = [{name.split(" [")[0]: float(value) for name, value in row.items() if value}
                for row in csv.DictReader(file)]
    # The shear stress is G τ γ' (1 - exp(-t/τ)) until t = 1 and decays afterwards; the block has
    # the volume 1/2, and the dashpot takes the stress squared over G τ.
    tau, rate, volume = 0.5, 1e-5, 0.5
    largest = tau * rate * (1 - math.exp(-2))
    while_sheared = (tau * rate)**2 * (1 - (1 - math.exp(-2)) + (1 - math.exp(-4)) / 4)
    while_held = largest**2 * (1 - math.exp(-4)) / 4
    expect(len(rows) == 3, f"{len(rows)} rows, not 3")
    for row, exact in zip(rows[1:], (while_sheared, while_sheared + while_held)):
        exact *= volume / tau
        t, dissipated = row["time"], row["plastic dissipation"]
        expect(row["relative error of stress"] < 1e-4,
               f"the error of the stress is {row['relative error of stress']} at {t}")
        expect(abs(dissipated - exact) < 2e-3 * exact, f"{dissipated} is lost at {t}, not {exact}")
        expect(abs(row["energy error"]) < 1e-6, f"energy error {row['energy error']} at {t}")
        expect(abs(row["plastic heat"] - dissipated) < 1e-12 * exact,
               f"{row['plastic heat']} heats at {t}, not {dissipated}")
        expect(abs(row["heat balance error"]) < 1e-12,
               f"heat balance error {row['heat balance error']} at {t}")
        expect(row["largest nodal temperature"] > 0., f"nothing is warm at {t}")

    refused = subprocess.run(program + ["--set", "Material: putty/maxwell/Relaxation time = 0",
                                        f"{source}/shear.prm"],
                             text=True, check=False, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
    expect(refused.returncode != 0 and "Relaxation time" in refused.stdout,
           f"a relaxation time of zero is not refused: {refused.stdout}")
    for problem in problems:
        print(problem)
    sys.exit(1 if problems else 0)


if __name__ == "__main__":
    main()

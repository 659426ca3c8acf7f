#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Runs the Maxwell material and compares with the closed form."""

import math
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "plugin"))
import outside


def main():
    project = outside.Project("maxwell")
    expect = project.expect
    project.run("shear", "shear.prm")
    rows = project.rows("shear")
    # The shear stress is G τ γ' (1 - exp(-t/τ)) until t = 1 and decays afterwards; the block has
    # the volume 1/2, and the dashpot dissipates the stress squared over G τ.
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

    refused = project.run("refused", "shear.prm", "Material: putty/maxwell/Relaxation time = 0",
                          succeeds=False)
    expect("Relaxation time" in refused, f"a relaxation time of zero is not refused: {refused}")
    project.end()


if __name__ == "__main__":
    main()

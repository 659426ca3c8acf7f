#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Runs the corrected particle alone, beside elements, beside smoothed particles on two ranks, and with
heat conduction."""

import re
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "plugin"))
import outside

# Bounds of the magnitude of the last number of a name in the summary. The energy that central
# differences report is off by a term of second order in the time step; the pulse has crossed the
# middle of the rod.
MOTION = {"energy_error_relative": 3e-4, "momentum_drift_relative": 1e-12}
BOUNDS = (("rod", 1, {**MOTION, "angular_momentum_drift_relative": 1e-12, "stress_xx": 0.1}),
          ("coupled", 1, {**MOTION, "stress_xx": 0.05}),
          ("mixed", 2, {**MOTION, "stress_xx": 0.06}),
          ("bar", 1, {"heat_balance_error_relative": 1e-12, "temperature": 2e-3}))


def main():
    project = outside.Project("corrected_particle")
    for name, ranks, bounds in BOUNDS:
        project.run(name, f"{name}.prm", ranks=ranks)
        summary = project.path(name, "summary.json").read_text(encoding="utf-8")
        for key, bound in bounds.items():
            value = re.findall(rf'"{key}": *(-?[0-9][0-9.e+-]*)', summary)[-1]
            project.expect(abs(float(value)) < bound, f"{name}: {key} is {value}, not below {bound}")
    project.end()


if __name__ == "__main__":
    main()

#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Runs bodies with balls around their nodes and compares with closed forms."""

import sys
from math import log, sqrt
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "plugin"))
import outside

GAP, RADIUS = 0.5, 0.3
CANCELLING = ("drift", "error", "residual")


def main():
    project = outside.Project("balls")
    expect = project.expect

    def near(name, value, wanted, tolerance):
        expect(abs(value - wanted) <= tolerance, f"{name} is {value}, not {wanted}")

    def last_rows(scene):
        """The last rows of both tables, the same on one rank and on two."""
        both = []
        for ranks in (1, 2):
            project.run(f"{scene}_{ranks}", f"{scene}.prm", ranks=ranks)
            both.append({**project.rows(f"{scene}_{ranks}")[-1],
                         **project.rows(f"{scene}_{ranks}", "contact.csv")[-1]})
        for column, value in both[0].items():
            if not any(word in column for word in CANCELLING):
                near(f"{scene}: {column} on two ranks", both[1][column], value,
                     1e-7 * max(abs(value), 1e-2))
        return both[0]

    # Each bar has the mass 5. Waves need 2 L = 10 to end the contact.
    bars = last_rows("bars")
    near("impulse of the bars", bars["joint impulse x"], -0.05, 5e-4)
    touching = [row["time"] for row in project.rows("bars_1", "contact.csv") if row["joint nodes"] > 0]
    near("begin of the contact", touching[0], 20., 0.3)
    near("end of the contact", touching[-1], 30., 1.5)

    # Of the way at the end what is no gap and no overlap of balls shortens both bars. The Kirchhoff
    # stress is the logarithmic strain, and the width stays.
    rest = last_rows("rest")
    strain = (0.25 - GAP + RADIUS - rest["joint penetration"]) / 10
    expect(strain > 1e-3, f"nothing presses: {strain}")
    force = -log(1 - strain) / (1 - strain)
    near("force at rest", -rest["joint mean force x"], force, 1e-6 * force)

    corner = last_rows("corner")
    expect(corner["joint impulse x"] < -1e-4, "the corner is not hit")
    near("direction of the impulse", corner["joint impulse y"] / corner["joint impulse x"],
         -0.1 / sqrt(0.2**2 - 0.1**2), 0.02)
    near("drift of the angular momentum", corner["angular momentum drift"], 0., 1e-10)

    for scene, last in (("bars", bars), ("corner", corner)):
        near(f"{scene}: drift of the momentum", last["momentum drift"], 0., 1e-12)
        near(f"{scene}: error of the energy", last["energy error"], 0., 1e-3)

    balls = "Body contact: joint"
    for setting, words in ((f"{balls}/balls/Radius = 0", "Radius"),
                           (f"{balls}/Type = bals", 'Did you mean "balls"'),
                           (f"{balls}/balls/Radius = 0.6", "the bodies overlap at the start")):
        text = project.run("refused", "bars.prm", setting, succeeds=False)
        expect(words in text, f"{setting} is refused with other words: {text}")
    project.end()


if __name__ == "__main__":
    main()

#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Runs the heat source and the spring and checks them."""

import sys
from math import hypot
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "plugin"))
import outside

# What the mechanics of the expanding plate sums from terms that cancel: no relative error.
CANCELLING = ("momentum", "impulse", "drift", "error", "share")


def main():
    project = outside.Project("moving_heat_source", "point_spring")
    run, rows_of, expect = project.run, project.rows, project.expect

    def near(value, wanted, scale):
        return abs(value - wanted) <= 1e-12 * scale

    given_in_all = 0.1**2  # the integral of 2 t
    for scene in ("heat", "expansion"):
        tables = []
        for ranks in (1, 2):
            name = f"{scene}_{ranks}"
            text = run(name, f"{scene}.prm", ranks=ranks)
            expect('heat source "torch" of radius 0.08' in text, f"{name} does not describe it")
            tables.append(rows_of(name))
            expect(len(tables[-1]) == 3, f"{name} has {len(tables[-1])} rows, not 3")
            for row in tables[-1]:
                t = row["time"]
                expect(near(row["heat of torch"], t**2, given_in_all),
                       f"{name}: {row['heat of torch']} was given at {t}, not {t**2}")
                expect(near(row["enthalpy"], t**2, given_in_all),
                       f"{name}: the nodes have {row['enthalpy']} at {t}, not {t**2}")
                expect(near(row["heat balance error"], 0, 1),
                       f"{name}: heat balance error {row['heat balance error']} at {t}")
                for column, wanted in (("power of torch", 2 * t), ("torch x", 0.2 + 6 * t),
                                       ("torch y", 0.1)):
                    expect(near(row[column], wanted, 1), f"{name}: {column} is {row[column]} at {t}")
            expect(tables[-1][-1]["largest nodal temperature"] > 0.1, f"{name}: nothing became hot")
        # Volumes of cells have the round-off of positions, which strains are a small part of.
        round_off_factor = 100 if scene == "expansion" else 1
        for one, two in zip(*tables):
            for column, value in one.items():
                scale = round_off_factor * max(abs(row[column]) for row in tables[0])
                if not any(word in column for word in CANCELLING):
                    expect(near(two[column], value, scale),
                           f"{scene}: {column} is {value} on one rank, {two[column]} on two")

        # From the middle of the run, which is within a thermal step where there is mechanics.
        checkpoints = sorted(project.path(f"{scene}_1", "checkpoint").glob("step_*.h5"))
        expect(len(checkpoints) > 1, f"{scene}: {len(checkpoints)} checkpoints")
        run(f"{scene}_resumed", f"{scene}.prm",
            options=[f"--resume={checkpoints[(len(checkpoints) - 1) // 2]}"])
        expect(project.path(f"{scene}_resumed", "statistics.csv").read_bytes() ==
               project.path(f"{scene}_1", "statistics.csv").read_bytes(),
               f"{scene}: the resumed run is another one")
    expect(tables[0][-1]["thermal work"] != 0, "nothing expanded")
    run("at_rest", "expansion.prm", "Time integration = quasi-static", "Conditions = hold",
        "Condition: hold/Type = clamp", "Condition: hold/Boundary = x min")
    last = rows_of("at_rest")[-1]
    expect(near(last["heat of torch"], given_in_all, given_in_all) and last["thermal work"] != 0,
           "a body at rest is not heated")

    springs = ("between", "above", "inside")
    for smoothing in ("paper", "affine"):
        particles = "Part: particles/momentum consistent particle"
        tables = []
        for ranks in (1, 2):
            name = f"spring_{smoothing}_{ranks}"
            run(name, "spring.prm", f"{particles}/Smoothing = {smoothing}", ranks=ranks)
            tables.append(rows_of(name))
            expect(len(tables[-1]) == 6, f"{name} has {len(tables[-1])} rows, not 6")
            for row in tables[-1]:
                for column, most in (("energy error", 2e-5), ("momentum drift", 1e-12)):
                    expect(abs(row[column]) <= most, f"{name}: {column} is {row[column]}")
            last = tables[-1][-1]
            for spring in springs:
                expect(last[f"work of {spring}"] != 0, f"{name}: spring {spring} does no work")
            for row in rows_of(name, "springs.csv"):
                for spring, stiffness in zip(springs, (200, 100, 300)):
                    force = hypot(row[f"{spring} force x"], row[f"{spring} force y"])
                    expect(near(force, stiffness * row[f"{spring} length"], stiffness),
                           f"{name}: the force of {spring} is {force} at {row['time']}")
            works = sum(last[f"work of {spring}"] for spring in springs)
            expect(near(last["external work"], 0, 1) and works > 1e-7,
                   f"{name}: {works} is the work of all springs")
        for one, two in zip(*tables):
            for column, value in one.items():
                scale = max(abs(row[column]) for row in tables[0])
                if not any(word in column for word in CANCELLING):
                    expect(abs(two[column] - value) <= 1e-9 * scale,
                           f"{smoothing}: {column} is {value} on one rank, {two[column]} on two")
        checkpoints = sorted(project.path(f"spring_{smoothing}_1", "checkpoint").glob("step_*.h5"))
        expect(len(checkpoints) > 1, f"springs: {len(checkpoints)} checkpoints")
        run("spring_resumed", "spring.prm", f"{particles}/Smoothing = {smoothing}",
            options=[f"--resume={checkpoints[len(checkpoints) // 2]}"])
        expect(project.path("spring_resumed", "statistics.csv").read_bytes() ==
               project.path(f"spring_{smoothing}_1", "statistics.csv").read_bytes(),
               f"{smoothing}: the resumed run with springs is another one")
        rows = rows_of("spring_resumed", "springs.csv")  # from the checkpoint on
        expect(len(rows) > 1 and
               rows == rows_of(f"spring_{smoothing}_1", "springs.csv")[-len(rows):],
               f"{smoothing}: springs.csv of the resumed run is another one")
    # Clamped particles, which have no images at rest, and nodes between others above a plane of
    # symmetry, along which springs alone hold the body.
    particles = ("Mesh/Refine where =", "Condition: plane/Type = clamp",
                 "Condition: plane/Boundary = x min")
    for name, ranks, settings in (("particles", 1, particles),
                                  ("hanging", 1, ("Part: particles/Formulation = hexahedron",)),
                                  ("hanging", 2, ("Part: particles/Formulation = hexahedron",))):
        for stiffer in (1, 100):
            text = f"springs of {stiffer} at rest, {name} on {ranks}"
            run(f"{name}_at_rest", "spring.prm", "Time integration = quasi-static", *settings,
                *(f"Process: {spring}/point spring/Stiffness = {stiffness * stiffer}"
                  for spring, stiffness in (("between", 200), ("above", 100), ("inside", 300))),
                ranks=ranks)
            for row in rows_of(f"{name}_at_rest"):
                expect(abs(row["energy error"]) <= 1e-4 * stiffer,
                       f"{text}: energy error {row['energy error']}")
                expect(row["static iterations"] <= 4,
                       f"{text}: {row['static iterations']} iterations")
            expect(row["work of above"] != 0, f"{text}: a spring does no work")

    torch = "Process: torch/moving heat source"
    for ranks, settings, words, file in (
            (1, [f"{torch}/Radius = 0"], "Radius", "heat.prm"),
            (1, [f"{torch}/Radius = -1"], "Radius", "heat.prm"),
            (1, [f"{torch}/Path = 0.5"], "Path", "heat.prm"),
            (1, [f"{torch}/Path = x; 0"], "allowed are functions of t", "heat.prm"),
            (1, [f"{torch}/Power = 2*y"], "the power is that of the whole source", "heat.prm"),
            (2, [f"{torch}/Path = 1e9; 0"], 'heat source "torch" is too far from all nodes',
             "heat.prm"),
            (1, ["Process: torch/Type = moving heat sauce"], 'Did you mean "moving heat source"',
             "heat.prm"),
            (1, [], "the scene has no heat", "cold.prm")):
        text = run("refused_" + Path(file).stem, file, *settings, ranks=ranks, succeeds=False)
        expect(words in text and "terminate called" not in text,
               f"{settings} of {file} is refused with other words: {text}")
    project.end()


if __name__ == "__main__":
    main()

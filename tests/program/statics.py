#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""The strips of parameter_files/statics/, which are bent and released.

    statics.py PROGRAM MPIEXEC PROJECT SUBJECT

bitwise  A chain of static stages that is ended in a stage, or between two, and resumed leaves the same
         bits: what came after a checkpoint of a stage is removed, as if the run had been killed there,
         before `--resume`.
strip    Spring-back and the stress that is left against the closed form of ideal plasticity in plane
         strain (t = 2, R = 50, E = 70e3, nu = 0.3, yield stress 324), and how fast Newton's method
         converges while the strip flows.
cylinder Spring-back of a strip that is bent over a cylinder, by contact that the second stage does not
         have; a stage with contact that is ended and resumed leaves the same bits.
meshfree A bar of elements, smoothed cells and particles that is ended and resumed leaves the same bits.
stop     A signal ends a run within a long step, with the outputs of before.
"""

import json
import math
import os
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

for room in ("loaded", "regression"):
    sys.path.insert(0, str(Path(__file__).resolve().parents[1] / room))
import loaded
import run_case

PROGRAM, MPIEXEC, PROJECT, SUBJECT = sys.argv[1:5]
SETTINGS = {"Mesh/box/Cells": "16, 4", "Statics/Largest step": "0.125",
            "Checkpoint/Step interval": "3", "Checkpoint/Keep": "10", "Output/Times": "0, 0.5, 1"}


CYLINDER = "parameter_files/statics/cylinder.prm"
CYLINDER_SETTINGS = {"Mesh/box/Cells": "48, 4", "Statics/Largest step": "0.1",
                     "Checkpoint/Step interval": "3", "Checkpoint/Keep": "10"}


MESHFREE = "tests/regression/static_three_parts.prm"
MESHFREE_SETTINGS = {"Checkpoint/Step interval": "3", "Checkpoint/Keep": "10"}
STRIP = "parameter_files/statics/strip.prm"


def run(output, ranks, *options, settings=SETTINGS, scene=STRIP):
    command = [*loaded.start_of(PROGRAM)]
    if ranks > 1:
        command = [MPIEXEC, "-n", str(ranks), *command]
    command += ["--quiet", *options, f"{PROJECT}/{scene}",
                "--set", f"Output directory = {output}"]
    for entry, value in settings.items():
        command += ["--set", f"{entry} = {value}"]
    result = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                            check=False)
    if result.returncode != 0:
        sys.exit(f"{' '.join(command)} ended with {result.returncode}:\n{result.stdout}")
    return result.stdout


def results(output):
    return {path.relative_to(output): path.read_bytes() for path in sorted(output.rglob("*"))
            if path.suffix in (".csv", ".vtu")}


def compare(whole, resumed, what):
    different = [str(name) for name in sorted(set(whole) | set(resumed))
                 if whole.get(name) != resumed.get(name)]
    if different or len(whole) < 8:
        sys.exit(f"{what}: {len(whole)} files, other bits in {different}")
    print(f"{what}: the same bits in {len(whole)} files")


def judge(what, value, smallest, largest):
    print(f"{what}: {value:.6g} (from {smallest} to {largest})")
    if not smallest <= value <= largest:
        sys.exit(f"{what}: {value} is not from {smallest} to {largest}")


def strip():
    with tempfile.TemporaryDirectory() as directory:
        run(directory, 1, settings={})
        results_of = run_case.Results(directory)
        positions = results_of.field("release", "cells", "initial position")
        displacements = results_of.field("release", "cells", "displacement")
        stresses = results_of.field("release", "cells", "stress")
        nodes = [c[0] for c in results_of.field("release", "cells", "connectivity")]

        def angle(x):
            """By which the section at x has turned."""
            top, bottom = ([a + b for a, b in zip(position, displacement)]
                           for y in (1, -1)
                           for position, displacement in zip(positions, displacements)
                           if abs(position[0] - x) < 1e-9 and abs(position[1] - y) < 1e-9)
            return math.atan2(bottom[0] - top[0], top[1] - bottom[1])

        judge("curvature that is left over that of bending, over its closed form, less 1",
              (angle(4) - angle(2)) / 2 / 0.02 / 0.64310 - 1, -0.01, 0.01)
        layers = {}
        for cell, stress in enumerate(stresses):
            centre = [sum(positions[n][d] for n in nodes[4 * cell:4 * cell + 4]) / 4 for d in (0, 1)]
            if abs(centre[0] - 2.125) < 1e-6:
                layers[centre[1]] = stress[0]
        if len(layers) != 8:
            sys.exit(f"{len(layers)} layers, not 8")
        inside, next_inside, *_, next_outside, outside = (layers[y] for y in
                                                          sorted(layers, reverse=True))
        surface = 0.5 * ((1.5 * inside - 0.5 * next_inside) - (1.5 * outside - 0.5 * next_outside))
        judge("stress at the surfaces over its closed form, less 1", surface / 174.96 - 1, -0.03,
              0.03)

        log = (Path(directory) / "bend" / "log.txt").read_text(encoding="utf-8")
        orders = []
        for line in re.findall(r"statics, step (?:1[0-9]|20) .*: (.*)", log):
            # After the first iteration, which moves the supports, down to round-off.
            norms = [float(norm) for norm in line.split(", ")][1:]
            norms = [norm for norm in norms if norm > 1e-13]
            ratios = [b / a for a, b in zip(norms, norms[1:])]
            orders.append(math.log(ratios[-1]) / math.log(ratios[-2]) if len(ratios) > 2 else 2.)
            judge("last reduction of the residual in a step that flows", ratios[-1], 0, 1e-3)
        judge("steps", len(orders), 11, 11)
        judge("mean order of convergence", sum(orders) / len(orders), 1.5, 3)


def bitwise():
    with tempfile.TemporaryDirectory() as directory:
        for ranks in (1, 2):
            output = Path(directory) / f"whole {ranks}"
            run(output, ranks)
            whole = results(output)

            within = Path(directory) / f"within {ranks}"
            run(within, ranks)
            shutil.rmtree(within / "release")
            for name in ("summary.json", "checkpoint/end.h5", "checkpoint/step_000000000006.h5",
                         "checkpoint/step_000000000008.h5"):
                os.remove(within / "bend" / name)
            run(within, ranks, "--resume")
            compare(whole, results(within), f"{ranks} ranks, resumed within a stage")

            across = Path(directory) / f"across {ranks}"
            run(across, ranks)
            shutil.rmtree(across / "release")
            printed = run(across, ranks, "--resume")
            if "Stage: bend" in printed:
                sys.exit("a stage that was at its end began again")
            compare(whole, results(across), f"{ranks} ranks, resumed between stages")


def angle_of(results_of, stage):
    """By which the section at x has turned."""
    positions = {}
    for position, displacement in zip(results_of.field(stage, "cells", "initial position"),
                                      results_of.field(stage, "cells", "displacement")):
        positions[tuple(round(x, 6) for x in position[:2])] = [a + b for a, b in
                                                               zip(position, displacement)]

    def angle(x):
        top, bottom = positions[(x, 1.)], positions[(x, -1.)]
        return math.atan2(bottom[0] - top[0], top[1] - bottom[1])

    return angle


def cylinder():
    with tempfile.TemporaryDirectory() as directory:
        whole = Path(directory) / "whole"
        run(whole, 1, settings={}, scene=CYLINDER)
        results_of = run_case.Results(whole)
        bent, released = (angle_of(results_of, stage) for stage in ("bend", "release"))
        judge("radius of the middle on the cylinder, over that of cylinder and half the strip, less 1",
              3 / abs(bent(8.) - bent(5.)) / 50 - 1, -0.01, 0.01)
        judge("curvature that is left over that of bending, over its closed form, less 1",
              (released(8.) - released(5.)) / (bent(8.) - bent(5.)) / 0.64310 - 1, -0.02, 0.02)

        whole = Path(directory) / "coarse"
        run(whole, 2, settings=CYLINDER_SETTINGS, scene=CYLINDER)
        expected = results(whole)
        shutil.rmtree(whole / "release")
        checkpoints = sorted((whole / "bend" / "checkpoint").glob("step_*.h5"))
        if len(checkpoints) < 3:
            sys.exit("there are too few checkpoints to go back to one")
        for name in checkpoints[2:]:
            os.remove(name)
        os.remove(whole / "bend" / "checkpoint" / "end.h5")
        os.remove(whole / "bend" / "summary.json")
        run(whole, 2, "--resume", settings=CYLINDER_SETTINGS, scene=CYLINDER)
        compare(expected, results(whole), "2 ranks, resumed within a stage with contact")


def meshfree():
    with tempfile.TemporaryDirectory() as directory:
        for ranks in (1, 2):
            output = Path(directory) / str(ranks)
            run(output, ranks, settings=MESHFREE_SETTINGS, scene=MESHFREE)
            whole = results(output)
            checkpoints = sorted((output / "checkpoint").glob("step_*.h5"))
            if len(checkpoints) < 3:
                sys.exit("there are too few checkpoints to go back to one")
            for name in checkpoints[2:]:
                os.remove(name)
            os.remove(output / "summary.json")
            run(output, ranks, "--resume", settings=MESHFREE_SETTINGS, scene=MESHFREE)
            compare(whole, results(output), f"{ranks} ranks, three kinds of parts")


def stop():
    settings = {"Mesh/box/Cells": "160, 32", "Time integration": "dynamic relaxation",
                "Statics/Tolerance": "1e-14",
                "Statics/dynamic relaxation/Max iterations": "1000000000"}
    for ranks in (1, 2):
        with tempfile.TemporaryDirectory() as directory:
            command = [MPIEXEC, "-n", str(ranks)] if ranks > 1 else []
            command += [*loaded.start_of(PROGRAM), "--quiet",
                        f"{PROJECT}/tests/regression/static_cantilever.prm",
                        "--set", f"Output directory = {directory}"]
            for entry, value in settings.items():
                command += ["--set", f"{entry} = {value}"]
            log = Path(directory) / "log.txt"
            with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                                  text=True) as process:
                try:
                    while not (log.exists() and "t = 0 " in log.read_text(encoding="utf-8")):
                        if process.poll() is not None:
                            sys.exit(f"the run does not begin:\n{process.stdout.read()}")
                        time.sleep(0.05)
                    time.sleep(0.5)
                    # mpirun of Open MPI 5 kills ranks that do not end within 0.2 s.
                    children = Path(f"/proc/{process.pid}/task/{process.pid}/children")
                    for rank in children.read_text("utf-8").split() if ranks > 1 else [process.pid]:
                        os.kill(int(rank), signal.SIGTERM)
                    printed = process.communicate()[0]
                finally:
                    process.kill()
            ended = json.loads((Path(directory) / "summary.json").read_text(encoding="utf-8"))["ended"]
            if ended != "terminated" or process.returncode == 0:
                sys.exit(f"{ranks} ranks: {ended}, exit code {process.returncode}:\n{printed}")
            if "The run was ended within step 1" not in log.read_text(encoding="utf-8"):
                sys.exit("the log does not say in which step the run was ended")
            print(f"{ranks} ranks: ended within a step")


{"bitwise": bitwise, "strip": strip, "cylinder": cylinder, "meshfree": meshfree,
 "stop": stop}[SUBJECT]()

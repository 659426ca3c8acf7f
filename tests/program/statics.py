#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""A chain of static stages that is ended in a stage, or between two, and resumed leaves the same bits.

    statics.py PROGRAM MPIEXEC PROJECT

The strip of parameter_files/statics/strip.prm is bent and released: once to the end; then again, and
what came after a checkpoint of a stage is removed, as if the run had been killed there, before
`--resume`.
"""

import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "loaded"))
import loaded

PROGRAM, MPIEXEC, PROJECT = sys.argv[1:4]
SETTINGS = {"Mesh/box/Cells": "16, 4", "Statics/Largest step": "0.125",
            "Checkpoint/Step interval": "3", "Checkpoint/Keep": "10", "Output/Times": "0, 0.5, 1"}


def run(output, ranks, *options):
    command = loaded.start_of(PROGRAM)
    if ranks > 1:
        command = [MPIEXEC, "-n", str(ranks), *command]
    command += ["--quiet", *options, f"{PROJECT}/parameter_files/statics/strip.prm",
                "--set", f"Output directory = {output}"]
    for entry, value in SETTINGS.items():
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


def main():
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


main()

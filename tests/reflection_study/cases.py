# SPDX-License-Identifier: LGPL-2.1-or-later
"""Cases of the tests of the reflection study, and what comes of them."""

import os
import sys
import tempfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "scripts"))

from reflection.burst import send_burst  # noqa: E402
from reflection.case import ReflectionCase, Strip  # noqa: E402
from reflection.operators import Probes, StripOperators  # noqa: E402


def read_programs():
    """Of the command line: strip_operators and tombolo."""
    for variable in ("TOMBOLO_STRIP_OPERATORS", "TOMBOLO_PROGRAM"):
        os.environ[variable] = str(Path(sys.argv.pop(1)).resolve())


def into_particles(smoothing, bridge="paper", **settings):
    return ReflectionCase(right="particles", smoothing=smoothing, bridge=bridge, **settings)


def out_of_particles(smoothing, **settings):
    return ReflectionCase(left="particles", smoothing=smoothing, **settings)


def operators_of(cases):
    """The operators of each case."""
    with tempfile.TemporaryDirectory() as directory:
        strips = [Strip(case) for case in cases]
        probes = Probes(strips, directory, 2)
        for error in probes.failures.values():
            raise error
        return [StripOperators(strip, probes.file(strip)) for strip in strips]


def results_of(*cases):
    return [send_burst(case, operators) for case, operators in zip(cases, operators_of(cases))]

# SPDX-License-Identifier: LGPL-2.1-or-later
"""A stand-in for a program and one for mpirun, which sets its number of ranks; the packages of the fuzzer."""

import os
import sys
import tempfile

PROJECT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
sys.path[:0] = [os.path.join(PROJECT, *names) for names in (
    ["scripts"], ["tests", "loaded"], ["tests", "regression"], ["tests", "program"])]

LAUNCHER = r'''#!/usr/bin/python3
import os, sys
os.environ["STAND_IN_RANKS"] = sys.argv[2]
os.execv(sys.argv[3], sys.argv[3:])
'''


def judge_of(test, kind, program, patience):
    """A judge of this kind with a program of this text, until the test ends."""
    holder = tempfile.TemporaryDirectory(prefix="tombolo_judge_test_")
    test.addCleanup(holder.cleanup)
    names = []
    for name, text in (("program", program), ("launcher", LAUNCHER)):
        names.append(os.path.join(holder.name, name))
        with open(names[-1], "w") as file:
            file.write(text)
        os.chmod(names[-1], 0o755)
    return kind(names[0], os.path.join(holder.name, "runs"), names[1], patience)

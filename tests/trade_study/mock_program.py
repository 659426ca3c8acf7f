#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Stands for tombolo in the tests of studies: ends in all the ways in which programs end, as its
entry Behaviour requests, and writes value = slope * x + offset in summary.json and statistics.csv."""

import json
import os
import signal
import sys
import time
from pathlib import Path

if sys.argv[1:] == ["--version"]:
    print("mock program, version " + os.environ.get("MOCK_VERSION", "1"))
    sys.exit()

settings = dict(text.split(" = ", 1) for text in sys.argv[1:] if " = " in text)
log = os.environ.get("MOCK_LOG")
if log:
    with open(log, "a", encoding="utf-8") as file:
        file.write(" ".join(sys.argv[1:]) + "\n")
behaviour = settings.get("Model/Behaviour", "good")
x = float(settings.get("Model/x", "1"))
if "OMPI_COMM_WORLD_SIZE" in os.environ or "PMIX_RANK" in os.environ:
    sys.exit("the marks of MPI reach the run")
if behaviour == "refuses":
    print("\nError: file.prm:3: entry \"x\" = \"-1\": allowed is\n  a number above 0", file=sys.stderr)
    sys.exit(1)
if behaviour == "stops":
    print("\nThe run stopped: node 7 is lost.\nThe outputs written before are complete.")
    sys.exit(2)
if behaviour == "crashes":
    os.kill(os.getpid(), signal.SIGSEGV)
if behaviour == "hangs":
    signal.signal(signal.SIGTERM, signal.SIG_IGN)
    time.sleep(3600)
if behaviour == "mute":
    sys.exit(1)
if behaviour == "bounded" and x > 0.7:
    print("\nThe run stopped: x is too large.\n")
    sys.exit(2)
output = Path(settings["Output directory"])
output.mkdir(parents=True, exist_ok=True)

error = float(settings.get("Model/error", "1")) / x
with open(output / "statistics.csv", "w", encoding="utf-8") as file:
    file.write('time [s],"error, relative",undefined\n0,8,nan\n1,' + f"{-2 * error},nan\n2,{error},nan\n")
if behaviour != "silent":
    summary = {"wall_seconds": x, "limit": 0.5, "results": {"list": [{"length": 16.2 + error}]}}
    (output / "summary.json").write_text(json.dumps(summary), encoding="utf-8")

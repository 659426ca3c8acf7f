#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Stands for a program that measures runs: writes the number that it is given into measured.json of
the output directory, or fails where it is given none."""

import json
import sys
from pathlib import Path

directory, text = sys.argv[1:]
try:
    number = float(text)
except ValueError:
    sys.exit(f"there is no number {text}")
summary = json.loads((Path(directory) / "summary.json").read_text(encoding="utf-8"))
(Path(directory) / "measured.json").write_text(
    json.dumps({"sum": number + summary["wall_seconds"]}), encoding="utf-8")

#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Runs the scenes of doc/body_contact.md and draws them by scripts/plot_body_contact.

    body_contact_test.py PROGRAM
"""

import os
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

PROJECT = Path(__file__).resolve().parents[2]
PROGRAM = sys.argv.pop(1)


def draw(directory):
    return subprocess.run([sys.executable, "-B", "-m", "plotting.body_contact", str(directory)],
                          env=dict(os.environ, PYTHONPATH=str(PROJECT / "scripts")),
                          capture_output=True, text=True, check=False)


class PlotTest(unittest.TestCase):
    def test_scenes_are_drawn_against_their_closed_forms(self):
        with tempfile.TemporaryDirectory() as temporary:
            for scene in ("colliding_bars", "hertz_cylinders", "pressed_plate"):
                subprocess.run([PROGRAM, "--quiet", f"parameter_files/contact/{scene}.prm", "--set",
                                f"Output directory = {temporary}/{scene}"], cwd=PROJECT,
                               capture_output=True, check=True)
            finished = draw(temporary)
            self.assertEqual(finished.returncode, 0, finished.stderr)
            self.assertEqual({path.name for path in (Path(temporary) / "pictures").iterdir()},
                             {"bars.png", "cylinders.png", "plate.png"})
            rows = [line.split("|") for line in finished.stdout.splitlines()[2:]]
            self.assertEqual(len(rows), 3 + 2 + 4)
            for row in rows:
                self.assertLess(abs(float(row[4].split()[0])), 5, row)

    def test_a_directory_without_scenes_is_refused(self):
        with tempfile.TemporaryDirectory() as temporary:
            finished = draw(temporary)
            self.assertEqual(finished.returncode, 1)
            self.assertIn("has none of the scenes", finished.stderr)


if __name__ == "__main__":
    unittest.main()

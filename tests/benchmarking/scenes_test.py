#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""The program accepts every scene that scripts/benchmark runs.

    scenes_test.py PROGRAM
"""

import sys
import unittest
from pathlib import Path

TESTS = Path(__file__).resolve().parents[1]
sys.path[:0] = [str(TESTS / "python"), str(TESTS / "loaded")]

import loaded  # noqa: E402
from script_testing import PROJECT, DirectoryTest, run  # noqa: E402

from benchmarking import peers, roofline, scaling, solutions, whole, whole_runs  # noqa: E402
from benchmarking.runs import rod  # noqa: E402

PROGRAM = sys.argv.pop(1)
CELLS, N_STEPS = (12, 2, 2), 4


def scenes():
    """(name, parameter file, settings)."""
    small_rod = rod(CELLS, N_STEPS)
    for label, file, settings in whole_runs.WHOLE_RUNS:
        yield label, file, small_rod + settings
    for case in roofline.CASES:
        yield case.label, roofline.SCENE, small_rod + case.settings
    for case in peers.CASES:
        if case.package == peers.TOMBOLO:
            yield case.label, peers.SCENE, small_rod + case.settings
    for label, file, _ in scaling.SCENES:
        yield label, file, scaling.settings_of(file, CELLS, N_STEPS, 2)
    for scene in whole.read_scenes(PROJECT, None):
        yield scene.name, whole.FOLDER / scene.file, scene.run_to(1)
    problem = solutions.Problem(PROJECT)
    for model in problem.models:
        yield model.name, solutions.FOLDER / model.file, problem.settings_of(model, model.sizes[0])


class Scenes(DirectoryTest):
    def test_are_accepted(self):
        for name, file, settings in scenes():
            with self.subTest(name):
                words = [word for one in [*settings, f"Output directory = {self.directory}/run"] for word in ("--set", one)]
                done = run(*loaded.start_of(PROGRAM), "--dry-run", PROJECT / file, *words, **loaded.ALONE)
                self.assertEqual(done.returncode, 0, done.stderr)


if __name__ == "__main__":
    unittest.main()

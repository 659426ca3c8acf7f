#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""The blocks of doc/python.md run in their order; a scene, a run and a table report what is missing.

usage: page_test.py PROGRAM
"""

import os
import re
import sys
import tempfile
import unittest
from pathlib import Path

PROJECT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(PROJECT / "scripts"))

import tombolo  # noqa: E402

os.environ["TOMBOLO_PROGRAM"] = str(Path(sys.argv.pop(1)).resolve())


class PageTest(unittest.TestCase):
    def setUp(self):
        holder = tempfile.TemporaryDirectory()
        self.addCleanup(holder.cleanup)
        self.addCleanup(os.chdir, os.getcwd())
        os.chdir(holder.name)

    def test_the_blocks_of_the_page_run_in_order(self):
        names = {}
        blocks = re.findall(r"```python\n(.*?)```", (PROJECT / "doc/python.md").read_text("utf-8"), re.DOTALL)
        self.assertEqual(len(blocks), 5)
        for block in blocks:
            exec(compile(block, "doc/python.md", "exec"), names)  # pylint: disable=exec-used

    def test_a_missing_directory_and_table_are_named(self):
        Path("output/rod").mkdir(parents=True)
        with self.assertRaisesRegex(tombolo.TomboloError, 'Did you mean "rod"'):
            tombolo.Run("output/rdo")
        with self.assertRaisesRegex(tombolo.TomboloError, "contact.csv"):
            tombolo.Run("output/rod").contacts
        with self.assertRaisesRegex(AttributeError, 'Did you mean "contacts"'):
            tombolo.Run("output/rod").contact

    def test_columns_are_lists_without_arrays(self):
        Path("t.csv").write_text("time [s],x\n0,1\n1,\n", "utf-8")
        table = tombolo.Table("t.csv", arrays=False)
        self.assertEqual((table["time"], table.units), ([0, 1], {"time": "s", "x": ""}))

    def test_a_scene_is_written_and_read(self):
        tombolo.Scene({"Title": "A", "Mesh": {"box": {"Cells": [4, 2]}}, "Mesh/Type": "box"}).write("a.prm")
        self.assertEqual(tombolo.Scene("a.prm", {"Title": True}).entries,
                         {"Title": "true", "Mesh/box/Cells": "4, 2", "Mesh/Type": "box"})


if __name__ == "__main__":
    unittest.main()

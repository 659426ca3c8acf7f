# SPDX-License-Identifier: LGPL-2.1-or-later
"""What tests of scripts share: the packages of scripts/, a directory for each test, tables and commands."""

import os
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

PROJECT = Path(__file__).resolve().parents[2]
SCRIPTS = str(PROJECT / "scripts")
sys.path.insert(0, SCRIPTS)


class DirectoryTest(unittest.TestCase):
    """Each test has an empty directory, which is gone after it."""

    def setUp(self):
        holder = tempfile.TemporaryDirectory()
        self.addCleanup(holder.cleanup)
        self.directory = Path(holder.name)


def run(*command, **environment):
    return subprocess.run([str(word) for word in command], env={**os.environ, **environment}, capture_output=True,
                          text=True, check=False)


def run_module(name, *arguments):
    """A package of scripts/ as a command."""
    return run(sys.executable, "-B", "-m", name, *arguments, PYTHONPATH=SCRIPTS)


def write_table(path, headings, rows):
    lines = [",".join(headings)] + [",".join(str(value) for value in row) for row in rows]
    path.write_text("\n".join(lines) + "\n", "utf-8")

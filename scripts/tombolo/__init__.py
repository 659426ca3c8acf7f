# SPDX-License-Identifier: LGPL-2.1-or-later
"""Runs of Tombolo from Python: what they left behind, and scenes to run (doc/python.md)."""

from .errors import TomboloError
from .run import Run
from .scene import Scene
from .table import Table

__all__ = ["Run", "Scene", "Table", "TomboloError"]

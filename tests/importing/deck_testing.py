# SPDX-License-Identifier: LGPL-2.1-or-later
"""What tests of decks share: the importer, decks, and the measures of meshes."""

import csv
import os
import shutil
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

PROJECT = Path(sys.argv[1])
PROGRAM = sys.argv[2] if len(sys.argv) > 2 else None
DECKS = PROJECT / "tests" / "importing" / "decks"
sys.path.insert(0, str(PROJECT / "scripts"))
from importing.convert import convert  # noqa: E402
from importing.text import DeckError  # noqa: E402


def text_of(name):
    return (DECKS / name).read_text(encoding="utf-8")


def part_of(text, begin, end):
    first = text.index(begin)
    return text[first:text.index(end, first)]


def card(*fields, width=10):
    return "".join(f"{field:>{width}}" for field in fields)


def replaced(text, *changes):
    for old, new in changes:
        assert text.count(old) >= 1, old
        text = text.replace(old, new, 1)
    return text


class DeckTest(unittest.TestCase):
    def setUp(self):
        self.directory = Path(tempfile.mkdtemp())
        self.addCleanup(shutil.rmtree, self.directory)

    def write(self, name, text):
        path = self.directory / name
        os.makedirs(path.parent, exist_ok=True)
        path.write_bytes(text if isinstance(text, bytes) else text.encode())
        return path

    def converted(self, text, name, **options):
        path = self.write(name, text)
        return convert(path, path.with_suffix(".prm"), **options)

    def mesh(self, text, name, dimension=3):
        """The mesh alone."""
        return self.converted(text, name, dimension=dimension, is_mesh_alone=True).mesh

    def error(self, text, name, dimension=3):
        """What is said of a deck that is refused."""
        with self.assertRaises(DeckError) as context:
            self.mesh(text, name, dimension)
        return str(context.exception)

    def scene(self, text, name="deck.k", **options):
        """The scene, whose files are written, and all that is said of it, on one blank between words."""
        result = self.converted(text, name, **options)
        for path, content in result.files().items():
            path.write_text(content, encoding="utf-8")
        prm = self.directory / name
        return " ".join(prm.with_suffix(".prm").read_text(encoding="utf-8").split()), "\n".join(result.report.summary())

    def check_scene(self, text, name, *parts, runs=False, **options):
        """What is written and said has these parts, or has them not (!). --validate finds nothing wrong."""
        scene, said = self.scene(text, name, **options)
        for part in parts:
            if part.startswith("!"):
                self.assertNotIn(part[1:], scene + said)
            else:
                self.assertIn(part, scene + said)
        code, printed = self.run_program(*([] if runs else ["--validate"]), str(Path(name).with_suffix(".prm")))
        self.assertEqual(code, 0, printed)

    def rows(self, table, name="deck"):
        """The columns of a table by their names without units."""
        with open(self.directory / "output" / name / table, encoding="utf-8") as file:
            head, *rows = csv.reader(file)
        return {column.partition(" [")[0]: [float(row[k]) for row in rows] for k, column in enumerate(head)}

    def run_program(self, *options):
        result = subprocess.run([PROGRAM, *options], cwd=self.directory, capture_output=True, text=True, check=False)
        return result.returncode, result.stdout + result.stderr

    def dry_run(self, name):
        code, said = self.run_program("--dry-run", name)
        self.assertEqual(code, 0, said)
        return said

    def assert_volume(self, mesh, group, value):
        self.assertAlmostEqual(sum(volume(mesh, c) for c in mesh.groups[group]), value, 12)

    def assert_area(self, mesh, name, value):
        faces = {tuple(sorted(face)) for face in mesh.surfaces.get(name, ())}
        if name in mesh.node_sets:
            faces |= set(mesh.faces_of_nodes(mesh.node_sets[name]))
        self.assertAlmostEqual(mesh.area(faces), value, 12)

    def assert_remark(self, mesh, text):
        self.assertTrue(any(text in remark for remark in mesh.remarks), (text, mesh.remarks))


def volume(mesh, c):
    """Of a brick or a rectangle: the mean of the determinants at its corners."""
    return mesh.corners_of(mesh.cells[c])[0] / len(mesh.cells[c].nodes)


def same_measures(mesh, other):
    """Whether groups, surfaces and sets of nodes have the same names and sizes."""
    def all_of(one):
        return (one.dimension, len(one.cells), {name: len(cells) for name, cells in one.groups.items()},
                {name: round(one.area(faces), 12) for name, faces in one.surfaces.items()},
                {name: len(nodes) for name, nodes in one.node_sets.items()},
                round(sum(volume(one, c) for c in range(len(one.cells))), 12))
    return all_of(mesh) == all_of(other)


def main():
    unittest.main(argv=sys.argv[:1], verbosity=1)

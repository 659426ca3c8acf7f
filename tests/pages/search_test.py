#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Words of the trade find their pages: the ranking of the site, run by Node.js on the index of the site. Ends with 77 where
python3-markdown or Node.js is missing."""

import json
import shutil
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

PROJECT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(PROJECT / "scripts"))
SKIPPED = 77

# What a reader types, and the page that must be among the first results.
WANTED = {
    "restart": "checkpoint", "element deletion": "erosion", "spot weld": "contact", "CFL": "stable_step",
    "calibrate": "trade", "load curve": "conditions", "amplitude": "conditions", "mass scaling": "scaling",
    "hourglass": "taylor_impact stability parameters method", "friction": "contact", "rigid wall": "contact",
    "spring-back": "statics", "springback": "statics", "SPH": "smoothed_particles", "remeshing": "meshes",
    "half model": "symmetry", "rigid body": "rigid_bodies", "STL": "contact", "self-contact": "failure",
    "Johnson-Cook": "materials", "equation of state": "materials", "user material": "add_a_material",
    "parameter study": "trade", "import a deck": "meshes keywords", "post-processing": "results", "probes": "results",
    "convection": "heat_conditions", "residual stress": "friction_stir_welding statics", "mpirun": "performance building",
    "tensile instability": "stability pair_terms", "element-free Galerkin": "smoothed_cells", "exit code": "robustness",
    "implicit": "statics heat", "damping": "conditions", "bulk viscosity": "materials", "fracture": "failure",
    "time step": "parameters stable_step",
}
FIRST = 3

SCRIPT = """
const fs = require("fs"), ranking = require(process.argv[1]);
globalThis.window = {};
(0, eval)(fs.readFileSync(process.argv[2], "utf8"));
const prepared = ranking.prepare(window.searchIndex), queries = JSON.parse(process.argv[3]);
const found = {};
for (const query of queries)
  found[query] = ranking.find(prepared, query).sections.map(({ k, p, h, u }) => ({ k, p, h, u }));
console.log(JSON.stringify(found));
"""


def search(directory, queries):
    """The results of each query, the best first."""
    command = [node(), "-e", SCRIPT, str(directory / "search.js"), str(directory / "search-index.js"),
               json.dumps(list(queries))]
    return json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout)


def node():
    return shutil.which("node") or shutil.which("nodejs")


def file_of(result):
    return result["u"].partition("#")[0].removesuffix(".html")


class SearchTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.temporary = tempfile.TemporaryDirectory()
        cls.directory = Path(cls.temporary.name) / "site"
        site.make(PROJECT, cls.directory, has_classes=False)
        index = cls.directory / "search-index.js"
        text = index.read_text("utf-8")
        # Classes as Doxygen's tags give them.
        names = ("Checkpoint", "FrictionLaw", "RigidBody", "Erosion", "Damping", "Statics")
        classes = ",".join(json.dumps({"k": "class", "p": "Class", "h": name, "u": f"classes/{name}.html", "t": ""}) for name in names)
        end = text.rindex("]")
        index.write_text(text[:end] + "," + classes + text[end:], "utf-8")
        cls.found = search(cls.directory, [*WANTED, "checkpoint", "spring back", "self contact", "zyzzyva",
                                           "the", "drilling torque"])

    @classmethod
    def tearDownClass(cls):
        cls.temporary.cleanup()

    def test_words_of_the_trade_find_their_pages(self):
        self.assertGreaterEqual(len(WANTED), 31)
        wrong = {}
        for query, wanted in WANTED.items():
            first = [file_of(result) for result in self.found[query][:FIRST]]
            if not set(first) & set(wanted.split()):
                wrong[query] = first
        self.assertEqual(wrong, {})

    def test_pages_come_before_tables_and_classes(self):
        for query in ("checkpoint", "friction", "damping"):
            kinds = [result["k"] for result in self.found[query]]
            self.assertIn("class", kinds, query)
            self.assertEqual(set(kinds[:FIRST]) - {"page", "entries"}, set(), query)
            self.assertEqual(kinds[0], "page")

    def test_hyphens_are_blanks(self):
        for one, other in (("spring-back", "spring back"), ("self-contact", "self contact")):
            self.assertEqual(self.found[one], self.found[other])

    def test_all_words_must_be_there(self):
        self.assertEqual(self.found["zyzzyva"], [])
        self.assertIn("friction_drilling", [file_of(result) for result in self.found["drilling torque"][:FIRST]])
        # A word that means little is one where it is alone.
        self.assertNotEqual(self.found["the"], [])


class SynonymsTest(unittest.TestCase):
    def read(self, text):
        with tempfile.TemporaryDirectory() as temporary:
            file = Path(temporary) / "synonyms.txt"
            file.write_text(text, "utf-8")
            return synonyms.read(file)

    def test_lines_are_read_and_wrong_ones_refused(self):
        self.assertEqual(self.read("# a remark\na, b c = d, e f\n"), {"a": ["d", "e f"], "b c": ["d", "e f"]})
        for line, message in (("a\n", "expected"), ("a = \n", "expected"), ("a = b\na = c\n", "twice")):
            with self.assertRaisesRegex(synonyms.SynonymError, message):
                self.read(line)


if __name__ == "__main__":
    if node() is None:
        print("There is no Node.js (`scripts/setup nodejs` installs it): the search was not tried.")
        sys.exit(SKIPPED)
    try:
        from pages import site, synonyms
    except ModuleNotFoundError as error:
        print(f"{error} (`scripts/setup python3-markdown` installs it): no site was made.")
        sys.exit(SKIPPED)
    unittest.main()

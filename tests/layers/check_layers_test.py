#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Proves that check_layers.py can fail: one small project per rule, each wrong in one place."""

import tempfile
import unittest
from pathlib import Path

import check_layers


class CheckLayersTest(unittest.TestCase):
    def violations(self, files):
        with tempfile.TemporaryDirectory() as directory:
            root = Path(directory)
            for name, text in files.items():
                path = root / name
                path.parent.mkdir(parents=True, exist_ok=True)
                path.write_text(text, encoding="utf-8")
            return check_layers.check(root)[0]

    def assert_only(self, files, expected):
        found = self.violations(files)
        self.assertEqual(len(found), 1, found)
        self.assertTrue(found[0].startswith(expected), found)

    def test_lower_layers_may_be_included(self):
        self.assertEqual(self.violations({
            "include/tombolo/formulations/hexahedron.h":
                "#include <tombolo/base/a.h>\n#include <tombolo/mesh/a.h>\n"
                "#include <tombolo/state/a.h>\n#include <tombolo/approximation/a.h>\n"
                "#include <tombolo/materials/a.h>\n#include <tombolo/version.h>\n",
            "source/formulations/hexahedron.cc":
                "#include <tombolo/formulations/hexahedron.h>\n",
            "applications/program.cc": "#include <tombolo/simulation/simulation.h>\n",
        }), [])

    def test_a_higher_layer_is_refused_with_its_line(self):
        self.assert_only(
            {"include/tombolo/base/a.h": "#pragma once\n#include \"tombolo/state/field.h\"\n"},
            "include/tombolo/base/a.h:2: base must not include state")

    def test_every_upward_pair_is_refused(self):
        order = [["base"], ["mesh"], ["state"], ["approximation", "materials"],
                 ["formulations", "boundary", "contact"], ["coupling"], ["output"],
                 ["model"], ["physics"], ["simulation"], ["study/waves"]]
        # The studies run the program as another process.
        self.assertEqual({layer for rank in order for layer in rank} | {"study"},
                         set(check_layers.ALLOWED))
        for layer in set(check_layers.ALLOWED) - {"base", "output", "study"}:
            self.assertIsNotNone(check_layers.check_include("study", f"{layer}/a.h"))
        for layer in set(check_layers.ALLOWED) - {"study"}:
            self.assertIsNotNone(check_layers.check_include(layer, "study/a.h"))
        for rank, layers in enumerate(order):
            for layer in layers:
                for others in order[rank:]:
                    for other in others:
                        problem = check_layers.check_include(layer, f"{other}/a.h")
                        self.assertEqual(problem is None, layer == other, (layer, other))

    def test_approximation_and_materials_know_no_mesh_and_not_each_other(self):
        for layer, other in (("approximation", "mesh"), ("materials", "mesh"),
                             ("approximation", "materials"), ("materials", "approximation")):
            self.assert_only(
                {f"include/tombolo/{layer}/a.h": f"#include <tombolo/{other}/b.h>\n"},
                f"include/tombolo/{layer}/a.h:1: {layer} must not include {other}")

    def test_a_layer_that_does_not_exist_is_refused(self):
        self.assert_only({"applications/a.cc": "#include <tombolo/utilities/a.h>\n"},
                         "applications/a.cc:1: tombolo/utilities/a.h is in no layer")
        self.assert_only({"include/tombolo/utilities/a.h": ""},
                         "include/tombolo/utilities/a.h:1: is in the directory of no layer")

    def test_a_source_implements_a_header_of_its_layer(self):
        self.assert_only({
            "include/tombolo/mesh/a.h": "",
            "source/mesh/a.cc": "#include <tombolo/mesh/b.h>\n",
        }, "source/mesh/a.cc:1: does not include its own header")
        self.assert_only({"source/mesh/b.cc": "#include <tombolo/base/b.h>\n"},
                         "source/mesh/b.cc:1: has no header of its own")

    def test_a_header_among_the_sources_is_refused(self):
        self.assert_only({"source/mesh/a.h": ""}, "source/mesh/a.h:1: headers belong into")

    def test_a_long_file_is_refused(self):
        self.assertEqual(self.violations({"applications/a.cc": "\n" * 600}), [])
        self.assert_only({"applications/a.cc": "\n" * 601}, "applications/a.cc:601: has 601 lines")

    def test_a_path_of_one_machine_is_refused(self):
        # Put together here, so that this file does not name one.
        path = "/" + "home/somebody/mesh.msh"
        self.assert_only({"applications/a.cc": f"\nread(\"{path}\");\n"},
                         "applications/a.cc:2: names a path of one machine")


if __name__ == "__main__":
    unittest.main()

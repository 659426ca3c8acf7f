#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Proves that check_features.py can fail."""

import unittest

import check_features
import small_project


class CheckFeaturesTest(unittest.TestCase):
    def violations(self, files):
        return small_project.violations(check_features.check, files)

    def test_a_feature_may_be_named_in_its_own_files(self):
        self.assertEqual(self.violations({"source/contact/mortar_contact.cc": "MortarContact contact;\n",
                                          "source/physics/statics/steps.cc": "AtRest process;\n"}), [])

    def test_each_feature_is_noticed_in_a_foreign_file_with_its_line(self):
        for feature, code in (("archive", "StateArchive &archive;"), ("archive", "void serialize(A &a);"),
                              ("bonds", "Bonds bonds;"), ("bonds", "n_broken = 0;"),
                              ("conversion", "ConversionCriterion a;"), ("erosion", "refuse_erosion();"),
                              ("hanging-nodes", "collect(hanging_nodes, force);"), ("mirror-planes", "const Symmetry *a;"),
                              ("mortar", '#include <tombolo/contact/mortar_contact.h>'),
                              ("rigid-bodies", "RigidBodies<dim> a;"), ("scaled-inertia", "model.inertia_factor"),
                              ("statics", "class A : public AtRest {};")):
            found = self.violations({"source/model/a.cc": f"// words\n{code}\n"})
            self.assertEqual(found, [f"source/model/a.cc:2: names {feature}, and is none of its files"])

    def test_comments_are_no_names_and_messages_are(self):
        self.assertEqual(self.violations({"include/tombolo/model/a.h": "/** Erosion,\n mortar */ int a; // bonds\n"}), [])
        self.assertEqual(len(self.violations({"source/model/a.cc": 'fail("// erosion");\n'})), 1)

    def test_listed_files_are_known(self):
        self.assertEqual(self.violations({"source/model/a.cc": "Bonds bonds;\n",
                                          check_features.FOREIGN_NAMES: "# words\nbonds source/model/a.cc\n"}), [])

    def test_a_line_of_the_list_that_is_out_of_date_is_refused_with_the_command_that_renews_it(self):
        found = self.violations({"source/model/a.cc": "int a;\n",
                                 check_features.FOREIGN_NAMES: "bonds source/model/a.cc\n"})
        self.assertEqual(len(found), 1)
        self.assertIn("source/model/a.cc does not name bonds any more", found[0])
        self.assertIn("--list . > tests/layers/foreign_names.txt", found[0])

    def test_a_list_that_says_something_else_is_refused(self):
        for text in ("magic source/model/a.cc\n", "bonds source/a.cc\nbonds source/a.cc\n"):
            with self.assertRaises(ValueError):
                self.violations({check_features.FOREIGN_NAMES: text})


if __name__ == "__main__":
    unittest.main()
